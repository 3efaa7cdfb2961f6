"""What a script of the benchmark writes: one file of JSON lines, and its figures, each with its bar.

The first line says what was measured, where and when; then a line for each record; then a line for each figure. A
figure is formed only over answers that were checked and found clean, else it is refused.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.machine import ROOT, commit, machine, sources

Document = dict[str, Any]
Records = Mapping[str, Document]
"""Records by the names of their items; the key `findings` of each holds what is wrong with its answers."""

FOLDER = ROOT / "benchmarks" / "results"
SAMPLES = ROOT / "out" / "bench" / "quick"
"""Folder for results of a sample: no page is filled from there."""
WIDTH = 120
"""Characters of the tables, where the terminal has not more."""
T = TypeVar("T")


def progress(items: Iterable[T], about: str, total: float | None = None) -> Iterable[T]:
    """The items; standard error shows how many are over. `total`: their number, where they have no length."""
    return track(items, about, total, console=Console(stderr=True))


@dataclass(frozen=True)
class Figure:
    """`values`: one, or one for each set; None where `refused` says why. `bar`: likewise, or none at all.
    `beside`: the same figure of another commit, in words."""

    name: str
    values: tuple[float | None, ...]
    unit: str = ""
    bar: tuple[float, ...] = ()
    at_least: bool = False
    decimals: int = 1
    note: str = ""
    beside: str = ""
    refused: str | None = None

    def reached(self) -> str:
        """The values in words."""
        words = ["refused" if value is None else f"{value:.{self.decimals}f}" for value in self.values]
        return f"{' / '.join(words)} {self.unit}".strip()

    def required(self) -> str:
        """The bar in words; empty without one."""
        if not self.bar:
            return ""
        bars = " / ".join(f"{value:g}" for value in (self.bar[:1] if len(set(self.bar)) == 1 else self.bar))
        return f"at {'least' if self.at_least else 'most'} {bars} {self.unit}".strip()

    def met(self) -> str:
        """Whether the bar is met, by each value where they differ; empty without a bar."""
        if not self.bar:
            return ""
        words = []
        for value, bar in zip(self.values, self.bar, strict=True):
            good = value is not None and (value >= bar if self.at_least else value <= bar)
            words.append("?" if value is None else "yes" if good else "no")
        return words[0] if len(set(words)) == 1 else " / ".join(words)


def unclean(records: Records) -> str | None:
    """Why these records may not be used; None if every one was checked and has no fault."""
    found = [
        f"{name}: {record['findings'][0] if 'findings' in record else 'was not checked'}"
        for name, record in records.items()
        if record.get("findings") != []
    ]
    return f"{len(found)} not clean, first {found[0]}" if found else None


def figure(
    name: str,
    groups: Sequence[Records],
    value: Callable[[list[Document]], float | None],
    unit: str = "",
    bar: tuple[float, ...] = (),
    **more: Any,
) -> Figure:
    """A figure with a value for each group of records. A group that is empty, not clean, or has no value is refused."""
    values: list[float | None] = []
    reasons: list[str] = []
    for records in groups:
        why = unclean(records) if records else "nothing was measured"
        worth = value(list(records.values())) if why is None else None
        if why is None and (worth is None or not np.isfinite(worth)):
            why, worth = "no answer to measure", None
        values.append(None if worth is None else float(worth))
        reasons += [why] if why is not None else []
    return Figure(name, tuple(values), unit, bar, refused="; ".join(reasons) or None, **more)


def quantile(values: Iterable[float], share: float) -> float | None:
    """The quantile, or None of nothing."""
    there = list(values)
    return float(np.quantile(there, share)) if there else None


def of_planned(key: str, share: float, scale: float = 1e3) -> Callable[[list[Document]], float | None]:
    """The quantile of what planned answers have under a key, a time in s, in ms."""
    return lambda rows: quantile([scale * row[key] for row in rows if row["status"] == "planned"], share)


def finish(
    script: str, about: str, quick: bool, parameters: Document, records: Records, figures: Sequence[Figure]
) -> None:
    """Writes the result of a script, whole or not at all, and prints its figures."""
    path = (SAMPLES if quick else FOLDER) / f"{script}.jsonl"
    head = {
        "script": script,
        "about": about,
        "sample": quick,
        "date": datetime.now(UTC).date().isoformat(),
        **commit(),
        "sources": sources(),
        "machine": machine(),
        "parameters": parameters,
    }
    lines = [head, *({"item": name, **record} for name, record in records.items())]
    lines += [{"figure": each.name, **asdict(each)} for each in figures]
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_suffix(".part")
    beside.write_text("".join(json.dumps(line, allow_nan=False) + "\n" for line in lines), encoding="utf-8")
    beside.replace(path)
    show(figures, f"{about}{' (a sample)' if quick else ''}")


def show(figures: Sequence[Figure], title: str) -> None:
    """Prints figures with their bars, and below them the reasons for refused figures."""
    console = Console(width=max(WIDTH, Console().width))
    table = Table("figure", "bar", "reached", "met", "", title=title)
    for each in figures:
        table.add_row(
            each.name, each.required(), each.reached(), each.met(), "; ".join(filter(None, (each.beside, each.note)))
        )
    console.print(table)
    for each in figures:
        if each.refused is not None:
            console.print(f"refused: {each.name}: {each.refused}", soft_wrap=True)


def read(path: Path) -> tuple[Document, dict[str, Document], list[Figure]]:
    """Head, records and figures of a result."""
    head, *rest = (json.loads(line) for line in path.read_text(encoding="utf-8").splitlines())
    records = {line["item"]: line for line in rest if "item" in line}
    figures = []
    for line in rest:
        if line.pop("figure", None) is not None:
            figures.append(Figure(**{**line, "values": tuple(line["values"]), "bar": tuple(line["bar"])}))
    return head, records, figures

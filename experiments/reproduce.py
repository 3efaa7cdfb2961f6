"""Runs experiments and writes, for each, NAME.png, NAME.svg, NAME.json and NAME.md."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from assur.experiments.figures import write
from assur.experiments.registry import ENTRIES, Entry
from assur.planner.errors import InputError

ALL = "all"


@dataclass(frozen=True)
class Reproduced:
    """One experiment that was run, the `number`-th of `count`: the files that it left, the `paragraph`, and how long it
    took."""

    entry: Entry
    paragraph: str
    files: tuple[Path, ...]
    elapsed_s: float
    number: int
    count: int


def chosen(name: str) -> tuple[Entry, ...]:
    """The experiments that a name means. Raises `InputError` for a name that is neither one of them nor `all`."""
    found = ENTRIES if name == ALL else tuple(entry for entry in ENTRIES if entry.name == name)
    if not found:
        raise InputError("NAME", name, f"{ALL}, {', '.join(entry.name for entry in ENTRIES)}")
    return found


def reproduce(name: str, folder: Path) -> Iterator[Reproduced]:
    """Run the experiment `name`, or `all`, one after the other, into `folder`, which is made if it is not there."""
    entries = chosen(name)
    if folder.exists() and not folder.is_dir():
        raise InputError("--out", str(folder), "a folder")
    folder.mkdir(parents=True, exist_ok=True)
    for number, entry in enumerate(entries, start=1):
        yield _one(entry, folder, number, len(entries))


def _one(entry: Entry, folder: Path, number: int, count: int) -> Reproduced:
    started = time.perf_counter()
    result = entry.run()
    stem = folder / entry.name
    figures = write(result.draw, result.size, stem)
    numbers = stem.with_name(f"{entry.name}.json")
    document = {"experiment": entry.name, "source": entry.source, "numbers": result.numbers}
    numbers.write_text(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
    words = stem.with_name(f"{entry.name}.md")
    parts = (f"## {entry.title}", f"Source {entry.source}.", result.paragraph, f"![{entry.name}]({entry.name}.svg)")
    words.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    elapsed_s = time.perf_counter() - started
    return Reproduced(entry, result.paragraph, (*figures, numbers, words), elapsed_s, number, count)

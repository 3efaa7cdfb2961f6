"""A figure. It is formed only over answers that were checked and found clean; else it is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

Document = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Figure:
    """`value` in `unit`. `refused`: why there is no value."""

    name: str
    value: float | None
    unit: str = ""
    refused: str | None = None
    note: str = ""

    def document(self) -> Document:
        return asdict(self)


def unclean(records: Iterable[tuple[str, Mapping[str, Any]]]) -> str | None:
    """Why nothing may be said of these records by name; None if every one was checked and nothing was found."""
    found = []
    for name, record in records:
        findings = record.get("findings")
        if findings is None:
            found.append(f"{name}: was not checked")
        elif findings:
            found.append(f"{name}: {findings[0]}")
    if not found:
        return None
    return f"{len(found)} not clean, first {found[0]}"


def figure(
    name: str,
    records: Mapping[str, Mapping[str, Any]],
    value: Callable[[Sequence[Mapping[str, Any]]], float | None],
    unit: str = "",
    *,
    note: str = "",
) -> Figure:
    """The figure of the records, or a refusal: when one of them is not clean, there are none, or it has no value."""
    why = unclean(records.items()) if records else "nothing was measured"
    worth = value(list(records.values())) if why is None else None
    if why is None and (worth is None or not np.isfinite(worth)):
        why, worth = "no answer to measure", None
    return Figure(name, None if worth is None else float(worth), unit, why, note)


def quantile(values: Iterable[float], share: float) -> float | None:
    """The quantile, or None of nothing."""
    there = list(values)
    return float(np.quantile(there, share)) if there else None

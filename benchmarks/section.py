"""What a section of the benchmark is, to the runner."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any

from benchmarks.figures import Figure

Document = dict[str, Any]
Records = Mapping[str, Document]
"""Records by the names of their items, in the order of the items."""


@dataclass(frozen=True, slots=True)
class Item:
    """One thing to measure. Items of one `group` are measured in one warm process, another group in a fresh one."""

    group: str
    name: str


@dataclass(frozen=True, slots=True)
class Summary:
    """What a section comes to: figures, and the data that tables and plots are made of."""

    figures: tuple[Figure, ...]
    data: Document = field(default_factory=dict)


def died(record: Document) -> bool:
    """Whether there was a fault, or the measuring process died: the item is measured again when a run is resumed."""
    told = record.get("findings", [])
    return any(finding.startswith(("the measuring process died", "fault: ")) for finding in told)


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the benchmark.

    `parameters(quick)`: all that decides what is measured. `items`: what is measured, in order. `measuring(parameters,
    group)`: warms up and gives the function from an item's name to its record; a record has `findings`, what is wrong
    with its answers. `summary`: over all records. `one_core`: whether the measuring process keeps to one core.
    """

    name: str
    about: str
    parameters: Callable[[bool], Document]
    items: Callable[[Document], list[Item]]
    measuring: Callable[[Document, str], AbstractContextManager[Callable[[str], Document]]]
    summary: Callable[[Document, Records], Summary]
    one_core: bool = True
    limit_s: float = 120.0
    """Longest time that one item may take."""
    again: Callable[[Document], bool] = died
    """Whether a record is not kept when a run is resumed."""
    after: Callable[[Document, Records], None] | None = None
    """What is done once, after a full run, with all records."""

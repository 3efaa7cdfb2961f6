"""Which slots are free: those of grids at rest, which are exchanged when they are full, and those of carriers, which
come with their stream and leave."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from assur.scenes.schema.normal import normal
from assur.scenes.simulation.cell import SimulatedCell
from assur.scenes.streams.arrivals import ArrivingPart
from assur.scenes.streams.stream import Stream
from assur.scenes.tasks.grids import pose_of_slot
from assur.scenes.tasks.request_of_task import HANDLED

Document = dict[str, Any]
PATIENCE_S = 1.0
"""A motion that would wait longer for its part, or for its slot, is not committed yet: another one may be seen
meanwhile."""


@dataclass(frozen=True)
class FreeSlot:
    """A slot of a grid, by its number from 0, at rest or on a `carrier`. A motion to it may be planned at `free_s` or
    later; a part can be put down in it between `opens_s` and `leaves_s`."""

    grid: str
    number: int
    carrier: str | None = None
    free_s: float = -math.inf
    opens_s: float = -math.inf
    leaves_s: float = math.inf


@dataclass(frozen=True, eq=False)
class _Carrier:
    """A carrier that was seen, its stream by its number, and the parts in its slots, by grid and slot."""

    part: ArrivingPart
    number: int
    parts: dict[tuple[str, int], str] = field(default_factory=dict)


class Filling:
    """The slots of a cell during a run, and the parts in them."""

    def __init__(self, cell: SimulatedCell) -> None:
        stated = cell.kept.file.valid.slots
        self._cell, self._counts = cell, cell.chooser.counts
        self._grids: dict[str, Document] = {grid: normal(stated[grid].document()) for grid in self._counts}
        self._lying: dict[str, list[str]] = {grid: [] for grid, of in self._grids.items() if "kind" not in of}
        self._exchanged_s: dict[str, float] = {}
        """Of the grids that are full, when they are empty again, s."""
        self._carriers: dict[str, _Carrier] = {}

    def comes(self, part: ArrivingPart, number: int) -> None:
        """A carrier of the stream with this number is known."""
        self._carriers[part.name] = _Carrier(part, number)

    def leaves(self, name: str) -> list[str]:
        """A part of a stream is out of reach. Returns the names of the parts that leave with it: those in its slots."""
        carrier = self._carriers.pop(name, None)
        return [] if carrier is None else list(carrier.parts.values())

    def exchanged(self, grid: str) -> list[str]:
        """A full grid at rest is empty again. Returns the names of the parts that were in it."""
        del self._exchanged_s[grid]
        parts, self._lying[grid] = self._lying[grid], []
        return parts

    def first(self, grid: str, now_s: float, at_s: float) -> tuple[FreeSlot | None, float]:
        """The first slot of a grid to which a motion may be planned now, for a part that is put down by `at_s`, s; and
        when there may be one, if there is none."""
        later_s = math.inf
        for slot in self._free(grid):
            if slot.leaves_s < at_s:
                continue
            ready_s = max(slot.free_s, slot.opens_s - PATIENCE_S - (at_s - now_s))
            if ready_s <= now_s:
                return slot, now_s
            later_s = min(later_s, ready_s)
        return None, later_s

    def put(self, slot: FreeSlot, part: str, placed_s: float) -> float | None:
        """A part is put down in a slot at `placed_s`. Returns until when the exchange of its grid lasts, s, if that is
        at rest and full then."""
        if slot.carrier is not None:
            self._carriers[slot.carrier].parts[slot.grid, slot.number] = part
            return None
        self._lying[slot.grid].append(part)
        if len(self._lying[slot.grid]) < self._counts[slot.grid]:
            return None
        self._exchanged_s[slot.grid] = placed_s + self._grids[slot.grid].get("exchange_s", 0.0)
        return self._exchanged_s[slot.grid]

    def steps(self, part: str, window_m: list[float], slot: FreeSlot) -> list[Document]:
        """The pick of a part in a window of its stream, and the place in a slot."""
        if slot.carrier is None:
            return [{"transfer": {"parts": [part], "to": slot.grid, "window_m": window_m}}]
        grid = self._grids[slot.grid]
        stream = self._cell.streams[self._carriers[slot.carrier].number]
        place: Document = {
            "part": part,
            "name": f"place-{part}",
            "to": {**pose_of_slot(grid, slot.number + 1), "body": slot.carrier},
            "window_m": list(stream.window_m),
            "contact_with": [slot.carrier],
            **{key: grid[key] for key in HANDLED if key in grid},
        }
        return [{"pick": {"part": part, "name": f"pick-{part}", "window_m": window_m}}, {"place": place}]

    def _free(self, grid: str) -> Iterator[FreeSlot]:
        """The slots of a grid that are free, or will be: carriers in the order in which they were seen."""
        if grid in self._lying:
            at_s = self._exchanged_s.get(grid, -math.inf)
            yield FreeSlot(grid, len(self._lying[grid]) % self._counts[grid], free_s=at_s)
            return
        kind = self._grids[grid]["kind"]
        for name, each in self._carriers.items():
            if each.part.kind.name != kind:
                continue
            clear_s = self._cell.clear_s(each.number, each.part)
            for number in range(self._counts[grid]):
                if (grid, number) not in each.parts:
                    opens_s, leaves_s = self._within(each, grid, number)
                    yield FreeSlot(grid, number, name, clear_s, opens_s, leaves_s)

    def _within(self, carrier: _Carrier, grid: str, number: int) -> tuple[float, float]:
        """From when until when a slot of a carrier is in the window of its stream, s."""
        stream: Stream = self._cell.streams[carrier.number]
        x, y, _ = pose_of_slot(self._grids[grid], number + 1)["at_m"]
        ahead = x * math.cos(carrier.part.yaw_rad) - y * math.sin(carrier.part.yaw_rad)
        first, last = (carrier.part.passes_s(end - ahead, stream.speed_m_s) for end in stream.window_m)
        return first, last

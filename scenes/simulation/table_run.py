"""A run without plans: the streams, the choice of the next part, and cycles that take the times of the tables."""

from __future__ import annotations

import heapq
import math
from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from assur.scenes.simulation.cell import SimulatedCell
from assur.scenes.simulation.filling import PATIENCE_S, Filling, FreeSlot
from assur.scenes.simulation.run import RETRY_S
from assur.scenes.streams.arrivals import arrivals

if TYPE_CHECKING:
    from assur.planner.selection.next_part import KnownPart


def table_rate(cell: SimulatedCell, seed: int, until_s: float, planning_ms: float) -> float:
    """Parts a minute of a run with the parts of this seed, if every cycle took the time that the tables have for it:
    no obstacles, no refusals. Slots are filled as in a run. An arm that waits is in the refuge. The same arguments give
    the same number."""
    from assur.planner.selection import columns as c
    from assur.planner.selection.next_part import FreeArm, arm_after, next_part

    chooser, planning_s, now_s, placed = cell.chooser, planning_ms / 1e3, 0.0, 0
    times, refuge, ride_s = chooser.times, len(chooser.grids) - 1, float(chooser.times.rides[0, c.RIDE_PLACE])
    streams = [(number, stream) for number, stream in enumerate(cell.streams) if not stream.brings_carriers]
    parts = [(part, number) for number, stream in streams for part in arrivals(stream, seed, until_s)]
    coming = deque(
        (part.known_s, max(part.known_s, cell.clear_s(number, part)), chooser.known(cell.streams[number].name, part))
        for part, number in sorted(parts, key=lambda each: each[0].known_s)
    )
    leaves = times.lanes[:, c.LANE_LEAVES].tolist()
    from_refuge = np.flatnonzero(times.there[refuge, 0].min(axis=(1, 2, 3)) < c.UNREACHED).tolist()
    known: list[tuple[float, KnownPart]] = []
    slots = _Slots(cell, seed, until_s)
    place, way, mode, free_s = refuge, 0.0, 0, 0.0
    while now_s < until_s:
        slots.events(now_s)
        while coming and coming[0][0] <= now_s:
            known.append(coming.popleft()[1:])
        if free_s < now_s + planning_s:
            place, way, free_s = refuge, 0.0, now_s + planning_s
            mode = mode if mode in from_refuge else next(iter(from_refuge), mode)
        known = [each for each in known if each[1].passed_s + leaves[each[1].lane] >= free_s]
        free, slot_s = slots.free(now_s, free_s + chooser.nominal_s)
        ready = {part.name: part for clear_s, part in known if clear_s <= now_s and chooser.grids[part.place] in free}
        later_s = min([clear_s for clear_s, _ in known if clear_s > now_s], default=math.inf)
        later_s = max(min(later_s, slot_s, coming[0][0] if coming else math.inf), now_s + planning_s)
        points = [chooser.point(grid, free[grid].number if grid in free else 0) for grid in chooser.grids[:-1]]
        choices = next_part(free_s, FreeArm(place, way, mode, (*points, 0)), [*ready.values()], times, chooser.rule)
        best_s = choices[0].waits_until_s - PATIENCE_S if choices else math.inf
        if best_s > free_s + RETRY_S:
            now_s = min(later_s, max(best_s, now_s + planning_s))
            continue
        part = ready[choices[0].part]
        slot = free[chooser.grids[part.place]]
        row = np.array([free_s, place, way, mode, *points, 0], dtype=np.float64)
        after = arm_after(times, row, np.array([part.lane, part.passed_s, part.place], dtype=np.float64))
        known = [each for each in known if each[1] is not part]
        free_s = max(float(after[c.ARM_TIME]), slot.opens_s)
        place, way, mode = part.place, float(after[c.ARM_WAY]), int(after[c.ARM_MODE])
        decide_s = free_s - ride_s  # what is next is decided then, and the slot counts as filled
        slots.put(slot, part.name, decide_s)
        placed += free_s <= until_s
        now_s = max(now_s + planning_s, decide_s)
    return 60.0 * placed / until_s


class _Slots:
    """The slots of a run, and when carriers come and leave, and full grids are exchanged."""

    def __init__(self, cell: SimulatedCell, seed: int, until_s: float) -> None:
        self._cell, self._filling = cell, Filling(cell)
        carriers = [(number, stream) for number, stream in enumerate(cell.streams) if stream.brings_carriers]
        parts = [(part, number) for number, stream in carriers for part in arrivals(stream, seed, until_s)]
        self._coming = deque(sorted(parts, key=lambda each: each[0].known_s))
        self._ends: list[tuple[float, str, bool]] = []
        """When a carrier is out of reach, or the exchange of a grid is over, s; its name; and whether it is a grid."""

    def events(self, now_s: float) -> None:
        """What happens up to a time, s."""
        while self._coming and self._coming[0][0].known_s <= now_s:
            part, number = self._coming.popleft()
            self._filling.comes(part, number)
            left_s = part.passes_s(self._cell.leaves_m[number], self._cell.streams[number].speed_m_s)
            heapq.heappush(self._ends, (left_s, part.name, False))
        while self._ends and self._ends[0][0] <= now_s:
            _, name, is_grid = heapq.heappop(self._ends)
            (self._filling.exchanged if is_grid else self._filling.leaves)(name)

    def free(self, now_s: float, at_s: float) -> tuple[dict[str, FreeSlot], float]:
        """The next free slot of each grid that has one for a part that is put down by `at_s`; and when there may be one
        for the others, s."""
        found, later_s = dict[str, FreeSlot](), self._coming[0][0].known_s if self._coming else math.inf
        for grid in self._cell.chooser.grids[:-1]:
            slot, ready_s = self._filling.first(grid, now_s, at_s)
            if slot is None:
                later_s = min(later_s, ready_s)
            else:
                found[grid] = slot
        return found, later_s

    def put(self, slot: FreeSlot, part: str, placed_s: float) -> None:
        """A part is put down in a slot."""
        exchanged_s = self._filling.put(slot, part, placed_s)
        if exchanged_s is not None:
            heapq.heappush(self._ends, (exchanged_s, slot.grid, True))

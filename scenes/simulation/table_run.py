"""A run without plans: the streams, the choice of the next part, and cycles that take the times of the tables."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from assur.scenes.simulation.cell import SimulatedCell
from assur.scenes.simulation.filling import PATIENCE_S
from assur.scenes.simulation.run import RETRY_S
from assur.scenes.streams.arrivals import arrivals

if TYPE_CHECKING:
    from assur.planner.selection.next_part import KnownPart


def table_rate(cell: SimulatedCell, seed: int, until_s: float, planning_ms: float) -> float:
    """Parts a minute of a run with the parts of this seed, if every cycle took the time that the tables have for it:
    no obstacles, no refusals. An arm that waits is in the refuge. The same arguments give the same number."""
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
    filled = dict.fromkeys(chooser.grids[:-1], 0)
    place, way, mode, free_s = refuge, 0.0, 0, 0.0
    while now_s < until_s:
        while coming and coming[0][0] <= now_s:
            known.append(coming.popleft()[1:])
        if free_s < now_s + planning_s:
            place, way, free_s = refuge, 0.0, now_s + planning_s
            mode = mode if mode in from_refuge else next(iter(from_refuge), mode)
        known = [each for each in known if each[1].passed_s + leaves[each[1].lane] >= free_s]
        ready = {part.name: part for clear_s, part in known if clear_s <= now_s}
        later_s = min([clear_s for clear_s, _ in known if clear_s > now_s], default=math.inf)
        later_s = max(min(later_s, coming[0][0] if coming else math.inf), now_s + planning_s)
        slots = (*(chooser.point(grid, count) for grid, count in filled.items()), 0)
        choices = next_part(free_s, FreeArm(place, way, mode, slots), [*ready.values()], times, chooser.rule)
        best_s = choices[0].waits_until_s - PATIENCE_S if choices else math.inf
        if best_s > free_s + RETRY_S:
            now_s = min(later_s, max(best_s, now_s + planning_s))
            continue
        part = ready[choices[0].part]
        row = np.array([free_s, place, way, mode, *slots], dtype=np.float64)
        after = arm_after(times, row, np.array([part.lane, part.passed_s, part.place], dtype=np.float64))
        known = [each for each in known if each[1] is not part]
        grid = chooser.grids[part.place]
        filled[grid] = (filled[grid] + 1) % chooser.counts[grid]
        free_s, place, way, mode = float(after[c.ARM_TIME]), part.place, float(after[c.ARM_WAY]), int(after[c.ARM_MODE])
        placed += free_s <= until_s
        now_s = max(now_s + planning_s, free_s - ride_s)
    return 60.0 * placed / until_s

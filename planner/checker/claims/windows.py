"""Whether as much time is left in the window of a point as an arrival says: how much later it could be met."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.checker import along
from assur.planner.checker.along import MEET_M
from assur.planner.checker.laws import tables
from assur.planner.checker.meeting import measured, posed
from assur.planner.checker.motion import Tables
from assur.planner.checker.targets import Target
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import Arrival

LEFT_S = 1e-6
"""By how much the time that is left may be off, s; and by what a belt needs for `MEET_M`, as windows along it are kept
to that."""
LOOKED_S = 60.0
"""So long after the start, s, a window along a conveyor is looked at: what is open then counts as closed."""
MOST_S = 3600.0
"""A window along a conveyor is not looked at for longer, s."""


def windows(world: World, arrivals: tuple[Arrival, ...], found: tuple[Target, ...]) -> list[Finding]:
    """A finding for each arrival that says another time left in its window than there is, or says one of no window."""
    findings = list[Finding]()
    if [arrival.step for arrival in arrivals] != list(range(len(found))):
        return findings  # it is not said of which point an arrival is, which `meeting` finds
    for i, (arrival, target) in enumerate(zip(arrivals, found, strict=True)):
        window, said, where = target.step.window, arrival.window_left_s, f"arrivals[{i}].window_left_s"
        if (window.time is None and window.along is None) is not (said is None):
            what = f"{target.step.name} has {'no' if said is not None else 'a'} window, and it is said otherwise"
            findings.append(Finding(Code.CLAIM, what, where=where))
        elif said is not None:
            off = _off(world, arrival, target, said)
            if not off <= LEFT_S:
                what = f"the time left in the window of {target.step.name} is not what the answer says"
                findings.append(Finding(Code.CLAIM, what, off if math.isfinite(off) else math.nan, "s", where))
    return findings


def _off(world: World, arrival: Arrival, target: Target, said: float) -> float:
    """By how much the time that is left is not what is said, s; inf: it cannot be shown."""
    scene, law, window = world.scene, world.scene.frames[target.frame].law, target.step.window
    latest = math.inf if scene.options.latest_end_s is None else scene.options.latest_end_s
    closes = min(law.valid[1], latest, math.inf if window.time is None else window.time[1])
    left = max(closes - arrival.until, 0.0)
    if window.along is None or law.kind not in ("conveyor", "linear"):
        return abs(said - left)
    if not 0.0 <= said <= min(left + LEFT_S, MOST_S):
        return math.inf
    # the point stays inside for as long as is said, and not for longer
    end = arrival.until + said
    made = tables(scene, world.knots, world.start, end + 1.0)
    inner = max(end - LEFT_S, arrival.until)
    if _outside(world, target, arrival.until, inner, made, MEET_M):
        return math.inf
    over = said >= left - LEFT_S or end >= scene.start.time + LOOKED_S - LEFT_S
    beyond = min(end + LEFT_S, closes)
    return 0.0 if over or _outside(world, target, beyond, beyond, made, -MEET_M) else math.inf


def _outside(world: World, target: Target, t0: float, t1: float, made: Tables, wider: float) -> bool:
    """Whether the point is not shown to stay inside its window along the conveyor, `wider` by so much, m, at both ends,
    over [t0, t1]."""
    way = measured(world.scene.frames[target.frame].law)
    if way is None or target.step.window.along is None:
        return True
    direction, zero = way
    low, high = target.step.window.along
    row, found = np.zeros(along.NUMBERS), np.zeros(4)
    more = wider - MEET_M  # the kernel allows as much by itself
    asked = [(along.FRAME, world.frame[target.frame]), (along.FOLLOWS, zero + low - more)]
    asked += [(along.HEIGHT, zero + high + more), *((along.TCP + k, direction[k]) for k in range(3))]
    for column, value in asked + posed(target.point):
        row[column] = value
    along.keeps(along.ALONG, row, t0, t1, made, found)
    return bool(found[0] != 0.0)

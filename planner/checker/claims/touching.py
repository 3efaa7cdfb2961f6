"""Whether a tool is as near to the part that it takes, and a part to what it is put down on, as is said and required.

Distances are searched where the knots have the arm when the part changes hands, from both sides: two points that are so
near, and a normal along which no point of both is nearer.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import IntArray
from assur.planner.checker.jets import TABLES
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.motion import LINKS, Tables, all_jets, carry
from assur.planner.checker.nearest import WITHIN_M
from assur.planner.checker.rows import Apart
from assur.planner.checker.separation import HINT, ITEM, ONE, ONE_ON, OTHER, OTHER_ON, distance
from assur.planner.checker.solids import CARRIER, FIRST, I2, Solids
from assur.planner.checker.verdict import Code, Finding
from assur.planner.compiled import kernel
from assur.planner.model.outcome import Arrival, LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Pick, Place, Scene, Step


@kernel(f"UniTuple(float64, 2)({I2}, float64, {TABLES}, float64)", allocates=True)
def distance_between(pair: IntArray, t: float, tables: Tables, claimed: float) -> tuple[float, float]:
    """A lower and an upper value of the distance, m, of two bodies at an instant, as near to each other as it takes to
    say on which side of `claimed` it is. `pair` (2, 3): their first pieces, how many, and their carriers. NaN where it
    is not known; the lower one is less than 0 where they meet."""
    jets, item, low, high = all_jets(tables), np.zeros(ITEM), math.inf, math.inf
    for c in (pair[0, 2], pair[1, 2]):
        if not carry(0 if c < tables[0][0, LINKS] else c, t, t, tables, jets):
            return math.nan, math.nan
    item[ONE_ON], item[OTHER_ON] = pair[0, 2], pair[1, 2]
    for i in range(pair[0, 0], pair[0, 0] + pair[0, 1]):
        for k in range(pair[1, 0], pair[1, 0] + pair[1, 1]):
            item[ONE], item[OTHER], item[HINT], item[HINT + 1], item[HINT + 2] = i, k, 0.0, 0.0, 1.0
            least, most = distance(tables, jets, item, claimed)
            low, high = min(low, least), min(high, most)
    return low, high


def distances(apart: Apart, scene: Scene, arrivals: tuple[Arrival, ...]) -> list[Finding]:
    """Findings about how far tools and supports are from parts, as arrivals say it, and where a step asks for it."""
    found = list[Finding]()
    for i, arrival in enumerate(arrivals):
        step = scene.task[arrival.step]
        told = (("grip_m", Pick, arrival.grip_m), ("support_m", Place, arrival.support_m))
        for field, kind, said in told:
            its_own = isinstance(step, kind)
            pairs = _pairs(apart, scene, arrival) if its_own else []
            where = f"arrivals[{i}].{field}"
            if said is not None and not pairs:
                what = f"{step.name} has nothing of which {field} could be measured"
                found.append(Finding(Code.CLAIM, what, where=where))
            elif said is not None:
                found += _untrue(apart, step.name, pairs, arrival, said, where)
            if its_own:
                found += _too_far(apart, step, pairs, arrival.until)
    return found


def _pairs(apart: Apart, scene: Scene, arrival: Arrival) -> list[IntArray]:
    """The pairs of bodies of which the nearest counts, as `distance_between` takes them."""
    step = scene.task[arrival.step]
    for number, phase in enumerate(apart.phases):
        ends = phase.step == arrival.step and phase.kind is LegKind.FOLLOW and abs(phase.t1 - arrival.until) <= TIME_S
        if ends and step.part is not None:
            names = [(other, step.part) for other in _others(scene, phase, step.part)]
            return [pair_of(apart.table, number, *both) for both in names]
    return []


def _others(scene: Scene, phase: Phase, part: str) -> list[str]:
    """Of a pick the tool's bodies, of a place what the part may rest on."""
    if isinstance(scene.task[phase.step], Pick):
        return [body.name for body in scene.tool.bodies]
    return sorted({name for names in phase.contacts if part in names for name in names} - {part})


def pair_of(table: Solids, phase: int, one: str, other: str) -> IntArray:
    """Two bodies as `distance_between` takes them, as they are carried in a phase."""
    pair = np.empty((2, 3), dtype=np.int64)
    for row, name in zip(pair, (one, other), strict=True):
        body = table.number[name]
        seat = table.seats[table.seat[phase, body]]
        row[:] = seat[FIRST], table.count[body], seat[CARRIER]
    return pair


def _untrue(apart: Apart, step: str, pairs: list[IntArray], arrival: Arrival, said: float, where: str) -> list[Finding]:
    """A finding if what is said is off by more than `WITHIN_M`: there are no points so near, or nearer ones."""
    below = [distance_between(pair, arrival.until, apart.tables, said - WITHIN_M)[0] for pair in pairs]
    above = [distance_between(pair, arrival.until, apart.tables, said + WITHIN_M)[1] for pair in pairs]
    # bodies that meet are at 0
    low, high = max(float(np.min(below)), 0.0), float(np.min(above))
    if high - said <= WITHIN_M and said - low <= WITHIN_M:
        return []
    what = f"the part of {step} is not at the distance that is said"
    return [Finding(Code.CLAIM, what, max(high - said, said - low), "m", where)]


def _too_far(apart: Apart, step: Step, pairs: list[IntArray], until: float) -> list[Finding]:
    """A finding if the part is farther away than its step allows, by more than `WITHIN_M`, or not shown not to be."""
    allowed = math.inf
    if isinstance(step, Pick | Place):
        allowed = step.grip_within_m if isinstance(step, Pick) else step.support_within_m
    if allowed == math.inf:
        return []
    most = allowed + WITHIN_M
    high = float(np.min([distance_between(pair, until, apart.tables, most)[1] for pair in pairs], initial=math.inf))
    if high <= most:
        return []
    beside = "the tool" if isinstance(step, Pick) else "what it may rest on"
    what = f"the part of {step.name} is farther from {beside} than is allowed"
    return [Finding(Code.ERROR, what, high - allowed, "m", f"{until:.6g} s")]

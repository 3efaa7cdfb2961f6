"""Whether the tool can be farther from a control point than an arrival says (equation U4), and whether what the arrival
says of it is so: what each cause adds, and one realisation that comes near the largest error.

All combinations of signs of what a request does not know are looked at: errors of the frame, joints that lag to either
end, and a start that is late by any time (`error_terms`). An error that is stated may be larger than ours, since a
planner has bounds of its own, but not by much.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.checker.claims.error_terms import DIRECTION, LATE, Terms, gone, terms_of
from assur.planner.checker.targets import Target
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.laws.law import EXACT
from assur.planner.model.arrival_error import ArrivalError, Cause
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import Handled, Phase
from assur.planner.model.scene import Trace

ROUNDING_M, ROUNDING_RAD = 1e-9, 1e-9
MORE, MORE_M, MORE_RAD, BOWS = 0.05, 1e-5, 1e-5, 2.0
"""Share, m and rad by which an error that is stated, and what a cause adds to it, may be larger than ours, and by which
a realisation may stay below it; and as often what counts for bent ways, of which a planner has bounds of its own."""
LESS = 2e-6
"""m or rad by which what one cause adds may be smaller than ours: only what all of them add is bounded from above."""
Four = tuple[float, float, float, float]
UNITS = ("m", "m", "m", "rad")


def accuracies(
    world: World, arrivals: tuple[Arrival, ...], found: tuple[Target, ...], phases: tuple[Phase, ...]
) -> list[Finding]:
    """Findings about arrivals whose error is not what they say, or larger than their step allows."""
    findings: list[Finding] = []
    if [arrival.step for arrival in arrivals] != list(range(len(found))):
        return findings  # it is not said of which point an arrival is
    if world.scene.exact:
        return [
            Finding(Code.ERROR, f"all is known of {arrival.control_point}, and an error is stated", where=_field(i))
            for i, arrival in enumerate(arrivals)
            if arrival.error is not None
        ]
    for i, (arrival, target) in enumerate(zip(arrivals, found, strict=True)):
        handled = next((phase.handled for phase in phases if phase.step == arrival.step), Handled())
        if isinstance(target.step, Trace):
            target = replace(target, point=target.step.end)  # where the tool is when it is done
        shifting = {belt for phase in phases if phase.step == arrival.step for belt in phase.corrected}
        shifting = set() if target.step.tracks else shifting - {target.frame}
        terms = terms_of(world, arrival, target, handled, shifting)
        bound = terms.bound()
        findings += _stated(target, arrival, terms, bound) + _allowed(target, arrival, bound)
        if arrival.error is not None:
            findings += _causes(terms, arrival.error, i) + _worst(world, target, arrival, terms, i)
    return findings


def _field(i: int) -> str:
    return f"arrivals[{i}].error"


def _more(terms: Terms, amount: float, unit: str) -> float:
    """The largest number that may be stated where ours is `amount`."""
    rounding, more = (ROUNDING_RAD, MORE_RAD) if unit == "rad" else (ROUNDING_M, MORE_M)
    more += 0.0 if unit == "rad" else BOWS * terms.bows
    return amount * (1.0 + MORE) + more if amount > 0.0 else rounding


def _stated(target: Target, arrival: Arrival, terms: Terms, bound: Four) -> list[Finding]:
    """Errors that are smaller, or much larger, than ours."""
    said, name, where = arrival.error, target.step.name, f"{arrival.until:.6g} s"
    within = EXACT if said is None else said.within
    stated = (0.0 if said is None else said.position_m, within.position_m, within.vertical_m, within.yaw_rad)
    findings = list[Finding]()
    hows = ("far", "far to the side", "far up or down", "much turned")
    for what, amount, least, unit in zip(hows, stated, bound, UNITS, strict=True):
        rounding = ROUNDING_RAD if unit == "rad" else ROUNDING_M
        if not amount >= least - rounding:
            text = f"the tool may be more {what} off {name} than its arrival says"
            findings.append(Finding(Code.ERROR, text, least - amount, unit, where))
        elif not amount <= _more(terms, least, unit):
            text = f"the tool cannot be as {what} off {name} as its arrival says"
            findings.append(Finding(Code.ERROR, text, amount - least, unit, where))
    return findings


def _allowed(target: Target, arrival: Arrival, bound: Four) -> list[Finding]:
    """A finding where a step allows less."""
    allowed, where = target.step.tolerance, f"{arrival.until:.6g} s"
    far, turned = bound[0] - allowed.position_m, bound[3] - allowed.yaw_rad
    if far <= ROUNDING_M and turned <= ROUNDING_RAD:
        return []
    text = f"the tool may be farther off {target.step.name} than its tolerance allows"
    return [Finding(Code.ERROR, text, far if far > 0.0 else turned, "m" if far > 0.0 else "rad", where)]


def _causes(terms: Terms, said: ArrivalError, i: int) -> list[Finding]:
    """What each cause adds, the largest first; a cause that adds nothing is none."""
    where, own = f"{_field(i)}.causes", dict[Cause, tuple[float, float]]()
    for cause in Cause:
        far, _, _, yaw = terms.bound(cause)
        if far > 0.0 or yaw > 0.0:
            own[cause] = far, yaw
    findings = list[Finding]()
    names = [share.cause for share in said.shares]
    least = {cause for cause, (far, yaw) in own.items() if far > ROUNDING_M or yaw > ROUNDING_RAD}
    if len(set(names)) != len(names) or not least <= set(names) <= set(own):
        told = ", ".join(map(str, own)) or "none"
        findings.append(Finding(Code.ERROR, f"the causes of the error are {told}, and others are stated", where=where))
        return findings
    for share in said.shares:
        for amount, true, unit in zip((share.position_m, share.yaw_rad), own[share.cause], ("m", "rad"), strict=True):
            if not true - LESS <= amount <= _more(terms, true, unit):
                what = f"what is added to the error by {share.cause} is not what the answer says"
                findings.append(Finding(Code.ERROR, what, abs(amount - true), unit, where))
    sizes = [(share.position_m, share.yaw_rad) for share in said.shares]
    if sizes != sorted(sizes, reverse=True):
        findings.append(Finding(Code.ERROR, "the largest cause of the error must come first", where=where))
    return findings


def _worst(world: World, target: Target, arrival: Arrival, terms: Terms, i: int) -> list[Finding]:
    """Whether the realisation that is stated is one, and comes near the largest error that is stated."""
    said, where = arrival.error, f"{_field(i)}.worst"
    if said is None:
        return []
    told = dict(said.worst)
    vectors = {name: vector for _, name, vector in terms.signed if vector.any()}
    flat, upright = sum(terms.flat.values()), sum(terms.upright.values())
    may_be = {*vectors, *terms.joints} | ({LATE} if len(terms.late_s) > 1 else set()) | ({DIRECTION} if flat else set())
    slight = {name for name, moved in terms.joints.items() if not moved > ROUNDING_M}
    must_be = may_be - slight - (set() if flat > ROUNDING_M else {DIRECTION})
    signs_are = all(abs(told[name]) == 1.0 for name in told if name not in (LATE, DIRECTION))
    if len(told) != len(said.worst) or not must_be <= set(told) <= may_be or not signs_are:
        what = f"the realisation that is stated is none: it has to say {', '.join(sorted(must_be)) or 'nothing'}"
        return [Finding(Code.ERROR, what, where=where)]
    late = told.get(LATE, 0.0)
    if not float(terms.late_s[0]) - ROUNDING_M <= late <= float(terms.late_s[-1]) + ROUNDING_M:
        return [Finding(Code.ERROR, "the robot cannot be as late as the realisation that is stated", where=where)]
    off = sum((told[name] * vector for name, vector in vectors.items()), np.zeros(3))
    off = off + gone(world, target, arrival.until, late) - _lagged(world, terms, told)
    side = np.array(off[:2]) + flat * np.array([math.cos(told.get(DIRECTION, 0.0)), math.sin(told.get(DIRECTION, 0.0))])
    far = math.hypot(*side.tolist(), abs(float(off[2])) + upright) + sum(terms.yaw.values()) * terms.grasp
    if not far >= said.position_m * (1.0 - MORE) - MORE_M - BOWS * terms.bows:
        what = f"the realisation that is stated for {target.step.name} does not come near the error that is stated"
        return [Finding(Code.ERROR, what, said.position_m - far, "m", where)]
    return []


def _lagged(world: World, terms: Terms, told: dict[str, float]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """How far (3,), m, the tool is moved by joints that lag with the signs that are told; any sign of the others."""
    if not terms.signs.shape[1]:
        return np.zeros(3)
    names = [joint.name for joint in world.scene.robot.joints]
    fits = np.ones(len(terms.signs), dtype=bool)
    for j, name in enumerate(names):
        if name in told:
            fits &= terms.signs[:, j] == told[name]
    return np.asarray(terms.lagged[int(np.flatnonzero(fits)[0])])

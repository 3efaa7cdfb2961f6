"""A joint that exceeds a limit after the start in every motion that ends at rest (W2 of docs/guarantees.md)."""

from __future__ import annotations

import math

from assur.planner.checker.legs import START, TIME_S, dwell
from assur.planner.checker.limits import share_of
from assur.planner.checker.refusals.start import amount_of, same
from assur.planner.checker.spline import JERK, RATE
from assur.planner.checker.world import REST
from assur.planner.model.attachments import at_start
from assur.planner.model.proofs.witness import PROVED_SHARE
from assur.planner.model.refusal import Overshoot, Refusal
from assur.planner.model.scene import Place, Scene

HALVINGS = 200
"""Of a bracket of times: it is as small as rounding allows by then."""
INSTANT = 1e-6
"""Relative: two instants at which a velocity is 0 are the same if they differ by no more."""


def overshoot(scene: Scene, refusal: Refusal, facts: Overshoot) -> str:
    """Why it is not shown that a joint must exceed a limit after the start; nothing: it must."""
    k = next((k for k, joint in enumerate(scene.robot.joints) if joint.name == refusal.joint), None)
    if k is None or facts.rate not in (None, "velocity"):
        return "the robot has no such joint, or the joint no such limit"
    if not scene.options.jerk_limited or scene.options.end != "rest":
        return "the motion may end before, or its jerk is not limited"
    return "" if any(_shown(scene, refusal, facts, k, sign) for sign in (1.0, -1.0)) else "the joint can keep its limit"


def _shown(scene: Scene, refusal: Refusal, facts: Overshoot, k: int, sign: float) -> bool:
    """Whether it is shown in one direction of the joint, for the load that is carried then, with these numbers."""
    given, start = scene.robot.limits, scene.start
    q, v, a = (sign * float(each[k]) for each in (start.q, start.qd, start.qdd))
    low, high = float(given.lower[k]), float(given.upper[k])
    end = high if sign > 0.0 else -low
    most = end if facts.rate is None else float(given.velocity[k])
    slack = PROVED_SHARE * (high - low if facts.rate is None else most)
    for share, until in _shares(scene):
        most_a, most_j = share * float(given.acceleration[k]), share * float(given.jerk[k])
        # the first knot may be another state by START, and a motion is at rest up to REST
        worse = q - START, v - START - REST, a - START - REST
        least = _least(facts, worse, most_a * (1.0 + RATE), most_j * (1.0 + JERK))
        true = _least(facts, (q, v, a), most_a, most_j)
        if least is None or true is None or not true[0] <= until or not least[1] - most > slack:
            continue
        value, limit = true[1], most
        if facts.rate is None:
            value, limit = scene.counted(k, sign * value), scene.counted(k, sign * limit)
        told = same(facts.value, value) and same(facts.limit, limit) and same(amount_of(refusal), true[1] - most)
        if told and same(facts.after_s, true[0], INSTANT):
            return True
    return False


def _shares(scene: Scene) -> list[tuple[float, float]]:
    """The shares of acceleration and jerk that loads leave after the start, and how long each is in force at least, s:
    a part is held until it was tracked to the end of the dwell, and then nothing is lighter than the tool."""
    tool, held = scene.tool.mass_kg or 0.0, at_start(scene).held
    alone = share_of(scene, tool), math.inf
    if held is None:
        return [alone]
    loaded = share_of(scene, tool + (scene.index[held.part].mass_kg or 0.0))
    place = next((step for step in scene.task if isinstance(step, Place)), None)
    return [(loaded, math.inf)] if place is None else [(loaded, dwell(place) - TIME_S), alone]


def _least(
    facts: Overshoot, state: tuple[float, float, float], most_a: float, most_j: float
) -> tuple[float, float] | None:
    """When and how far the hardest braking goes, s; None: it does not go that way."""
    q, v, a = state
    peak = max(a, 0.0) / most_j
    if facts.rate is not None:
        return peak, _braked(v, a, most_a, most_j, peak)[0]
    # from the greatest velocity on it only falls: where it is 0 is found by halving
    low, high = peak, peak + 1.0
    if not _braked(v, a, most_a, most_j, low)[0] > 0.0:
        return None
    for _ in range(HALVINGS):
        if not _braked(v, a, most_a, most_j, high)[0] > 0.0:
            break
        low, high = high, 2.0 * high
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        if _braked(v, a, most_a, most_j, middle)[0] > 0.0:
            low = middle
        else:
            high = middle
    return low, q + _braked(v, a, most_a, most_j, low)[1]


def _braked(v: float, a: float, most_a: float, most_j: float, t: float) -> tuple[float, float]:
    """Velocity and way after the time t of the hardest braking: the jerk is -J, and from when the acceleration is -A on
    what it is below that is added again (W2)."""
    late = max(0.0, t - max(0.0, (a + most_a) / most_j))
    speed = v + a * t - most_j * (t * t - late * late) / 2.0
    return speed, v * t + a * t * t / 2.0 - most_j * (t**3 - late**3) / 6.0

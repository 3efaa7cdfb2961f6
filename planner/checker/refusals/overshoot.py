"""A joint that exceeds a limit after the start in every motion that ends at rest (W2 of docs/guarantees.md)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from assur.planner.checker.refusals.stated import Shown
from assur.planner.checker.statement.differences import SAME
from assur.planner.checker.statement.limits import SHARES
from assur.planner.checker.statement.loads import share_of
from assur.planner.model.attachments import at_start
from assur.planner.model.proofs.witness import PROVED_SHARE
from assur.planner.model.refusal import JointName, Overshoot, Reason, Refusal, Stage, of_joint
from assur.planner.model.scene import Place, Scene

HALVINGS = 200
"""Of a bracket of times: it is as small as rounding allows by then."""
INSTANT = 1e-6
"""Relative: two instants at which a velocity is 0 are the same if they differ by no more."""
State = tuple[float, float, float]
"""Position, velocity and acceleration of a joint."""
Extreme = Callable[[State, tuple[float, float]], tuple[float, float]]
"""When, s, and how far the hardest braking goes, from a state and with limits of acceleration and jerk."""


def overshoot(scene: Scene, _: Refusal) -> Iterator[Shown]:
    """Limits of joints that are exceeded after the start."""
    if not scene.options.jerk_limited or scene.options.end != "rest":
        return  # the motion may end before, or its jerk is not limited
    given, start = scene.robot.limits, scene.start
    for k in range(len(scene.robot.joints)):
        for sign in (1.0, -1.0):
            q, v, a = (sign * float(each[k]) for each in (start.q, start.qd, start.qdd))
            state = q, v, a
            low, high, fastest = float(given.lower[k]), float(given.upper[k]), float(given.velocity[k])
            for share, until in _shares(scene):
                limits = share * float(given.acceleration[k]), share * float(given.jerk[k])
                after, value = _peak(state, limits)
                if _exceeds(state, limits, _peak, fastest, fastest) and after <= until:
                    facts = Overshoot(rate="velocity", value=value, limit=fastest, after_s=after)
                    yield _shown(scene, Reason.MOTION_LIMIT, k, value - fastest, facts)
                after, value = _turn(state, limits)
                end = high if sign > 0.0 else -low
                if _exceeds(state, limits, _turn, end, high - low) and after <= until:
                    reached, limit = scene.counted(k, sign * value), scene.counted(k, sign * end)
                    facts = Overshoot(rate=None, value=reached, limit=limit, after_s=after)
                    yield _shown(scene, Reason.JOINT_LIMIT, k, value - end, facts)


def _shown(scene: Scene, reason: Reason, k: int, over: float, facts: Overshoot) -> Shown:
    joint, t = scene.robot.joints[k], scene.start.time
    amount = of_joint(joint.kind, over, 0 if facts.rate is None else 1)
    return Shown(
        Refusal(
            stage=Stage.START,
            reason=reason,
            step=0,
            subject=JointName(joint.name),
            interval=(t, t),
            amount=amount,
            facts=facts,
        ),
        INSTANT,
    )


def _exceeds(state: State, limits: tuple[float, float], extreme: Extreme, limit: float, size: float) -> bool:
    """Whether the hardest braking exceeds a limit, also from a state that a plan may have in place of the start (its
    first knot may differ, and a motion is at rest up to `SAME`) and with limits that are exceeded as far as a plan may.
    `size`: what the limit is compared with."""
    q, v, a = state
    worse = q - SAME, v - 2.0 * SAME, a - 2.0 * SAME
    _, value = extreme(worse, (limits[0] * (1.0 + SHARES[2]), limits[1] * (1.0 + SHARES[3])))
    return value - limit > PROVED_SHARE * size


def _shares(scene: Scene) -> list[tuple[float, float]]:
    """The shares of acceleration and jerk that loads leave after the start, and how long each is in force at least, s:
    a part is held until it was tracked to the end of the dwell, and then nothing is lighter than the tool."""
    tool, held = scene.tool.mass_kg or 0.0, at_start(scene).held
    alone = share_of(scene, tool), math.inf
    if held is None:
        return [alone]
    loaded = share_of(scene, tool + (scene.index[held.part].mass_kg or 0.0))
    place = next((step for step in scene.task if isinstance(step, Place)), None)
    return [(loaded, math.inf)] if place is None else [(loaded, place.dwell_s - SAME), alone]


def _peak(state: State, limits: tuple[float, float]) -> tuple[float, float]:
    """When, s, and how high the velocity is at its peak."""
    after = max(state[2], 0.0) / limits[1]
    return after, _braked(state, limits, after)[0]


def _turn(state: State, limits: tuple[float, float]) -> tuple[float, float]:
    """When, s, and where the joint turns round; at minus infinity if it never moves that way."""
    low, _ = _peak(state, limits)
    # from the greatest velocity on it only falls: where it is 0 is a matter of halving
    high = low + 1.0
    if not _braked(state, limits, low)[0] > 0.0:
        return 0.0, -math.inf
    for _ in range(HALVINGS):
        if not _braked(state, limits, high)[0] > 0.0:
            break
        low, high = high, 2.0 * high
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        if _braked(state, limits, middle)[0] > 0.0:
            low = middle
        else:
            high = middle
    return low, _braked(state, limits, low)[1]


def _braked(state: State, limits: tuple[float, float], t: float) -> tuple[float, float]:
    """Velocity and position after the time t of the hardest braking: the jerk is -J, and from when the acceleration is
    -A on what it is below that is added again (W2)."""
    (q, v, a), (most_a, most_j) = state, limits
    late = max(0.0, t - max(0.0, (a + most_a) / most_j))
    speed = v + a * t - most_j * (t * t - late * late) / 2.0
    return speed, q + v * t + a * t * t / 2.0 - most_j * (t**3 - late**3) / 6.0

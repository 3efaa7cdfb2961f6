"""A joint that exceeds a limit after the start in every motion that ends at rest (W2 of docs/guarantees.md).

The acceleration of a joint with jerk limit J and acceleration limit A is never less than that of the hardest braking,
max(a - J t, -A), so velocity and position are never less than those of the hardest braking, either.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from assur.planner.checker.refusals.stated import Shown
from assur.planner.checker.statement.differences import SAME
from assur.planner.checker.statement.limits import SHARES
from assur.planner.checker.statement.loads import share_of
from assur.planner.model.attachments import at_start
from assur.planner.model.proofs.witness import PROVED_SHARE
from assur.planner.model.refusal import JointName, Overshoot, Reason, of_joint
from assur.planner.model.scene import Place, Scene


def overshoots(scene: Scene, _: int = 0) -> Iterator[Shown]:
    """Each limit of a joint that is exceeded after the start by all motions that end at rest. It is also
    exceeded from each state that a plan may have in place of the start (its first knot may differ, and a motion is at
    rest up to `SAME`), with limits that are exceeded as far as a plan may."""
    if not scene.options.jerk_limited or scene.options.end != "rest" or not scene.start.moving:
        return  # without a limit the jerk is as high as is needed, and a motion that ends in motion may end before
    given, start = scene.robot.limits, scene.start
    for k in range(len(scene.robot.joints)):
        low, high, fastest = (float(each[k]) for each in (given.lower, given.upper, given.velocity))
        for sign in (1.0, -1.0):
            q, v, a = (sign * float(each[k]) for each in (start.q, start.qd, start.qdd))
            worse = q - SAME, v - 2.0 * SAME, a - 2.0 * SAME
            end = high if sign > 0.0 else -low
            for share, until in _shares(scene):
                hard = share * float(given.acceleration[k]), share * float(given.jerk[k])
                harder = hard[0] * (1.0 + SHARES[2]), hard[1] * (1.0 + SHARES[3])
                after, value = highest_velocity(v, a, hard[1])
                least = highest_velocity(*worse[1:], harder[1])[1]
                if after <= until and least - fastest > PROVED_SHARE * fastest:
                    facts = Overshoot(rate="velocity", value=value, limit=fastest, after_s=after)
                    yield _shown(scene, Reason.MOTION_LIMIT, k, value - fastest, facts)
                after, value = farthest_position(q, v, a, *hard)
                least = farthest_position(*worse, *harder)[1]
                if after <= until and least - end > PROVED_SHARE * (high - low):
                    reached, limit = scene.counted(k, sign * value), scene.counted(k, sign * end)
                    facts = Overshoot(rate=None, value=reached, limit=limit, after_s=after)
                    yield _shown(scene, Reason.JOINT_LIMIT, k, value - end, facts)


def _shown(scene: Scene, reason: Reason, k: int, over: float, facts: Overshoot) -> Shown:
    joint = scene.robot.joints[k]
    return Shown(reason, facts, of_joint(joint.kind, over, 0 if facts.rate is None else 1), JointName(joint.name))


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


def highest_velocity(v: float, a: float, jerk: float) -> tuple[float, float]:
    """When, s, and how high the velocity is at the least peak after a start with velocity v and acceleration a."""
    return (a / jerk, v + a * a / (2.0 * jerk)) if a > 0.0 else (0.0, v)


def farthest_position(q: float, v: float, a: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """When, s, and where the hardest braking from position q, velocity v and acceleration a turns round, in the
    direction of increasing q; at minus infinity if it never moves that way."""
    ramp = (a + acceleration) / jerk
    left = v + (a * a - acceleration * acceleration) / (2.0 * jerk)
    if left > 0.0:
        after = ramp + left / acceleration
        return after, q + ramp * (v + ramp * (a / 2.0 - ramp * jerk / 6.0)) + left * left / (2.0 * acceleration)
    square = a * a + 2.0 * jerk * v
    after = (a + math.sqrt(square)) / jerk if square >= 0.0 else 0.0
    if not after > 0.0:
        return 0.0, -math.inf
    return after, q + after * (v + after * (a / 2.0 - after * jerk / 6.0))

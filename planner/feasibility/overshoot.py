"""Starts in motion that must exceed a limit, however hard the joint brakes: closed forms for one joint.

The acceleration of a joint with jerk limit J and acceleration limit A is never less than that of the hardest braking,
max(a - J t, -A), so velocity and position are never less than those of the hardest braking, either.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from assur.planner.model.attachments import at_start
from assur.planner.model.refusal import JointName, Overshoot, Reason, Refusal, Stage, of_joint
from assur.planner.model.scene import Place, Scene
from assur.planner.robots.facts import Limits


def overshoots(scene: Scene) -> Iterator[Refusal]:
    """A refusal for each limit of a joint that is exceeded after the start by all motions that end at rest."""
    if not scene.options.jerk_limited or scene.options.end != "rest" or not scene.start.moving:
        return  # without a limit the jerk is as high as is needed, and a motion that ends in motion may end before
    given, start = scene.robot.limits, scene.start
    for i, joint in enumerate(scene.robot.joints):
        for sign in (1.0, -1.0):
            q, v, a = (sign * float(state[i]) for state in (start.q, start.qd, start.qdd))
            end, most = float((given.upper if sign > 0 else given.lower)[i]), float(given.velocity[i])
            for limits, until in _limits(scene):
                most_a, most_j = float(limits.acceleration[i]), float(limits.jerk[i])
                after, value = highest_velocity(v, a, most_j)
                if after <= until and value > most:
                    facts = Overshoot(rate="velocity", value=value, limit=most, after_s=after)
                    yield Refusal(
                        stage=Stage.START,
                        reason=Reason.MOTION_LIMIT,
                        step=0,
                        subject=JointName(joint.name),
                        amount=of_joint(joint.kind, value - most, 1),
                        facts=facts,
                    )
                after, value = farthest_position(q, v, a, most_a, most_j)
                if after <= until and value > sign * end:
                    reached, allowed = (scene.counted(i, x) for x in (sign * value, end))
                    yield Refusal(
                        stage=Stage.START,
                        reason=Reason.JOINT_LIMIT,
                        step=0,
                        subject=JointName(joint.name),
                        amount=of_joint(joint.kind, value - sign * end),
                        facts=Overshoot(rate=None, value=reached, limit=allowed, after_s=after),
                    )


def _limits(scene: Scene) -> list[tuple[Limits, float]]:
    """The joints' limits after the start, each with how long they are in force at least, s. A part that is held at the
    start leaves the gripper no sooner than the dwell of its place ends; afterwards no load is lighter than the tool."""
    tool = scene.limits_with(None), math.inf
    held = at_start(scene)
    if held.held is None:
        return [tool]
    put_down = next((step.dwell_s for step in scene.task if isinstance(step, Place)), math.inf)
    return [(held.limits(scene), put_down), *([] if put_down == math.inf else [tool])]


def highest_velocity(v: float, a: float, jerk: float) -> tuple[float, float]:
    """When, s, and how high the velocity is at the least peak after a start with velocity v and acceleration a."""
    return (a / jerk, v + a * a / (2.0 * jerk)) if a > 0.0 else (0.0, v)


def farthest_position(q: float, v: float, a: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """When, s, and where the hardest braking from position q, velocity v and acceleration a turns round, in the
    direction of increasing q; (0, q) if it never moves that way."""
    ramp = (a + acceleration) / jerk
    left = v + (a * a - acceleration * acceleration) / (2.0 * jerk)
    if left > 0.0:
        after = ramp + left / acceleration
        return after, q + ramp * (v + ramp * (a / 2.0 - ramp * jerk / 6.0)) + left * left / (2.0 * acceleration)
    square = a * a + 2.0 * jerk * v
    after = (a + math.sqrt(square)) / jerk if square >= 0.0 else 0.0
    if not after > 0.0:
        return 0.0, q
    return after, q + after * (v + after * (a / 2.0 - after * jerk / 6.0))

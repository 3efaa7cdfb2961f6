"""Sentences about limits that a joint would have to exceed: after the start, and in an acceleration time."""

from __future__ import annotations

from assur.planner.model.refusal import AccelerationTime, Overshoot, Refusal
from assur.planner.model.scene import Scene
from assur.planner.report.number_format import amount, position


def overshoots(scene: Scene, refusal: Refusal, facts: Overshoot) -> str:
    """What the joint reaches at least, when, and what is allowed."""
    joint = refusal.joint or "a joint"
    kind = next((each.kind for each in scene.robot.joints if each.name == joint), "revolute")
    after = f"{amount(facts.after_s, 's')} after the start"
    more = "" if refusal.amount is None else f", {amount(refusal.amount.value, refusal.amount.unit)} too much"
    if facts.rate is None:
        value, limit = (position(x, kind) for x in (facts.value, facts.limit))
        return (
            f"{joint} moves towards the end of its range at {limit} too fast to stop there: "
            f"however hard it brakes, it reaches {value} {after}{more}"
        )
    unit = "rad/s" if kind == "revolute" else "m/s"
    value, limit = (amount(x, unit) for x in (facts.value, facts.limit))
    return (
        f"{joint} accelerates at the start, and however fast the acceleration falls, the velocity reaches {value} "
        f"{after}{more}; its limit is {limit}"
    )


def acceleration_time(refusal: Refusal, facts: AccelerationTime) -> str:
    """What a change of velocity would need of a joint in the time that is given, and what would be enough."""
    unit = "m/s²" if refusal.amount is None else refusal.amount.unit
    enough = "" if facts.enough_s is None else f"; {amount(facts.enough_s, 's')} would be enough"
    return (
        f"with an acceleration time of {amount(facts.given_s, 's')} {refusal.joint} would need "
        f"{amount(facts.needed, unit)}, but it has {amount(facts.limit, unit)}{enough}"
    )

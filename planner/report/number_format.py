"""Numbers as people read them: mm, ms, degrees, with the digits that count."""

from __future__ import annotations

import math

from assur.planner.model.refusal import AccelerationTime, NotTouching, Overshoot, Refusal
from assur.planner.model.scene import Scene

SHOWN_AS = {
    "m": ("mm", 1e3),
    "mm": ("mm", 1.0),
    "s": ("ms", 1e3),
    "rad": ("deg", math.degrees(1.0)),
    "deg": ("deg", 1.0),
    "1": ("", 1.0),
    "rad/s": ("deg/s", math.degrees(1.0)),
    "rad/s²": ("deg/s²", math.degrees(1.0)),
    "rad/s³": ("deg/s³", math.degrees(1.0)),
    "m/s": ("mm/s", 1e3),
    "m/s²": ("mm/s²", 1e3),
    "m/s³": ("mm/s³", 1e3),
}
"""Units of a document, and what people read instead, with the factor."""
LEAST_SHOWN = 1e-3
"""Amounts below a thousandth of mm, ms or degree are shown as less than that."""

MOST_DIGITS = 12
"""No more digits than these tell two lengths apart: more are rounding."""


def amount(value: float | None, unit: str | None) -> str:
    """A length in mm, a time in ms or s, an angle in degrees, anything else as it is; nothing for no number."""
    if value is None or not math.isfinite(value):
        return ""
    name, factor = ("s", 1.0) if unit == "s" and abs(value) >= 1.0 else SHOWN_AS.get(unit or "", (unit or "", 1.0))
    size = abs(value * factor)
    if 0.0 < size < LEAST_SHOWN:
        return f"less than {LEAST_SHOWN:g} {name}".rstrip()
    return f"{number(value * factor, 3)} {name}".rstrip()


def apart(one: float, other: float) -> tuple[str, str]:
    """Two lengths, m, of which one is what is and the other what must be: with so many digits that they differ where
    they do."""
    shown = amount(one, "m"), amount(other, "m")
    for digits in range(4, MOST_DIGITS + 1):
        if shown[0] != shown[1]:
            break
        shown = f"{number(1e3 * one, digits)} mm", f"{number(1e3 * other, digits)} mm"
    return shown


def position(value: float, kind: str) -> str:
    """The position of a joint of this kind, "revolute" or "prismatic", to a hundredth of a degree or millimetre."""
    name, factor = SHOWN_AS["rad" if kind == "revolute" else "m"]
    return f"{round(value * factor, 2) + 0.0:g} {name}"


def number(value: float, digits: int) -> str:
    """A number with so many digits that count and no power of ten; whole ones lose none: 359934 → 359,900 (4)."""
    rounded = float(f"{value:.{digits}g}") + 0.0  # no -0
    whole = f"{rounded:,.0f}"
    return whole if abs(rounded) >= 10 ** (digits - 1) else f"{rounded:.{digits}g}"


# Sentences about limits that a joint would have to exceed: after the start, and in an acceleration time.


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


# Sentences about a tool that is too far from the part that it takes, and about a part that is put down on nothing.


def not_touching(refusal: Refusal, facts: NotTouching) -> str:
    """Which body is nearest, how far it is, and what is allowed."""
    one, other = refusal.bodies
    far = f"is {amount(facts.distance_m, 'm')} away, and at most {amount(facts.allowed_m, 'm')} is allowed"
    if facts.of == "grip":
        return f"the tool would be too far from {other} when it takes it: {one}, its nearest body, {far}"
    return f"{one} would be too far from what it is put down on: {other}, the nearest, {far}"

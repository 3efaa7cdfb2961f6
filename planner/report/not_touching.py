"""What is said of a tool that is too far from the part that it takes, and of a part that is put down on nothing."""

from __future__ import annotations

from assur.planner.model.refusal import NotTouching, Refusal
from assur.planner.report.number_format import amount


def not_touching(refusal: Refusal, facts: NotTouching) -> str:
    """Which body is nearest, how far it is, and what is allowed."""
    one, other = refusal.bodies
    far = f"is {amount(facts.distance_m, 'm')} away, and at most {amount(facts.allowed_m, 'm')} is allowed"
    if facts.of == "grip":
        return f"the tool would be too far from {other} when it takes it: {one}, its nearest body, {far}"
    return f"{one} would be too far from what it is put down on: {other}, the nearest, {far}"

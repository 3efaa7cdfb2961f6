"""Notes for people: how a leg goes, and what of a request is probably not meant. No decision reads them."""

from __future__ import annotations

from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.outcome import Course, Route
from assur.planner.report.number_format import amount


def warned(warning: InputWarning) -> str:
    """What is probably not meant."""
    first, second = warning.bodies
    if warning.kind is Odd.PART_FLOATS:
        return f"{first} is {amount(warning.amount_m, 'm')} above {second} and rests on nothing"
    if warning.kind is Odd.TOOL_OFF_PART:
        off = f"{first}, the nearest, is {amount(warning.amount_m, 'm')} away"
        return f"no body of the tool touches {second} where it is picked: {off}; check grasp and tcp"
    if warning.kind is Odd.RELEASED_IN_AIR:
        return f"{first} is released {amount(warning.amount_m, 'm')} above {second} and rests on nothing there"
    if warning.kind is Odd.SUPPORT_OFF_PART:
        away = amount(warning.amount_m, "m")
        return f"{first} should touch {second} in step {warning.step}, as contact_with says, but is {away} away from it"
    if warning.kind is Odd.BODIES_OVERLAP:
        return f"{first} and {second} overlap by more than {amount(warning.amount_m, 'm')} where they are at the start"
    if warning.kind is Odd.MAY_MISS:
        most = f", mainly due to: {warning.cause}" if warning.cause else ""
        return (
            f"the tool may miss {second} by {amount(warning.amount_m, 'm')}{most}; state tolerance_mm for step "
            f"{warning.step} to have it refused"
        )
    by = f" by more than {amount(warning.amount_m, 'm')} along the flange's axis" if warning.amount_m else ""
    return f"{first}, a body of the tool, overlaps {second} of the arm{by}, and nothing keeps the two apart"


COURSES = {
    Course.PATH: "along its path",
    Course.TO_REST: "comes to rest",
    Course.FOR_BODIES: "lets bodies pass",
    Course.FOR_POINT: "waits for the control point",
}
"""Notes of legs, where they are not the names of the courses."""


def note(route: Route | None) -> str:
    """How a leg goes, or why the arm waits; nothing where there is nothing to say."""
    if route is None:
        return ""
    vias = f"{route.vias} via point{'s' * (route.vias != 1)}" if route.vias else ""
    if route.course is Course.DIRECT:
        words = vias or str(route.course)
    else:
        words = COURSES.get(route.course, str(route.course)) + (f", {vias}" if vias else "")
    return words + " after a wait" * route.after_wait + " later" * route.later

"""The notes of an answer: which limit binds, where, and what helps; how a leg goes; the time left in a window; and what
of a request is probably not meant. No decision reads them, and nobody verifies them (`not_checked` in a verdict)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.legs.control_point import WINDOW_S, ControlPoint
from assur.planner.model.input_warning import InputWarning, WarningKind
from assur.planner.model.outcome import Arrival, Busiest, Course, Leg, LegKind, Route
from assur.planner.model.phases import AFTER_S, Phase, gone_from
from assur.planner.model.refusal import RATES
from assur.planner.model.scene import Place, Scene, Window
from assur.planner.report.number_format import amount
from assur.planner.trajectory import Trajectory

NEAR_PEAK = 0.01
"""A limit is used within this share of its peak."""
AT_LIMIT, BOUND = 0.9, 0.5
"""A joint is at a limit where it uses this share of it or more: a motion that meets a moving point is often a few per
cent slower than it could be. A limit binds a phase if its joint is at a limit for this share of the phase or more."""
SAMPLES = 64
"""Instants of a phase at which this is evaluated."""


@dataclass(frozen=True, slots=True)
class MostUsed:
    """The limit that a plan uses to the largest share: velocity, acceleration or jerk (`kind`) of a joint, or, where
    `joint` is empty, the acceleration of the carried part."""

    share: float
    joint: str
    kind: str

    @property
    def binds(self) -> str:
        """The limit and its share in words."""
        return f"{_limit_words(self.kind, self.joint)} ({100 * self.share:.0f} %)"

    @property
    def helps(self) -> str:
        """What would make the busiest leg quicker."""
        return f"a higher limit, or less travel of {self.joint}" if self.joint else "a higher limit (carry)"


def busiest(
    scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...], limit: MostUsed, t: FloatArray, lasts: FloatArray
) -> Busiest | None:
    """The phase in which a limit is longest within `NEAR_PEAK` of its peak; None: it is at none of the times `t` (T,);
    each time counts for so long (T,), s."""
    from assur.planner.legs.tool_motion import tool_accelerations  # kernels, which no writer of answers may load

    if limit.joint:
        number, order = [each.name for each in scene.robot.joints].index(limit.joint), RATES.index(limit.kind) + 1
        used = np.abs(trajectory.evaluate(t, order)[:, number])
        for phase in phases:
            here = (t >= phase.t0) & (t < phase.t1)
            used[here] /= getattr(phase.attached.limits(scene), limit.kind)[number]
    else:
        carried = np.any([(t >= p.t0) & (t <= p.t1) for p in phases if p.attached.held is not None], axis=0)
        used = np.where(carried, tool_accelerations(scene, trajectory, t) / (scene.carry_acceleration or np.inf), 0.0)
    return _longest(phases, t, lasts, used >= (1.0 - NEAR_PEAK) * limit.share)


def binding_limit(scene: Scene, trajectory: Trajectory, phase: Phase) -> str:
    """The limit that binds a phase, in words: that at which the joint is longest that is at its limits longest; else
    the acceleration of the carried part, for whose peak a motion is slowed down. Empty where neither is at a limit: the
    motion is slower than the arm could be, as one is that comes in time for its point."""
    from assur.planner.legs.tool_motion import tool_accelerations  # kernels, which no writer of answers may load

    t, limits = np.linspace(phase.t0, phase.t1, SAMPLES), phase.attached.limits(scene)
    kinds = RATES if scene.options.jerk_limited else RATES[:2]
    used = [np.abs(trajectory.evaluate(t, 1 + k)) / getattr(limits, kind) for k, kind in enumerate(kinds)]
    at_limit = np.array(used) >= AT_LIMIT
    shares = at_limit.any(axis=0).mean(axis=0)
    joint, carry = int(shares.argmax()), scene.carry_acceleration
    if shares[joint] >= BOUND:
        kind = kinds[int(at_limit[:, :, joint].sum(axis=1).argmax())]
        return _limit_words(kind, scene.robot.joints[joint].name)
    if carry is not None and phase.attached.held is not None:
        peak = float(tool_accelerations(scene, trajectory, t).max())
        return _limit_words("acceleration", "") if peak >= AT_LIMIT * carry else ""
    return ""


def _limit_words(kind: str, joint: str) -> str:
    return f"{kind} of {joint or 'the carried part'}"


def _longest(phases: tuple[Phase, ...], t: FloatArray, lasts: FloatArray, at_peak: BoolArray) -> Busiest | None:
    """The phase in which `at_peak` (T,) holds longest."""
    moving = [phase for phase in phases if phase.step >= 0 and phase.t1 > phase.t0]
    times = [float(lasts[at_peak & (t >= phase.t0) & (t < phase.t1)].sum()) for phase in moving]
    time = max(times, default=0.0)
    if not time > 0.0:
        return None
    phase = moving[times.index(time)]
    return Busiest(str(phase.kind), phase.step, phase.t0, phase.t1, min(time, phase.t1 - phase.t0))


def window_left(point: ControlPoint, begin: float) -> float | None:
    """How much later, s, than at `begin` a point could be met in its window; None: it has none."""
    if point.window == Window():
        return None
    spans = (span for span in point.intervals if span[0] - WINDOW_S <= begin <= span[1] + WINDOW_S)
    return next((max(high - begin, 0.0) for _, high in spans), None)


WARNINGS = {
    WarningKind.PART_FLOATS: "{0} is {by} above {1} and rests on nothing",
    WarningKind.TOOL_OFF_PART: "no body of the tool touches {1} where it is picked: {0}, the nearest, is {by} away; "
    "check grasp and tcp{why}",
    WarningKind.RELEASED_IN_AIR: "{0} is released {by} above {1} and rests on nothing there",
    WarningKind.SUPPORT_OFF_PART: "{0} should touch {1} in step {step}, as contact_with says, but is {by} away from it",
    WarningKind.BODIES_OVERLAP: "{0} and {1} overlap by more than {by} where they are at the start",
    WarningKind.MAY_MISS: "the tool may miss {1} by {by}{cause}; state tolerance_mm for step {step} to have it refused",
    WarningKind.TOOL_IN_ARM: "{0}, a body of the tool, overlaps {1} of the arm{mount}, and nothing keeps the two apart",
}
"""What is probably not meant, by its kind, with the names of the two bodies."""


def warned(warning: InputWarning) -> str:
    """What is probably not meant."""
    by = amount(warning.amount_m, "m")
    cause = f", mainly due to: {warning.cause}" if warning.cause else ""
    why = f": {warning.cause}" if warning.cause else ""
    mount = f" by more than {by} along the flange's axis" if warning.amount_m else ""
    return WARNINGS[warning.kind].format(*warning.bodies, by=by, step=warning.step, cause=cause, why=why, mount=mount)


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


WAIT_S = 1e-6
"""A wait that ends within this time, s, of the end for which it was made is that wait."""


def leg_note(scene: Scene, leg: Leg, arrivals: Iterable[Arrival]) -> str:
    """The note of a leg of a plan with these arrivals: as `note`; of a wait for parts to be gone, which and when."""
    if leg.kind is LegKind.WAIT and leg.route == Route(Course.FOR_BODIES):
        put_down = [(step, each.until) for each in arrivals if isinstance(step := scene.task[each.step], Place)]
        times = {step.part: gone_from(scene, step, until) for step, until in put_down}
        gone = {part: time for part, time in times.items() if abs(time + AFTER_S - leg.t1) <= WAIT_S}
        if gone:
            verb = "is" if len(gone) == 1 else "are"
            return f"waits until {' and '.join(sorted(gone))} {verb} gone (at {max(gone.values()):.3f} s)"
    return note(leg.route)

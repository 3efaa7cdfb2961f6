"""Sentences for people about refusals, made of facts. No decision reads them."""

from __future__ import annotations

import math

from assur.planner.model.outcome import Census, CensusLine
from assur.planner.model.refusal import (
    OF_CANDIDATES,
    AccelerationTime,
    BeyondRange,
    Carrying,
    Corrected,
    Enclosed,
    ForbiddenYaw,
    Inaccurate,
    LawEnds,
    MotionLimit,
    NotTouching,
    Obstacle,
    OnPath,
    OutOfReach,
    Overload,
    Overshoot,
    Reason,
    Refusal,
    Refuted,
    Separation,
    Singular,
    Stage,
)
from assur.planner.model.scene import Scene, Trace
from assur.planner.model.window_missed import WindowMissed
from assur.planner.report.number_format import acceleration_time, amount, not_touching, number, overshoots, position
from assur.planner.report.too_late import law_ended, too_near, window_missed


def sentence(scene: Scene, refusal: Refusal | None, line: CensusLine | None, census: Census, *, cut: bool) -> str:
    """Why there is no plan. `line`: where the refusal is counted, if it is; `cut`: the clock ended the search."""
    budget = f"{scene.options.budget_s:g} s"
    if refusal is None:
        if census.candidates:
            return (
                f"No plan was found among {census.candidates} candidate{'s' * (census.candidates > 1)}; "
                "the search ended before it reached the last step."
            )
        return f"No plan was found in {budget}; nothing was tried."
    tail = ""
    if line is not None and refusal.stage in OF_CANDIDATES and census.candidates:
        most = _most_frequent(line, census)
        others = _others(line, census, most)
        tail = f"{others} ({_counted(line, census)} candidates{_span(refusal)})"
        if most is not None:
            tail += f"; most frequent: {_named(scene, most.refusal)} ({_counted(most, census)})"
        if cut:
            tail += f"; the budget of {budget} was spent"
    step = "" if refusal.stage is Stage.START else f"{scene.task[refusal.step].name}: "
    return f"{step}{because(scene, refusal)}{tail}."


def because(scene: Scene, refusal: Refusal) -> str:
    """What would happen, or what is missing: a sentence without its step and its full stop."""
    return _on_path(scene, refusal) + _because(scene, refusal)


def _on_path(scene: Scene, refusal: Refusal) -> str:
    """Where on a path it happens: how far along it, and at which point of its frame."""
    facts, target = refusal.facts, scene.task[refusal.step].target
    if not isinstance(facts, OnPath) or facts.path_m is None or facts.path_at_m is None:
        return ""
    frame = "" if target is None else f" in {target.frame}"
    at = f"at [{', '.join(f'{1e3 * x:z.1f}' for x in facts.path_at_m)}] mm{frame}, "
    if facts.path_part == "lead-in":
        return f"on the lead-in, {_mm(-facts.path_m)} before the path begins, {at}"
    if facts.path_part == "lead-out":
        step = scene.task[refusal.step]
        behind = (
            f", {_mm(facts.path_m - step.path.length)} behind the end of the path" if isinstance(step, Trace) else ""
        )
        return f"on the lead-out{behind}, {at}"
    return f"{_mm(facts.path_m)} along the path, {at}"


def _because(scene: Scene, refusal: Refusal) -> str:
    short = "" if refusal.amount is None else amount(refusal.amount.value, refusal.amount.unit)
    match refusal.facts:
        case OutOfReach() as facts:
            return _out_of_reach(refusal.stage, facts, short)
        case BeyondRange() as facts:
            return _beyond_range(scene, refusal, facts, short)
        case Singular() as facts:
            return _singular(refusal, facts)
        case MotionLimit() as facts:
            return _motion_limit(refusal, facts, short)
        case Overshoot() as facts:
            return overshoots(scene, refusal, facts)
        case AccelerationTime() as facts:
            return acceleration_time(refusal, facts)
        case Separation() | Enclosed() as facts:
            return too_near(scene, refusal, facts)
        case Carrying() as facts:
            most, limit = (number(value, 3) for value in (facts.acceleration, facts.limit))
            return f"the part would be accelerated with {most} m/s², but only {limit} m/s² are allowed"
        case Inaccurate() as facts:
            return _inaccurate(facts)
        case NotTouching() as facts:
            return not_touching(refusal, facts)
        case Overload() as facts:
            return _overload(scene, refusal, facts)
        case Corrected() as facts:
            what = f"{facts.joint} beyond its range" if facts.joint else "the arm to a singular position"
            return f"the belt correction may shift the tool by {_mm(facts.shift_m)}, which would bring {what}"
        case ForbiddenYaw() as facts:
            return _forbidden_yaw(refusal, facts, short)
        case WindowMissed() as facts:
            return window_missed(scene, refusal, facts, short)
        case LawEnds() as facts:
            return law_ended(refusal, facts)
        case Refuted() as facts:
            return (
                f"the checker refuses the plan: {facts.code}, {facts.what}{f', {facts.where}' if facts.where else ''}"
            )


def _overload(scene: Scene, refusal: Refusal, facts: Overload) -> str:
    """What is carried, from when on, and what would help."""
    unit, axis = "kg", ""
    if facts.of == "max_inertia":
        unit, axis = "kg·m²", f" about {scene.robot.joints[-1].name}"
    value, limit, tool = (f"{number(x, 4)} {unit}" for x in (facts.value, facts.limit, facts.tool))
    what, from_when = f"the tool has {value}{axis}", ""
    if facts.part is not None:
        part = f"{number(facts.part_value, 4)} {unit}"
        what = f"tool and {facts.part} have {value}{axis} together ({tool} and {part})"
        from_when = " from the start on" if refusal.stage is Stage.START else " from here on"
    allowed = {
        "max_load": f"the maximum load of {scene.robot.name} is {limit}",
        "max_inertia": f"the maximum of {scene.robot.name} is {limit}",
        "table": f"acceleration_by_load ends at {limit}",
    }[facts.of]
    left = facts.limit - facts.tool
    help_ = "a lighter tool" if facts.of != "max_inertia" else "a tool that is lighter or nearer to the axis"
    if facts.part is not None and left > 0.0:
        help_ = f"a part of up to {number(left, 4)} {unit}, {help_}"
    more = "a row for this mass" if facts.of == "table" else "a robot for this load"
    return f"{what}{from_when}, but {allowed}; {help_} or {more} would help"


def _inaccurate(facts: Inaccurate) -> str:
    """How far the tool may be off, and why."""
    if facts.allowed_m is not None and facts.position_m > facts.allowed_m:
        off, allowed, most = (_mm(value) for value in (facts.position_m, facts.allowed_m, facts.most))
    else:
        off, allowed, most = (amount(value, "rad") for value in (facts.yaw_rad, facts.allowed_rad or 0.0, facts.most))
    return f"the tool may be {off} off, but only {allowed} are allowed; most of it, {most}, is due to: {facts.cause}"


def _forbidden_yaw(refusal: Refusal, facts: ForbiddenYaw, short: str) -> str:
    """Which range the tool would be in, or turn through."""
    first, last, yaw = (f"{math.degrees(angle):.6g} deg" for angle in (facts.first_rad, facts.last_rad, facts.yaw_rad))
    ends = f"from {first} to {last}"
    if facts.lag_rad > 0.0:
        ends += f" ({amount(facts.lag_rad, 'rad')} wider at both ends, for joints that lag)"
    if refusal.stage is Stage.START:
        return (
            f"the yaw of the tool at the start is {yaw}, in the forbidden range {ends}, {short} beyond its nearer end"
        )
    if not facts.on_the_way:
        would = f"the yaw of the tool would be {yaw}, in the forbidden range {ends}, {short} beyond its nearer end"
        return f"{would}{_mode(facts.mode)}"
    if refusal.stage is Stage.INVERSE:
        return f"to a yaw of {yaw} the tool would have to turn through the forbidden range {ends}{_mode(facts.mode)}"
    return f"on its way the tool would turn into the forbidden range of yaw {ends}, by {short}"


def _counted(line: CensusLine, census: Census) -> str:
    """How often it was refused; more often than candidates were: before there was a candidate, too."""
    return f"{line.count} {'of' if line.count <= census.refused else 'times, beside'} {census.candidates}"


def _most_frequent(line: CensusLine, census: Census) -> CensusLine | None:
    """What stopped most candidates at the step, where that is not what stopped the one that came furthest."""
    here = (each for each in census.lines if each.refusal.step == line.refusal.step)
    of_candidates = (each for each in here if each.refusal.stage in OF_CANDIDATES)
    most = max(of_candidates, key=lambda each: each.count, default=line)
    cause, other = line.refusal, most.refusal
    same = (cause.reason, cause.subject) == (other.reason, other.subject)
    return most if most.count > line.count and not same else None


def _named(scene: Scene, refusal: Refusal) -> str:
    """A refusal by its reason and what it is about; where that has no name, in words."""
    about = " and ".join(refusal.bodies) or refusal.joint or refusal.frame
    return f"{refusal.reason} of {about}" if about else because(scene, refusal)


def _others(line: CensusLine, census: Census, most: CensusLine | None) -> str:
    """Bodies that are hit about as often, at the same step, without those that are hit most often."""
    leading = line.refusal
    if leading.reason is not Reason.BODY_COLLISION:
        return ""
    seen, also = set(leading.bodies[1:]), []
    for other in census.lines:
        bodies, same = other.refusal.bodies, other.refusal.step == leading.step
        alike = same and other.refusal.reason is leading.reason and 2 * other.count >= line.count
        if alike and other is not most and not seen.issuperset(bodies[1:]):
            seen |= set(bodies[1:])
            also.append(f"{bodies[0]} with {' and '.join(bodies[1:])}")
    return f"; likewise {', '.join(also[:2])}" if also else ""


def _span(refusal: Refusal) -> str:
    if refusal.interval is None:
        return ""
    a, b = refusal.interval
    return f", at {a:.2f} s" if b - a < 0.005 else f", between {a:.2f} s and {b:.2f} s"


def _mm(value: float) -> str:
    return amount(value, "m")


def _mode(mode: str | None) -> str:
    return f" (mode {mode})" if mode else ""


def _out_of_reach(stage: Stage, facts: OutOfReach, short: str) -> str:
    if facts.modes is not None:
        first, second = facts.modes
        return f"a straight leg cannot change from mode {first} to {second}, and its line leaves the workspace"
    if facts.path_m is not None and stage is not Stage.CONTROL_POINT:
        far = f"; from there on it is up to {short} out of reach" if short else ""
        return f"the path of the tool leaves the reach of the arm{far}"
    if stage is Stage.STRAIGHT:
        return "the straight line leaves the workspace"
    if stage is Stage.TRACKING:
        return "the point leaves the workspace while it is tracked"
    if stage is Stage.TIMING:
        return "the point is out of reach when the arm could be there"
    what = f"the point is {short} out of reach" if short else "the point is out of reach"
    if facts.every_pitch:
        return f"{what} at every pitch of the tool"
    if facts.heights_m is not None:
        required, possible = (_mm(height) for height in facts.heights_m)
        return f"{what}: the flange would have to be at a height of {required}, but it stays at {possible}"
    if facts.from_axis_m is not None:
        pitch = "" if facts.pitch_rad is None else f", with the tool at a pitch of {amount(facts.pitch_rad, 'rad')}"
        return f"{what}: the flange would be {_mm(facts.from_axis_m)} from the arm's axis{pitch}"
    if stage is Stage.INVERSE and short:
        what = f"the point stays at least {short} out of reach at all times at which it may be met"
    return f"{what}{_mode(facts.mode)}"


def _beyond_range(scene: Scene, refusal: Refusal, facts: BeyondRange, short: str) -> str:
    joint = refusal.joint or "a joint"
    if refusal.amount is not None and refusal.amount.unit == "1":
        short = f"{100 * refusal.amount.value:.3g} % of its range"
    where = f"{short} beyond its limit" if short else "beyond its limit"
    if facts.value is not None and facts.limit is not None:
        kind = next((each.kind for each in scene.robot.joints if each.name == joint), "revolute")
        value, limit = (position(x, kind) for x in (facts.value, facts.limit))
        beyond = f"{short + ' ' if short else ''}beyond the end of its range at {limit}"
        if refusal.stage is Stage.START:
            return f"{joint} starts at {value}, {beyond}"
        where = f"to {value}, {beyond}"
        if facts.path_m is not None:
            return f"{joint} leaves its range; from there on it would have to go up to {value}, {beyond}"
    if refusal.stage is Stage.START:
        return f"{joint} starts {where}"
    arch = "" if facts.arch_top_m is None else f"for an arch up to {_mm(facts.arch_top_m)}, "
    if facts.arch_top_m is not None and refusal.amount is not None and refusal.amount.unit == "m":
        most = facts.arch_top_m - refusal.amount.value
        arch = f"for an arch up to {_mm(facts.arch_top_m)} (the lift allows {_mm(most)}), "
    above = f"{_mm(facts.above_m)} above the point, " if facts.above_m else ""
    return f"{arch}{above}{joint} would have to go {where}{_mode(facts.mode)}"


POSITIONS = {
    "stretched": "the arm would be stretched",
    "folded": "the arm would be folded",
    "indeterminate": "the tool would be on the shoulder's axis",
    "aligned": "the tool would be over the base axis",
}
"""Singular positions, by their codes."""


def _singular(refusal: Refusal, facts: Singular) -> str:
    near = None if facts.distance_m is None else _mm(facts.distance_m)
    if facts.modes is not None:
        first, second = facts.modes
        return (
            f"a straight leg cannot change from mode {first} to {second}: "
            f"its line comes no closer than {near} to a singular position"
        )
    parallel = refusal.reason is Reason.NEAR_PARALLEL_SINGULARITY
    kind = "parallel margin" if parallel else "singularity margin"
    margins = ""
    if facts.margin is not None and facts.required is not None:
        margins = f"{kind} {facts.margin:.3f}, required {facts.required:.3f}"
    if parallel:
        if facts.margin is None or facts.margin < 0:
            crossed = "the arm would cross a position in which its motors do not hold the tool (type 2 singularity)"
            return f"{crossed}: {margins}" if margins else crossed
        return f"the arm would be too close to a position in which its motors do not hold the tool ({margins})"
    if near is not None:
        at = f"{' or '.join(facts.positions)}; " if facts.positions else ""
        return f"the straight line comes within {near} of a singular position ({at}{margins})"
    if facts.positions:
        return " or ".join(POSITIONS.get(name, name) for name in facts.positions) + _mode(facts.mode)
    if facts.path_m is not None and facts.margin is not None and facts.required is not None:
        least = f"the {kind} is {facts.margin:.3f} at the least, required {facts.required:.3f}"
        return f"the arm comes too close to a singular position; from there on {least}"
    return "the arm would be too close to a singular position" + (f" ({margins})" if margins else "")


OBSTACLES = {
    Obstacle.NOT_SMOOTH: "the joints cannot follow the path: its motion is not smooth",
    Obstacle.NO_PATH_LAW: "no motion along the straight line was found that keeps the limits of all joints",
    Obstacle.NO_PROFILE: "no motion was found that keeps the limits of all joints",
    Obstacle.NO_SUCH_DURATION: "no motion was found that takes exactly the time to a meeting",
    Obstacle.NO_ARCH: "the lift would go down before the top of the arch, or up after it",
    Obstacle.STOPS_AT_VIA: "the arm would stop at the point before, which is to be flown by",
    Obstacle.STRAIGHT_FROM_MOTION: "a straight leg must begin at rest or while a frame is tracked",
    Obstacle.POINT_TOO_FAST: "the control point moves too fast to be met",
    Obstacle.OTHER_FRAME: "a leg along a path must begin and end in the same frame, or in frames that stand still",
    Obstacle.OTHER_MODE: "a leg along a path cannot change the working mode",
    Obstacle.NO_PATH: "from where the leg begins there is no such path: points coincide, lie on a line, or turn back",
    Obstacle.PROCESS_SPEED: "the joints cannot follow the path within 0.01 mm and 1 % of its speed: it bends too much",
}
"""Obstacles that are no joint's rate."""


def _motion_limit(refusal: Refusal, facts: MotionLimit, short: str) -> str:
    if facts.obstacle in OBSTACLES:
        return OBSTACLES[facts.obstacle]
    if refusal.amount is not None and refusal.amount.unit == "1":
        short = f"{number(100 * refusal.amount.value, 3)} %"
    what, joint = facts.rate or "velocity, acceleration or jerk", refusal.joint or "a joint"
    unit = None if refusal.amount is None else refusal.amount.unit
    numbers = ""
    if facts.value is not None and facts.limit is not None and unit not in (None, "1"):
        numbers = f"{amount(facts.value, unit)}, but its limit is {amount(facts.limit, unit)}"
    if refusal.stage is Stage.START:
        has = f"of {joint} at the start"
        return f"the {what} {has} is {numbers}" if numbers else f"the {what} {has} exceeds its limit by {short}"
    tracking = "" if facts.frame is None else f"to move with {facts.frame}, "
    if facts.obstacle is Obstacle.PATH_TOO_FAST:
        speed = "the process speed" if facts.speed_m_s is None else amount(facts.speed_m_s, "m/s")
        tracking = f"to go along the path at {speed}, "
    if numbers:
        return f"{tracking}{joint} would need a {what} of {numbers}{_mode(facts.mode)}"
    return f"{tracking}{joint} would have to exceed its limit of {what} by {short}{_mode(facts.mode)}"

"""What an answer says beside its plan: claims for the checker, and what it repeats of the request, held to that here.

What an answer leaves out is no claim. Of fields about the search (how long, what was refused), and of notes for people,
only the form is checked (`scenes.schema.checked`). A field that no answer has is refused, wherever it is.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import cache
from typing import Any, NotRequired, TypeVar, get_args, get_origin

from typing_extensions import get_type_hints

from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.attachments import at_start
from assur.planner.model.claims import Claims
from assur.planner.model.load import Carried
from assur.planner.model.outcome import Arrival, Contact, JointPeak, Nearest, Plan, ToolPeaks
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.report.straight_parts import assumed
from assur.scenes.faults import fault
from assur.scenes.reading.plan import BESIDE, PLAN
from assur.scenes.schema import answer as document
from assur.scenes.schema.checked import NOT_CHECKED, not_checked
from assur.scenes.schema.read import read_normal, read_written

Stated = TypeVar("Stated")
BOUND_S = 1e-9
"""A stated lower bound may exceed the computed one by this, s: rounding of what is written."""
SAME_ERROR = 1e-7
"""m or rad, and a share: by which an error that is stated may differ from the one that is computed again."""
MORE_THAN_REALISED_M = 1e-5
"""By which an error may exceed what its realisation comes to, m: a planner adds what counts for rounding."""
WITHIN = ("position_m", "vertical_m", "yaw_rad")
"""The parts of an error."""


def check_beside(plan: object) -> None:
    """Raises `DocumentError` below "plan" for a field beside the plan that no answer has, or of another kind."""
    if not isinstance(plan, dict):
        return  # no answer, which who reads the plan says
    check_notes(plan, document.PlannedAnswer, NOT_CHECKED)
    for key, model in _fields(document.PlannedAnswer).items():
        if key in BESIDE - {"margins", *NOT_CHECKED} and key in plan:
            read_normal(model, plan[key], plan[key], (PLAN, key))
    margins, known = _below(plan, "margins"), _fields(document.Margins)
    for key in margins:
        if key not in known:
            raise fault({PLAN: plan}, (PLAN, "margins", key), f"one of {', '.join(known)}")
        read_normal(known[key], margins[key], margins[key], (PLAN, "margins", key))


def check_notes(answer: dict[str, Any], form: Any, keys: Collection[str]) -> None:
    """Raises `DocumentError` below "plan" for one of the fields `keys` of an answer that is not as its form has it.
    What they say is not looked at."""
    for key, model in _fields(form).items():
        if key in keys and key in answer:
            read_written(model, answer[key], answer[key], (PLAN, key))


@cache
def _fields(kind: Any) -> dict[str, Any]:
    """The kinds of the fields of a TypedDict."""
    optional: Any = NotRequired
    hints = get_type_hints(kind, include_extras=True)
    return {key: get_args(hint)[0] if get_origin(hint) is optional else hint for key, hint in hints.items()}


def claims_of(plan: object) -> Claims:
    """What a planned answer claims of its plan. Raises `DocumentError` below "plan"."""
    margins, lasting = _below(plan, "margins"), _below(plan, "load")
    pairs = [
        _nearest(each, "margins", key, i)
        for key in ("travel_pairs", "near_pairs")
        for i, each in enumerate(_items(margins.get(key), "margins", key))
    ]
    peaks, contacts = margins.get("peaks"), plan.get("contacts") if isinstance(plan, dict) else None
    arrivals = plan.get("arrivals") if isinstance(plan, dict) else None
    bound = plan.get("lower_bound_s") if isinstance(plan, dict) else None
    tool, pull = margins.get("tool"), margins.get("tool_acceleration_m_s2")
    return Claims(
        nearest=_stated(margins, "nearest", lambda item: _nearest(item, "margins", "nearest")),
        placed=_stated(margins, "placed", lambda item: _nearest(item, "margins", "placed")),
        pairs=tuple(pairs),
        carried=_carried(lasting) if lasting else None,
        contacts=None
        if contacts is None
        else tuple(_contact(i, each) for i, each in enumerate(_items(contacts, "contacts"))),
        peaks=None
        if peaks is None
        else tuple(_peak(i, each) for i, each in enumerate(_items(peaks, "margins", "peaks"))),
        tool=None if tool is None else _tool(tool),
        tool_acceleration=_read(document.Number, pull, "margins", "tool_acceleration_m_s2"),
        singularity=_stated(margins, "singularity", float),
        parallel=_stated(margins, "parallel", float),
        modes=tuple(each.get("mode") for each in arrivals if isinstance(each, dict)) if arrivals else None,
        not_checked=not_checked(plan),
        lower_bound=_read(document.Number, bound, "lower_bound_s"),
    )


def _stated(margins: dict[str, Any], key: str, made: Callable[[Any], Stated]) -> tuple[Stated | None] | None:
    """What is said of a margin, (None,) being that there is none; None: nothing is said."""
    if key not in margins:
        return None
    return (None if margins[key] is None else made(margins[key]),)


def untrue_repeats(plan: object, scene: Scene) -> tuple[Finding, ...]:
    """What an answer repeats of its request and is not so there: digest, seed, assumptions, what the robot may carry,
    the limit of the tool's acceleration, whether jerk is limited; and the notice."""
    from assur.scenes.answer import NOTICE

    if not isinstance(plan, dict):
        return ()
    known, margins, lasting = scene.load_limits, _below(plan, "margins"), _below(plan, "load")
    by_table = "table" if known.shares else "rated_load"
    law = "none" if known.rated_kg is None and not known.shares else by_table
    repeated: list[tuple[dict[str, Any], str, str, object]] = [
        (plan, "", "request_digest", scene.digest),
        (plan, "", "seed", scene.options.seed),
        (plan, "", "assumptions", list(assumed(scene))),
        (plan, "", "notice", NOTICE),
        (lasting, "load.", "rated_kg", known.rated_kg),
        (lasting, "load.", "max_kg", known.max_kg),
        (lasting, "load.", "max_inertia_kgm2", known.max_inertia_kgm2),
        (lasting, "load.", "law", law),
        (margins, "margins.", "tool_acceleration_limit_m_s2", scene.carry_acceleration),
        (margins, "margins.", "jerk", "limited" if scene.options.jerk_limited else "unbounded"),
    ]
    found = [
        Finding(Code.CLAIM, f"{above}{key} is {_short(inside[key])}, but of this request it is {_short(true)}",
                where=f"{above}{key}")
        for inside, above, key, true in repeated
        if key in inside and not (inside[key] == true and isinstance(inside[key], bool) is isinstance(true, bool))
    ]  # fmt: skip
    return tuple(found)


def untrue_arrivals(arrivals: Sequence[Arrival], scene: Scene) -> tuple[Finding, ...]:
    """What arrivals repeat of the task and is not so there: whether a velocity is to be matched, and which points are
    on a conveyor, as how far they have come along it is then said."""
    found, frames, attached = list[Finding](), list[str](), at_start(scene)
    for step in scene.task:
        frames.append(attached.frame(scene, step))
        attached = attached.after(scene, step)
    for i, arrival in enumerate(arrivals):
        if not 0 <= arrival.step < len(frames):
            continue  # of another task, which the checker finds
        step = scene.task[arrival.step]
        matches = step.match == "velocity" and not step.via
        if arrival.matched is not matches:
            what = f"the velocity of {step.name} is {'' if matches else 'not '}to be matched, and it is said otherwise"
            found.append(Finding(Code.CLAIM, what, where=f"arrivals[{i}].matched"))
        if arrival.along_m is None and scene.frames[frames[arrival.step]].law.way is not None:
            what = f"{step.name} is on a conveyor, and it is not said how far along"
            found.append(Finding(Code.CLAIM, what, where=f"arrivals[{i}].along_m"))
    return tuple(found)


def untrue_errors(plan: Plan, scene: Scene) -> tuple[Finding, ...]:
    """Errors of arrivals, what their causes add, and realisations of them, that are not those which are computed again
    from the request and the motion. That no error is larger than is stated is shown elsewhere."""
    from assur.planner.legs.accuracy import arrival_error, realised
    from assur.planner.model.phases import phases

    found, first = list[Finding](), dict[int, Phase]()
    for each in phases(scene, plan.legs, plan.arrivals):
        first.setdefault(each.step, each)
    for i, arrival in enumerate(plan.arrivals):
        stated, phase, where = arrival.error, first.get(arrival.step), f"arrivals[{i}].error"
        if stated is None or phase is None or not plan.trajectory.start <= arrival.until <= plan.trajectory.end:
            continue  # the checker has found what is missing
        given = (scene, arrival.step, phase.attached, phase.handled, plan.trajectory.evaluate(arrival.until))
        own = arrival_error(*given, arrival.until)
        if own is None:
            what = f"all is known of {arrival.control_point}, and an error is stated"
            found.append(Finding(Code.ERROR, what, where=where))
            continue
        true = {share.cause: share for share in own.shares}
        told = {share.cause: share for share in stated.shares}
        pairs = [("position_m", stated.position_m, own.position_m)]
        pairs += [(name, getattr(stated.within, name), getattr(own.within, name)) for name in WITHIN]
        if [share.cause for share in stated.shares] != list(true):
            what = f"the causes of the error are {', '.join(true) or 'none'}, and others are stated"
            found.append(Finding(Code.ERROR, what, where=f"{where}.causes"))
        else:
            pairs += [(f"causes, {cause}", told[cause].position_m, share.position_m) for cause, share in true.items()]
            pairs += [(f"causes, {cause}", told[cause].yaw_rad, share.yaw_rad) for cause, share in true.items()]
        for name, one, other in pairs:
            if not abs(one - other) <= SAME_ERROR * (1.0 + abs(other)):
                what = f"{where}.{name} is {one:.6g}, but of this plan it is {other:.6g}"
                found.append(Finding(Code.ERROR, what, abs(one - other), where=where))
        far = realised(*given, arrival.until, dict(stated.worst))
        if far is None or not far >= stated.position_m - MORE_THAN_REALISED_M:
            what = "the realisation that is stated is none, or does not come near the error that is stated"
            found.append(Finding(Code.ERROR, what, where=f"{where}.worst"))
    return tuple(found)


def untrue_bound(stated: float | None, scene: Scene, lasts: float) -> tuple[Finding, ...]:
    """A finding if a stated lower bound of the duration, s, is larger than the one that is computed again from the
    request, or than the plan takes (`lasts`, s). None, 0 or less states nothing."""
    from assur.planner.bound.duration import least_duration

    where = "lower_bound_s"
    if stated is None or stated <= 0.0:
        return ()
    if not stated <= lasts + BOUND_S:
        what = f"{where} is {stated:.6f}, but this plan takes only {lasts:.6f}"
        return (Finding(Code.CLAIM, what, stated - lasts, "s", where),)
    least = least_duration(scene)
    if least is None:
        return (Finding(Code.CLAIM, f"{where} is {stated:.6f}, but no bound is known of this request", where=where),)
    if not stated <= least + BOUND_S:
        what = f"{where} is {stated:.6f}, but of this request it is {least:.6f}"
        return (Finding(Code.CLAIM, what, stated - least, "s", where),)
    return ()


def _short(value: object) -> str:
    """A value as it is told, no longer than a line bears."""
    return f"{value!r:.60}"


def _below(plan: object, key: str) -> dict[str, Any]:
    """An object within the answer; empty where there is none. Raises `DocumentError` where something else is there."""
    inside: dict[str, Any] = _read(dict[str, Any], plan.get(key) if isinstance(plan, dict) else None, key)
    return inside or {}


def _items(value: object, *path: str) -> list[Any]:
    """A list within the answer; empty where there is none. Raises `DocumentError` where something else is there."""
    items: list[Any] = _read(list[Any], value, *path)
    return items or []


def _read(model: Any, value: Any, *path: str | int) -> Any:
    return None if value is None else read_normal(model, value, value, (PLAN, *path))


def _item(model: Any, value: object, *path: str | int) -> Any:
    """An object within the answer. Raises `DocumentError` where something else is there, null as well."""
    return read_normal(model, value, value, (PLAN, *path))


def _nearest(value: object, *path: str | int) -> Nearest:
    item: document.Nearest = _item(document.Nearest, value, *path)
    one, other = item["bodies"]
    return Nearest(item["gap_m"], item["time_s"], (one, other), item["phase"], item["gap_m"])


def _carried(value: dict[str, Any]) -> tuple[Carried, ...]:
    item: document.LoadApplied = _read(document.LoadApplied, value, "load")
    return tuple(
        Carried(
            part=load["part"],
            mass_kg=load["mass_kg"],
            inertia_kgm2=load["inertia_kgm2"],
            share=load["acceleration_share"],
            t0=load["from_s"],
            t1=load["to_s"],
        )
        for load in item["carried"]
    )


def _contact(i: int, value: object) -> Contact:
    item: document.Contact = _item(document.Contact, value, "contacts", i)
    one, other = item["bodies"]
    return Contact((one, other), item["from_s"], item["to_s"])


def _peak(i: int, value: object) -> JointPeak:
    item: document.Peak = _item(document.Peak, value, "margins", "peaks", i)
    return JointPeak(**item)


def _tool(value: object) -> ToolPeaks:
    item: document.ToolPeaks = _read(document.ToolPeaks, value, "margins", "tool")
    return ToolPeaks(item["speed_m_s"], item["speed_at_s"], item["acceleration_m_s2"], item["acceleration_at_s"])

"""The statements of an answer in addition to its plan: claims for the checker, and repetitions of the request.

The repetitions are compared with the request here. A field that is left out is no claim. Of fields about the search
(its time, its refusals), and of notes for people, only the form is checked (`scenes.schema.checked`). A field that no
answer has is refused, wherever it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.attachments import at_start
from assur.planner.model.claims import Claims
from assur.planner.model.load import Carried
from assur.planner.model.outcome import Arrival, Contact, JointPeak, Nearest, Plan, ToolPeaks
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.scenes.answer_facts import fact_of
from assur.scenes.reading.plan import PLAN
from assur.scenes.schema import answer as document
from assur.scenes.schema.checked import NOT_CHECKED, not_checked
from assur.scenes.schema.read import read_normal, read_written

Fact = TypeVar("Fact")
CLAIMED = tuple(
    key
    for key in document.PlannedAnswer.__annotations__
    if key not in {*document.ShownMotion.__annotations__, "schema", "status", "certificate", *NOT_CHECKED}
)
"""Fields of a planned answer that state something in addition to its plan, and are no notes."""
BOUND_S = 1e-9
"""A stated lower bound may exceed the computed one by this, s: rounding of what is written."""
SAME_ERROR = 1e-7
"""m or rad, and a share: by which an error that is stated may differ from the one that is computed again."""
MORE_THAN_REALISED_M = 1e-5
"""By which an error may exceed what its realisation comes to, m: a planner adds what counts for rounding."""
WITHIN = ("position_m", "vertical_m", "yaw_rad")
"""The parts of an error."""


def claimed_in(plan: object) -> dict[str, Any]:
    """The fields of an answer that state something of its plan or of the request, and are no notes. Raises
    `DocumentError` below "plan" for a field that no answer has, or of another kind; of notes, too."""
    if not isinstance(plan, dict):
        return {}  # no answer, which who reads the plan says
    check_notes(plan, document.PlannedAnswer, NOT_CHECKED)
    form = document.partial(document.PlannedAnswer, CLAIMED, (), (("margins", document.partial(document.Margins)),))
    given = {key: value for key, value in plan.items() if key in CLAIMED}
    claimed: dict[str, Any] = read_normal(form, given, given, (PLAN,))
    return claimed


def check_notes(answer: dict[str, Any], form: Any, keys: tuple[str, ...]) -> None:
    """Raises `DocumentError` below "plan" for one of the fields `keys` of an answer that is not as its form has it.
    What they say is not evaluated."""
    notes = {key: value for key, value in answer.items() if key in keys}
    read_written(document.partial(form, keys), notes, notes, (PLAN,))


def claims_of(answer: dict[str, Any], claimed: dict[str, Any]) -> Claims:
    """What a planned answer claims of its plan. `claimed`: as `claimed_in` reads it."""
    margins, contacts = claimed.get("margins", {}), claimed.get("contacts")
    near = {key: _nearest(margins[key]) for key in ("nearest", "placed") if key in margins}
    pairs = [_nearest(each) for key in ("travel_pairs", "near_pairs") for each in margins.get(key, ())]
    tool, arrivals = margins.get("tool"), answer.get("arrivals")
    return Claims(
        nearest=(near["nearest"],) if "nearest" in near else None,
        placed=(near["placed"],) if "placed" in near else None,
        pairs=tuple(filter(None, pairs)),
        carried=_facts(Carried, claimed["load"]["carried"]) if "load" in claimed else None,
        contacts=None if contacts is None else _facts(Contact, contacts),
        peaks=_facts(JointPeak, margins["peaks"]) if "peaks" in margins else None,
        tool=None if tool is None else fact_of(ToolPeaks, tool),
        tool_acceleration=margins.get("tool_acceleration_m_s2"),
        singularity=(margins["singularity"],) if "singularity" in margins else None,
        parallel=(margins["parallel"],) if "parallel" in margins else None,
        modes=tuple(each.get("mode") for each in arrivals) if arrivals else None,
        not_checked=not_checked(answer),
        lower_bound=claimed.get("lower_bound_s"),
    )


def _facts(kind: type[Fact], items: list[Any]) -> tuple[Fact, ...]:
    return tuple(fact_of(kind, item) for item in items)


def _nearest(item: Any) -> Nearest | None:
    return None if item is None else fact_of(Nearest, item, distance_m=item["gap_m"])


def untrue_repeats(answer: dict[str, Any], scene: Scene) -> tuple[Finding, ...]:
    """The fields that repeat the request wrongly, of an answer whose form is right."""
    from assur.scenes.answer import repeated

    found = list[Finding]()
    for path, true in repeated(scene).items():
        *above, key = path.split(".")
        inside = answer.get(above[0], {}) if above else answer
        if key in inside and not (inside[key] == true and isinstance(inside[key], bool) is isinstance(true, bool)):
            what = f"{path} is {_short(inside[key])}, but of this request it is {_short(true)}"
            found.append(Finding(Code.CLAIM, what, where=path))
    return tuple(found)


def untrue_arrivals(arrivals: Sequence[Arrival], scene: Scene) -> tuple[Finding, ...]:
    """What arrivals repeat wrongly of the task: whether a velocity is to be matched, and which points are on a conveyor
    (their arrivals state how far along they are)."""
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
            be = "is" if matches else "is not"
            what = f"the velocity of {step.name} {be} to be matched, and the arrival states the opposite"
            found.append(Finding(Code.CLAIM, what, where=f"arrivals[{i}].matched"))
        if arrival.along_m is None and scene.frames[frames[arrival.step]].law.way is not None:
            what = f"{step.name} is on a conveyor, and the arrival does not state how far along"
            found.append(Finding(Code.CLAIM, what, where=f"arrivals[{i}].along_m"))
    return tuple(found)


def untrue_errors(plan: Plan, scene: Scene) -> tuple[Finding, ...]:
    """Findings for errors of arrivals, shares of their causes, and realisations that differ from those computed again
    from the request and the motion. That no error is larger than stated is proved elsewhere."""
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
        claimed = {share.cause: share for share in stated.shares}
        pairs = [("position_m", stated.position_m, own.position_m)]
        pairs += [(name, getattr(stated.within, name), getattr(own.within, name)) for name in WITHIN]
        if [share.cause for share in stated.shares] != list(true):
            what = f"the causes of the error are {', '.join(true) or 'none'}, and others are stated"
            found.append(Finding(Code.ERROR, what, where=f"{where}.causes"))
        else:
            pairs += [
                (f"causes, {cause}", claimed[cause].position_m, share.position_m) for cause, share in true.items()
            ]
            pairs += [(f"causes, {cause}", claimed[cause].yaw_rad, share.yaw_rad) for cause, share in true.items()]
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
    request, or than the plan takes (`lasts`, s). None states nothing; 0 or less no answer has."""
    from assur.planner.bound.duration import least_duration

    where = "lower_bound_s"
    if stated is None:
        return ()
    if not stated > 0.0:
        return (Finding(Code.CLAIM, f"{where} is {stated:.6g}, but a bound is more than 0, or null", where=where),)
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
    """A value as it is reported, cut to the length of a line."""
    return f"{value!r:.60}"

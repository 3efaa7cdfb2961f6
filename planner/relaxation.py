"""What would have helped: small changes of a request, each tried; first those that the refusal is about, then the
others in the order in which a shop would make them.

Changes of one kind are a family. Its strongest member is tried first: where it does not help, no weaker one does. Where
it helps, the weakest member that helps, too, is reported.

Never a robot beyond its limits, never a clearance below the uncertainties (those are added to it).
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby

import numpy as np

from assur.planner.blends.search import searcher
from assur.planner.collision.proof import Prover
from assur.planner.errors import InputError
from assur.planner.frames import Conveyor, Linear
from assur.planner.frames.belt_window import travelled
from assur.planner.frames.motion import Pose
from assur.planner.model.clearance import clearances
from assur.planner.model.easier_path import rounder, slower
from assur.planner.model.outcome import Plan, Relaxation
from assur.planner.model.progress import Watch
from assur.planner.model.refusal import LawEnds, NotTouching, Overshoot, Reason, Refusal, Separation
from assur.planner.model.scene import (
    WORLD,
    Clearance,
    ClearanceException,
    Follow,
    Move,
    Pick,
    Place,
    Scene,
    Step,
    Window,
)

ATTEMPT_S = 1.0
"""Longest time for one change of a request that counts no candidates, s; and no more than `SHARE` of what is left."""
SHARE = 1 / 3
MORE = 4
"""How much more the change of the budget allows."""
FEWEST_S = 0.02
"""A change is not tried with less time than this left, s."""
SHOWN_M = 1e-4
"""Clearances are proposed in whole tenths of a millimetre."""
WHOLE = 1e-3
"""Windows are proposed in whole milliseconds, and in whole millimetres of belt."""

ROUNDING = 1e-9
"""Ends of windows that differ by no more, s or m, are the same."""

Change = tuple[str, str, Scene]
"""Kind, value for people, and the request with the change."""


def relax(
    scene: Scene,
    step: int,
    blocker: str | None,
    deadline: float,
    refusal: Refusal | None = None,
    *,
    proved: bool = False,
    watch: Watch | None = None,
) -> tuple[Relaxation | None, tuple[str, ...], bool]:
    """The first kind of change that works, as small as it was found to work; what was tried; and whether the time was
    spent before all of it was. `deadline` in monotonic seconds.

    `refusal`: why there is no plan, and whether that is `proved`: only what it leaves open is tried.
    """
    tried: list[str] = []
    geometric = refusal is not None and refusal.reason in GEOMETRIC
    ended = refusal is not None and refusal.reason is Reason.LAW_ENDS and proved
    for what, members in groupby(changes(scene, step, blocker, refusal), key=lambda change: change[0]):
        if (proved and what == "budget") or (geometric and what not in OF_GEOMETRY) or (ended and what not in OF_LAW):
            continue
        family = list(members)
        left = deadline - time.perf_counter()
        if left < FEWEST_S:
            return None, tuple(tried), True
        strongest = _attempt(family[-1], deadline, tried, watch)
        if strongest is None:
            continue
        relaxation, spent = _weakest(scene, step, family, strongest, deadline, tried, watch)
        return relaxation, tuple(tried), spent
    return None, tuple(tried), False


def _weakest(
    scene: Scene,
    step: int,
    family: list[Change],
    strongest: Plan,
    deadline: float,
    tried: list[str],
    watch: Watch | None,
) -> tuple[Relaxation, bool]:
    """The weakest member of a family whose strongest has the plan `strongest`; whether the time was spent before it was
    known to be the weakest."""
    change, made = family[-1], strongest
    for weaker in family[:-1]:
        if deadline - time.perf_counter() < FEWEST_S:
            return _told(scene, change, made), True
        found = _attempt(weaker, deadline, tried, watch)
        if found is not None:
            change, made = weaker, found
            break
    if change[0] in NARROWED:
        # what was opened altogether is closed again behind the plan, and that is tried, too
        narrow = _narrowed(scene, step, change, made)
        if narrow is not None:
            if deadline - time.perf_counter() < FEWEST_S:
                return _told(scene, change, made), True
            found = _attempt(narrow, deadline, tried, watch)
            if found is not None:
                change, made = narrow, found
    return _told(scene, change, made), False


def _told(scene: Scene, change: Change, made: Plan) -> Relaxation:
    return Relaxation(change[0], change[1], made.trajectory.end - scene.start.time)


def _attempt(change: Change, deadline: float, tried: list[str], watch: Watch | None = None) -> Plan | None:
    """The search that the changed request would cause, up to its first plan: what is found here, that request finds.

    A search that could only repeat what has failed, because no more time is left for it, is left out.
    """
    what, value, scene = change
    options, left = scene.options, deadline - time.perf_counter()
    if options.max_candidates is not None:
        # the count ends each attempt, so what is found does not depend on the machine; the clock only keeps half of
        # the time for the changes that follow
        longest = left / 2
    elif what == "budget":
        longest = left / 2
        if longest * MORE <= options.budget_s:
            return None
    else:
        longest = min(ATTEMPT_S, SHARE * left)
    if what != "budget" and options.max_candidates is None:
        longest = min(longest, options.budget_s)
    tried.append(f"{what}: {value}")
    changed = replace(scene, options=replace(options, budget_s=longest))
    told: Watch | None = None if watch is None else lambda progress: watch(replace(progress, stage="relaxation"))
    search = searcher(changed, Prover(changed), time.perf_counter(), watch=told)
    search.until_first = True
    return search.run().plan


def _narrowed(scene: Scene, step: int, change: Change, made: Plan) -> Change | None:
    """The window, or the latest end, just as wide as the plan uses it, in round numbers; None if it uses no more than
    the request allows."""
    if change[0] == "latest end":
        latest = scene.options.latest_end_s
        ends = _up(made.trajectory.end, WHOLE)
        if latest is None or not ends > latest + ROUNDING:
            return None
        options = replace(scene.options, latest_end_s=ends)
        return "latest end", f"{ends:.3f} s, {1e3 * (ends - latest):.0f} ms later", replace(scene, options=options)
    window = scene.task[step].window
    arrival = next(each for each in made.arrivals if each.step == step)
    texts, span, along = [], window.time, window.along
    if span is not None:
        low, high = min(span[0], _down(arrival.time, WHOLE)), max(span[1], _up(arrival.until, WHOLE))
        texts += [f"from {low:.3f} s, {1e3 * (span[0] - low):.0f} ms earlier"] * (low < span[0] - ROUNDING)
        texts += [f"until {high:.3f} s, {1e3 * (high - span[1]):.0f} ms later"] * (high > span[1] + ROUNDING)
        span = (low, high)
    law = scene.frames[_frame(scene, scene.task[step])].law
    if along is not None and arrival.along_m is not None and isinstance(law, Conveyor | Linear):
        ways = travelled(law, Pose(), np.array([arrival.time, arrival.until]))
        begin, end = arrival.along_m, arrival.along_m + float(ways[1] - ways[0])
        low, high = min(along[0], _down(min(begin, end), WHOLE)), max(along[1], _up(max(begin, end), WHOLE))
        texts += [f"from {1e3 * low:.0f} mm, {1e3 * (along[0] - low):.0f} mm sooner"] * (low < along[0] - ROUNDING)
        texts += [f"to {1e3 * high:.0f} mm, {1e3 * (high - along[1]):.0f} mm farther"] * (high > along[1] + ROUNDING)
        along = (low, high)
    if not texts:
        return None
    return "window", " and ".join(texts), _step(scene, step, replace(scene.task[step], window=Window(span, along)))


def _up(value: float, unit: float) -> float:
    """The next whole number of units; a millionth of one is rounding."""
    return math.ceil(value / unit - 1e-6) * unit


def _down(value: float, unit: float) -> float:
    return math.floor(value / unit + 1e-6) * unit


def changes(scene: Scene, step: int, blocker: str | None, refusal: Refusal | None = None) -> Iterator[Change]:
    """All changes: first the kinds that the refusal is about, then the others, each kind from its weakest change to its
    strongest."""
    about = ABOUT.get(refusal.reason, ()) if refusal is not None else ()
    listed = list(_listed(scene, step, blocker, refusal))
    for kind in about:
        yield from (change for change in listed if change[0] == kind)
    yield from (change for change in listed if change[0] not in about)


def _listed(scene: Scene, step: int, blocker: str | None, refusal: Refusal | None) -> Iterator[Change]:
    """Changes in the order of a shop: window, latest end, acceleration time, budget, elbow, pitch, match, process
    speed, blend, heights of approach and depart, dwell, belt speed, clearance of a pair or of all, margin, a body or
    another robot left out."""
    what, options = scene.task[step], scene.options
    if what.window != Window():
        span, along = what.window.time, what.window.along
        later = Window(None if span is None else (span[0], FAR), None if along is None else (along[0], FAR))
        yield "window", "open at its end", _step(scene, step, replace(what, window=later))
        yield "window", "open", _step(scene, step, replace(what, window=Window()))
    if options.latest_end_s is not None:
        yield "latest end", "none", replace(scene, options=replace(options, latest_end_s=None))
    if options.acceleration_time_s is not None:
        yield (
            "acceleration time",
            "left to the planner",
            replace(scene, options=replace(options, acceleration_time_s=None)),
        )
    yield _budget(scene)
    if options.elbow != "auto" and len(scene.robot.modes) > 1:
        yield "elbow", "auto", replace(scene, options=replace(options, elbow="auto"))
    if isinstance(what, Move | Follow) and what.target.pitch is not None:
        yield "pitch", "free", _step(scene, step, replace(what, target=replace(what.target, pitch=None)))
    if isinstance(what, Move) and what.match == "velocity":
        yield "match", "position", _step(scene, step, replace(what, match="position"))
    for kind, steps in (("process speed", slower(what)), ("blend", rounder(what))):
        yield from ((kind, value, _step(scene, step, changed)) for value, changed in steps)
    yield from _heights(scene, step, what)
    yield from _dwells(scene, step, what)
    yield from _belts(scene, what)
    yield from _clearances(scene, refusal)
    if options.singularity_margin > 0:
        yield "singularity margin", "0", replace(scene, options=replace(options, singularity_margin=0.0))
    if blocker is not None and blocker in scene.index and not _is_part(scene, blocker):
        # the bodies of another robot have its name before theirs
        robot, of_robot, _ = blocker.partition("/")
        bodies = tuple(
            body
            for body in scene.bodies
            if body.name != blocker and not (of_robot and body.name.startswith(f"{robot}/"))
        )
        try:
            yield "without", robot, replace(scene, bodies=bodies)
        except InputError:
            # a step names the body (contact_with): without it the task would be another one
            return


def _clearances(scene: Scene, refusal: Refusal | None) -> Iterator[Change]:
    """Smaller distances of the pair that the refusal is about, by what is missing, by half and none; then of all pairs
    for which no exception is made."""
    clearance = scene.options.clearance

    def with_clearance(changed: Clearance) -> Scene:
        return replace(scene, options=replace(scene.options, clearance=changed))

    if refusal is not None and isinstance(refusal.facts, Separation) and len(refusal.bodies) == 2:
        first, second = refusal.bodies
        near, travel = (float(clearances(scene, of, [first], [second])[0, 0]) for of in (True, False))
        gap, required = refusal.facts.gap_m, refusal.facts.required_m
        short = None if gap is None or required is None else required - gap
        for travel_m, near_m in _smaller(travel, near, short):
            rule = ClearanceException(frozenset((first,)), frozenset((second,)), travel_m, near_m)
            changed = replace(clearance, exceptions=(*clearance.exceptions, rule))
            yield "pair clearance", f"{first} and {second}: {_distances(travel_m, near_m)}", with_clearance(changed)
    for travel_m, near_m in _smaller(clearance.travel_m, clearance.near_m, None):
        changed = replace(clearance, travel_m=travel_m, near_m=near_m)
        yield "clearance", _distances(travel_m, near_m), with_clearance(changed)


def _smaller(travel: float, near: float, short: float | None) -> Iterator[tuple[float, float]]:
    """Smaller distances of travel and near, from the greatest to none; one of both alone before both. `short`: by how
    much they are missed."""
    sizes = [(0.5 * travel, 0.5 * near), (0.0, 0.0)]
    if short is not None and short > 0.0:
        sizes.insert(0, (_less(travel, short), _less(near, short)))
    seen = {(travel, near)}
    for less_travel, less_near in sizes:
        for pair in ((travel, less_near), (less_travel, near), (less_travel, less_near)):
            if pair not in seen:
                seen.add(pair)
                yield pair


def _less(distance: float, short: float) -> float:
    """What is left, a hundredth of a millimetre less at least: the proof keeps a reserve."""
    return max(0.0, _down(distance - short - 0.1 * SHOWN_M, SHOWN_M))


def _distances(travel: float, near: float) -> str:
    return f"travel {1e3 * travel:g} mm, near {1e3 * near:g} mm"


def _budget(scene: Scene) -> Change:
    """A longer search: of more time and, where the request counts them, more candidates."""
    options, seconds = scene.options, MORE * scene.options.budget_s
    if options.max_candidates is None:
        return "budget", f"{seconds:g} s", replace(scene, options=replace(options, budget_s=seconds))
    count = MORE * options.max_candidates
    longer = replace(options, budget_s=seconds, max_candidates=count)
    return "budget", f"{count} candidates in {seconds:g} s", replace(scene, options=longer)


def _heights(scene: Scene, step: int, what: Step) -> Iterator[Change]:
    """Shorter straight parts of the ways to and from the point: of one of both alone, then of both."""
    if not isinstance(what, Pick | Place):
        return
    for share in (0.5, 0.2):
        approach, depart = share * what.approach_m, share * what.depart_m
        shorter = {"approach": approach} if approach > 0 else {}
        shorter |= {"depart": depart} if depart > 0 else {}
        alone = [{name: height} for name, height in shorter.items()] if len(shorter) == 2 else []
        for heights in (*alone, shorter) if shorter else ():
            lower = replace(
                what,
                approach_m=heights.get("approach", what.approach_m),
                depart_m=heights.get("depart", what.depart_m),
            )
            value = ", ".join(f"{name} {1e3 * height:g} mm" for name, height in heights.items())
            yield "heights", value, _step(scene, step, lower)


def _dwells(scene: Scene, step: int, what: Step) -> Iterator[Change]:
    for share in (0.8, 0.6, 0.4, 0.2, 0.1):
        if isinstance(what, Follow):
            duration = share * what.duration_s
            yield "dwell", f"{1e3 * duration:.0f} ms", _step(scene, step, replace(what, duration_s=duration))
        elif isinstance(what, Pick | Place) and what.dwell_s > 0:
            dwell = share * what.dwell_s
            yield "dwell", f"{1e3 * dwell:.0f} ms", _step(scene, step, replace(what, dwell_s=dwell))


def _belts(scene: Scene, what: Step) -> Iterator[Change]:
    name = _frame(scene, what)
    frame = scene.frames[name]
    if name == WORLD or not isinstance(frame.law, Conveyor) or frame.law.changes:
        return
    for share in (0.8, 0.5):
        law = replace(frame.law, speed=share * frame.law.speed)
        frames = {**scene.frames, name: replace(frame, law=law)}
        yield "belt speed", f"{1e3 * law.speed:.0f} mm/s", replace(scene, frames=frames)


def _frame(scene: Scene, what: Step) -> str:
    """The frame in which a step's control point is."""
    if isinstance(what, Pick):
        return scene.index[what.part].frame
    return what.to.frame if isinstance(what, Place) else what.target.frame


def _is_part(scene: Scene, name: str) -> bool:
    return any(isinstance(step, Pick | Place) and step.part == name for step in scene.task)


def _step(scene: Scene, number: int, step: Step) -> Scene:
    return replace(scene, task=(*scene.task[:number], step, *scene.task[number + 1 :]))


GEOMETRIC = frozenset({Reason.OUT_OF_REACH, Reason.JOINT_LIMIT})
OF_GEOMETRY = frozenset({"elbow", "pitch", "heights"})
"""Where a point cannot be reached, only another posture or another height can help."""
OF_LAW = frozenset({"window", "latest end", "dwell"})
"""Where it is proved that the motion of a frame is known for too short a time, only what needs less of it can help."""
FAR = 1e6
"""An end of a window, s or m, that is as good as none."""
NARROWED = frozenset({"window", "latest end"})
"""Kinds of which the plan that was found says how much would do."""
IN_THE_WAY = ("pair clearance", "clearance", "heights", "without")
ABOUT: dict[Reason, tuple[str, ...]] = {
    Reason.WINDOW_MISSED: ("window", "latest end", "dwell", "belt speed"),
    Reason.LAW_ENDS: ("dwell", "window", "latest end"),
    Reason.BODY_COLLISION: IN_THE_WAY,
    Reason.CONTROL_POINT_IN_COLLISION: IN_THE_WAY,
    Reason.NOT_CERTIFIED: IN_THE_WAY,
    Reason.SELF_COLLISION: ("pair clearance", "elbow"),
    Reason.OUT_OF_REACH: ("elbow", "pitch", "heights"),
    Reason.JOINT_LIMIT: ("elbow", "pitch", "heights"),
    Reason.NEAR_SINGULARITY: ("singularity margin", "elbow"),
    Reason.MOTION_LIMIT: ("process speed", "blend", "acceleration time", "match", "belt speed", "dwell"),
    Reason.CARRY_LIMIT: ("belt speed", "heights"),
}
"""Kinds of change that are about what a refusal is about, the likeliest first."""
HOPELESS = frozenset({Reason.START_IN_COLLISION, Reason.LAW_ENDS, Reason.LOAD_LIMIT, Reason.FORBIDDEN_YAW})
"""Reasons that no change of the list can mend."""


def worth_trying(refusal: Refusal | None) -> bool:
    """Whether any change of the list could help: also where the motion of a frame is known for too short a time for a
    control point."""
    if refusal is None or not (refusal.reason in HOPELESS or isinstance(refusal.facts, NotTouching | Overshoot)):
        return True
    return isinstance(refusal.facts, LawEnds) and refusal.facts.tracked_s is not None

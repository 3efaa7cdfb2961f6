"""Which bodies are the robot's, where each part sits and which contacts are allowed, in each leg of a plan.

All of it follows from the request and the legs alone: a pick attaches its part at the end of its follow, a place
detaches it, so it changes at the ends of legs and nowhere else. A part that is taken away after its place is gone in
the legs of later steps that begin then or later. Planner and checker both derive it here; the tests hold
this module to a second implementation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter

import numpy as np

from assur.planner.frames.motion import Pose
from assur.planner.laws.law import EXACT, Law, PoseUncertainty
from assur.planner.model.attachments import AT_START, Attachments, at_start
from assur.planner.model.outcome import TRACKING, Arrival, Leg, LegKind
from assur.planner.model.scene import Pick, Place, Scene, Step
from assur.planner.model.task import is_taken_away

CONTACT_M = 1e-4
"""Bodies in an allowed contact may overlap by this much, m: rounding of poses and a part that is not quite flat."""
KEPT = 256
"""Poses of frames that are kept: the phases of a plan are derived for each of its parts, and for all of it."""

Contacts = frozenset[tuple[str, str]]
"""Pairs of names, each in the order of `pair`, that may touch (down to -CONTACT_M)."""


@dataclass(frozen=True, slots=True)
class GraspUncertainty:
    """What is known of the parts that were gripped: how well each is known, in the gripper that holds it or in the
    frame where it was put down, sorted by name; and pairs of a part that was put down and a body on which it rests."""

    within: tuple[tuple[str, PoseUncertainty], ...] = ()
    supports: frozenset[tuple[str, str]] = frozenset()

    def of(self, part: str) -> PoseUncertainty | None:
        """How well a part is known; None: it was not gripped."""
        return dict(self.within).get(part)

    def changed(self, part: str, within: PoseUncertainty, rest: Contacts) -> GraspUncertainty:
        """The same after a part was gripped (`rest`: none) or put down, in contact with what it rests on."""
        others = [each for each in self.within if each[0] != part]
        kept = frozenset(each for each in self.supports if part not in each)
        supports = frozenset((part, name) for each in rest for name in each if name != part)
        return GraspUncertainty(tuple(sorted([*others, (part, within)], key=itemgetter(0))), kept | supports)

    def without(self, part: str) -> GraspUncertainty:
        """The same without a part that was taken away: nothing must keep clear of it."""
        return GraspUncertainty(
            tuple([each for each in self.within if each[0] != part]),
            frozenset([each for each in self.supports if part not in each]),
        )


NOBODY = frozenset[str]()
NOTHING_HANDLED = GraspUncertainty()


@dataclass(frozen=True, slots=True)
class Phase:
    """[t0, t1] of one leg (or the standstill after the last, whose step is -1).

    `contacts`: pairs that may touch, as deep as `contact_tolerance_m` allows; `tracked`: the frame that a tracking leg
    follows; `corrected`: with belt correction, the belts that the tracking legs before and behind this leg follow: for
    either the arm may be shifted on its way; `handled`: what is known of parts that were gripped. `robot`:
    whether the robot counts; it does not where only its late start is waited for.
    """

    t0: float
    t1: float
    kind: LegKind
    step: int
    attached: Attachments = AT_START
    contacts: Contacts = frozenset()
    tracked: str | None = None
    corrected: tuple[str, ...] = ()
    contact_tolerance_m: float = 0.0
    handled: GraspUncertainty = NOTHING_HANDLED
    robot: bool = True

    @property
    def near(self) -> bool:
        """Whether the clearance of approach, follow and depart counts."""
        return self.kind in TRACKING

    def is_of_kind(self, other: Phase) -> bool:
        """Whether all but the times and the step is surely the same: compared by identity, where that is quicker."""
        return (
            self.attached is other.attached
            and self.handled is other.handled
            and self.contacts is other.contacts
            and self.kind is other.kind
            and self.tracked is other.tracked
            and self.corrected == other.corrected
            and self.contact_tolerance_m == other.contact_tolerance_m
            and self.robot == other.robot
        )


def pair(first: str, second: str) -> tuple[str, str]:
    """Two names in the one order in which a pair is stored."""
    return (first, second) if first <= second else (second, first)


def phases(scene: Scene, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> tuple[Phase, ...]:
    """The phases of a plan with these legs, with the standstill for `stay_safe_s` behind the last one."""
    found, attached, handled = leg_phases(scene, legs, arrivals)
    return tuple(found + stay_phases(scene, legs[-1].t1, attached, handled, arrivals)) if legs else ()


LegPhases = tuple[list[Phase], Attachments, GraspUncertainty]
"""Phases of legs, one for each; and the attachments, and what is known of parts, behind the last."""


def leg_phases(scene: Scene, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> LegPhases:
    """The phases of these legs; and what the gripper holds, where parts are and how well they are known, behind the
    last one."""
    attached, handled, first = at_start(scene), handled_at_start(scene), 0
    found = list[Phase]()
    while first < len(legs):
        number, last = legs[first].step, first
        while last < len(legs) and legs[last].step == number:
            last += 1
        here, attached, handled = step_phases(scene, attached, handled, legs[first:last], arrivals)
        found += here
        first = last
    return found, attached, handled


def handled_at_start(scene: Scene) -> GraspUncertainty:
    """What is known of the part that the gripper holds when the plan begins."""
    holding = scene.start.holding
    return NOTHING_HANDLED if holding is None else GraspUncertainty(((holding.part, holding.within),))


AFTER_S = 0.02
"""So long after a part is gone the arm goes on, s: it is gone, too, where an export rounds times to a controller's
cycle."""


def gone_from(scene: Scene, step: Step, until: float) -> float:
    """From when on, s, the part of a step that ended at `until` is gone: after its time, and after that by which the
    robot may be late, for it is then put down so much later. Infinite: nobody takes it away."""
    after = step.gone_after_s if isinstance(step, Place) else None
    return math.inf if after is None else until + after + scene.execution.start_tolerance_s


def cleared(
    scene: Scene, attached: Attachments, handled: GraspUncertainty, arrivals: Sequence[Arrival], time: float
) -> tuple[Attachments, GraspUncertainty]:
    """Both without the parts that are gone at `time`, s, after these arrivals; the same objects if none is."""
    for part in sorted(parts_gone(scene, arrivals, time)):
        if handled.of(part) is not None:
            attached, handled = attached.without(scene, part), handled.without(part)
    return attached, handled


def parts_gone(scene: Scene, arrivals: Sequence[Arrival], time: float) -> frozenset[str]:
    """The parts that are gone at `time`, s, after these arrivals."""
    if not scene.clears:
        return NOBODY
    met = [(each, scene.task[each.step]) for each in arrivals]
    return frozenset([str(step.part) for each, step in met if gone_from(scene, step, each.until) <= time])


def stay_phases(
    scene: Scene, end: float, attached: Attachments, handled: GraspUncertainty, arrivals: Sequence[Arrival]
) -> list[Phase]:
    """What follows a motion that ends at `end`, s: the standstill for `stay_safe_s`, if one is required; and for parts
    that were put down the time by which the robot may be late, until when they must be kept clear, too."""
    stay, corrected = scene.options.stay_safe_s, on_way(scene, len(scene.task))
    found = list[Phase]()
    attached, handled = cleared(scene, attached, handled, arrivals, end)
    if scene.options.end == "rest" and stay > 0:
        found.append(Phase(end, end + stay, LegKind.WAIT, -1, attached, corrected=corrected, handled=handled))
        end += stay
        attached, handled = cleared(scene, attached, handled, arrivals, end)
    late = scene.execution.start_tolerance_s
    if late > 0.0 and any(name != attached.part for name, _ in handled.within):
        found.append(Phase(end, end + late, LegKind.WAIT, -1, attached, handled=handled, robot=False))
    return found


def step_phases(
    scene: Scene,
    attached: Attachments,
    handled: GraspUncertainty,
    legs: tuple[Leg, ...],
    arrivals: Sequence[Arrival],
) -> LegPhases:
    """The phases of the legs of one step, which begins with `attached` and `handled`; and both behind them.
    `arrivals`: at least those up to this step."""
    number = legs[0].step
    step, arrival = scene.task[number], next((each for each in arrivals if each.step == number), None)
    earlier = [each for each in arrivals if each.step < number]
    attached, handled = cleared(scene, attached, handled, earlier, legs[0].t0)
    frame = attached.frame(scene, step) if step.tracks else None
    leaving = frozenset([put.part for put in scene.task[:number] if is_taken_away(put)]) if scene.clears else NOBODY
    before, after = contacts_of(scene, step, attached, None if arrival is None else arrival.until, leaving)
    found, tracked, deep = list[Phase](), 0, step.contact_tolerance_m
    for leg in legs:
        attached, handled = cleared(scene, attached, handled, earlier, leg.t0)
        if frame is None or leg.kind not in TRACKING:
            # a leg to rest behind the tracking counts as on its way to the next step
            on_the_way = on_way(scene, number + min(tracked, 1))
            found.append(Phase(leg.t0, leg.t1, leg.kind, number, attached, corrected=on_the_way, handled=handled))
            continue
        tracked += 1
        found.append(Phase(leg.t0, leg.t1, leg.kind, number, attached, before, frame, (), deep, handled))
        if leg.kind is LegKind.FOLLOW and step.part is not None:
            within = gripped_within(step, arrival)
            handled = handled.changed(step.part, within, before if isinstance(step, Place) else frozenset())
            attached = attached.after(scene, step, 0.0 if arrival is None else arrival.yaw_offset)
            before = after
    return found, attached, handled


def gripped_within(step: Step, arrival: Arrival | None) -> PoseUncertainty:
    """How well a part is known once it was gripped or put down: as well as the tool met it, or as is stated."""
    if isinstance(step, Pick) and step.held_within is not None:
        return step.held_within
    error = None if arrival is None else arrival.error
    return EXACT if error is None else error.within


def contacts_of(
    scene: Scene, step: Step, attached: Attachments, time: float | None, leaving: frozenset[str] = NOBODY
) -> tuple[Contacts, Contacts]:
    """The pairs that may touch while a step is tracked: until its part is taken or put down, and from then on.

    A gripper touches the part that it takes or has put down, a held part what it stands on at `time` (None: the start).
    Nothing is put on what will be taken away (`leaving`).
    """
    if step.part is None:
        return frozenset(), frozenset()
    grip = frozenset(pair(body.name, step.part) for body in scene.tool.bodies)
    names = resting_on(scene, step.part, *attached.point(scene, step), step.contact_with, attached, time)
    rest = frozenset(pair(name, step.part) for name in names - leaving)
    return (grip, rest) if isinstance(step, Pick) else (rest, grip)


def resting_on(
    scene: Scene,
    part: str,
    frame: str,
    pose: Pose,
    names: tuple[str, ...] | None,
    attached: Attachments | None = None,
    time: float | None = None,
) -> frozenset[str]:
    """What a part at `pose` in `frame` touches from above: the named bodies, or those under it with their top at its
    bottom.

    `time` (None: the start) and `attached` (None: as at the start) say where each body is when the part is taken or put
    down, so that parts can be stacked. A body counts as under the part when the circles about both overlap; a pair that
    may touch must still be proved not to overlap by more than CONTACT_M.
    """
    if names is not None:
        return frozenset(names)
    at_s, attached = scene.start.time if time is None else time, attached or AT_START

    here = _pose_at(scene.frames[frame].law, at_s)
    if here is None:
        return frozenset()
    there, part_body = here.then(pose), scene.index[part].body
    bottom, around = there.z + part_body.heights[0], part_body.radius
    found = set()
    for body in scene.bodies:
        on, local = attached.pose_of(scene, body.name)
        below = None if body.name == part else _pose_at(scene.frames[on].law, at_s)
        if below is None or not abs(below.z + local.z + body.body.heights[1] - bottom) <= CONTACT_M:
            continue
        other = below.then(local)
        if math.hypot(other.x - there.x, other.y - there.y) <= around + body.body.radius:
            found.add(body.name)
    return frozenset(found)


@lru_cache(maxsize=KEPT)
def _pose_at(law: Law, at_s: float) -> Pose | None:
    """Where a frame is at a time; None: that is not known, and the checks of the laws' validity refuse it."""
    motion = law.motion(np.array(at_s))
    numbers = (*motion.p.tolist(), float(motion.yaw))
    return Pose(*numbers) if all(map(math.isfinite, numbers)) else None


def on_way(scene: Scene, number: int) -> tuple[str, ...]:
    """The belts that the last tracking legs of the steps before `number`, and the first of those from it on, follow:
    on all of the way between two of them, however many legs it has, belt correction may shift the arm for either."""
    if not scene.execution.belt_correction:
        return ()
    attached, before, behind = at_start(scene), "", ""
    for k, step in enumerate(scene.task):
        frame = attached.frame(scene, step) if step.tracks else ""
        if k < number:
            before = frame or before
        else:
            behind = behind or frame
        attached = attached.after(scene, step)
    return tuple(sorted({frame for frame in (before, behind) if frame and scene.corrects(frame)}))


def yaw_offsets(scene: Scene, step: Step) -> tuple[float, ...] | None:
    """Turns of the tool that a control point leaves to choose from, rad; None: any."""
    if "yaw" not in scene.robot.coordinates:
        return (0.0,)  # the heading of such an arm follows from the position
    if isinstance(step, Pick):
        fold = scene.index[step.part].yaw_symmetry
        return tuple(2 * np.pi * k / fold for k in range(fold)) if fold > 0 else None
    return None if step.target.yaw_free and step.part is None else (0.0,)


def contact_gap(phase: Phase) -> float:
    """The gap, m, that a pair which may touch must keep: less than 0, it is how deep it may overlap."""
    return -CONTACT_M - phase.contact_tolerance_m

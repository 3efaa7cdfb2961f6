"""The arm waits for a part that was put down to be gone: it stops, if it has not, and stands until then."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from assur.planner.legs.forbidden_yaw import turns_into
from assur.planner.legs.limits import beyond_limits
from assur.planner.legs.state import Knots, TimedLeg
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.outcome import Course, Leg, LegKind, Route
from assur.planner.model.phases import AFTER_S, Phase, cleared, gone_from, step_phases
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene
from assur.planner.search.extension import at_rest, too_hard, wrist_travel
from assur.planner.search.meeting_options import shifted_out
from assur.planner.search.partial_plan import PartialPlan, flown_by
from assur.planner.trajectory import Trajectory


def departures(scene: Scene, partial: PartialPlan) -> dict[str, float]:
    """Until when, s, the arm would have to wait at the end of a partial plan for each part that was put down to be
    gone."""
    if not scene.clears:
        return {}
    put_down = [(scene.task[each.step], each.until) for each in partial.arrivals]
    times = {str(step.part): gone_from(scene, step, until) for step, until in put_down}
    return {part: time + AFTER_S for part, time in times.items() if partial.state.time < time < math.inf}


def waits(scene: Scene, partial: PartialPlan) -> Iterator[tuple[PartialPlan, Trajectory, tuple[Phase, ...]]]:
    """The partial plans behind a wait for each part that will be gone, without their proofs; the motion of the wait and
    its phases."""
    times = sorted(set(departures(scene, partial).values()))
    if not times or partial.step == len(scene.task) or partial.waited or flown_by(scene, partial):
        return
    stopped = _stopped(scene, partial)
    if stopped is None:
        return
    for until in times:
        legs, rest = list(stopped), stopped[-1].knots.last if stopped else partial.state
        if until > rest.time:
            legs.append(TimedLeg(LegKind.WAIT, Knots.standing(rest, until), Route(Course.FOR_BODIES)))
        knots = legs[0].knots
        for leg in legs[1:]:
            knots = knots.then(leg.knots)
        trajectory = Trajectory.of_knots(knots.table)
        made = tuple(Leg(leg.kind, partial.step, leg.knots.begin, leg.knots.end, leg.route) for leg in legs)
        given = (scene, partial.attached, partial.handled)
        phases, *_ = step_phases(*given, made, partial.arrivals)
        if _refused(scene, partial, trajectory, tuple(phases)):
            continue
        attached, handled = cleared(*given, partial.arrivals, knots.end)
        after = replace(
            partial,
            state=knots.last,
            attached=attached,
            handled=handled,
            legs=partial.legs + made,
            knots=knots if partial.knots is None else partial.knots.then(knots),
            trajectory=None,
            wrist=partial.wrist + wrist_travel(scene.robot, knots.q),
            rises=0.0,
            tracked=None,
            waited=True,
            lines={},
        )
        yield after, trajectory, tuple(phases)


def _stopped(scene: Scene, partial: PartialPlan) -> list[TimedLeg] | None:
    """The leg to rest at the end of a partial plan, none where the arm rests; None: it cannot stop there."""
    if partial.state.resting:
        return []
    if scene.task[partial.step].leg == "cartesian" or not scene.options.jerk_limited or partial.knots is None:
        return None
    ends = TimedLeg(LegKind.MOVE, Knots(partial.knots.table[-1:]))
    legs = at_rest(partial.step, [ends], 1.0, partial.attached.limits(scene))
    return None if isinstance(legs, Refusal) else legs[1:]


def _refused(scene: Scene, partial: PartialPlan, trajectory: Trajectory, phases: tuple[Phase, ...]) -> bool:
    """Whether the arm cannot stop in this way."""
    step = partial.step
    refusal = (
        beyond_limits(scene, step, trajectory, partial.attached.limits(scene))
        or leaves_assembly(scene.robot, step, trajectory)
        or turns_into(scene, step, trajectory)
        or shifted_out(scene, step, trajectory, list(phases))
        or too_hard(scene, step, trajectory, phases)
    )
    return refusal is not None

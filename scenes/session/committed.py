"""The motion that runs: plans one after the other, each left at the instant at which the next one begins."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.errors import FaultError

if TYPE_CHECKING:
    from assur.planner.arrays import FloatArray
    from assur.planner.model.attachments import Attachments
    from assur.planner.model.outcome import Arrival, Leg, Plan
    from assur.planner.model.phases import GraspUncertainty, LegPhases
    from assur.planner.trajectory import Trajectory
    from assur.scenes.reading.cell import Cell
    from assur.scenes.session.judged import JudgedOutcome

MOST_JUMPS = (1e-9, 1e-7, 1e-5)
"""Most by which position, velocity and acceleration of a joint may differ where one plan follows another: rad or m, and
per s and s². Rounding of units is far below."""

KEPT_S = 10.0
"""So long a plan is kept behind its end, s: a reading may come late."""


@dataclass(frozen=True)
class History:
    """What is no longer seen in a plan that follows others: when, s, each part was `handled` last, and when those that
    were put down to be taken away are gone, which `leaves` has."""

    handled: Mapping[str, float] = field(default_factory=dict)
    leaves: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Segment:
    """A plan of the committed motion, `judged`, proved from `starts_s` on, executed until `until_s`. `proved_until_s`:
    until when it is proved if it is not left. `before`: what happened before it. `of_legs`: the
    phases of its legs."""

    judged: JudgedOutcome
    cell: Cell
    motion: Trajectory
    legs: tuple[Leg, ...]
    arrivals: tuple[Arrival, ...]
    of_legs: LegPhases
    before: History
    starts_s: float
    proved_until_s: float
    until_s: float

    def state(self, at_s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈ (n,) at an instant, in the planner's order; at rest behind the end."""
        return self.motion.state(min(at_s, self.motion.end))

    def during(self, at_s: float) -> tuple[Attachments, GraspUncertainty]:
        """What the gripper holds, where parts are and how well they are known at an instant; until a part is gripped or
        put down, as before."""
        phases, attached, known = self.of_legs
        now = next((phase for phase in phases if at_s < phase.t1), None)
        return (attached, known) if now is None else (now.attached, now.handled)

    def history(self, at_s: float) -> History:
        """What happened before an instant."""
        from assur.planner.model.phases import gone_from

        handled, leaves = dict(self.before.handled), dict(self.before.leaves)
        for arrival in self.arrivals:
            step = self.cell.scene.task[arrival.step]
            if step.part is not None and arrival.until <= at_s:
                handled[step.part] = arrival.until
                leaves[step.part] = gone_from(self.cell.scene, step, arrival.until)
        return History(handled, {name: time for name, time in leaves.items() if time < math.inf})


def segment_of(judged: JudgedOutcome, plan: Plan, before: History) -> Segment:
    """The `plan` of an outcome as one that may be committed, and until when standing at its end is proved."""
    from assur.planner.model.phases import leg_phases
    from assur.scenes.tasks.instants import stands_until

    cell, motion, legs, arrivals = judged.cell, plan.trajectory, plan.legs, plan.arrivals
    of_legs = leg_phases(cell.scene, legs, arrivals)
    until_s = stands_until(cell.scene, of_legs[1], motion.end)
    return Segment(judged, cell, motion, legs, arrivals, of_legs, before, motion.start, until_s, until_s)


class CommittedMotion:
    """The committed motion; it begins with one plan."""

    def __init__(self, first: Segment) -> None:
        self.segments: tuple[Segment, ...] = (first,)

    @property
    def last(self) -> Segment:
        return self.segments[-1]

    def at(self, at_s: float) -> Segment:
        """The plan that is executed from an instant on; the first one before all of them, the last one behind them."""
        return next((each for each in self.segments if at_s < each.until_s), self.last)

    def forget(self, clock_s: float) -> None:
        """Leaves out plans that ended so long before the clock that no reading is of them."""
        self.segments = (*[each for each in self.segments[:-1] if each.until_s > clock_s - KEPT_S], self.last)

    def follow(self, made: Segment) -> None:
        """From the start of a plan on it is the motion. Raises `FaultError` where the motion would jump there."""
        at_s = made.starts_s
        left = self.at(at_s)
        for one, other, most, what in zip(
            left.state(at_s), made.state(at_s), MOST_JUMPS, ("position", "velocity", "acceleration"), strict=True
        ):
            jump = float(np.abs(one - other).max())
            if not jump <= most:
                raise FaultError(f"at {at_s:.6g} s the {what} of a joint jumps by {jump:.3g}, by more than {most:g}")
        kept = [each for each in self.segments if each.starts_s < at_s]
        if kept:
            kept[-1] = replace(kept[-1], until_s=at_s)
        self.segments = (*kept, made)

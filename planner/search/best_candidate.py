"""The candidate that came furthest, of a search that finds no plan: what stopped it is why there is none, and it is
what is shown of a refusal."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.collision.screening import Encounter
from assur.planner.legs.state import Knots
from assur.planner.model.outcome import Arrival, BestCandidate, Course, Leg, LegKind, Route
from assur.planner.model.refusal import Refusal, Separation, Stage
from assur.planner.model.scene import Scene
from assur.planner.search.partial_plan import Extension, PartialPlan, TimedCandidate
from assur.planner.trajectory import Trajectory

MOST_KNOTS = 1_000
"""Knots of the motion that is told of a refusal, about 100 kB of an answer: a follow of many minutes has 20,000."""


ORDER = tuple(Stage)
"""Stages, in the order in which a candidate comes to them."""


@dataclass(frozen=True, eq=False)
class RefusedMotion:
    """A motion that was timed, and why it was refused: for bodies that are too near at one instant, the deepest first,
    or for something else. It refers to what the search has anyway: keeping one costs nothing."""

    motion: TimedCandidate | Extension
    encounters: tuple[Encounter, ...]

    @property
    def rank(self) -> tuple[int, bool, bool, int, float]:
        """The greater the further it came: by steps, then by stages, then by how little is missing.

        The leg to a point is screened before what follows at the point is timed, and that before all of it is screened.
        """
        refusal, whole = self.encounters[0].refusal, isinstance(self.motion, Extension)
        free = whole or refusal.stage is not Stage.SCREENING
        lacks = math.inf if refusal.amount is None else refusal.amount.value
        return self.motion.before.step, free, whole, ORDER.index(refusal.stage), -lacks


def best_candidate(scene: Scene, refused: RefusedMotion | None, proved: PartialPlan | None) -> BestCandidate | None:
    """What came furthest: a motion that was refused, behind what was proved before it; or, where there is none, the
    longest partial plan that was `proved`. None: there is neither."""
    if refused is not None:
        return _of_motion(scene, refused.motion, refused.encounters[0].confirmed())
    if proved is None or proved.knots is None:
        return None
    return BestCandidate(motion_told(scene, proved.knots), proved.legs, proved.arrivals)


def _of_motion(scene: Scene, motion: TimedCandidate | Extension, refusal: Refusal) -> BestCandidate:
    facts, interval = refusal.facts, refusal.interval
    if isinstance(motion, Extension):
        knots, legs, arrivals = motion.after.knots, motion.after.legs, motion.after.arrivals
    else:
        knots, legs, arrivals = None, *_leg_of(motion)
    if knots is None:
        own, before = Knots.of(motion.trajectory), motion.before
        if own.begin > before.state.time:
            own = Knots.standing(before.state, own.begin).then(own)
        knots = own if before.knots is None else before.knots.then(own)
    met = isinstance(facts, Separation)
    bodies = refusal.bodies
    return BestCandidate(
        trajectory=motion_told(scene, knots),
        legs=legs,
        arrivals=arrivals,
        at=interval[0] if met and interval is not None else None,
        bodies=(bodies[0], bodies[1]) if met and len(bodies) == 2 else None,
        gap_m=facts.gap_m if isinstance(facts, Separation) else None,
        required_m=facts.required_m if isinstance(facts, Separation) else None,
    )


def _leg_of(motion: TimedCandidate) -> tuple[tuple[Leg, ...], tuple[Arrival, ...]]:
    """The legs up to a control point that a timed candidate comes to, and the arrivals before it."""
    before, shape, step = motion.before, motion.candidate.shape, motion.before.step
    begin, end = motion.trajectory.start, motion.trajectory.end
    legs = before.legs
    if begin > before.state.time:
        legs += (Leg(LegKind.WAIT, step, before.state.time, begin, Route(Course.FOR_BODIES)),)
    kind = LegKind.ARCH if shape.hop else LegKind.MOVE
    return (*legs, Leg(kind, step, begin, end, shape.route)), before.arrivals


def motion_told(scene: Scene, knots: Knots) -> Trajectory:
    """The motion through knots, or, where they are more than `MOST_KNOTS`, through so many of them: it is told for help
    and nothing is proved of it."""
    table = knots.table
    if len(table) > MOST_KNOTS:
        table = table[np.linspace(0, len(table) - 1, MOST_KNOTS).round().astype(np.int64)]
    return Trajectory.of_knots(table, jumps=not scene.options.jerk_limited)

"""Options of a request: how to search, which distances are required, and how motions are timed.

With parabolic blends only joint moves from rest to rest can be timed: a blend misses its pose, and its acceleration
jumps. What needs a velocity, a line or a gripper is refused here, field by field, before anything is planned.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from assur.planner.errors import InputError
from assur.planner.laws.law import Frame
from assur.planner.model.task import Move, Step, key_of

LEAST_ACCELERATION_TIME_S = 2e-3
"""s. Shorter blends cannot be written: over 2 ms, rounding of positions costs 1e-8 rad/s² of acceleration."""


@dataclass(frozen=True, slots=True)
class ClearanceException:
    """Required distances, m, of any body of `first` from any of `second` (none named: of all)."""

    first: frozenset[str]
    second: frozenset[str]
    travel_m: float
    near_m: float


@dataclass(frozen=True, slots=True)
class Clearance:
    """Required distances, m: `near` in approach, follow and depart, `travel` elsewhere; and what differs from that:
    the last that names a pair counts."""

    travel_m: float = 0.0
    near_m: float = 0.0
    exceptions: tuple[ClearanceException, ...] = ()

    def exception(self, first: str, second: str) -> ClearanceException | None:
        """The exception that counts for two bodies; None: there is none."""
        for rule in reversed(self.exceptions):
            for one, other in ((rule.first, rule.second), (rule.second, rule.first)):
                if (not one or first in one) and (not other or second in other):
                    return rule
        return None

    def lowered(self, travel_m: float, near_m: float, names: tuple[str, ...]) -> Clearance:
        """The same with other distances of two bodies, or, without names, of all for which no exception is made."""
        if not names:
            return replace(self, travel_m=travel_m, near_m=near_m)
        one, other = (frozenset((name,)) for name in names)
        rule = ClearanceException(one, other, travel_m, near_m)
        return replace(self, exceptions=(*self.exceptions, rule))

    def distances(self, *names: str) -> tuple[float, float]:
        """The distances in travel and near a control point of two bodies, or, without names, of all for which no
        exception is made, m."""
        rule = self.exception(*names) if names else None
        return (self.travel_m, self.near_m) if rule is None else (rule.travel_m, rule.near_m)


LONGEST_BUDGET_S, MOST_CANDIDATES = 60.0, 10_000_000
"""Most seconds of search, and most candidates, of one request."""


@dataclass(frozen=True, slots=True)
class Options:
    """How to search. `stop`: at the first certified plan, or when the budget is spent."""

    seed: int = 0
    budget_s: float = 1.0
    max_candidates: int | None = None
    stop: Literal["first", "budget"] = "budget"
    explain_budget_s: float = 0.0
    report: Literal["none", "short", "full"] = "short"
    """What an answer states in addition to its plan: nothing; the smallest clearances; or all margins with the nearest
    pairs of bodies, the lower bound of the duration, and warnings, which refusals have as well."""
    clearance: Clearance = Clearance()
    singularity_margin: float = 0.05
    elbow: str = "keep"
    """`keep` (the start's working mode), `auto` (any, changes allowed), or the name of one of the robot's modes."""
    end: Literal["rest", "moving"] = "rest"
    stay_safe_s: float = 0.0
    latest_end_s: float | None = None
    """The motion must have ended by this time, s."""
    timing: Literal["jerk_limited", "parabolic_blend"] = "jerk_limited"
    """`parabolic_blend`: joint moves by parabolic blends (`assur.planner.blends`, equations B1 to B7)."""
    acceleration_time_s: float | None = None
    """How long each blend lasts, s; None: each as short as the limits allow."""

    @property
    def jerk_limited(self) -> bool:
        """Whether the jerk keeps its limits; if not, the acceleration may jump, and the jerk has no bound."""
        return self.timing == "jerk_limited"

    @property
    def vias_missed(self) -> bool:
        """Whether a via is passed at a distance, which its arrival states; if not, it is met."""
        return self.timing == "parabolic_blend"


DEFAULTS = Options()
"""What a request that chooses nothing has."""


def check_timing(options: Options, task: tuple[Step, ...], frames: Mapping[str, Frame], *, moving: bool) -> None:
    """Accept an acceleration time and a task that the timing can do; `moving`: whether the start is in motion.

    Raises `InputError` naming the field, its value and what is allowed.
    """
    time, blended = options.acceleration_time_s, "with timing parabolic_blend"
    if time is not None and options.jerk_limited:
        raise InputError("options.acceleration_time", time, "none: only timing parabolic_blend has one")
    if time is not None and not LEAST_ACCELERATION_TIME_S <= time < math.inf:
        raise InputError("options.acceleration_time", time, f"{1e3 * LEAST_ACCELERATION_TIME_S:g} ms or more")
    if options.jerk_limited:
        return
    if moving:
        raise InputError("start.velocity", "a start in motion", f"a start at rest {blended}")
    if options.end != "rest":
        raise InputError("options.end", options.end, f"rest {blended}")
    for i, step in enumerate(task):
        field = f"task[{i}].{key_of(step)}"
        if not isinstance(step, Move):
            raise InputError(field, step.name, f"moves only {blended}: poses are missed, accelerations jump")
        if step.leg != "joint":
            raise InputError(f"{field}.leg", step.leg, f"joint {blended}")
        if step.target.yaw_keep:
            raise InputError(f"{field}.to.yaw_keep", True, f"false {blended}: yaws between blends are missed")
        if step.arch is not None:
            raise InputError(f"{field}.arch", step.arch.top_m, f"no arch {blended}")
        frame = frames[step.target.frame]
        if step.match == "velocity" and not frame.law.is_fixed:
            raise InputError(f"{field}.match", step.match, f"position {blended}, for {frame.name} moves")
        if step.via and i == len(task) - 1:
            raise InputError(f"{field}.via", True, f"false {blended}: the motion ends at rest in the last pose")

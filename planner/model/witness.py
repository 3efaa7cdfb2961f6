"""What proves that there is no plan: witnesses of a refusal, for the checker and for everybody who wants to verify it.

A refusal whose facts and amount are all there is to prove (a limit, a load, a range of yaw, a law that ends) needs no
witness in addition. Lengths in m, angles in rad, times in s of the scene's clock; points in the world at the start.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from assur.planner.model.refusal import Reason, Unit

PROVED_M = 5e-6
"""A length proves nothing unless it is off by more than this, m. A plan may meet a point within 1e-6 m (`MEET_M` of the
checker), so what is nearer than that to being possible may be possible."""
PROVED_TRACKED_M = 2e-5
"""The same above a point, where a plan may be off its line by 1e-5 m (`TRACKED_M` of the checker)."""
PROVED_RAD = 5e-6
"""The same for angles, rad: a yaw may be met within 1e-6 rad (`MEET_RAD` of the checker)."""
PROVED_SHARE = 1e-8
"""The same for what has a limit (a rate, a load, a margin), as a share of it; and for positions, as a share of the
joint's range. The checker lets trajectories exceed their limits by 1e-9 of them."""
PROVED_S = 1e-8
"""The same for times, s: the checker compares times of plans up to 1e-9 s."""

Place = Literal["start", "point", "behind", "approach", "depart"]
"""Where bodies meet: at the start; at the control point, before (`point`) and after (`behind`) the part is taken or put
down; and where a straight part begins or ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstruction:
    """In one working mode, and with the part turned by `turn_rad` (None: any turn), a control point, or the place
    `above_m` over it, cannot be met: `reason` says why, `joint` which joint would be beyond its range, `by` how much is
    missing."""

    mode: str
    turn_rad: float | None
    above_m: float
    reason: Reason
    joint: str | None = None
    by: float
    unit: Unit


@dataclass(frozen=True, slots=True, kw_only=True)
class Unreachable:
    """A control point that stands still: one hindrance for each working mode that is allowed and each turn of the part,
    so that none is left."""

    kind: Literal["hindered"] = "hindered"
    ways: tuple[Obstruction, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Meeting:
    """Two bodies that come too near: the first holds the first of `points_m`, the second the second; both points are
    the same where the bodies overlap. A point inside a hollow mesh is held by it, too (`inside`). In the working mode
    `mode` (None: the start) and with the part turned by `turn_rad` (None: any turn)."""

    mode: str | None
    turn_rad: float | None
    place: Place
    bodies: tuple[str, str]
    points_m: tuple[tuple[float, float, float], tuple[float, float, float]]
    inside: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlap:
    """Bodies that are in the way: one pair at the start; at a control point one for each working mode and each turn of
    the part."""

    kind: Literal["met"] = "met"
    ways: tuple[Meeting, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenIntervals:
    """All times at which a control point may be met at all, its law, its windows and the latest end considered, from
    the start on for ever: none of these intervals is as long as the point must be tracked."""

    kind: Literal["openings"] = "openings"
    spans_s: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class PeriodicReach:
    """A point on a frame that repeats its motion: over `span_s`, a whole period, it is never nearer to the arm's reach
    than `short_m`."""

    kind: Literal["orbit"] = "orbit"
    span_s: tuple[float, float]
    short_m: float


Witness = Unreachable | Overlap | OpenIntervals | PeriodicReach

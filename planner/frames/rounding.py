"""How far what is on a frame goes in the time for which its law is evaluated: numbers of that size are what rounds.

A law that has run for T seconds at up to V m/s is a sum of terms of up to V T. Each rounds by 2^-53 of that, so far
from the time at which a frame's pose is stated, or from time zero, its place is known less well than proofs need.
"""

from __future__ import annotations

import math

from assur.planner.errors import InputError
from assur.planner.frames.conveyor import Conveyor
from assur.planner.frames.fixed import Linear
from assur.planner.frames.indexer import Indexer
from assur.planner.frames.law import Law
from assur.planner.frames.oscillation import Oscillation
from assur.planner.frames.swing import Swing
from assur.planner.frames.turntable import Turntable

FARTHEST_WAY_M = 200_000.0
"""Greatest way V T, m: sixteen roundings of it are 0.36 nm (docs/guarantees.md, "Rounding"). A dial of 600 mm at one
turn a second goes so far in 29 hours."""
FARTHEST_PLACE_M = 10_000.0
"""How far a body may be from the origin of the frame that bears it, m: forty roundings of it are 0.05 nm. Coordinates
are 100 m at most, but frames may be fixed on frames."""
STEEPEST = 35.0 / 16.0
"""Peak of the speed of an indexer's move as a multiple of its mean (F3)."""


def speed_of(law: Law, reach: float) -> float:
    """The greatest speed, m/s, of a point within `reach` m of a frame's vertical axis. 0 for what stands still, and for
    what is given by instants that are exact: keyframes, and the links of another robot."""
    if isinstance(law, Linear):
        return math.hypot(*law.velocity)
    if isinstance(law, Conveyor | Turntable):
        first = law.speed if isinstance(law, Conveyor) else law.rate
        most = max(abs(rate) for rate in (first, *(change.speed for change in law.changes)))
        return most if isinstance(law, Conveyor) else most * reach + abs(law.rise)
    if isinstance(law, Swing | Oscillation):
        arm = reach if isinstance(law, Swing) else 1.0
        return 2.0 * math.pi / law.period * abs(law.amplitude) * arm
    if isinstance(law, Indexer):
        return STEEPEST * abs(law.step) / law.move_s * (reach if law.kind == "turn" else 1.0)
    return 0.0


def stated_at(law: Law) -> float:
    """The instant, s, from which a law counts."""
    if isinstance(law, Linear | Conveyor | Turntable):
        return law.at_time
    return law.start if isinstance(law, Indexer) else 0.0


def way(law: Law, reach: float, begin: float, end: float) -> float:
    """The way V T, m: at up to V the law runs from the instant at which it is stated, or time zero, to the farthest of
    two instants, s."""
    at = stated_at(law)
    return speed_of(law, reach) * max(abs(at), *(max(abs(t), abs(t - at)) for t in (begin, end)))


def check_rounding(field: str, law: Law, reach: float, begin: float, lasts: float) -> None:
    """Raises `InputError` naming `field` for a body that reaches so far, m, from its frame's origin that it is beyond
    `FARTHEST_PLACE_M`, or that goes farther than `FARTHEST_WAY_M` in a plan that begins at `begin`, s, and lasts so
    long, s, at least."""
    if not reach <= FARTHEST_PLACE_M:
        allowed = (
            f"bodies within {FARTHEST_PLACE_M:g} m of the frame's origin, frames that are fixed on it counted along"
        )
        raise InputError(field, reach, allowed)
    far = way(law, reach, begin, begin + lasts)
    if far <= FARTHEST_WAY_M:
        return
    speed, since = speed_of(law, reach), stated_at(law)
    allowed = (
        f"a way of at most {FARTHEST_WAY_M:g} m, speed times time (numbers of a longer way round by more than a proof "
        f"allows for): what is on the frame moves at up to {speed:.6g} m/s, its pose is stated at {since:g} s, and the "
        f"plan is from {begin:g} s to {begin + lasts:g} s at least"
    )
    raise InputError(field, far, allowed)

"""How far what is on a frame goes in the time for which its law is evaluated: numbers of that size are what rounds.

A law that has run for T seconds at up to V m/s is a sum of terms of up to V T. Each rounds by 2^-53 of that, so far
from the time at which a frame's pose is stated, or from time zero, its place is known less well than proofs need.
"""

from __future__ import annotations

from assur.planner.errors import InputError
from assur.planner.laws.law import Law

FARTHEST_WAY_M = 200_000.0
"""Greatest way V T, m: eighteen roundings of it are 0.4 nm (docs/guarantees.md, "Rounding"). A dial of 600 mm at one
turn a second goes so far in 29 hours."""
FARTHEST_PLACE_M = 10_000.0
"""How far a body may be from the origin of the frame that bears it, m: forty roundings of it are 0.05 nm. Coordinates
are 100 m at most, but frames may be fixed on frames."""


def way(law: Law, reach: float, begin: float, end: float) -> float:
    """The way V T, m, of a point within `reach` m of a frame's vertical axis: at up to V the law runs from the instant
    at which it is stated, or time zero, to the farthest of two instants, s."""
    at = law.stated_s
    return _speed(law, reach) * max(abs(at), *(max(abs(t), abs(t - at)) for t in (begin, end)))


def _speed(law: Law, reach: float) -> float:
    return law.fastest[0] + reach * law.fastest[1]


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
    speed, since = _speed(law, reach), law.stated_s
    allowed = (
        f"a way of at most {FARTHEST_WAY_M:g} m, speed times time (numbers of a longer way round by more than a proof "
        f"allows for): what is on the frame moves at up to {speed:.6g} m/s, its pose is stated at {since:g} s, and the "
        f"plan is from {begin:g} s to {begin + lasts:g} s at least"
    )
    raise InputError(field, far, allowed)

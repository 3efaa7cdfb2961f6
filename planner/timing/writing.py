"""How a profile is written as knots that a spline through them keeps its jerk.

A knot at every switch, those of different joints that almost coincide as one: the spline repeats the phases, but for
two things. A joint whose switch of Δj is δ beside the shared knot has a jerk off by up to 9 Δj δ/h on a piece of
length h; and rounding costs jerk on short pieces (`assur.planner.trajectory.rounding`). Both are looked at afterwards,
and the one motion in two hundred where they take up more than half of the reserve is written anew, all inner velocities
and accelerations chosen by least squares, with several widths of what counts as one switch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.errors import FaultError
from assur.planner.timing.question import JERK_RESERVE, RATE_RESERVE
from assur.planner.trajectory.hermite import rate_hulls
from assur.planner.trajectory.rounding import defect, moved, relaxed, settled

if TYPE_CHECKING:
    from assur.planner.timing.profile import Profile

MERGE = 1e-6
"""s. Switches closer than this share one knot. From 1 µs up, velocities as doubles know a jerk to 0.03 rad/s³; wider
merges cost more: at 10 µs one motion in a thousand would break a limit, at 30 µs one in a hundred."""
WIDTHS = (1e-6, 4e-6, 1.6e-5)
"""s. Merges that are tried where that is not good enough."""
ENOUGH = 0.5
"""Share of the reserves that a spline may take up without being written anew."""
COINCIDENT = 1e-12
"""s. Switches of several joints this close are one: J δ/h is lost in rounding for every h above `MERGE`."""

Knots = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Times (K,), q, q̇, q̈ (K, n)."""


def clusters(profile: Profile, width: float) -> tuple[FloatArray, FloatArray]:
    """Begins and ends of the clusters of switches that share a knot, from 0 to the duration."""
    times = np.sort(profile.time, axis=None).tolist()
    last = profile.duration
    low, high = [0.0], [0.0]
    for t in times:
        if t > last - width:
            break
        if t < low[-1] + width:
            high[-1] = t
        else:
            low.append(t)
            high.append(t)
    low.append(next(t for t in times if t > last - width))
    high.append(last)
    return np.array(low), np.array(high)


def middles(profile: Profile, low: FloatArray, high: FloatArray) -> FloatArray:
    """Where the knots are: in the middle of their clusters, the first and last at the very ends."""
    out = (low + high) / 2
    out[0], out[-1] = 0.0, profile.duration
    return np.asarray(out)


def written(profile: Profile, offset: float) -> Knots:
    """The knots of a profile that begins at `offset` s; see `Profile.knots`."""
    if not profile.duration > 0:
        raise FaultError("a motion of no duration has no knots")
    knots = _write(profile, offset, MERGE)
    excess = _excess(profile, knots)
    if excess <= ENOUGH:
        return knots
    tried = [(excess, knots)]
    for width in WIDTHS:
        knots = _write(profile, offset, width, relax=True)
        tried.append((_excess(profile, knots), knots))
    return min(tried, key=lambda pair: pair[0])[1]


def _excess(profile: Profile, knots: Knots) -> float:
    """How far a spline may be over the limits its phases were made for: the worst joint, in units of the reserves."""
    time, *states = knots
    _, *rates = rate_hulls(time[1:] - time[:-1], *states)
    over = [np.abs(hull).max(0).max(1) / limit - 1 for hull, limit in zip(rates, profile.limits, strict=True)]
    return float(max(over[0].max() / RATE_RESERVE, over[1].max() / JERK_RESERVE))


def _write(profile: Profile, offset: float, width: float, *, relax: bool = False) -> Knots:
    low, high = clusters(profile, width)
    t = middles(profile, low, high)
    time, rest = moved(t, offset)
    h = time[1:] - time[:-1]
    states = list(profile.at(t, profile.active(high, "right"))[:3])
    jerk = (states[2][1:] - states[2][:-1]) / (t[1:] - t[:-1])[:, None]
    spread = high - low > COINCIDENT
    if spread.any():
        _blend(profile, states, t, low, spread)
    # States belong to the rounded times.
    wait = -rest[:, None]
    q, qd, qdd = states[0] + wait * states[1], states[1] + wait * states[2], states[2]
    for k, state in ((0, profile.start), (-1, profile.end)):
        q[k], qd[k], qdd[k] = state
    if relax:
        return time, q, *relaxed(h, q, qd, qdd, jerk)
    left_over = defect(h, q, qd, qdd)
    left_over[spread[1:] | spread[:-1]] = 0.0
    return time, q, *settled(h, qd, qdd, left_over)


def _blend(profile: Profile, states: list[FloatArray], t: FloatArray, low: FloatArray, spread: BoolArray) -> None:
    """Mix, at inner knots whose switches are spread, the polynomials before and after: the longer piece bears more."""
    inner = np.flatnonzero(spread)
    inner = inner[(inner > 0) & (inner < len(t) - 1)]
    before, after = t[inner] - t[inner - 1], t[inner + 1] - t[inner]
    left = (after / (before + after))[:, None]
    for state, before_it in zip(states, profile.at(t[inner], profile.active(low[inner], "left")), strict=False):
        state[inner] = left * before_it + (1 - left) * state[inner]

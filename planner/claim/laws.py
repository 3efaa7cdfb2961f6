"""Laws of motion as accelerations: polynomials on pieces of time, and sines."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.unstated import unstated
from assur.planner.frames import Conveyor, Fixed, Indexer, Keyframes, Law, Linear, Oscillation, Swing, Turntable
from assur.planner.frames.validity import ALWAYS

MOVE = np.array([420.0, -1680.0, 2100.0, -840.0])
"""Coefficients of u², u³, u⁴, u⁵ of the second derivative of a step (F3)."""
Pieces = tuple[FloatArray, FloatArray]
"""When each piece begins (K,), s, and the acceleration of x, y, z and yaw in it (K, 4, powers): coefficients of the
powers of the time since then."""
Waves = list[tuple[float, ...]]
NO_PIECES = c.table("laws", [])


def endless(law: Law) -> bool:
    """Whether a law is stated for all times, without pieces."""
    return law.valid == ALWAYS and isinstance(law, Fixed | Swing | Oscillation)


def law_of(law: Law, begin: float, until: float) -> tuple[list[float], FloatArray, Waves]:
    """Pose and rate at the first time (8), pieces (K, c.LAW) and sines of a law over [begin, until], s, as far as it is
    known. Raises `InputError` for a law that cannot be stated."""
    if endless(law):
        pose = law.pose  # type: ignore[attr-defined]
        return [pose.x, pose.y, pose.z, pose.yaw, 0.0, 0.0, 0.0, 0.0], NO_PIECES, _waves(law)
    begin, until = max(begin, law.valid[0]), min(until, law.valid[1])
    if not begin < until:
        raise unstated("a frame whose motion is not known during the plan")
    starts, powers = _pieces(law, begin, until)
    ends = np.minimum(np.append(starts[1:], until), until)
    kept = starts < ends  # some last no time
    starts, ends, powers = starts[kept], ends[kept], powers[kept]
    first = max(int(np.searchsorted(starts, begin, side="right")) - 1, 0)
    found = np.zeros((len(starts) - first, c.LAW))
    found[:, c.LAW_BEGIN], found[:, c.LAW_END] = starts[first:], ends[first:]
    found[:, c.LAW_POWER :].reshape(-1, 4, c.MOST_POWERS)[:, :, : powers.shape[2]] = powers[first:]
    at = law.motion(starts[first])
    if not np.isfinite(at.p).all():
        raise unstated("a frame whose motion begins within the plan")
    return [*at.p.tolist(), float(at.yaw), *at.v.tolist(), float(at.yaw_d)], found, []


def _waves(law: Law) -> Waves:
    if isinstance(law, Swing):
        return [(3, law.amplitude, 2.0 * math.pi / law.period, law.phase)]
    if isinstance(law, Oscillation):
        rate = 2.0 * math.pi / law.period
        return [(k, law.amplitude * u, rate, law.phase) for k, u in enumerate(law.along.tolist()) if u != 0.0]
    return []


def _pieces(law: Law, begin: float, until: float) -> Pieces:
    """The pieces of a law that reach into [begin, until], and maybe others around them."""
    if isinstance(law, Fixed | Linear):
        return np.array([begin]), np.zeros((1, 4, 0))
    if isinstance(law, Conveyor | Turntable):
        drive = law.drive
        starts, way = np.array([begin, *drive.switches]), _second(drive.coefficients)
        if begin != drive.first and way[0].any():
            raise unstated("a drive that accelerates for ever")  # its first piece is linear in time
        later = int(len(starts) > 1 and begin > starts[1])
        return starts[later:], _along(way[later:], None if isinstance(law, Turntable) else law.pose.yaw)
    if isinstance(law, Indexer):
        begins = law.start + _periods(law.start, law.period, begin, until) * law.period
        parts = 2 if law.dwell_s > 0.0 else 1
        starts, way = np.repeat(begins, parts), np.zeros((parts * len(begins), 6))
        way[::parts, 2:] = law.step * MOVE / np.array([law.move_s ** (k + 4) for k in range(4)])
        starts[1::2] += law.move_s if parts == 2 else 0.0
        return starts, _along(way, None if law.kind == "turn" else law.pose.yaw)
    if isinstance(law, Keyframes):
        count = min(len(law.knots), len(law.coefficients))
        starts, powers = law.knots[:count], _second(law.coefficients[:count]).transpose(0, 2, 1)
        if law.period:
            first = float(law.times[0])
            whole = _periods(first, law.period, begin, until)
            starts = ((first + whole * law.period)[:, None] + starts).ravel()
            powers = np.tile(powers, (len(whole), 1, 1))
        return starts, powers
    raise unstated(f"the motion {type(law).__name__} of a frame")


def _second(rows: FloatArray) -> FloatArray:
    """Coefficients of the second derivative of polynomials, the powers along axis 1."""
    k = np.arange(2.0, rows.shape[1])
    return np.asarray(rows[:, 2:] * (k * (k - 1.0)).reshape(-1, *[1] * (rows.ndim - 2)))


def _along(way: FloatArray, heading: float | None) -> FloatArray:
    """(K, 4, powers) of accelerations `way` (K, powers) along a heading, rad; None: of the yaw."""
    found = np.zeros((len(way), 4, way.shape[1]))
    if heading is None:
        found[:, 3] = way
    else:
        found[:, 0], found[:, 1] = math.cos(heading) * way, math.sin(heading) * way
    return found


def _periods(start: float, period: float, begin: float, until: float) -> FloatArray:
    """Numbers of the periods that reach into [begin, until], and of one before and behind."""
    return np.arange(math.floor((begin - start) / period) - 1, math.ceil((until - start) / period) + 2, dtype=float)

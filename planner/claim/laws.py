"""Laws of motion in a claim: pieces and sines of the planner's table of a law, cut to the time of a plan."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.claim.unstated import unstated
from assur.planner.kernels.columns import laws as own
from assur.planner.laws import ALWAYS, Law

Waves = list[tuple[float, ...]]
NO_PIECES = c.table("laws", [])


def endless(law: Law) -> bool:
    """Whether a law is stated for all times, without pieces."""
    return law.valid == ALWAYS and (law.is_fixed or law.row[own.WAVES] > 0.0)


def law_of(law: Law, begin: float, until: float) -> tuple[list[float], FloatArray, Waves]:
    """Pose and rate at the first time (8), pieces (K, c.LAW) and sines of a law over [begin, until], s, as far as it is
    known. Raises `InputError` for a law that cannot be stated."""
    count = int(law.row[own.COUNT])
    pieces, waves = law.side[:count], [tuple(each) for each in law.side[count:, : c.WAVE].tolist()]
    if endless(law):
        return [*pieces[0, own.POSE : own.RATE].tolist(), 0.0, 0.0, 0.0, 0.0], NO_PIECES, waves
    begin, until = max(begin, law.valid[0]), min(until, law.valid[1])
    if not begin < until:
        raise unstated("a frame whose motion is not known during the plan")
    starts, numbers = _starts(law, pieces, begin, until)
    ends = np.minimum(np.append(starts[1:], until), until)
    kept = starts < ends  # some last no time
    starts, ends, numbers = starts[kept], ends[kept], numbers[kept]
    first = max(int(np.searchsorted(starts, begin, side="right")) - 1, 0)
    found = np.zeros((len(starts) - first, c.LAW))
    found[:, c.LAW_BEGIN], found[:, c.LAW_END] = starts[first:], ends[first:]
    found[:, c.LAW_POWER :] = pieces[numbers[first:], own.POWER :]
    at = replace(law, row=np.where(np.arange(len(law.row)) == own.WAVES, 0.0, law.row)).motion(starts[first])
    if not np.isfinite(at.p).all():
        raise unstated("a frame whose motion begins within the plan")
    return [*at.p.tolist(), float(at.yaw), *at.v.tolist(), float(at.yaw_d)], found, waves


def _starts(law: Law, pieces: FloatArray, begin: float, until: float) -> tuple[FloatArray, IntArray]:
    """When each piece begins, and its number; those of the periods that reach into [begin, until], and of one before
    and behind. A first piece of constant speed begins with the plan."""
    starts, start, period = pieces[:, own.PIECE_BEGIN].copy(), law.row[own.START], law.row[own.PERIOD]
    if not period > 0.0:
        if not pieces[0, own.POWER :].any():
            starts[0] = begin
        return starts, np.arange(len(starts))
    k = np.arange(math.floor((begin - start) / period) - 1, math.ceil((until - start) / period) + 2, dtype=np.float64)
    return np.add.outer(start + k * period, starts).ravel(), np.tile(np.arange(len(starts)), len(k))

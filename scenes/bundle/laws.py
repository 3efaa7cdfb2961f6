"""Motions of frames, by their accelerations: the pieces and the sines of the planner's tables, cut to a plan's time."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.columns import laws as c
from assur.planner.laws import Law
from assur.scenes.bundle.unstated import unstated

Document = dict[str, Any]
SINE = ("coordinate", "amplitude", "rate", "phase")


def law_of(law: Law, begin: float, until: float) -> Document:
    """A law over [begin, until], as far as it is known. Raises `InputError` for a law that cannot be stated."""
    count = int(law.row[c.COUNT])
    pieces, waves = law.side[:count], law.side[count:, : len(SINE)].tolist()
    sines = [dict(zip(SINE, (int(k), *numbers), strict=True)) for k, *numbers in waves]
    if law.valid == (-math.inf, math.inf) and (law.is_fixed or sines):
        pose = pieces[0, c.POSE : c.RATE].tolist()
        return {"pose": pose, "rate": [0.0] * 4, "edges": [], "acceleration": [], "waves": sines}
    begin, until = max(begin, law.valid[0]), min(until, law.valid[1])
    if not begin < until:
        raise unstated("a frame whose motion is not known during the plan")
    powers = pieces[:, c.POWER :].reshape(count, 4, c.MOST_POWERS)
    starts, numbers = _starts(law, pieces, begin, until)
    ends = np.append(starts[1:], until)
    lasting = (starts < until) & (starts < ends)
    starts, numbers = starts[lasting], numbers[lasting]
    first = max(int(np.searchsorted(starts, begin, side="right")) - 1, 0)
    starts, numbers = starts[first:], numbers[first:]
    at = replace(law, row=np.where(np.arange(len(law.row)) == c.WAVES, 0.0, law.row)).motion(starts[0])
    if not np.isfinite(at.p).all():
        raise unstated("a frame whose motion begins within the plan")
    return {
        "pose": [*at.p.tolist(), float(at.yaw)],
        "rate": [*at.v.tolist(), float(at.yaw_d)],
        "edges": [*starts.tolist(), until],
        "acceleration": [[np.trim_zeros(way, "b").tolist() for way in powers[k]] for k in numbers],
        "waves": sines,
    }


def _starts(law: Law, pieces: FloatArray, begin: float, until: float) -> tuple[FloatArray, IntArray]:
    """When each piece begins, and its number; those of the periods that reach into [begin, until], and of one before
    and behind. A first piece of constant speed begins with the plan."""
    own, start, period = pieces[:, c.PIECE_BEGIN].copy(), law.row[c.START], law.row[c.PERIOD]
    if not period > 0.0:
        if not pieces[0, c.POWER :].any():
            own[0] = begin
        return own, np.arange(len(own))
    k = np.arange(math.floor((begin - start) / period) - 1, math.ceil((until - start) / period) + 2, dtype=np.float64)
    return np.add.outer(start + k * period, own).ravel(), np.tile(np.arange(len(own)), len(k))

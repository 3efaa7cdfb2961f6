"""Laws of motion in a claim: pieces, sines and period of the planner's table of a law.

They belong to the cell: no law is cut to the time of a plan, and none to the time for which it is known, which the
statement checker compares with each plan.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.chain import unstated
from assur.planner.kernels.columns import laws as own
from assur.planner.laws import Law

NO_PERIOD = (0.0, 0.0, 0.0, 0.0, 0.0)


class StatedLaw(NamedTuple):
    """A law in a claim: `at` (8), its pose and rate when its first piece begins; `pieces` (K, c.LAW); its sines; its
    period, s, and by how much it has gone on after that (4)."""

    at: list[float]
    pieces: FloatArray
    waves: list[tuple[float, ...]]
    period: tuple[float, ...] = NO_PERIOD


def law_of(law: Law, early: float) -> StatedLaw:
    """A law from `early`, s, on at the latest, until the last time that a claim may have.

    Pieces that end before `early` are left out: what they round would add up. A first piece of constant speed begins at
    `early`, when the law is stated, or when the second one begins, whichever is first. What repeats begins where its
    law does, or the whole periods before that are needed.

    Raises `InputError` for a law that begins too early or too late for any claim.
    """
    count, period = int(law.row[own.COUNT]), float(law.row[own.PERIOD])
    pieces, waves = law.side[:count], [tuple(each) for each in law.side[count:, : c.WAVE].tolist()]
    # the first one that ends later; all of them if none does
    left_out = 0 if period > 0.0 else int(np.argmax(pieces[:, own.PIECE_END] > early))
    pieces = pieces[left_out:]
    pose, rate, powers = pieces[0, own.POSE : own.RATE], pieces[0, own.RATE : own.CORNER], pieces[:, own.POWER :]
    if law.is_fixed or waves:
        return StatedLaw([*pose.tolist(), 0.0, 0.0, 0.0, 0.0], c.table("laws", []), waves)
    starts, ends = pieces[:, own.PIECE_BEGIN].copy(), pieces[:, own.PIECE_END].copy()
    repeated = NO_PERIOD
    if period > 0.0:
        step, start = law.row[own.STEP : own.STEP + 4], float(law.row[own.START])
        whole = -math.ceil(max(start - early, 0.0) / period) + math.ceil(max(-c.LATEST_S - start, 0.0) / period)
        starts, pose = starts + (start + whole * period), pose + whole * step
        ends = np.append(starts[1:], starts[0] + period)
        repeated = (period, *step.tolist())
    elif left_out == 0 and not powers[0].any():
        begin = max(min(early, law.stated_s, starts[0]), -c.LATEST_S)
        pose, starts[0] = pose - (starts[0] - begin) * rate, begin
    ends = np.minimum(ends, c.LATEST_S)
    kept = starts < ends  # some last no time
    if not (kept.any() and starts[0] >= -c.LATEST_S):
        raise unstated(f"a frame whose motion begins before {-c.LATEST_S:g} s or after {c.LATEST_S:g} s")
    found = np.zeros((int(kept.sum()), c.LAW))
    found[:, c.LAW_BEGIN], found[:, c.LAW_END], found[:, c.LAW_POWER :] = starts[kept], ends[kept], powers[kept]
    return StatedLaw([*pose.tolist(), *rate.tolist()], found, waves, repeated)

"""How deep a pair that may touch is pressed together: where a straight part begins or ends, which no screening sees."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.collision.proof import Prover, Search
from assur.planner.collision.rows import Unproved
from assur.planner.kernels.intervals import DONE, HIT, RESERVE_M, RESISTED
from assur.planner.kernels.screening import HIT_A, HIT_B, HIT_GAP, HIT_NEED, HIT_S
from assur.planner.kernels.solids import FIRST, REQUIRED, SECOND
from assur.planner.kernels.walk import SCREEN
from assur.planner.model.phases import Phase
from assur.planner.trajectory import Trajectory


def deepest(prover: Prover, phase: Phase, trajectory: Trajectory, unproved: Unproved) -> Unproved:
    """A pair that may touch and was not proved in a phase, where it is deepest: there, or at an end of the phase."""
    arrangement, spline = prover.of(phase), prover.spline(trajectory)
    pairs = prover.pairs(arrangement, phase)
    body = arrangement.body[pairs.rows[:, [FIRST, SECOND]].astype(np.int64)]
    ours = [arrangement.number[name] for name in unproved.bodies]
    touching = pairs.rows[(body == ours).all(1) & (pairs.rows[:, REQUIRED] < 0.0)]
    for t in (phase.t0, phase.t1) if len(touching) else ():
        search = Search(prover, replace(phase, t0=t, t1=t), spline, touching, pairs.doubt, most_hits=len(touching))
        while search.go_on(SCREEN) not in (DONE, HIT, RESISTED) and not search.over:
            pass
        for hit in search.too_near:
            gap, need = float(hit[HIT_GAP]), float(hit[HIT_NEED]) - RESERVE_M
            if not gap - need >= unproved.gap - unproved.required:
                touch = prover.touch(arrangement, spline, t, int(hit[HIT_A]), int(hit[HIT_B]), float(hit[HIT_S]))
                unproved = replace(unproved, time=t, gap=gap, required=need, touching=touch)
    return unproved

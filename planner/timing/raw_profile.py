"""A timed motion as the solver gave it, phases of constant jerk a joint; and the trajectory that is made of several."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.kernels.knots import knots_of_phases
from assur.planner.timing.inputs import Numbers
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, slots=True, eq=False)
class RawProfile:
    """Motion of n joints over [0, `duration`] s from the state `begin` to `goal`, which the phases all but meet.

    `phases` (n, 2, S): durations in s and jerks of each joint, from 0 on. A joint whose phases end before the duration
    goes on with constant acceleration.
    """

    duration: float
    begin: Numbers
    goal: Numbers
    phases: FloatArray


def trajectory_of(profiles: Sequence[RawProfile], begins: Sequence[float]) -> Trajectory:
    """The trajectory of profiles in a row (equations T4 and T5), which repeats the states between them to the bit.

    `begins`: when each of them begins, and when the last one ends, s, increasing. Whether it keeps any limits is for
    the caller to check: merged switches and exact ends cost one in a thousand motions more than the reserves.

    Raises `FaultError` for times that do not increase.
    """
    if not all(a < b for a, b in pairwise(begins)):
        raise FaultError(f"profiles that begin at {list(begins)} s")
    if len(profiles) == 1:
        phases = profiles[0].phases[None]
    else:
        n, most = len(profiles[0].phases), max(profile.phases.shape[2] for profile in profiles)
        phases = np.zeros((len(profiles), n, 2, most))
        for row, profile in zip(phases, profiles, strict=True):
            row[:, :, : profile.phases.shape[2]] = profile.phases
    states = np.array([profiles[0].begin, *(profile.goal for profile in profiles)])
    return Trajectory.of_knots(knots_of_phases(np.array(begins, dtype=np.float64), states, phases))

"""Two knots at one time: a jump in acceleration, and nothing else.

A motion without a limit of the jerk may jump from one acceleration to another. At such a time there is one knot for
what ends and one for what begins; q and q̇ are the same in both, to the bit, so the motion and its speed are continuous.
Evaluation is continuous from the right. The jerk has no bound there.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError


def doubled(time: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> None:
    """Accept knots of which two at one time are a jump. Raises `InputError` naming field and knot otherwise."""
    step = time[1:] - time[:-1]
    if not (step >= 0).all():
        raise InputError("trajectory.time", int(np.argmin(step >= 0)) + 1, "times that do not decrease")
    if not time[-1] > time[0]:
        raise InputError("trajectory.time", float(time[0]), "knots at two times at least")
    second = np.flatnonzero(step == 0) + 1
    crowded = np.flatnonzero(np.diff(second) == 1)
    if len(crowded):
        raise InputError("trajectory.time", int(second[crowded[0] + 1]), "two knots at one time, not three")
    for k in second:
        for name, states in (("q", q), ("qd", qd)):
            if not (states[k] == states[k - 1]).all():
                allowed = "the same in both knots at one time: only the acceleration may jump"
                raise InputError(f"trajectory.{name}", int(k), allowed)
        if not (qdd[k] != qdd[k - 1]).any():
            raise InputError("trajectory.qdd", int(k), "a jump where two knots share a time; one knot will do")

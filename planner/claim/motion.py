"""The motion of an arm as knots."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.unstated import unstated
from assur.planner.trajectory import Trajectory


def knots_of(path: Trajectory, begin: float, until: float) -> FloatArray:
    """Knots (K, c.KNOT) of an arm that follows a trajectory and stands before and after it, from `begin` to `until`, s.

    Raises `InputError` for a trajectory that does not rest at an end beyond which it is required.
    """
    before, after, count, n = int(begin < path.time[0]), int(until > path.time[-1]), len(path.time), path.n
    found = np.zeros((count + before + after, c.KNOT))
    own = found[before : before + count]
    own[:, c.KNOT_TIME] = path.time
    for first, states in ((c.KNOT_Q, path.q), (c.KNOT_QD, path.qd), (c.KNOT_QDD, path.qdd)):
        own[:, first : first + n] = states
    for needed, end, t in ((before, 0, begin), (after, -1, until)):
        if needed:
            if path.qd[end].any() or path.qdd[end].any():
                when = "begins, and is needed before" if end == 0 else "ends, and is needed after"
                raise unstated(f"a motion that is not at rest when it {when}")
            found[end, c.KNOT_TIME], found[end, c.KNOT_Q : c.KNOT_Q + n] = t, path.q[end]
    return found

"""A motion on another grid, measured: by how much it deviates, and how much of each limit it uses."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.resampling.keeping import positions


def deviation(one: Trajectory, other: Trajectory) -> FloatArray:
    """The largest distance of each joint of two motions while both last, (n,) rad or m; a bound, from above.

    Between two times at which either has a knot the difference is a quintic, which its control values bound.
    """
    begin, end = max(one.start, other.start), min(one.end, other.end)
    times = np.unique(np.concatenate([one.time, other.time]))
    times = np.concatenate([[begin], times[(times > begin) & (times < end)], [end]])
    states = [np.stack(each.states(times)) for each in (one, other)]
    off = states[0] - states[1]
    worst = np.abs(off[0]).max(0)
    for k, h in enumerate(np.diff(times)):
        ends = np.concatenate([off[:, k], off[:, k + 1]])
        worst = np.maximum(worst, np.abs(positions(float(h)) @ ends).max(0))
    return np.asarray(worst)


def ratios(scene: Scene, phases: tuple[Phase, ...], trajectory: Trajectory) -> FloatArray:
    """The greatest share that each joint uses of its limits of velocity, acceleration and jerk, (3, n), with the load
    that is carried then; of pieces across the begin or the end of a load the smaller limit counts."""
    found = np.zeros((3, trajectory.n))
    columns = (trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd)
    for phase in phases:
        first = max(int(np.searchsorted(trajectory.time, phase.t0, side="right")) - 1, 0)
        last = min(int(np.searchsorted(trajectory.time, phase.t1)), len(trajectory.time) - 1)
        if not trajectory.time[last] > trajectory.time[first]:
            continue
        part = Trajectory(*(column[first : last + 1] for column in columns), jumps=trajectory.jumps)
        limits = phase.attached.limits(scene)
        for kind, limit in enumerate((limits.velocity, limits.acceleration, limits.jerk)):
            low, high = part.extrema(kind + 1)
            found[kind] = np.maximum(found[kind], np.maximum(high, -low) / limit)
    return found

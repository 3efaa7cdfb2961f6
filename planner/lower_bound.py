"""A duration that no plan of any budget beats: the joints' velocity and acceleration limits alone."""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray
from planner.legs.control_point import control_point
from planner.legs.meeting import meetings
from planner.phases import Carried, held, initial_rides, yaw_offsets
from planner.scene import Pick, Place, Scene
from planner.timing import least_duration


def lower_bound(scene: Scene) -> float:
    """Seconds from the start to the end of the task: the way to the first control point, then all dwells.

    The first way is bounded over every mode, turn and meeting time on the grid of `planner.legs.meeting`, from which one
    grid step is taken off; later ways between points that stand still are bounded by velocity alone.
    """
    limits, start = scene.robot.limits, scene.start
    rides, carried = initial_rides(scene), None
    total, before = 0.0, None
    for number, step in enumerate(scene.task):
        offsets = yaw_offsets(scene, step)
        here = []
        least = np.inf
        for offset in (offsets if offsets is not None else ()):
            point = control_point(scene, number, rides, carried, offset)
            found = meetings(scene, point, start.time, 0.0, tuple(range(len(scene.robot.modes))))
            for branch in found.branches:
                rows = np.flatnonzero(branch.legal)
                if number == 0:
                    ends = branch.q[rows], branch.qd[rows], branch.qdd[rows]
                    duration = least_duration(
                        start.q, start.qd, start.qdd, *ends, limits.velocity, limits.acceleration, limits.jerk
                    )
                    duration = np.atleast_1d(duration)
                    if point.via:
                        duration = np.max(np.abs(branch.q[rows] - start.q) / limits.velocity, axis=-1)
                    if not branch.still:
                        duration = np.maximum(duration, branch.time[rows] - start.time)
                        # a meeting is possible only where the bound fits before it
                        fits = branch.time[rows] - start.time >= duration - 1e-12
                        duration = duration[fits] - _step(branch.time) if fits.any() else np.array([np.inf])
                    least = min(least, float(duration.min()))
                if branch.still:
                    here.append(branch.q[rows[0]])
            dwell = point.dwell
        if number == 0:
            total += max(0.0, least) if np.isfinite(least) else 0.0
        elif before and here:
            total += min(float(np.max(np.abs(a - b) / limits.velocity)) for a in before for b in here)
        before = here
        total += dwell if offsets is not None else 0.0
        carried, rides = _next(scene, number, carried, rides, (offsets or (0.0,))[0])
    return total


def _step(t: FloatArray) -> float:
    return float(np.diff(t).max()) if len(t) > 1 else 0.0


def _next(
    scene: Scene,
    number: int,
    carried: Carried | None,
    rides: dict[str, tuple[str, object]],
    offset: float,
) -> tuple[Carried | None, dict[str, tuple[str, object]]]:
    step = scene.task[number]
    if isinstance(step, Pick):
        return held(scene, step, offset), rides
    if isinstance(step, Place):
        return None, {**rides, step.part: (step.to.frame, step.to.pose)}
    return carried, rides

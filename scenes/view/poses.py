"""Poses of links and frames over time, as few samples: interpolation between them is at most 0.1 mm wrong.

Between two samples the position follows a straight line and the attitude the shorter arc, both evenly. Therefore a
viewer needs neither kinematics nor time laws.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.view.quaternions import angles_between, interpolated, of_matrices, of_yaws
from assur.scenes.view.thinning import needed, shares

WITHIN_M = 1e-4
"""Largest error of a drawn point, m."""
SAMPLED_M = 8e-5
"""Largest error at the sampled instants, m. The rest is for the time between them: with 1 ms and 100 m/s² the error
there is at most a h²/8 = 0.0125 mm."""
STEP_S = 0.001
"""Time between sampled instants, s."""
MOST_INSTANTS = 60_000
"""Largest number of even instants: for a long motion the step is longer."""
PARTS = 4
"""Errors are measured at this many instants per step of the samples."""


@dataclass(frozen=True, eq=False)
class Track:
    """Pose of a link or a frame: `position` (K, 3), m, and `rotation` (K, 4) at times (K,), s, in the world. It is
    constant before the first time and after the last. `reach`: largest distance of a point on it from its origin, m."""

    name: str
    time: FloatArray
    position: FloatArray
    rotation: FloatArray
    reach: float

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Positions (T, 3), m, and rotations (T, 4) at times (T,), s, by the interpolation of a viewer."""
        if len(self.time) == 1:
            return np.repeat(self.position, len(t), 0), np.repeat(self.rotation, len(t), 0)
        k = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.time) - 2)
        share = np.clip((t - self.time[k]) / (self.time[k + 1] - self.time[k]), 0.0, 1.0)
        position = self.position[k] + share[:, None] * (self.position[k + 1] - self.position[k])
        return position, interpolated(self.rotation[k], self.rotation[k + 1], share)

    def in_single_precision(self, start: float) -> Track:
        """The track as numbers of 32 bits hold it, with times since `start`, s. Neighbouring quaternions have the same
        sign, so that a linear interpolation of their numbers takes the shorter arc."""
        sign = np.ones(len(self.time))
        sign[1:] = np.cumprod(np.where(np.sum(self.rotation[1:] * self.rotation[:-1], -1) < 0.0, -1.0, 1.0))
        arrays = self.time - start, self.position, self.rotation * sign[:, None]
        time, position, rotation = (each.astype(np.float32).astype(np.float64) for each in arrays)
        return replace(self, time=time, position=position, rotation=rotation)


def instants(trajectory: Trajectory, start: float, end: float, step_s: float = STEP_S) -> FloatArray:
    """The times (T,), s, at which poses are sampled: even ones and all knots between start and end.

    Counted from `start` they are numbers of 32 bits, because viewers have no others. So a pose is sampled exactly when
    it is drawn.
    """
    step = max(step_s, (end - start) / MOST_INSTANTS)
    even = np.linspace(start, end, max(2, math.ceil((end - start) / step) + 1))
    knots = trajectory.edges
    t = np.concatenate([even, knots[(knots > start) & (knots < end)]])
    return np.asarray(start + np.unique((t - start).astype(np.float32)).astype(np.float64))


def joints_at(trajectory: Trajectory, t: FloatArray) -> FloatArray:
    """Joints (T, n) at times (T,), s: the arm is at rest before the trajectory and after it."""
    return trajectory.evaluate(np.clip(t, trajectory.start, trajectory.end))


def carrier_poses(scene: Scene, trajectory: Trajectory, t: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """Positions (T, 3), m, and rotations (T, 4) of all links, then of all frames, in the world at times (T,), s.
    Where the law of a frame is not known, its pose is that of the nearest time at which it is."""
    position, rotation = scene.robot.placements(joints_at(trajectory, t))
    turns = of_matrices(rotation)
    poses = [(position[:, k], turns[:, k]) for k in range(len(scene.robot.links))]
    for frame in scene.frames.values():
        motion = frame.law.motion(np.clip(t, *frame.law.valid))
        poses.append((motion.p, of_yaws(motion.yaw)))
    return poses


def thinned(name: str, t: FloatArray, position: FloatArray, rotation: FloatArray, reach: float) -> Track:
    """The track of a carrier with poses (T, 3), (T, 4) at times (T,), for points up to `reach` m from its origin."""

    def error(i: int, k: int) -> FloatArray:
        share = shares(t, i, k)
        line = position[i] + share[:, None] * (position[k] - position[i])
        turns = interpolated(rotation[i], rotation[k], share)
        moved: FloatArray = np.linalg.norm(position[i : k + 1] - line, axis=-1)
        return np.asarray((moved + reach * angles_between(rotation[i : k + 1], turns)) / SAMPLED_M)

    kept = needed(len(t), error)
    if len(kept) == 2 and (position[0] == position[-1]).all() and (rotation[0] == rotation[-1]).all():
        kept = kept[:1]  # it is at rest
    return Track(name, t[kept], position[kept], rotation[kept], reach)


def drawing_errors(
    scene: Scene, trajectory: Trajectory, drawn: tuple[Track, ...], start: float, end: float, step_s: float = STEP_S
) -> FloatArray:
    """Largest error of a point on each carrier, (C,) m, if all carriers are drawn as `drawn`, whose times are counted
    from `start`, s. `step_s`: the step of their samples; errors are measured between samples, too.

    A pose that is wrong by d and by an angle a moves a point at a distance r from its origin by at most d + r a.
    """
    sampled = instants(trajectory, start, end, step_s)
    inner = sampled[:-1, None] + np.diff(sampled)[:, None] * np.arange(PARTS) / PARTS
    t = np.append(inner.ravel(), sampled[-1])
    errors = np.zeros(len(drawn))
    for k, (track, (position, rotation)) in enumerate(zip(drawn, carrier_poses(scene, trajectory, t), strict=True)):
        at, turn = track.at(t - start)
        moved = np.linalg.norm(at - position, axis=-1)
        errors[k] = float((moved + track.reach * angles_between(turn, rotation)).max())
    return errors

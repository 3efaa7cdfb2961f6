"""Poses of links and frames over time, by so few samples that what is interpolated between them is 0.1 mm off at most.

Between two samples a position goes along a straight line and an attitude along the shorter arc, both evenly. So who
draws a motion needs no kinematics and no time laws.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.scene import Scene
from assur.planner.tracks.thinning import kept, shares
from assur.planner.tracks.turns import apart, between, of_matrices, of_yaws
from assur.planner.trajectory import Trajectory

WITHIN_M = 1e-4
"""How far a point that is drawn may be from where it is, m."""
SAMPLED_M = 8e-5
"""How far it may be at the instants that are looked at; the rest is for what is between them: with 1 ms and 100 m/s² it
is a h²/8 = 0.0125 mm."""
STEP_S = 0.001
"""Time between the instants that are looked at, s; of a long motion they are ..."""
MOST_INSTANTS = 60_000
"""... so many at most."""


@dataclass(frozen=True, eq=False)
class Track:
    """Where a link or a frame is: `position` (K, 3) m and `rotation` (K, 4), quaternions x, y, z, w, at times (K,) s,
    in the world. Before the first time and after the last it is as it is then. `reach`: the points that go with it are
    up to so far from its origin, m."""

    name: str
    time: FloatArray
    position: FloatArray
    rotation: FloatArray
    reach: float

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Positions (T, 3) m and rotations (T, 4) at times (T,) s: what whoever draws it computes."""
        if len(self.time) == 1:
            return np.repeat(self.position, len(t), 0), np.repeat(self.rotation, len(t), 0)
        k = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.time) - 2)
        share = np.clip((t - self.time[k]) / (self.time[k + 1] - self.time[k]), 0.0, 1.0)
        position = self.position[k] + share[:, None] * (self.position[k + 1] - self.position[k])
        return position, between(self.rotation[k], self.rotation[k + 1], share)


def instants(trajectory: Trajectory, start: float, end: float, step_s: float = STEP_S) -> FloatArray:
    """The times (T,), s, at which poses are looked at: even ones, and all knots within.

    Counted from `start` they are numbers of 32 bits, for whoever draws has no others: so a pose is looked at when it is
    drawn, and not half of a millionth of a second beside it.
    """
    step = max(step_s, (end - start) / MOST_INSTANTS)
    even = np.linspace(start, end, max(2, math.ceil((end - start) / step) + 1))
    knots = trajectory.edges
    t = np.concatenate([even, knots[(knots > start) & (knots < end)]])
    return np.asarray(start + np.unique((t - start).astype(np.float32)).astype(np.float64))


def joints_at(trajectory: Trajectory, t: FloatArray) -> FloatArray:
    """Joints (T, n) at times (T,): before the trajectory and after it the arm stands still."""
    return trajectory.evaluate(np.clip(t, trajectory.start, trajectory.end))


def link_poses(scene: Scene, trajectory: Trajectory, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions (T, L, 3) and rotations (T, L, 4) of the links at times (T,), in the world."""
    position, rotation = scene.robot.placements(joints_at(trajectory, t))
    return position, of_matrices(rotation)


def frame_poses(scene: Scene, name: str, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions (T, 3) and rotations (T, 4) of a frame; where its law is not known: as at the nearest time at which it
    is."""
    first, last = scene.frames[name].law.valid
    motion = scene.frames[name].law.motion(np.clip(t, first, last))
    return motion.p, of_yaws(motion.yaw)


def thinned(name: str, t: FloatArray, position: FloatArray, rotation: FloatArray, reach: float) -> Track:
    """The track of a carrier whose poses (T, 3), (T, 4) at times (T,) are known, for points up to `reach` m from its
    origin."""

    def off(i: int, k: int) -> FloatArray:
        share = shares(t, i, k)
        line = position[i] + share[:, None] * (position[k] - position[i])
        arc = between(rotation[i], rotation[k], share)
        moved: FloatArray = np.linalg.norm(position[i : k + 1] - line, axis=-1)
        return np.asarray((moved + reach * apart(rotation[i : k + 1], arc)) / SAMPLED_M)

    at = kept(len(t), off)
    if len(at) == 2 and (position[0] == position[-1]).all() and (rotation[0] == rotation[-1]).all():
        at = at[:1]  # it stands still
    return Track(name, t[at], position[at], rotation[at], reach)

"""By how much the poses that are drawn are off, between the instants that were looked at, too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.scene import Scene
from assur.planner.tracks.poses import STEP_S, Track, frame_poses, instants, link_poses
from assur.planner.tracks.tracks import Tracks
from assur.planner.tracks.turns import apart
from assur.planner.trajectory import Trajectory

PARTS = 4
"""Each step between two instants that were looked at is looked at in so many parts."""


def in_single(track: Track, start: float) -> Track:
    """A track as numbers of 32 bits hold it, its times counted from `start`, s; neighbouring quaternions are on the
    same side, so that straight lines between their numbers go the shorter way, too."""
    sign = np.ones(len(track.time))
    sign[1:] = np.cumprod(np.where(np.sum(track.rotation[1:] * track.rotation[:-1], -1) < 0.0, -1.0, 1.0))
    arrays = track.time - start, track.position, track.rotation * sign[:, None]
    time, position, rotation = (each.astype(np.float32).astype(np.float64) for each in arrays)
    return replace(track, time=time, position=position, rotation=rotation)


def farthest_off(
    scene: Scene, trajectory: Trajectory, shown: Tracks, drawn: tuple[Track, ...], step_s: float = STEP_S
) -> FloatArray:
    """By how much a point that goes with a carrier is at most beside where it is, (C,) m, if the carriers are drawn as
    `drawn`, whose times are counted from the start of `shown`. `step_s`: that with which `shown` was made.

    A pose that is off by d and by an angle a moves a point at a distance r from its origin by d + r a at most.
    """
    looked = instants(trajectory, shown.start, shown.end, step_s)
    inner = looked[:-1, None] + np.diff(looked)[:, None] * np.arange(PARTS) / PARTS
    t = np.append(inner.ravel(), looked[-1])
    position, rotation = link_poses(scene, trajectory, t)
    links, found = len(scene.robot.links), np.zeros(len(drawn))
    for k, track in enumerate(drawn):
        true = (position[:, k], rotation[:, k]) if k < links else frame_poses(scene, track.name, t)
        at, turn = track.at(t - shown.start)
        found[k] = float((np.linalg.norm(at - true[0], axis=-1) + track.reach * apart(turn, true[1])).max())
    return found

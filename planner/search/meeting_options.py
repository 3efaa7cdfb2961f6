"""The ways in which a control point can be met, those with the least possible duration first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.legs.branch import Branch
from assur.planner.legs.control_point import control_point
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.tilt import tilts
from assur.planner.model.scene import Scene
from assur.planner.search.partial_plan import Chain
from assur.planner.search.tuning import EVALUATED_MEETINGS
from assur.planner.timing import least_duration


@dataclass(frozen=True, eq=False)
class Option:
    """A branch of a control point, with the turn of a symmetric part it belongs to and a lower bound of its duration
    (`least`, less `grain`: how far before it the last meeting time that was looked at lies)."""

    meeting: Meetings
    yaw_offset: float
    branch: Branch
    least: float
    grain: float


def options(scene: Scene, chain: Chain, found: list[tuple[float, Meetings]], most: int) -> tuple[Option, ...]:
    """Branches of all turns of the part, those with the least possible duration first."""
    ways = [(yaw_offset, meeting, branch) for yaw_offset, meeting in found for branch in meeting.branches]
    if not ways:
        return ()
    looked_at = [branch.rows[:: 1 + len(branch.time) // EVALUATED_MEETINGS] for _, _, branch in ways]
    durations = _least(scene, chain, [branch for _, _, branch in ways], looked_at)
    result = []
    for (yaw_offset, meeting, branch), rows, least in zip(ways, looked_at, durations, strict=True):
        first, grain = float(least.min()), 0.0
        if not branch.still:
            # the earliest time looked at that the lower bound allows; any before it come after the one before
            time = branch.time[rows]
            ready = np.flatnonzero(time >= chain.state.time + least)
            first = float(time[ready[0]]) - chain.state.time if len(ready) else np.inf
            step = float(np.diff(branch.time).max(initial=0.0))
            before = float(time[ready[0] - 1]) if len(ready) and ready[0] > 0 else first + chain.state.time - step
            grain = first + chain.state.time - before if len(ready) else 0.0
        result.append(Option(meeting, yaw_offset, branch, first, grain))
    result.sort(key=lambda option: option.least)
    return tuple(result[:most])


def _least(scene: Scene, chain: Chain, branches: list[Branch], rows: list[IntArray]) -> list[FloatArray]:
    """Lower bounds of the durations to some rows of each branch, s: all in one batch."""
    limits, state = scene.robot.limits, chain.state
    q, qd, qdd = (
        np.concatenate([getattr(branch, name)[at] for branch, at in zip(branches, rows, strict=True)])
        for name in ("q", "qd", "qdd")
    )
    jerk = None if scene.options.blended else limits.jerk
    least = least_duration(state.q, state.qd, state.qdd, q, qd, qdd, limits.velocity, limits.acceleration, jerk)
    return np.split(least, np.cumsum([len(at) for at in rows[:-1]]))


def ahead(scene: Scene, chain: Chain, q: FloatArray) -> FloatArray | None:
    """Joints (n,) near those of the control point behind the next one, for a via that is flown by; None: no such."""
    step = scene.task[chain.step]
    if not step.via or chain.step + 1 >= len(scene.task):
        return None
    tilt = tilts(scene, scene.task[chain.step + 1], q)[0]
    behind = control_point(scene, chain.step + 1, chain.attached, 0.0, tilt)
    motion = behind.flange(np.array([chain.state.time]), behind.approach)
    found = scene.robot.inverse(motion, chain.mode, 0)
    if not np.isfinite(found.q).all():
        return None
    turns = np.round((q - found.q[0]) / (2 * np.pi))
    revolute = np.array([joint.kind == "revolute" for joint in scene.robot.joints])
    result: FloatArray = np.where(revolute, found.q[0] + 2 * np.pi * turns, found.q[0])
    return result

"""Who rides on what in each phase, where everything is at given times, and how fast its points can move.

A *carrier* is a link of the robot (0..L-1) or a frame of the cell (L..L+F-1); a *seat* is a body at a pose in its
carrier. Most bodies keep one seat for the whole plan; a part that is picked changes it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.ranges import Ranges
from assur.planner.checker.solids import Seated, Solids, turns
from assur.planner.frames.motion import Pose
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.robots.protocol import Sweep


@dataclass(frozen=True, eq=False)
class Stage:
    """`seat` (P, B): the seat of each body in each phase; per seat (S,) its `body`, `carrier`, `offset` (S, 4) as
    x, y, z, yaw; `seated`: the solids of all seats, the pieces of each from `seated.start[seat]` on, its box behind
    the last of them."""

    scene: Scene
    solids: Solids
    seat: IntArray
    body: IntArray
    carrier: IntArray
    offset: FloatArray
    seated: Seated

    @property
    def links(self) -> int:
        return len(self.scene.robot.links)

    @property
    def of_robot(self) -> BoolArray:
        """(P, B): whether a body is the robot's, its tool's, or in its gripper."""
        return np.asarray(self.carrier[self.seat] < self.links)

    def where(self, q: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Positions (T, C, 3) and rotations (T, C, 3, 3) of all carriers at times t (T,) with joints q (T, n)."""
        links, frames = self.links, self.scene.frames
        position, yaw = np.empty((len(t), links + len(frames), 3)), np.empty((len(t), len(frames)))
        rotation = np.empty((len(t), links + len(frames), 3, 3))
        position[:, :links], rotation[:, :links] = self.scene.robot.placements(q)
        for k, frame in enumerate(frames.values()):
            position[:, links + k], yaw[:, k] = frame.law.pose_at(t)
        rotation[:, links:] = turns(yaw)
        return position, rotation

    def place(self, seat: IntArray, piece: IntArray) -> IntArray:
        """Where in `seated` the pieces (N,) of bodies in seats (N,) are, −1 being the box."""
        return np.asarray(self.seated.start[seat] + np.where(piece < 0, self.solids.count[self.body[seat]], piece))

    def support(
        self, seat: IntArray, piece: IntArray, n: FloatArray, position: FloatArray, rotation: FloatArray
    ) -> FloatArray:
        """max of n·x in the world over pieces (N,) in seats (N,); `position`, `rotation` (N, ...): their carriers."""
        place = self.place(seat, piece)
        local = (n[:, None, :] @ rotation)[:, 0]
        own = (local[:, None, :] @ self.seated.axes[place])[:, 0]
        inside = self.solids.about(self.seated.solid[place], own)
        return np.asarray((n * position).sum(1) + (local * self.seated.centre[place]).sum(1) + inside)

    def bounds(
        self, seat: IntArray, piece: IntArray, n: FloatArray, t0: FloatArray, t1: FloatArray, sweep: Sweep
    ) -> tuple[FloatArray, FloatArray]:
        """Bounds (N,) of |n·ẋ| and |n·ẍ| over [t0, t1] (N,) for the points of pieces; `sweep` is of those intervals."""
        carrier = self.carrier[seat]
        at = self.place(seat, piece)
        reach = self.seated.reach[at]
        speed, acceleration = np.full(len(seat), np.inf), np.full(len(seat), np.inf)
        rows = np.flatnonzero(carrier < self.links)
        if len(rows):
            part = Sweep(sweep.lower[rows], sweep.upper[rows], sweep.rate[rows], sweep.rate_d[rows])
            speed[rows], acceleration[rows] = self.scene.robot.point_bounds(
                carrier[rows], reach[rows], self.seated.distance[at[rows]], n[rows], part
            )
        for k, frame in enumerate(self.scene.frames.values(), start=self.links):
            rows = np.flatnonzero(carrier == k)
            if len(rows):
                law = frame.law.bounds(t0[rows], t1[rows], n[rows])
                arm = reach[rows] * np.hypot(n[rows, 0], n[rows, 1])
                speed[rows] = law.speed + arm * law.yaw_rate
                acceleration[rows] = law.acceleration + arm * np.hypot(law.yaw_acceleration, law.yaw_rate**2)
        return speed, acceleration

    def bounds_over(
        self, seat: IntArray, piece: IntArray, n: FloatArray, t0: FloatArray, t1: FloatArray, ranges: Ranges
    ) -> tuple[FloatArray, FloatArray]:
        """`bounds` with the sweep of the joints made here."""
        return self.bounds(seat, piece, n, t0, t1, ranges.sweep(t0, t1))


def stage(scene: Scene, table: Solids, phases: tuple[Phase, ...]) -> Stage:
    """The seats of all bodies in all phases."""
    flange, links = scene.robot.links.index("flange"), len(scene.robot.links)
    frames = {name: links + k for k, name in enumerate(scene.frames)}
    fixed = [(item.body.name, item.link, Pose()) for item in scene.robot.bodies]
    fixed += [(body.name, flange, Pose()) for body in scene.tool.bodies]
    fixed += [(item.name, frames[item.frame], item.pose) for item in scene.bodies]
    found: dict[tuple[int, int, Pose], int] = {}
    seat = np.zeros((len(phases), len(fixed)), dtype=np.int64)
    for i, phase in enumerate(phases):
        moved = {name: (frames[frame], pose) for name, frame, pose in phase.rides}
        if phase.carried is not None:
            moved[phase.carried.part] = (flange, phase.carried.in_flange)
        for b, (name, carrier, pose) in enumerate(fixed):
            carrier, pose = moved.get(name, (carrier, pose))
            seat[i, b] = found.setdefault((b, carrier, pose), len(found))
    offset = np.array([(pose.x, pose.y, pose.z, pose.yaw) for _, _, pose in found]).reshape(-1, 4)
    body = np.array([b for b, _, _ in found], dtype=np.int64)
    carriers = np.array([carrier for _, carrier, _ in found], dtype=np.int64)
    return Stage(scene, table, seat, body, carriers, offset, table.reach(body, offset))

"""The bodies of a cell as flat arrays: one *unit* per convex piece, and one per bounding box of a body of several.

A unit rides on a *carrier*: a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which part rides where, and
hence the units, depends on the phase; a `Solids` is one such arrangement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.frames.motion import Pose
from assur.planner.geometry.extents import extents_of
from assur.planner.geometry.shapes import Hull, Primitive
from assur.planner.geometry.units import COVER, Units, units
from assur.planner.model.phases import Carried, Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

__all__ = ["COVER", "Carriers", "Solids", "SolidsMaker", "asked_pairs", "carriers", "exempted", "standing"]


@dataclass(frozen=True, eq=False)
class Solids:
    """Units of one arrangement; `lifted` marks the robot's. All arrays (U, ...), metres, in the carrier's frame."""

    names: tuple[str, ...]
    links: int
    body: IntArray
    piece: IntArray
    carrier: IntArray
    centre: FloatArray
    rotation: FloatArray
    half: FloatArray
    disc: FloatArray
    ball: FloatArray
    hull: IntArray
    hulls: tuple[Hull, ...]
    reach: FloatArray
    distance: FloatArray
    roots: tuple[int, ...]
    """For each body the unit that stands for all of it."""
    pieces: tuple[tuple[int, ...], ...]
    """For each body the units of its convex pieces."""
    shapes: tuple[Primitive | Hull, ...]
    robot_bodies: int
    """Bodies 0..robot_bodies-1 are the robot's, its tool's and the carried part."""

    @property
    def of_robot(self) -> BoolArray:
        return self.carrier < self.links


class SolidsMaker:
    """Makes the `Solids` of a scene, one per arrangement, and keeps them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        robot, links = scene.robot, len(scene.robot.links)
        self._flange = robot.links.index("flange")
        self._frames = {name: links + k for k, name in enumerate(scene.frames)}
        self._made: dict[tuple[object, ...], Solids] = {}
        self._units = units(scene.pieces)
        self._names = [each.body.name for each in robot.bodies] + [body.name for body in scene.tool.bodies]
        self._own = len(self._names)
        carrier = [each.link for each in robot.bodies] + [self._flange] * len(scene.tool.bodies)
        self._carrier = np.array(carrier + [self._frames[each.frame] for each in scene.bodies], dtype=np.int64)
        self._pose = np.zeros((len(self._carrier), 4))
        self._pose[self._own :] = np.array([_numbers(each.pose) for each in scene.bodies]).reshape(-1, 4)
        self._names += scene.index
        self._number = {name: k for k, name in enumerate(self._names)}

    def __call__(self, carried: Carried | None, rides: tuple[tuple[str, str, Pose], ...]) -> Solids:
        """The arrangement in which `carried` is in the gripper and each part of `rides` rides on its frame."""
        key = (carried, rides)
        if key not in self._made:
            self._made[key] = self._make(carried, rides)
        return self._made[key]

    def _make(self, carried: Carried | None, rides: tuple[tuple[str, str, Pose], ...]) -> Solids:
        carrier, pose = self._carrier.copy(), self._pose.copy()
        for part, frame, there in rides:
            carrier[self._number[part]], pose[self._number[part]] = self._frames[frame], _numbers(there)
        order = list(range(len(self._names)))
        if carried is not None:
            held = self._number[carried.part]
            carrier[held], pose[held] = self._flange, _numbers(carried.in_flange)
            order.insert(self._own, order.pop(held))
        robot_bodies = self._own + (carried is not None)
        names = tuple(self._names[k] for k in order)
        mine = np.array(order, dtype=np.int64)
        return _flatten(self._units, mine, carrier[mine], pose[mine], names, len(self.scene.robot.links), robot_bodies)


def _numbers(pose: Pose) -> tuple[float, float, float, float]:
    return pose.x, pose.y, pose.z, pose.yaw


def _flatten(
    of_all: Units,
    bodies: IntArray,
    carrier: IntArray,
    pose: FloatArray,
    names: tuple[str, ...],
    links: int,
    robot_bodies: int,
) -> Solids:
    """The arrangement of bodies number `bodies` (B,) of `of_all`, at `pose` (B, 4) on `carrier` (B,)."""
    count = of_all.count[bodies]
    first = np.cumsum(count) - count
    body = np.repeat(np.arange(len(bodies)), count)
    of = of_all.first[bodies][body] + np.arange(len(body)) - first[body]
    turn = _turns(pose[:, 3])[body]
    centre = pose[body, :3] + (turn @ of_all.position[of][:, :, None])[:, :, 0]
    rotation, half, piece = turn @ of_all.rotation[of], of_all.half[of], of_all.piece[of]
    shapes = tuple(of_all.shapes[k] for k in of)
    hulls = {k: shape for k, shape in enumerate(shapes) if isinstance(shape, Hull)}
    reach, distance = extents_of(half, of_all.disc[of], of_all.ball[of], hulls, centre, rotation)
    hull = np.full(len(of), -1)
    for number, (k, shape) in enumerate(hulls.items()):
        # half edges of its bounding box in its own axes: a seed for normals, no claim
        hull[k], half[k] = number, (shape.vertices.max(0) - shape.vertices.min(0)) / 2
    ends = (first + count).tolist()
    whole = (first + (piece[first] == COVER)).tolist()
    return Solids(
        names=names,
        links=links,
        body=body,
        piece=piece,
        carrier=carrier[body],
        centre=centre,
        rotation=rotation,
        half=half,
        disc=of_all.disc[of],
        ball=of_all.ball[of],
        hull=hull,
        hulls=tuple(hulls.values()),
        reach=reach,
        distance=distance,
        roots=tuple(first.tolist()),
        pieces=tuple(tuple(range(begin, end)) for begin, end in zip(whole, ends, strict=True)),
        shapes=shapes,
        robot_bodies=robot_bodies,
    )


def _turns(yaw: FloatArray) -> FloatArray:
    """Rotations (U, 3, 3) about the vertical."""
    found = np.zeros((len(yaw), 3, 3))
    found[:, 0, 0] = found[:, 1, 1] = np.cos(yaw)
    found[:, 1, 0] = np.sin(yaw)
    found[:, 0, 1] = -found[:, 1, 0]
    found[:, 2, 2] = 1.0
    return found


def asked_pairs(scene: Scene, solids: Solids) -> tuple[IntArray, IntArray]:
    """The robot's bodies against all others, and against each other where the robot's `self_pairs` ask for it."""
    roots = np.array(solids.roots, dtype=np.int64)
    mine, others = roots[: solids.robot_bodies], roots[solids.robot_bodies :]
    first, second = np.repeat(mine, len(others)), np.tile(others, len(mine))
    name = scene.robot.links
    wanted = {frozenset(links) for links in scene.robot.self_pairs}
    own = [
        (a, b)
        for i, a in enumerate(mine)
        for b in mine[i + 1 :]
        if frozenset((name[solids.carrier[a]], name[solids.carrier[b]])) in wanted
        and solids.carrier[a] != solids.carrier[b]
    ]
    if own:
        first = np.concatenate([first, [a for a, _ in own]])
        second = np.concatenate([second, [b for _, b in own]])
    return first, second


def exempted(solids: Solids, phase: Phase, a: IntArray, b: IntArray) -> BoolArray:
    """Which pairs (P,) of units are of bodies that may touch in a phase."""
    number = {name: i for i, name in enumerate(solids.names)}
    allowed = [(number[x], number[y]) for x, y in phase.exempt if x in number and y in number]
    found = np.zeros(len(a), dtype=bool)
    for x, y in allowed + [(y, x) for x, y in allowed]:
        found |= (solids.body[a] == x) & (solids.body[b] == y)
    return found


@dataclass(frozen=True, slots=True)
class Carriers:
    """Positions (T, K, 3) and rotations (T, K, 3, 3) of all carriers in the world at T times."""

    position: FloatArray
    rotation: FloatArray


def carriers(scene: Scene, q: FloatArray, t: FloatArray) -> Carriers:
    """Where links and frames are at times t (T,) with joints q (T, n). NaN where a law is not known."""
    links, frames = len(scene.robot.links), len(scene.frames)
    position = np.empty((len(t), links + frames, 3))
    rotation = np.zeros((len(t), links + frames, 3, 3))
    position[:, :links], rotation[:, :links] = scene.robot.placements(q)
    yaw = np.empty((len(t), frames))
    for k, frame in enumerate(scene.frames.values()):
        position[:, links + k], yaw[:, k] = frame.law.pose_at(t)
    c, s = np.cos(yaw), np.sin(yaw)
    rotation[:, links:, 0, 0], rotation[:, links:, 0, 1] = c, -s
    rotation[:, links:, 1, 0], rotation[:, links:, 1, 1] = s, c
    rotation[:, links:, 2, 2] = 1.0
    return Carriers(position, rotation)


def standing(trajectory: Trajectory, t: FloatArray) -> FloatArray:
    """q (T, n) at times t, the arm standing still before the first knot and after the last."""
    return trajectory.evaluate(np.clip(t, trajectory.start, trajectory.end))

"""The bodies of a cell as flat arrays: one *unit* per convex piece, and one per bounding box of a body of several.

A unit rides on a *carrier*: a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which part rides where, and
hence the units, depends on the phase; a `Solids` is one such arrangement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.arrays import BoolArray, FloatArray, IntArray
from planner.extents import extents
from planner.frames.motion import Pose
from planner.phases import Carried, Phase, initial_rides
from planner.scene import Scene
from planner.shapes import Body, Hull, Piece, Primitive, box, support
from planner.trajectory import Trajectory

COVER = -1
"""Piece number of the bounding box of a whole body."""


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


def bounding_box(body: Body) -> Piece:
    """The box in the body's own axes that holds all of its pieces, a nanometre larger than they are."""
    axes = np.eye(3)
    high = np.array([max(support(piece, n) for piece in body.pieces) for n in axes])
    low = -np.array([max(support(piece, -n) for piece in body.pieces) for n in axes])
    size = high - low + 2e-9
    return Piece(box(*(float(x) for x in size)), (high + low) / 2)


@dataclass(frozen=True, slots=True)
class _Unit:
    """A unit in its body's axes: number of its piece, shape, position and rotation."""

    piece: int
    shape: Primitive | Hull
    position: FloatArray
    rotation: FloatArray


@dataclass(frozen=True, slots=True)
class _Seat:
    """A body in an arrangement: on which carrier, at which pose, as which units."""

    name: str
    carrier: int
    pose: Pose
    units: list[_Unit]


def _units(body: Body) -> list[_Unit]:
    """A body's units: its only piece, if that is a primitive; else its bounding box and all of its pieces."""
    found = [_Unit(k, piece.shape, piece.position, piece.rotation) for k, piece in enumerate(body.pieces)]
    if len(found) > 1 or isinstance(found[0].shape, Hull):
        cover = bounding_box(body)
        found.insert(0, _Unit(COVER, cover.shape, cover.position, cover.rotation))
    return found


class SolidsMaker:
    """Makes the `Solids` of a scene, one per arrangement, and keeps them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.frames = tuple(scene.frames)
        self._flange = scene.robot.links.index("flange")
        self._made: dict[tuple[object, ...], Solids] = {}
        self._bodies: dict[str, list[_Unit]] = {}

    def _seat(self, body: Body, carrier: int, pose: Pose) -> _Seat:
        if body.name not in self._bodies:
            self._bodies[body.name] = _units(body)
        return _Seat(body.name, carrier, pose, self._bodies[body.name])

    def __call__(self, carried: Carried | None, rides: tuple[tuple[str, str, Pose], ...]) -> Solids:
        """The arrangement in which `carried` is in the gripper and each part of `rides` rides on its frame."""
        key = (carried, rides)
        if key not in self._made:
            self._made[key] = self._make(carried, rides)
        return self._made[key]

    def _make(self, carried: Carried | None, rides: tuple[tuple[str, str, Pose], ...]) -> Solids:
        scene, links = self.scene, len(self.scene.robot.links)
        where = {**initial_rides(scene), **{part: (frame, pose) for part, frame, pose in rides}}
        seats = [self._seat(item.body, item.link, Pose()) for item in scene.robot.bodies]
        seats += [self._seat(body, self._flange, Pose()) for body in scene.tool.bodies]
        if carried is not None:
            seats.append(self._seat(scene.index[carried.part].body, self._flange, carried.in_flange))
        robot_bodies = len(seats)
        number = {name: links + k for k, name in enumerate(self.frames)}
        for world in scene.bodies:
            if carried is None or world.body.name != carried.part:
                frame, pose = where[world.body.name]
                seats.append(self._seat(world.body, number[frame], pose))
        return _flatten(seats, links, robot_bodies)


def _flatten(seats: list[_Seat], links: int, robot_bodies: int) -> Solids:
    units = [unit for seat in seats for unit in seat.units]
    counts = [len(seat.units) for seat in seats]
    first = np.cumsum([0, *counts])
    body = np.repeat(np.arange(len(seats)), counts)
    pose = np.array([(s.pose.x, s.pose.y, s.pose.z, s.pose.yaw) for s in seats]).reshape(-1, 4)[body]
    turn = _turns(pose[:, 3])
    centre = np.array([unit.position for unit in units]).reshape(-1, 3)
    centre = pose[:, :3] + (turn @ centre[:, :, None])[:, :, 0]
    rotation = turn @ np.array([unit.rotation for unit in units]).reshape(-1, 3, 3)
    shapes = tuple(unit.shape for unit in units)
    hulls = tuple(shape for shape in shapes if isinstance(shape, Hull))
    hull = np.cumsum([isinstance(shape, Hull) for shape in shapes], dtype=np.int64) - 1
    hull[[not isinstance(shape, Hull) for shape in shapes]] = -1
    reach, distance = extents(shapes, centre, rotation)
    return Solids(
        names=tuple(seat.name for seat in seats),
        links=links,
        body=body,
        piece=np.array([unit.piece for unit in units], dtype=np.int64),
        carrier=np.array([seat.carrier for seat in seats], dtype=np.int64)[body],
        centre=centre,
        rotation=rotation,
        half=np.array([_core(shape) for shape in shapes]).reshape(-1, 3),
        disc=np.array([shape.disc if isinstance(shape, Primitive) else 0.0 for shape in shapes]),
        ball=np.array([shape.ball if isinstance(shape, Primitive) else 0.0 for shape in shapes]),
        hull=hull,
        hulls=hulls,
        reach=reach,
        distance=distance,
        roots=tuple(first[:-1].tolist()),
        pieces=tuple(
            tuple(start + k for k, unit in enumerate(seat.units) if unit.piece != COVER)
            for start, seat in zip(first.tolist(), seats, strict=False)
        ),
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


def _core(shape: Primitive | Hull) -> tuple[float, float, float]:
    """Half edges, m, of a shape's core; of a hull its bounding box in its own axes: a seed for normals, no claim."""
    if isinstance(shape, Primitive):
        return shape.half
    x, y, z = ((shape.vertices.max(0) - shape.vertices.min(0)) / 2).tolist()
    return x, y, z


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

"""The bodies of a cell as flat arrays: one *unit* per convex piece, and one per bounding box of a body of several.

A unit rides on a *carrier*: a link of the robot (0..L-1) or a frame of the cell (L..L+F-1). Which part rides where, and
hence the units, depends on the phase; a `Solids` is one such arrangement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.arrays import BoolArray, FloatArray, IntArray
from planner.frames.motion import Pose
from planner.phases import Carried, initial_rides
from planner.scene import Scene
from planner.shapes import Body, Hull, Piece, Primitive, box, distance, reach, support
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


def _rotation(yaw: float) -> FloatArray:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def bounding_box(body: Body) -> Piece:
    """The box in the body's own axes that holds all of its pieces, a nanometre larger than they are."""
    axes = np.eye(3)
    high = np.array([max(support(piece, n) for piece in body.pieces) for n in axes])
    low = -np.array([max(support(piece, -n) for piece in body.pieces) for n in axes])
    size = high - low + 2e-9
    return Piece(box(*(float(x) for x in size)), (high + low) / 2)


@dataclass(frozen=True, slots=True)
class _Unit:
    piece: int
    shape: Primitive | Hull
    position: FloatArray
    rotation: FloatArray
    half: tuple[float, float, float]
    disc: float
    ball: float
    reach: float
    distance: float


def _units(body: Body, position: FloatArray, rotation: FloatArray) -> list[_Unit]:
    """A body's units: its only piece, if that is a primitive; else its bounding box and all of its pieces."""
    pieces = [(k, piece) for k, piece in enumerate(body.pieces)]
    if len(pieces) > 1 or isinstance(body.pieces[0].shape, Hull):
        pieces.insert(0, (COVER, bounding_box(body)))
    found = []
    for number, piece in pieces:
        shape, centre, half, disc, ball = piece.shape, piece.position, (0.0, 0.0, 0.0), 0.0, 0.0
        if isinstance(shape, Primitive):
            half, disc, ball = shape.half, shape.disc, shape.ball
        else:
            # a hull's core is its bounding box in its own axes: a seed for normals, never a claim
            low, high = shape.vertices.min(0), shape.vertices.max(0)
            half = tuple(float(x) for x in (high - low) / 2)  # type: ignore[assignment]
        turned = rotation @ piece.rotation
        found.append(
            _Unit(
                number,
                shape,
                position + rotation @ centre,
                turned,
                half,
                disc,
                ball,
                reach(piece, position, rotation),
                distance(piece, position, rotation),
            )
        )
    return found


class SolidsMaker:
    """Makes the `Solids` of a scene, one per arrangement, and keeps them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.frames = tuple(scene.frames)
        self._flange = scene.robot.links.index("flange")
        self._made: dict[tuple[object, ...], Solids] = {}
        self._bodies: dict[tuple[object, ...], list[_Unit]] = {}

    def _placed(self, body: Body, pose: Pose) -> list[_Unit]:
        key = (body.name, pose)
        if key not in self._bodies:
            self._bodies[key] = _units(body, pose.position, _rotation(pose.yaw))
        return self._bodies[key]

    def __call__(self, carried: Carried | None, rides: tuple[tuple[str, str, Pose], ...]) -> Solids:
        """The arrangement in which `carried` is in the gripper and each part of `rides` rides on its frame."""
        key = (carried, rides)
        if key not in self._made:
            self._made[key] = self._make(carried, rides)
        return self._made[key]

    def _make(self, carried: Carried | None, rides: tuple[tuple[str, str, Pose], ...]) -> Solids:
        scene, links = self.scene, len(self.scene.robot.links)
        where = {**initial_rides(scene), **{part: (frame, pose) for part, frame, pose in rides}}
        placed: list[tuple[str, int, list[_Unit]]] = []
        for item in scene.robot.bodies:
            placed.append((item.body.name, item.link, self._placed(item.body, Pose())))
        for body in scene.tool.bodies:
            placed.append((body.name, self._flange, self._placed(body, Pose())))
        if carried is not None:
            body = scene.index[carried.part].body
            placed.append((carried.part, self._flange, self._placed(body, carried.in_flange)))
        robot_bodies = len(placed)
        for world in scene.bodies:
            if carried is not None and world.name == carried.part:
                continue
            frame, pose = where[world.name]
            placed.append((world.name, links + self.frames.index(frame), self._placed(world.body, pose)))
        return _flatten(placed, links, robot_bodies)


def _flatten(placed: list[tuple[str, int, list[_Unit]]], links: int, robot_bodies: int) -> Solids:
    units = [(b, carrier, unit) for b, (_, carrier, units) in enumerate(placed) for unit in units]
    first = np.cumsum([0] + [len(units) for _, _, units in placed])
    hulls: list[Hull] = []
    hull = np.full(len(units), -1, dtype=np.int64)
    centre = np.array([unit.position for _, _, unit in units]).reshape(-1, 3)
    for i, (_, _, unit) in enumerate(units):
        if isinstance(unit.shape, Hull):
            hull[i] = len(hulls)
            hulls.append(unit.shape)
    return Solids(
        names=tuple(name for name, _, _ in placed),
        links=links,
        body=np.array([b for b, _, _ in units], dtype=np.int64),
        piece=np.array([unit.piece for _, _, unit in units], dtype=np.int64),
        carrier=np.array([carrier for _, carrier, _ in units], dtype=np.int64),
        centre=centre,
        rotation=np.array([unit.rotation for _, _, unit in units]).reshape(-1, 3, 3),
        half=np.array([unit.half for _, _, unit in units]).reshape(-1, 3),
        disc=np.array([unit.disc for _, _, unit in units], dtype=np.float64),
        ball=np.array([unit.ball for _, _, unit in units], dtype=np.float64),
        hull=hull,
        hulls=tuple(hulls),
        reach=np.array([unit.reach for _, _, unit in units], dtype=np.float64),
        distance=np.array([unit.distance for _, _, unit in units], dtype=np.float64),
        roots=tuple(int(x) for x in first[:-1]),
        pieces=tuple(
            tuple(int(first[b]) + k for k, unit in enumerate(units) if unit.piece != COVER)
            for b, (_, _, units) in enumerate(placed)
        ),
        shapes=tuple(unit.shape for _, _, unit in units),
        robot_bodies=robot_bodies,
    )


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

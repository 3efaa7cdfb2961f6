"""Who rides on what in each phase, and all convex pieces where they sit, as tables for `separation`.

A *carrier* is a link of the robot (0..L-1) or a frame of the cell (L..L+F-1); a *seat* is a body at a pose in its
carrier. Most bodies keep one seat for the whole plan; a part that is picked changes it. A *solid* is a row of the
table: a piece of a seated body or, behind its pieces, the box in the body's own axes that holds all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.separation import ARM, ARM_FLAT, BALL, CENTRE, DISC, HALF, SOLID, TURN, VERTEX, VERTICES
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene

UPRIGHT = 1e-12
"""A solid of revolution whose axis is off the vertical by no more than this (a few roundings, rad) stands upright."""
_SIGNS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


@dataclass(frozen=True, eq=False)
class Solids:
    """`bodies`, by `number` of their name; `count` (B,) of their pieces; `seat` (P, B) in each phase; of each seat (S,)
    the `body`, the `carrier` and the row `first` of its pieces; `table` (N, SOLID) and the `vertices` of hulls.
    `offset` (S, 4): x, y, z, yaw of seats in their carriers; `tilts` (C,): 1 for carriers that do not stay upright."""

    bodies: tuple[Body, ...]
    number: dict[str, int]
    count: IntArray
    seat: IntArray
    body: IntArray
    carrier: IntArray
    first: IntArray
    offset: FloatArray
    table: FloatArray
    vertices: FloatArray
    tilts: FloatArray
    links: int

    @property
    def of_robot(self) -> BoolArray:
        """(P, B): whether a body is the robot's, its tool's, or in its gripper."""
        return np.asarray(self.carrier[self.seat] < self.links)

    def row(self, seat: IntArray, piece: IntArray) -> IntArray:
        """Rows of the pieces (N,) of bodies in seats (N,), -1 being the box."""
        return np.asarray(self.first[seat] + np.where(piece < 0, self.count[self.body[seat]], piece))


def solids(scene: Scene, phases: tuple[Phase, ...]) -> Solids:
    """The tables of a scene in the phases of a plan."""
    robot = scene.robot
    flange, links = robot.links.index("flange"), len(robot.links)
    frames = {name: links + k for k, name in enumerate(scene.frames)}
    fixed = [(item.body, item.link, Pose()) for item in robot.bodies]
    fixed += [(body, flange, Pose()) for body in scene.tool.bodies]
    fixed += [(item.body, frames[item.frame], item.pose) for item in scene.bodies]
    found: dict[tuple[int, int, Pose], int] = {}
    seat = np.zeros((len(phases), len(fixed)), dtype=np.int64)
    for row, phase in zip(seat, phases, strict=True):
        moved = {name: (frames[frame], pose) for name, frame, pose in phase.attached.placed}
        held = phase.attached.held
        if held is not None:
            moved[held.part] = (flange, held.in_flange)
        for b, (item, carrier, pose) in enumerate(fixed):
            row[b] = found.setdefault((b, *moved.get(item.name, (carrier, pose))), len(found))
    body = np.array([b for b, _, _ in found], dtype=np.int64)
    offset = np.array([(pose.x, pose.y, pose.z, pose.yaw) for _, _, pose in found]).reshape(-1, 4)
    own, vertices, first, count = _own(scene)
    sizes = count[body] + 1
    begins = np.cumsum(sizes) - sizes
    of = np.repeat(np.arange(len(body)), sizes)
    bodies = tuple(item for item, _, _ in fixed)
    return Solids(
        bodies=bodies,
        number={item.name: i for i, item in enumerate(bodies)},
        count=count,
        seat=seat,
        body=body,
        carrier=np.array([carrier for _, carrier, _ in found], dtype=np.int64),
        first=begins,
        offset=offset,
        table=_seated(own[np.arange(len(of)) - begins[of] + first[body[of]]], offset[of]),
        vertices=vertices,
        tilts=np.array([float(link in robot.tilting) for link in range(links)] + [0.0] * len(frames)),
        links=links,
    )


def _own(scene: Scene) -> tuple[FloatArray, FloatArray, IntArray, IntArray]:
    """Solids in their bodies' axes, each body's box behind its pieces; vertices; first row and pieces of each body."""
    raw = scene.pieces
    shift, many = np.repeat(np.arange(len(raw.count)), raw.count), len(raw.position)
    first = raw.first + np.arange(len(raw.count))
    at, boxed = np.arange(many) + shift, raw.first + raw.count + np.arange(len(raw.count))
    found = np.zeros((many + len(raw.count), SOLID))
    position, turn, half = raw.position.copy(), raw.rotation, raw.half
    lying = (np.abs(turn[:, :2, 2]).max(1, initial=0.0) > UPRIGHT) * raw.disc
    corners = (_SIGNS * half[:, None]) @ np.swapaxes(turn, 1, 2)
    flat, arm = np.hypot(corners[..., 0], corners[..., 1]).max(1) + lying, _length(half) + raw.disc
    size = (np.abs(turn) * half[:, None]).sum(-1) + raw.ball[:, None]
    size += raw.disc[:, None] * np.hypot(turn[..., 0], turn[..., 1])
    low, high = position - size, position + size
    kept: list[FloatArray] = []
    for k in np.flatnonzero(raw.hull >= 0):
        own = raw.hulls[raw.hull[k]].vertices
        middle = (own.min(0) + own.max(0)) / 2.0
        around = (own - middle) @ turn[k].T
        position[k] = position[k] + turn[k] @ middle
        low[k], high[k] = position[k] + around.min(0), position[k] + around.max(0)
        flat[k], arm[k] = np.hypot(around[:, 0], around[:, 1]).max(), _length(around).max()
        found[at[k], [VERTEX, VERTICES]] = sum(map(len, kept)), len(own)
        kept.append(own - middle)
    found[at, CENTRE:TURN], found[at, HALF:DISC] = position, half
    found[at, TURN:HALF] = np.swapaxes(turn, 1, 2).reshape(-1, 9)
    found[at, DISC], found[at, BALL], found[at, ARM_FLAT], found[at, ARM] = raw.disc, raw.ball, flat, arm
    if len(boxed):
        low, high = np.minimum.reduceat(low, raw.first), np.maximum.reduceat(high, raw.first)
        found[boxed, CENTRE:TURN], found[boxed, HALF:DISC] = (high + low) / 2.0, (high - low) / 2.0
        found[boxed, TURN:HALF] = np.eye(3).ravel()
        found[boxed, ARM_FLAT] = np.hypot(*found[boxed, HALF : HALF + 2].T)
        found[boxed, ARM] = _length(found[boxed, HALF:DISC])
    return found, np.concatenate([np.zeros((0, 3)), *kept]), first, raw.count


def _seated(found: FloatArray, offset: FloatArray) -> FloatArray:
    """Solids (N, SOLID) with centres and axes in the carriers, their bodies being at `offset` (N, 4)."""
    c, s = np.cos(offset[:, 3]), np.sin(offset[:, 3])
    for first in (CENTRE, TURN, TURN + 3, TURN + 6):
        x, y = found[:, first].copy(), found[:, first + 1].copy()
        found[:, first], found[:, first + 1] = c * x - s * y, s * x + c * y
    found[:, CENTRE:TURN] += offset[:, :3]
    return found


def _length(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt((vectors * vectors).sum(-1)))

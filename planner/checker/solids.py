"""Who sits on what in each phase, and all convex pieces where they sit, as tables; and how far they reach.

A *carrier* is a link of the robot (0..L-1) or a frame of the cell (L..L+F-1); a *seat* is a body at a pose in its
carrier. Most bodies keep one seat for the whole plan; a part that is picked changes it. A *solid* is a row of the
table: a piece of a seated body or, behind its pieces, the box in the body's own axes that holds all of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.jets import F1, F2, F3, VECTOR, size
from assur.planner.checker.motion import JETS
from assur.planner.compiled import kernel
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene

CENTRE, TURN, HALF, DISC, BALL, VERTEX, VERTICES, ARM_FLAT, ARM, TILTS, SOLID = (
    0, 3, 12, 15, 16, 17, 18, 19, 20, 21, 22,
)  # fmt: skip
"""Columns of a solid, in its carrier: centre, axes (columns one after the other), half sizes of the box, disc across
the z axis, ball (S1), first row and number of the vertices of a hull; how far points that count are from the vertical
through its centre, and from its centre; 1 on a carrier that does not stay upright; how many columns."""
BODY, CARRIER, FIRST = 0, 1, 2
"""Columns of a seat: number of the body, its carrier, and the row of the table where its pieces begin."""
UPRIGHT = 1e-12
"""A solid of revolution whose axis is off the vertical by no more than this (a few roundings, rad) stands upright."""
I2 = "int64[:, ::1]"
Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Solids:
    """`bodies`, by `number` of their name; `count` (B,) of their pieces; `seat` (P, B) in each phase; `seats` (S, 3)
    and `offset` (S, 4): x, y, z, yaw of seats in their carriers; `table` (N, SOLID) and the `vertices` of hulls;
    `mine` (B,): numbers of the bodies that are the robot's in
    any phase, -1 for others."""

    bodies: tuple[Body, ...]
    number: dict[str, int]
    count: IntArray
    seat: IntArray
    seats: IntArray
    offset: FloatArray
    table: FloatArray
    vertices: FloatArray
    mine: IntArray
    links: int

    @property
    def of_robot(self) -> BoolArray:
        """(P, B): whether a body is the robot's, its tool's, or in its gripper."""
        return np.asarray(self.seats[self.seat, CARRIER] < self.links)


def solids(scene: Scene, phases: tuple[Phase, ...]) -> Solids:
    """The tables of a scene in the phases of a plan."""
    robot = scene.robot
    flange, links, raw = robot.links.index("flange"), len(robot.links), scene.pieces
    frames = {name: links + k for k, name in enumerate(scene.frames)}
    bodies = (*(item.body for item in robot.bodies), *scene.tool.bodies, *(item.body for item in scene.bodies))
    number = {body.name: k for k, body in enumerate(bodies)}
    own = len(bodies) - len(scene.bodies)
    carriers = [item.link for item in robot.bodies] + [flange] * len(scene.tool.bodies)
    carriers += [frames[item.frame] for item in scene.bodies]
    offset = [(0.0, 0.0, 0.0, 0.0)] * own + [_four(item.pose) for item in scene.bodies]
    # at first every body has the seat of its own number; what is moved gets others
    seated, seat = list(range(len(bodies))), np.empty((len(phases), len(bodies)), dtype=np.int64)
    seat[:] = seated
    known: dict[tuple[str, int, Pose], int] = {}
    for row, phase in zip(seat, phases, strict=True):
        moved = [(name, frames[frame], pose) for name, frame, pose in phase.attached.placed]
        if phase.attached.held is not None:
            moved.append((phase.attached.held.part, flange, phase.attached.held.in_flange))
        for name, carrier, pose in moved:
            if (name, carrier, pose) not in known:
                known[name, carrier, pose] = len(seated)
                seated.append(number[name])
                carriers.append(carrier)
                offset.append(_four(pose))
            row[number[name]] = known[name, carrier, pose]
    seats = np.empty((len(seated), 3), dtype=np.int64)
    seats[:, BODY], seats[:, CARRIER] = seated, carriers
    rows = raw.count[seated] + 1
    seats[:, FIRST] = rows.cumsum() - rows
    mine = np.full(len(bodies), -1)
    robots = sorted({body for body, carrier in zip(seated, carriers, strict=True) if carrier < links})
    mine[robots] = range(len(robots))
    own_table, vertices = np.zeros((len(raw.position), SOLID)), np.zeros((0, 3))
    own_table[:, CENTRE:TURN], own_table[:, HALF:DISC] = raw.position, raw.half
    own_table[:, TURN:HALF] = raw.rotation.transpose(0, 2, 1).reshape(-1, 9)
    own_table[:, DISC], own_table[:, BALL] = raw.disc, raw.ball
    if raw.hulls:
        sizes = np.array([len(hull.vertices) for hull in raw.hulls])
        vertices, which = np.concatenate([hull.vertices for hull in raw.hulls]), np.flatnonzero(raw.hull >= 0)
        own_table[which, VERTEX], own_table[which, VERTICES] = np.cumsum(sizes) - sizes, sizes
    table, places, count = np.zeros((int(rows.sum()), SOLID)), np.array(offset).reshape(-1, 4), raw.count.copy()
    place(own_table, raw.first.copy(), count, seats, places, vertices, table)
    if robot.tilting:
        table[np.repeat(np.isin(carriers, list(robot.tilting)), rows), TILTS] = 1.0
    return Solids(bodies, number, count, seat, seats, places, table, vertices, mine, links)


def _four(pose: Pose) -> tuple[float, float, float, float]:
    return pose.x, pose.y, pose.z, pose.yaw


@kernel(f"void({F1}, {F2}, {F1}, {F1})")
def _extend(solid: FloatArray, vertices: FloatArray, low: FloatArray, high: FloatArray) -> None:
    """How far the points that count of a solid are from its centre, and what box it fills, in the axes it is in."""
    begin, many, flat, arm = int(solid[VERTEX]), int(solid[VERTICES]), 0.0, 0.0
    for i in range(many if many > 0 else 8):
        x, y, z = solid[HALF], solid[HALF + 1], solid[HALF + 2]
        if many > 0:
            x, y, z = vertices[begin + i, 0], vertices[begin + i, 1], vertices[begin + i, 2]
        else:
            x, y, z = (x if i & 1 else -x), (y if i & 2 else -y), (z if i & 4 else -z)
        for axis in range(3):
            at = solid[TURN + axis] * x + solid[TURN + 3 + axis] * y + solid[TURN + 6 + axis] * z
            round_ = solid[BALL] + solid[DISC] * math.hypot(solid[TURN + axis], solid[TURN + 3 + axis])
            low[axis] = min(low[axis], solid[CENTRE + axis] + at - round_)
            high[axis] = max(high[axis], solid[CENTRE + axis] + at + round_)
        across = math.hypot(
            solid[TURN] * x + solid[TURN + 3] * y + solid[TURN + 6] * z,
            solid[TURN + 1] * x + solid[TURN + 4] * y + solid[TURN + 7] * z,
        )
        flat, arm = max(flat, across), max(arm, math.sqrt(x * x + y * y + z * z))
    lies = max(abs(solid[TURN + 6]), abs(solid[TURN + 7])) > UPRIGHT
    solid[ARM_FLAT], solid[ARM] = flat + (solid[DISC] if lies else 0.0), arm + solid[DISC]


@kernel(f"void({F2}, int64[::1], int64[::1], {I2}, {F2}, {F2}, {F2})", allocates=True)
def place(
    raw: FloatArray,
    first: IntArray,
    count: IntArray,
    seats: IntArray,
    offset: FloatArray,
    vertices: FloatArray,
    table: FloatArray,
) -> None:
    """Fills the table from the pieces `raw` (M, SOLID) of bodies in their own axes; vertices are put about the centre
    of their hull, as are the centres of those pieces."""
    for k in range(len(raw)):
        begin, end, middle = int(raw[k, VERTEX]), int(raw[k, VERTEX] + raw[k, VERTICES]), np.zeros(3)
        for axis in range(3 if end > begin else 0):
            middle[axis] = (vertices[begin:end, axis].min() + vertices[begin:end, axis].max()) / 2.0
            for i in range(begin, end):
                vertices[i, axis] -= middle[axis]
        for axis in range(3):
            for i in range(3):
                raw[k, CENTRE + i] += raw[k, TURN + 3 * axis + i] * middle[axis]
    for s in range(len(seats)):
        body, row = seats[s, BODY], seats[s, FIRST]
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for k in range(first[body], first[body] + count[body]):
            table[row] = raw[k]
            _extend(table[row], vertices, low, high)
            row += 1
        box = table[row]
        for axis in range(3):
            box[CENTRE + axis], box[HALF + axis] = (low[axis] + high[axis]) / 2.0, (high[axis] - low[axis]) / 2.0
            box[TURN + 4 * axis] = 1.0
        _extend(box, vertices, low, high)
        c, d = math.cos(offset[s, 3]), math.sin(offset[s, 3])
        for i in range(seats[s, FIRST], row + 1):
            for at in (CENTRE, TURN, TURN + 3, TURN + 6):
                x, y = table[i, at], table[i, at + 1]
                table[i, at], table[i, at + 1] = c * x - d * y, d * x + c * y
            for axis in range(3):
                table[i, CENTRE + axis] += offset[s, axis]


@kernel(f"{VECTOR}({F1}, {F3}, int64, {F2}, {VECTOR}, float64)")
def farthest(solid: FloatArray, jets: FloatArray, c: int, vertices: FloatArray, n: Vector, ball: float) -> Vector:
    """The point of a solid on carrier c that is farthest along n, where the jets, of an instant, have it (S1); with
    `ball` 0 the ball about it is left out."""
    nx, ny, nz = n
    along = (
        nx * jets[c, 3, 0] + ny * jets[c, 4, 0] + nz * jets[c, 5, 0],
        nx * jets[c, 6, 0] + ny * jets[c, 7, 0] + nz * jets[c, 8, 0],
        nx * jets[c, 9, 0] + ny * jets[c, 10, 0] + nz * jets[c, 11, 0],
    )
    u = along[0] * solid[TURN] + along[1] * solid[TURN + 1] + along[2] * solid[TURN + 2]
    v = along[0] * solid[TURN + 3] + along[1] * solid[TURN + 4] + along[2] * solid[TURN + 5]
    w = along[0] * solid[TURN + 6] + along[1] * solid[TURN + 7] + along[2] * solid[TURN + 8]
    x, y, z = solid[HALF], solid[HALF + 1], solid[HALF + 2]
    x, y, z = (x if u >= 0.0 else -x), (y if v >= 0.0 else -y), (z if w >= 0.0 else -z)
    across = math.sqrt(u * u + v * v)
    if across > 0.0:
        x, y = x + solid[DISC] * u / across, y + solid[DISC] * v / across
    length = math.sqrt(u * u + v * v + w * w)
    if length > 0.0:
        share = ball * solid[BALL] / length
        x, y, z = x + share * u, y + share * v, z + share * w
    first, most, best = int(solid[VERTEX]), -math.inf, -1
    for i in range(first, first + int(solid[VERTICES])):
        reach = u * vertices[i, 0] + v * vertices[i, 1] + w * vertices[i, 2]
        if reach > most:
            most, best = reach, i
    if best >= 0:
        x, y, z = x + vertices[best, 0], y + vertices[best, 1], z + vertices[best, 2]
    p = solid[CENTRE] + x * solid[TURN] + y * solid[TURN + 3] + z * solid[TURN + 6]
    q = solid[CENTRE + 1] + x * solid[TURN + 1] + y * solid[TURN + 4] + z * solid[TURN + 7]
    r = solid[CENTRE + 2] + x * solid[TURN + 2] + y * solid[TURN + 5] + z * solid[TURN + 8]
    return (
        jets[c, 0, 0] + p * jets[c, 3, 0] + q * jets[c, 6, 0] + r * jets[c, 9, 0],
        jets[c, 1, 0] + p * jets[c, 4, 0] + q * jets[c, 7, 0] + r * jets[c, 10, 0],
        jets[c, 2, 0] + p * jets[c, 5, 0] + q * jets[c, 8, 0] + r * jets[c, 11, 0],
    )


@kernel(f"{VECTOR}({F1}, {F3}, int64, int64, {VECTOR})")
def moving(solid: FloatArray, jets: FloatArray, c: int, order: int, n: Vector) -> Vector:
    """Bounds of n·c of a solid's centre c, differentiated `order` times, and how far that of its points may be off."""
    low, high = 0.0, 0.0
    for k in range(3):
        for axis in range(4):
            share = n[k] if axis == 0 else n[k] * solid[CENTRE + axis - 1]
            least, most = share * jets[c, 3 * axis + k, 2 * order], share * jets[c, 3 * axis + k, 2 * order + 1]
            low += least if share >= 0.0 else most
            high += most if share >= 0.0 else least
    if solid[TILTS] > 0.0:
        return low, high, solid[ARM] * size(jets, c, 3, JETS, order)
    return low, high, solid[ARM_FLAT] * math.sqrt(n[0] * n[0] + n[1] * n[1]) * size(jets, c, 3, 5, order)

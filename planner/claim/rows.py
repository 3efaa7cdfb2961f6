"""Rows of the proof: those of a certificate about two bodies as they are, and in place of rows against planes those of
the pairs that the planes keep apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.claim import columns as c
from assur.planner.geometry.shapes import Body, Hull, support
from assur.planner.model.outcome import Certificate
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

INSTANTS = 9
"""Times of a phase at which it is evaluated which plane keeps two bodies farthest apart."""
WHOLE = -1
"""In place of a piece: the box that holds the body."""


def rows_of(
    scene: Scene,
    bodies: Sequence[Body],
    number: dict[str, int],
    path: Trajectory,
    certificate: Certificate,
    tables: dict[str, FloatArray],
) -> FloatArray:
    """All rows, sorted by their times. `bodies`, `number`: the claim's, and their rows by name; `tables`: the phases of
    the plan with their seats."""
    found = certificate_rows(certificate, number)
    planes = found[:, c.ROW_BODY + 1] < 0.0
    if planes.any():
        found = np.concatenate((found[~planes], _pairs(_Places(scene, bodies, path, tables), tables, found, planes)))
    return found[np.lexsort((found[:, c.ROW_T1], found[:, c.ROW_T0]))]


def certificate_rows(rows: Certificate, number: dict[str, int]) -> FloatArray:
    """The columns of a certificate, with the claim's numbers of bodies; where a row is against a plane its second body
    is -1."""
    found = np.zeros((len(rows), c.ROW))
    found[:, c.ROW_T0], found[:, c.ROW_T1] = rows.t0, rows.t1
    if rows.shift0 is not None and rows.shift1 is not None:
        # windows are sums of two numbers, which the rows have rounded
        for column, ahead, end in ((c.ROW_S0, rows.shift0, -math.inf), (c.ROW_S1, rows.shift1, math.inf)):
            found[:, column] = np.where(ahead != 0.0, np.nextafter(ahead, end), 0.0)
    at = np.array([*(number[name] for name in rows.names), -1])
    found[:, c.ROW_BODY], found[:, c.ROW_BODY + 1] = at[rows.first], at[rows.second]
    found[:, c.ROW_PIECE], found[:, c.ROW_PIECE + 1] = rows.first_piece, rows.second_piece
    found[:, c.ROW_NORMAL :] = rows.normal
    return found


def _pairs(places: _Places, tables: dict[str, FloatArray], rows: FloatArray, planes: BoolArray) -> FloatArray:
    """For each body that planes keep apart from what never moves, a row for each pair in place of them: along the
    normal of the plane that is farthest from the pair's second body."""
    phases, seated = tables["phases"], tables["seated"].astype(np.int64)
    of: IntArray = np.searchsorted(phases[:, c.PHASE_T0], rows[:, c.ROW_T0], side="right") - 1
    bodies = rows[:, c.ROW_BODY : c.ROW_PIECE].astype(np.int64)
    paired = {(p, *sorted(pair)) for p, pair in zip(of[~planes].tolist(), bodies[~planes].tolist(), strict=True)}
    groups: dict[tuple[int, int], list[int]] = {}
    for row in np.flatnonzero(planes).tolist():
        groups.setdefault((int(of[row]), int(bodies[row, 0])), []).append(row)
    normals, blocks, standing = rows[:, c.ROW_NORMAL :], list[FloatArray](), places.standing(seated)
    begin = float(phases[0, c.PHASE_T0])
    nearest = np.array([-places.reach(seat, begin, -normals) for seat in standing]).reshape(len(standing), len(rows))
    number, whole = {seat: k for k, seat in enumerate(standing)}, np.array([places.whole(k) for k in places.bodies])
    for (p, body), own in groups.items():
        seats = seated[p].tolist()
        others = [k for k, seat in enumerate(seats) if seat in number and (p, *sorted((body, k))) not in paired]
        t0, t1 = phases[p, : c.PHASE_NEAR].tolist()
        far = np.max([places.reach(seats[body], t, normals[own]) for t in np.linspace(t0, t1, INSTANTS).tolist()], 0)
        gaps = nearest[np.ix_([number[seats[k]] for k in others], own)] - far
        block = np.zeros((len(others), c.ROW))
        block[:, c.ROW_T0], block[:, c.ROW_T1] = t0, t1
        block[:, c.ROW_BODY], block[:, c.ROW_BODY + 1] = body, others
        block[:, c.ROW_PIECE], block[:, c.ROW_PIECE + 1] = whole[body], whole[others]
        block[:, c.ROW_NORMAL :] = normals[own][gaps.argmax(1)]
        blocks.append(block)
    return np.concatenate(blocks)


class _Places:
    """How far bodies reach along normals, by the planner's own kinematics: only to choose rows, which are proved."""

    def __init__(self, scene: Scene, bodies: Sequence[Body], path: Trajectory, tables: dict[str, FloatArray]) -> None:
        self.robot, self.path, self.bodies, self.seats = scene.robot, path, bodies, tables["seats"]
        self.laws = [frame.law for frame in scene.frames.values()]
        self.arms: dict[float, tuple[FloatArray, FloatArray]] = {}

    def standing(self, seated: IntArray) -> list[int]:
        """The seats that are used and stand still."""
        frames = self.seats[:, c.SEAT_FRAME].astype(int).tolist()
        return [int(k) for k in np.unique(seated) if frames[k] >= 0 and self.laws[frames[k]].is_fixed]

    @staticmethod
    def whole(body: Body) -> int:
        """The number of a piece that is all of a body: its only one, or the box that holds them."""
        return 0 if len(body.pieces) == 1 else WHOLE

    def reach(self, seat: int, t: float, n: FloatArray) -> FloatArray:
        """The largest n·x (N,) of a body in a seat at a time, for normals n (N, 3), m."""
        row = self.seats[seat]
        if row[c.SEAT_LINK] >= 0.0:
            if t not in self.arms:
                held = np.array([min(max(t, self.path.start), self.path.end)])
                self.arms[t] = self.robot.placements(self.path.evaluate(held))
            link = int(row[c.SEAT_LINK])
            p, r = self.arms[t][0][0, link], self.arms[t][1][0, link]
        else:
            motion = self.laws[int(row[c.SEAT_FRAME])].motion(np.array(t))
            p, r = motion.p, _turned(float(motion.yaw))
        local = n @ r
        pose = row[c.SEAT_POSE :]
        own = local @ _turned(float(pose[3]))
        return np.asarray(n @ p + local @ pose[:3] + _support(self.bodies[int(row[c.SEAT_BODY])], own))


def _support(body: Body, n: FloatArray) -> FloatArray:
    """The largest n·x (N,) of a body, or of the box in its axes that holds it if it has more than one piece."""
    if len(body.pieces) > 1:
        low, high = _box(body)
        return np.asarray(np.maximum(n * low, n * high).sum(1))
    piece = body.pieces[0]
    shape, local, offset = piece.shape, n @ piece.rotation, n @ piece.position
    if isinstance(shape, Hull):
        return np.asarray(offset + (local @ shape.vertices.T).max(1))
    reach = np.abs(local) @ np.array(shape.half)
    return np.asarray(
        offset + reach + shape.disc * np.hypot(local[:, 0], local[:, 1]) + shape.ball * np.linalg.norm(n, axis=1)
    )


@lru_cache(maxsize=4096)
def _box(body: Body) -> tuple[FloatArray, FloatArray]:
    ends = [[max(support(piece, sign * way) for piece in body.pieces) for way in np.eye(3)] for sign in (-1.0, 1.0)]
    return -np.array(ends[0]), np.array(ends[1])


def _turned(yaw: float) -> FloatArray:
    cosine, sine = math.cos(yaw), math.sin(yaw)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])

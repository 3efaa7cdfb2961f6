"""The rows of a certificate in a bundle: those of two bodies as they are, and in place of planes rows of the pairs that
they keep apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.geometry.shapes import Body, support
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.scenes.bundle.arms import link_number
from assur.scenes.bundle.solids import bodies_in

Document = dict[str, Any]
INSTANTS = 9
"""Times of a phase at which it is looked which plane keeps two bodies farthest apart."""
Rows = list[tuple[float, float, float, float, int, int, int, int, list[float]]]


class _Places:
    """Where bodies reach to along normals, by the planner's own kinematics: only to choose rows, which are proved."""

    def __init__(self, scene: Scene, plan: Plan, seats: list[Document]) -> None:
        self.robot, self.path, self.seats, self.bodies = scene.robot, plan.trajectory, seats, bodies_in(scene)
        self.laws = [frame.law for frame in scene.frames.values()]
        self.stands = [law.is_fixed for law in self.laws]
        self.known: dict[tuple[int, float, tuple[float, ...]], float] = {}
        self.arms: dict[float, tuple[FloatArray, FloatArray]] = {}

    def reach(self, seat: int, t: float, n: FloatArray) -> float:
        """The largest n·x of a body in a seat at a time, m."""
        on = self.seats[seat]["frame"]
        key = (seat, 0.0 if on >= 0 and self.stands[on] else t, tuple(n.tolist()))
        if key not in self.known:
            self.known[key] = self._reach(self.seats[seat], t, n)
        return self.known[key]

    def _reach(self, at: Document, t: float, n: FloatArray) -> float:
        if at["link"] >= 0:
            if t not in self.arms:
                held = np.array([min(max(t, self.path.start), self.path.end)])
                self.arms[t] = self.robot.placements(self.path.evaluate(held))
            link = link_number(self.robot, at["link"])  # which is its own inverse
            p, r = self.arms[t][0][0, link], self.arms[t][1][0, link]
        else:
            motion = self.laws[at["frame"]].motion(np.array(t))
            p, r = motion.p, _turned(float(motion.yaw))
        x, y, z, yaw = at["pose"]
        local = r.T @ n
        return float(n @ p + local @ np.array([x, y, z]) + _support(self.bodies[at["body"]], _turned(yaw).T @ local))


def _support(body: Body, n: FloatArray) -> float:
    """The largest n·x of a body, or of the box in its axes that holds it if it has more than one piece."""
    if len(body.pieces) == 1:
        return support(body.pieces[0], n)
    low, high = _box(body)
    return float(np.maximum(n * low, n * high).sum())


@lru_cache(maxsize=4096)
def _box(body: Body) -> tuple[FloatArray, FloatArray]:
    ends = [[max(support(piece, sign * way) for piece in body.pieces) for way in np.eye(3)] for sign in (-1.0, 1.0)]
    return -np.array(ends[0]), np.array(ends[1])


def _whole(body: Body) -> int:
    """The number of a piece that is all of a body: its only one, or the box that holds them."""
    return 0 if len(body.pieces) == 1 else -1


def _turned(yaw: float) -> FloatArray:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rows_of(
    scene: Scene, plan: Plan, phases: Sequence[Phase], seats: list[Document], seat: list[list[int]]
) -> list[Document]:
    """All rows."""
    c, number = plan.certificate, {body.name: k for k, body in enumerate(bodies_in(scene))}
    at = [number[name] for name in c.names]
    shifts = np.zeros((2, len(c))) if c.shift0 is None or c.shift1 is None else np.stack([c.shift0, c.shift1])
    rows: Rows = []
    planes: dict[tuple[int, int], list[list[float]]] = {}
    begins = np.array([phase.t0 for phase in phases])
    paired: set[tuple[int, int, int]] = set()
    for k in range(len(c)):
        first, second, n = at[int(c.first[k])], int(c.second[k]), c.normal[k].tolist()
        p = int(np.searchsorted(begins, c.t0[k], side="right")) - 1
        if second < 0:
            known = planes.setdefault((p, first), [])
            known += [] if n in known else [n]
            continue
        other = at[second]
        paired |= {(p, first, other), (p, other, first)}
        pieces = int(c.first_piece[k]), int(c.second_piece[k])
        # windows are sums of two numbers, which the rows have rounded
        ahead = [
            float(shifts[i, k]) and math.nextafter(shifts[i, k], end) for i, end in enumerate((-math.inf, math.inf))
        ]
        span = float(c.t0[k]), float(c.t1[k]), ahead[0], ahead[1]
        rows.append((*span, first, pieces[0], other, pieces[1], n))
    places = _Places(scene, plan, seats)
    whole = [_whole(body) for body in places.bodies]
    for (p, body), normals in planes.items():
        t = np.linspace(phases[p].t0, phases[p].t1, INSTANTS).tolist()
        far = [max(places.reach(seat[p][body], x, np.array(n)) for x in t) for n in normals]
        for other, own in enumerate(seat[p]):
            on = seats[own]["frame"]
            if on < 0 or not places.stands[on] or (p, body, other) in paired:
                continue
            gaps = [-places.reach(own, t[0], -np.array(n)) - f for n, f in zip(normals, far, strict=True)]
            n = normals[int(np.argmax(gaps))]
            rows.append((phases[p].t0, phases[p].t1, 0.0, 0.0, body, whole[body], other, whole[other], n))
    rows.sort(key=lambda row: (row[0], row[1]))
    return [
        {"t0": t0, "t1": t1, "s0": s0, "s1": s1, "bodies": [one, other], "pieces": [j, k], "normal": n}
        for t0, t1, s0, s1, one, j, other, k, n in rows
    ]

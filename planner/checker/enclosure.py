"""Whether anything begins inside something hollow, where the rows about its surface would not tell.

A mesh is covered by hulls of its triangles. While rows keep a piece off all of them, it stays on its side of the
surface; so one point of each piece is asked at each instant from which on the rows hold: at the start, when a contact
has ended, and when a part was taken or left.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker.rows import Apart
from assur.planner.checker.solids import CARRIER, CENTRE, FIRST, HALF, TURN, VERTEX, VERTICES
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.geometry.containment import inside, nothing

Box = tuple[FloatArray, FloatArray]


def enclosed(world: World, apart: Apart, between: Callable[[], None] = nothing) -> list[Finding]:
    """A finding for each pair of which one begins a phase inside the other. `between` is called between blocks of work;
    what it raises is raised here."""
    table = apart.table
    hollow = [i for i, body in enumerate(table.bodies) if body.surface is not None]
    if not hollow:
        return []
    many = len(table.bodies)
    findings, before = list[Finding](), np.zeros((len(hollow), many), dtype=np.bool_)
    boxes: dict[int, Box] = {}
    for i, phase in enumerate(apart.phases):
        if phase.t1 > phase.t0:
            now = np.zeros((len(hollow), many), dtype=np.bool_)
            for row, shell in zip(now, hollow, strict=True):
                between()
                row[:] = [apart.required(i, shell, body) for body in range(many)]
            points: dict[int, FloatArray] = {}
            for shell, new in zip(hollow, now & ~before, strict=True):
                if new.any():
                    findings += _inside(world, apart, i, shell, new, points, boxes, between)
            before = now
    return findings


def _inside(
    world: World,
    apart: Apart,
    number: int,
    shell: int,
    new: BoolArray,
    points: dict[int, FloatArray],
    boxes: dict[int, Box],
    between: Callable[[], None],
) -> list[Finding]:
    """Of the bodies `new` (B,), those of which a piece is inside the surface of a shell at the begin of a phase.
    `points`: of bodies at that time, and `boxes` round surfaces, that were found before."""
    table, t = apart.table, apart.phases[number].t0
    surface, seat, findings = table.bodies[shell].surface, int(table.seat[number, shell]), []
    if surface is None:
        return []
    between()
    # many bodies have one surface, whose vertices their scene keeps
    if id(surface[0]) not in boxes:
        boxes[id(surface[0])] = surface[0].min(0), surface[0].max(0)
    low, high = boxes[id(surface[0])]
    p, turn = world.place(int(table.seats[seat, CARRIER]), t)
    x, y, z, yaw = table.offset[seat]
    c, s = np.cos(yaw), np.sin(yaw)
    own = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    for body in np.flatnonzero(new).tolist():
        if body not in points:
            points[body] = _points(world, apart, number, body)
        local = ((points[body] - p) @ turn - (x, y, z)) @ own
        # What is outside its box is outside the surface; NaN is not outside.
        near = ~((local < low) | (local > high)).any(1)
        if near.any() and inside(surface, local[near], between).any():
            what = f"{table.bodies[body].name} begins inside {table.bodies[shell].name}"
            findings.append(Finding(Code.CONTAINMENT, what, where=f"{t:.6g} s"))
    return findings


def _points(world: World, apart: Apart, number: int, body: int) -> FloatArray:
    """A point (N, 3) of each piece of a body in the world, at the begin of a phase."""
    table = apart.table
    on = int(table.seat[number, body])
    first = int(table.seats[on, FIRST])
    rows = table.table[first : first + table.count[body]]
    at, turned = world.place(int(table.seats[on, CARRIER]), apart.phases[number].t0)
    return np.asarray(at + np.array([_point(row, table.vertices) for row in rows]) @ turned.T)


def _point(solid: FloatArray, vertices: FloatArray) -> FloatArray:
    """A point (3,) of a piece, in its carrier."""
    first, many = int(solid[VERTEX]), int(solid[VERTICES])
    local = vertices[first : first + many].mean(0) if many else np.zeros(3)
    return np.asarray(solid[CENTRE:TURN] + local @ solid[TURN:HALF].reshape(3, 3))

"""Whether anything begins inside something hollow, where the rows about its surface would not tell.

A mesh is covered by hulls of its triangles. While rows keep a piece off all of them, it stays on its side of the
surface; so one point of each piece is asked at each instant from which on the rows hold: at the start, when a contact
has ended, and when a part was taken or left.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker.rows import Apart
from assur.planner.checker.solids import CARRIER, CENTRE, FIRST, HALF, TURN, VERTEX, VERTICES
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.geometry.containment import inside


def enclosed(world: World, apart: Apart) -> list[Finding]:
    """A finding for each pair of which one begins a phase inside the other."""
    table = apart.table
    hollow = [i for i, body in enumerate(table.bodies) if body.surface is not None]
    if not hollow:
        return []
    many = len(table.bodies)
    findings, before = [], np.zeros((len(hollow), many), dtype=np.bool_)
    for i, phase in enumerate(apart.phases):
        if phase.t1 > phase.t0:
            now = np.array([[apart.required(i, shell, body) for body in range(many)] for shell in hollow])
            for shell, new in zip(hollow, now & ~before, strict=True):
                if new.any():
                    findings += _inside(world, apart, i, shell, new)
            before = now
    return findings


def _inside(world: World, apart: Apart, number: int, shell: int, new: BoolArray) -> list[Finding]:
    """Of the bodies `new` (B,), those of which a piece is inside the surface of a shell at the begin of a phase."""
    table, t = apart.table, apart.phases[number].t0
    surface, seat, findings = table.bodies[shell].surface, int(table.seat[number, shell]), []
    if surface is None:
        return []
    p, turn = world.place(int(table.seats[seat, CARRIER]), t)
    x, y, z, yaw = table.offset[seat]
    c, s = np.cos(yaw), np.sin(yaw)
    own = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    for body in np.flatnonzero(new):
        on = int(table.seat[number, body])
        first = int(table.seats[on, FIRST])
        rows = table.table[first : first + table.count[body]]
        at, turned = world.place(int(table.seats[on, CARRIER]), t)
        points = at + np.array([_point(row, table.vertices) for row in rows]) @ turned.T
        local = ((points - p) @ turn - (x, y, z)) @ own
        # What is outside its box is outside the surface; NaN is not outside.
        near = ~((local < surface[0].min(0)) | (local > surface[0].max(0))).any(1)
        if inside(surface, local[near]).any():
            what = f"{table.bodies[body].name} begins inside {table.bodies[shell].name}"
            findings.append(Finding(Code.CONTAINMENT, what, where=f"{t:.6g} s"))
    return findings


def _point(solid: FloatArray, vertices: FloatArray) -> FloatArray:
    """A point (3,) of a piece, in its carrier."""
    first, many = int(solid[VERTEX]), int(solid[VERTICES])
    local = vertices[first : first + many].mean(0) if many else np.zeros(3)
    return np.asarray(solid[CENTRE:TURN] + local @ solid[TURN:HALF].reshape(3, 3))

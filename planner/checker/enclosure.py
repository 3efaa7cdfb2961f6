"""Whether anything begins inside something hollow, where the rows about its surface would not tell.

A mesh is covered by hulls of its triangles. While rows keep a piece off all of them, it stays on its side of the
surface; so one point of each piece is asked at each instant from which on the rows hold: at the start, when a contact
has ended, and when a part was taken or left.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.cover import asked_pairs
from assur.planner.checker.ranges import Ranges
from assur.planner.checker.required import exempt
from assur.planner.checker.stage import Stage
from assur.planner.checker.verdict import Code, Finding
from assur.planner.geometry.containment import inside
from assur.planner.model.phases import Phase


def enclosed(stage: Stage, phases: tuple[Phase, ...], ranges: Ranges) -> list[Finding]:
    """A finding for each pair of which one begins a phase inside the other."""
    bodies = stage.solids.bodies
    hollow = [i for i, body in enumerate(bodies) if body.surface is not None]
    if not hollow:
        return []
    lasting = [i for i, phase in enumerate(phases) if phase.t1 > phase.t0]
    asked = asked_pairs(stage) & ~exempt(stage, phases)
    asked |= np.swapaxes(asked, 1, 2)
    findings = []
    before = np.zeros(asked.shape[1:], dtype=bool)
    for i in lasting:
        new = asked[i] & ~before
        before = asked[i]
        if new[hollow].any():
            findings += _inside(stage, phases[i], i, new, hollow, ranges)
    return findings


def _inside(
    stage: Stage, phase: Phase, number: int, new: BoolArray, hollow: list[int], ranges: Ranges
) -> list[Finding]:
    solids, t = stage.solids, np.array([phase.t0])
    position, rotation = stage.where(ranges.spline.state(t)[0], t)
    findings = []
    all_points, owners = _points(stage, number, np.flatnonzero(new[hollow].any(0)), position[0], rotation[0])
    for shell in hollow:
        surface, asked = solids.bodies[shell].surface, new[shell, owners]
        if surface is None or not asked.any():
            continue
        points, owner = all_points[asked], owners[asked]
        p, turn = _pose(stage, number, shell, position[0], rotation[0])
        local, box = (points - p) @ turn, solids.box[shell]
        # What is outside its box is outside the surface; NaN is not outside.
        near = ~(np.abs(local - solids.position[box]) > solids.half[box]).any(1)
        held = np.zeros(len(points), dtype=bool)
        held[near] = inside(surface, local[near])
        for k in np.unique(owner[held]):
            what = f"{solids.bodies[k].name} begins inside {solids.bodies[shell].name}"
            findings.append(Finding(Code.CONTAINMENT, what, where=f"{phase.t0:.6g} s"))
    return findings


def _pose(
    stage: Stage, number: int, body: int, position: FloatArray, rotation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Where a body's axes are in the world."""
    seat = stage.seat[number, body]
    carrier, (x, y, z, yaw) = stage.carrier[seat], stage.offset[seat]
    c, s = np.cos(yaw), np.sin(yaw)
    turn = rotation[carrier] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return position[carrier] + rotation[carrier] @ np.array([x, y, z]), turn


def _points(
    stage: Stage, number: int, bodies: IntArray, position: FloatArray, rotation: FloatArray
) -> tuple[FloatArray, IntArray]:
    """A point (N, 3) in the world of every piece of the bodies, and whose it is (N,)."""
    solids = stage.solids
    points, owner = [], []
    for body in bodies:
        p, turn = _pose(stage, number, int(body), position, rotation)
        for solid in range(solids.first[body], solids.first[body] + solids.count[body]):
            local = solids.position[solid]
            if solids.hull[solid] >= 0:
                local = local + solids.rotation[solid] @ solids.vertices[solids.hull[solid]].mean(0)
            points.append(p + turn @ local)
            owner.append(int(body))
    return np.array(points), np.array(owner, dtype=np.int64)

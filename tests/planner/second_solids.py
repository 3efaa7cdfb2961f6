"""Units where they are, their supports and gaps, by another way than the kernels: NumPy, from the shapes themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.collision.fcl_entry import PlacedShape
from assur.planner.collision.rows import Rows
from assur.planner.geometry.shapes import Hull
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.solids import CENTRE, ROTATION, Units
from assur.planner.kernels.solids import gap as kernel_gap
from assur.planner.kernels.solids import likely as kernel_likely
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True)
class Carriers:
    """Positions (T, K, 3) and rotations (T, K, 3, 3) of all carriers in the world at T times."""

    position: FloatArray
    rotation: FloatArray


def carriers(scene: Scene, q: FloatArray, t: FloatArray) -> Carriers:
    """Where links and frames are at times t (T,) with joints q (T, n), by the robot's and the laws' own methods."""
    links, frames = len(scene.robot.links), len(scene.frames)
    position = np.empty((len(t), links + frames, 3))
    rotation = np.zeros((len(t), links + frames, 3, 3))
    position[:, :links], rotation[:, :links] = scene.robot.placements(q)
    for k, frame in enumerate(scene.frames.values(), start=links):
        motion = frame.law.motion(t)
        position[:, k], c, s = motion.p, np.cos(motion.yaw), np.sin(motion.yaw)
        rotation[:, k, 0, 0], rotation[:, k, 0, 1] = c, -s
        rotation[:, k, 1, 0], rotation[:, k, 1, 1] = s, c
        rotation[:, k, 2, 2] = 1.0
    return Carriers(position, rotation)


def standing(trajectory: Trajectory, t: FloatArray) -> FloatArray:
    """q (T, n) at times t, the arm standing still before the first knot and after the last."""
    return trajectory.evaluate(np.clip(t, trajectory.start, trajectory.end))


def units_of(rows: Rows, column: int) -> IntArray:
    """(N,) the first units of rows (`UNIT`), or the second ones (`OTHER`), -1 for none."""
    return rows.table[:, column].astype(np.int64)


@dataclass(frozen=True)
class Placed:
    """Units `unit` (r,) of an arrangement at world centres (r, 3) with world axes (r, 3, 3), columns."""

    arrangement: Arrangement
    unit: IntArray
    centre: FloatArray
    axes: FloatArray

    def points(self, row: int) -> FloatArray:
        """Points (m, 3) of which the unit in a row is the hull, grown by its disc and its ball."""
        unit = int(self.unit[row])
        shape, axes = self.arrangement.shape(unit), self.axes[row]
        if isinstance(shape, Hull):
            local = shape.vertices - self.arrangement.offset(unit)
        else:
            signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
            local = signs * np.array(shape.half)
        found: FloatArray = self.centre[row] + local @ axes.T
        return found

    def posed(self, row: int) -> PlacedShape:
        """The shape in a row, for FCL."""
        unit = int(self.unit[row])
        with np.errstate(invalid="ignore"):  # some poses are none on purpose
            position = self.centre[row] - self.axes[row] @ self.arrangement.offset(unit)
        name = self.arrangement.names[self.arrangement.body[unit]]
        return PlacedShape(name, self.arrangement.shape(unit), position, self.axes[row])


def place(arrangement: Arrangement, where: Carriers, row: IntArray, unit: IntArray) -> Placed:
    """Units `unit` (r,) at the times number `row` (r,) of `where`."""
    carrier = arrangement.carrier[unit]
    turn = where.rotation[row, carrier]
    inside = arrangement.rows[unit][:, CENTRE : CENTRE + 3]
    axes = arrangement.rows[unit][:, ROTATION : ROTATION + 9].reshape(-1, 3, 3)
    centre = where.position[row, carrier] + np.einsum("rij,rj->ri", turn, inside)
    return Placed(arrangement, unit, centre, turn @ axes)


def support(placed: Placed, n: FloatArray) -> FloatArray:
    """max over the unit of n·(x - centre), (r, N), for directions n (r, N, 3)."""
    found = np.empty(n.shape[:2])
    for row, unit in enumerate(placed.unit):
        shape = placed.arrangement.shape(int(unit))
        points = placed.points(row) - placed.centre[row]
        found[row] = (n[row] @ points.T).max(-1)
        if not isinstance(shape, Hull):
            across = n[row] @ placed.axes[row][:, :2]
            found[row] += shape.disc * np.linalg.norm(across, axis=-1) + shape.ball
    return found


def gaps(a: Placed, b: Placed, n: FloatArray) -> FloatArray:
    """Gap (r, N) along unit normals n (r, N, 3) that point from a to b (C1)."""
    between: FloatArray = np.einsum("rni,ri->rn", n, b.centre - a.centre)
    found: FloatArray = between - support(a, n) - support(b, -n)
    return found


def tables(a: Placed, b: Placed, row: int) -> tuple[Units, int, int]:
    """Rows, vertices and places (1, U, 12), and units of the pair in a row, as the kernels want them."""
    placed = np.full((1, len(a.arrangement.rows), 12), np.nan)
    for each in (a, b):
        placed[0, each.unit[row], :3], placed[0, each.unit[row], 3:] = each.centre[row], each.axes[row].ravel()
    return (a.arrangement.rows, a.arrangement.bodies.vertices, placed), int(a.unit[row]), int(b.unit[row])


def kernel_gaps(a: Placed, b: Placed, n: FloatArray) -> FloatArray:
    """`gaps` by the kernel."""
    found = np.empty(n.shape[:2])
    for row in range(len(n)):
        units, i, j = tables(a, b, row)
        found[row] = [kernel_gap(units, 0, i, j, tuple(normal)) for normal in n[row].tolist()]
    return found


def likely(a: Placed, b: Placed, row: int = 0, enough: float = np.inf) -> tuple[float, FloatArray]:
    """The kernel's largest gap along the likely normals, and the normal."""
    units, i, j = tables(a, b, row)
    found, normal = kernel_likely(units, 0, i, j, enough)
    return found, np.array(normal)


def distance_by_gjk(a: Placed, b: Placed, row: int = 0) -> tuple[float, FloatArray, float]:
    """The kernel's gap along the best normal, that normal, and a length that the distance is not above."""
    units, i, j = tables(a, b, row)
    found, normal, above = separate(
        units, 0, i, j, np.inf, np.empty((0, 1)), -1, 0.0, np.empty((4, 3)), np.empty((3, 4))
    )
    return found, np.array(normal), above

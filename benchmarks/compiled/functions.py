"""Single functions and methods of the planner with a kernel inside: same arguments, same answers."""

from __future__ import annotations

import numpy as np

from benchmarks.compiled import curves, gjk, hermite, placing
from benchmarks.compiled.bounding import arm_bounds, curve, swept, tables
from benchmarks.compiled.control import inside as of_spline
from benchmarks.compiled.packing import FALLBACKS, arm_row, cell, units
from planner import gjk as planner_gjk
from planner import solids as planner_solids
from planner import tool_motion
from planner.arrays import FloatArray, IntArray
from planner.checker.spline import Spline
from planner.errors import FaultError
from planner.frames.motion import Motion
from planner.robots.protocol import Sweep
from planner.robots.scara import FLANGE, Scara
from planner.scene import Scene
from planner.separation import Placed
from planner.solids import Carriers
from planner.timing.sketch import Sketch
from planner.trajectory import Trajectory, extremum

_carriers, _separate, _tool_peak = planner_solids.carriers, planner_gjk.separate, tool_motion.tool_peak
_placements, _link_motion = Scara.placements, Scara.link_motion


def carriers(scene: Scene, q: FloatArray, t: FloatArray) -> Carriers:
    known = cell(scene)
    if known is None:
        FALLBACKS["carriers"] += 1
        return _carriers(scene, q, t)
    return Carriers(*placing.everywhere(known.arm, known.laws, np.ascontiguousarray(q), np.ascontiguousarray(t)))


def placements(self: Scara, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    if q.ndim == 1:
        position, rotation = placing.placements(arm_row(self), q[None])
        return position[0], rotation[0]
    return placing.placements(arm_row(self), np.ascontiguousarray(q)) if q.ndim == 2 else _placements(self, q)


def link_motion(self: Scara, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
    if link != FLANGE or q.ndim != 2:
        FALLBACKS["link motion"] += 1
        return _link_motion(self, link, q, qd, qdd, qddd)
    out, yaw = placing.flanges(arm_row(self), *(np.ascontiguousarray(x) for x in (q, qd, qdd, qddd)))
    return Motion(out[0], out[1], out[2], out[3], yaw[0], yaw[1], yaw[2], yaw[3])


def point_bounds(
    self: Scara, link: IntArray, reach: FloatArray, _distance: FloatArray, n: FloatArray, sweep: Sweep, /
) -> tuple[FloatArray, FloatArray]:
    rates = (np.ascontiguousarray(x) for x in (sweep.rate, sweep.rate_d))
    return arm_bounds(arm_row(self), link, reach, np.ascontiguousarray(n), *rates)


def sketched(self: Sketch, t: FloatArray) -> FloatArray:
    begins, rows = self._columns
    return curves.sketched(begins, rows, self.duration, np.ascontiguousarray(t))


def span(pieces: FloatArray) -> tuple[FloatArray, FloatArray]:
    lower, upper = curves.extremes(pieces, extremum.TIGHTNESS, extremum.ROUNDS)
    if not (np.isfinite(lower) & np.isfinite(upper)).all():
        raise FaultError("extrema of polynomial pieces did not close, or coefficients are not finite")
    return lower, upper


def hulls(h: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> tuple[FloatArray, ...]:
    return hermite.hulls(h, q, qd, qdd)


def powers(h: FloatArray, q: FloatArray, qd: FloatArray, hull: tuple[FloatArray, ...]) -> FloatArray:
    return hermite.powers(h, q, qd, hull[2], hull[3])


def evaluate(self: Trajectory, t: FloatArray | float, derivative: int = 0) -> FloatArray:
    way, t = curve(self), np.asarray(t, dtype=np.float64)
    flat = np.ascontiguousarray(t.reshape(-1))
    return hermite.values(way.edges, way.c, way.ends, flat, derivative).reshape(*t.shape, self.n)


def sweep(trajectory: Trajectory, t0: FloatArray, t1: FloatArray, rate_matrix: FloatArray) -> Sweep:
    if not (t0.ndim == 1 and t0.shape == t1.shape and rate_matrix.shape[1] == trajectory.n and (t0 <= t1).all()):
        raise FaultError("sweep over intervals or with rates that do not fit")
    way, rates, (m, n) = curve(trajectory), rate_matrix.copy(), rate_matrix.shape
    made = tables(np.diff(way.edges), *way.hulls, rates)
    rests = trajectory.rest_at_start, trajectory.rest_at_end
    bound = swept(way.edges, way.c, *made, rates, rests, np.ascontiguousarray(t0), np.ascontiguousarray(t1))
    return Sweep(-bound[:, 2 * m + n :], bound[:, 2 * m : 2 * m + n], bound[:, :m], bound[:, m : 2 * m])


def tool_peak(scene: Scene, trajectory: Trajectory, t0: float, t1: float) -> tuple[float, float]:
    known = cell(scene)
    if known is None:
        FALLBACKS["tool peak"] += 1
        return _tool_peak(scene, trajectory, t0, t1)
    way, tcp = curve(trajectory), scene.tool.tcp
    t = np.linspace(t0, t1, max(2, int(np.ceil((t1 - t0) / tool_motion.STEP_S)) + 1))
    pull, when = curves.pulled(way.edges, way.c, way.ends, known.arm, np.array([tcp.x, tcp.y]), t)
    return float(pull), float(when)


def separate(a: Placed, b: Placed, row: int) -> tuple[float, FloatArray | None]:
    packed, normal = units(a.solids), np.empty(3)
    one, other = np.empty((2, 12))
    for at, placed in ((one, a), (other, b)):
        at[:3], at[3:] = placed.centre[row], placed.axes[row].ravel()
    found = gjk.distance(
        packed.number, packed.table, packed.vertices, int(a.unit[row]), one, int(b.unit[row]), other, normal
    )
    return (0.0, None) if found < 0 else (found, normal)


def inside(self: Spline, piece: IntArray, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    return of_spline(*self.control, piece, np.ascontiguousarray(s))

"""The checker's rows in one kernel: gaps and bounds of every row anew, and whether it is true and proves what is asked.

Where a row is not right the original is asked for the findings: the kernel says only that all are.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.compiled.bounding import bound
from benchmarks.compiled.control import joints, over, parts, sweeps
from benchmarks.compiled.door import kernel
from benchmarks.compiled.packing import FALLBACKS, cell
from benchmarks.compiled.placing import frame, links
from benchmarks.compiled.separating import least
from planner.arrays import BoolArray, FloatArray, IntArray
from planner.checker.ranges import Ranges
from planner.checker.required import required
from planner.checker.rows import Rows
from planner.checker.spline import Spline
from planner.checker.stage import Stage
from planner.checker.verdict import Finding
from planner.outcome import Certificate
from planner.phases import Phase
from planner.requirement import is_certain
from planner.robots.protocol import Sweep

of_rows: Any = import_module("planner.checker.rows")
of_ranges: Any = import_module("planner.checker.ranges")
original: Any = getattr(of_rows, "proved", None)
"""What it is put in the place of, as it was when this was imported."""

GAP0, GAP1, SPEED, ACCELERATION, LEAST, ASKED = range(6)
"""Columns of the numbers of a row."""


@kernel
def support(
    table: FloatArray, seat: FloatArray, position: FloatArray, rotation: FloatArray, x: float, y: float, z: float
) -> float:
    """max of n·x in the world over a solid: `table` (18,) position, rotation, half, disc, ball; `seat` (4,)."""
    p = x * rotation[0, 0] + y * rotation[1, 0] + z * rotation[2, 0]
    q = x * rotation[0, 1] + y * rotation[1, 1] + z * rotation[2, 1]
    r = x * rotation[0, 2] + y * rotation[1, 2] + z * rotation[2, 2]
    c, s = np.cos(seat[3]), np.sin(seat[3])
    found = x * position[0] + y * position[1] + z * position[2] + (p * seat[0] + q * seat[1] + r * seat[2])
    p, q = c * p + s * q, c * q - s * p
    u = p * table[3] + q * table[6] + r * table[9]
    v = p * table[4] + q * table[7] + r * table[10]
    w = p * table[5] + q * table[8] + r * table[11]
    inside = p * table[0] + q * table[1] + r * table[2]
    inside += abs(u) * table[12] + abs(v) * table[13] + abs(w) * table[14]
    inside += table[15] * np.hypot(u, v)
    return float(found + (inside + table[16] * np.sqrt(u * u + v * v + w * w)))


@kernel
def examined(
    time: FloatArray,
    length: FloatArray,
    controls: tuple[FloatArray, FloatArray, FloatArray],
    part: tuple[IntArray, FloatArray, FloatArray, FloatArray, FloatArray],
    rests: bool,
    arm: FloatArray,
    laws: FloatArray,
    seats: FloatArray,
    table: FloatArray,
    one: IntArray,
    other: IntArray,
    solid_a: IntArray,
    solid_b: IntArray,
    reach_a: FloatArray,
    reach_b: FloatArray,
    n: FloatArray,
    t0: FloatArray,
    t1: FloatArray,
    clearance: FloatArray,
    slack: float,
    claims: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> FloatArray:
    """(N, 6) by the columns above; `seats` (S, 5): offset, carrier."""
    c0, c1, c2 = controls
    piece_of, begins, ends, top, standing = part
    joint, m = c0.shape[1], c1.shape[1]
    out = np.empty((len(t0), 6))
    swept, q = np.empty(top.shape[1]), np.empty(joint)
    carriers = 5 + len(laws)
    position, rotation = np.empty((2, carriers, 3)), np.empty((2, carriers, 3, 3))
    for i in range(len(t0)):
        if i == 0 or t0[i] != t0[i - 1] or t1[i] != t1[i - 1]:
            # many rows that follow each other share an interval
            over(time, length, c0, c1, c2, piece_of, begins, ends, top, standing, rests, t0[i], t1[i], swept)
            for end in range(2):
                t = t0[i] if end == 0 else t1[i]
                joints(time, length, c0, t, q)
                links(arm, q, position[end], rotation[end])
                for k in range(len(laws)):
                    frame(laws[k], t, position[end, 5 + k], rotation[end, 5 + k], False)
        rate, rate_d = swept[2 * joint : 2 * joint + m], swept[2 * joint + m :]
        x, y, z = n[i, 0], n[i, 1], n[i, 2]
        a, b = one[i], other[i]
        ka, kb = int(seats[a, 4]), int(seats[b, 4])
        for end in range(2):
            out[i, end] = -support(
                table[solid_a[i]], seats[a], position[end, ka], rotation[end, ka], x, y, z
            ) - support(table[solid_b[i]], seats[b], position[end, kb], rotation[end, kb], -x, -y, -z)
        v_a, m_a = bound(arm, laws, ka, reach_a[i], x, y, z, t0[i], t1[i], rate, rate_d)
        v_b, m_b = bound(arm, laws, kb, reach_b[i], x, y, z, t0[i], t1[i], rate, rate_d)
        out[i, SPEED], out[i, ACCELERATION] = v_a + v_b, m_a + m_b
        g0, g1 = least(out[i, GAP0], claims[0][i]), least(out[i, GAP1], claims[1][i])
        v, a_, h = max(out[i, SPEED], claims[2][i]), max(out[i, ACCELERATION], claims[3][i]), t1[i] - t0[i]
        first, second = (g0 + g1 - v * h) / 2, least(g0, g1) - a_ * h**2 / 8
        out[i, LEAST] = (first if (first >= second or second != second) else second) - slack
        out[i, ASKED] = clearance[i] if ka < 5 or kb < 5 else -np.inf
    return out


@dataclass(frozen=True, eq=False)
class _Known:
    """The stage for the kernel."""

    seats: FloatArray
    table: FloatArray


def _known(stage: Stage) -> _Known:
    solids = stage.solids
    seats = np.concatenate([stage.offset, stage.carrier[:, None].astype(np.float64)], 1)
    columns = [solids.position, solids.rotation.reshape(-1, 9), solids.half, solids.disc[:, None], solids.ball[:, None]]
    return _Known(seats, np.concatenate(columns, 1))


def numbers(
    stage: Stage, phases: tuple[Phase, ...], certificate: Certificate, rows: Rows, ranges: Ranges
) -> FloatArray | None:
    """What the kernel finds of each row; None: it cannot say."""
    scene = stage.scene
    known, execution = cell(scene), scene.execution
    certain = is_certain(scene) and execution.tracking_m == 0 and execution.start_tolerance_s == 0
    plain = not any(phase.exempt for phase in phases) and not len(stage.solids.vertices)
    if known is None or not len(rows) or not (certain and plain):
        return None
    i, solids, line = rows.number, stage.solids, ranges.spline
    seats = [stage.seat[rows.phase, body] for body in (rows.first, rows.second)]
    pieces = (rows.first_piece, rows.second_piece)
    solid = [solids.of(stage.body[seat], piece) for seat, piece in zip(seats, pieces, strict=True)]
    reach = [
        stage.reaches[stage.reach_at[seat] + np.where(piece < 0, solids.count[stage.body[seat]], piece)]
        for seat, piece in zip(seats, pieces, strict=True)
    ]
    asked = scene.options.clearance
    clearance = np.array([asked.near_m if phase.near else asked.travel_m for phase in phases], dtype=np.float64)
    packed, c, (q, qd, qdd) = _known(stage), certificate, ranges.controls
    return examined(
        line.time, line.length, (q, qd, qdd), (ranges.piece, ranges.t0, ranges.t1, ranges.top, standing(ranges)),
        line.at_rest, known.arm, known.laws, packed.seats, packed.table, seats[0], seats[1],
        solid[0], solid[1], reach[0], reach[1], c.normal[i],
        rows.t0, rows.t1, clearance[rows.phase], of_rows.SLACK_M, (c.gap0[i], c.gap1[i], c.speed[i], c.acceleration[i]),
    )  # fmt: skip


def numbers_of_the_original(
    stage: Stage, phases: tuple[Phase, ...], certificate: Certificate, rows: Rows, ranges: Ranges
) -> FloatArray:
    """The same by the checker's own functions, to compare with."""
    c, i, n = certificate, rows.number, certificate.normal[rows.number]
    seats = [stage.seat[rows.phase, body] for body in (rows.first, rows.second)]
    pieces = [rows.first_piece, rows.second_piece]
    swept = ranges.sweep(rows.t0, rows.t1)
    bounds = [stage.bounds(seats[k], pieces[k], n, rows.t0, rows.t1, swept) for k in (0, 1)]
    speed, acceleration = bounds[0][0] + bounds[1][0], bounds[0][1] + bounds[1][1]
    gap0, gap1 = of_rows._gaps(stage, ranges, seats, pieces, n, rows)
    g0, g1, h = np.minimum(gap0, c.gap0[i]), np.minimum(gap1, c.gap1[i]), rows.t1 - rows.t0
    v, m = np.maximum(speed, c.speed[i]), np.maximum(acceleration, c.acceleration[i])
    low = np.fmax((g0 + g1 - v * h) / 2, np.minimum(g0, g1) - m * h**2 / 8) - of_rows.SLACK_M
    return np.stack([gap0, gap1, speed, acceleration, low, required(stage, phases, rows, n)], -1)


def proved(
    stage: Stage, phases: tuple[Phase, ...], certificate: Certificate, rows: Rows, ranges: Ranges
) -> tuple[BoolArray, list[Finding]]:
    found = numbers(stage, phases, certificate, rows, ranges)
    if found is not None:
        c, i = certificate, rows.number
        n = c.normal[i]
        true = np.abs(np.sqrt((n * n).sum(1)) - 1.0) <= of_rows.UNIT_NORMAL
        true &= (c.gap0[i] <= found[:, GAP0] + of_rows.GAP_M) & (c.gap1[i] <= found[:, GAP1] + of_rows.GAP_M)
        true &= c.speed[i] >= found[:, SPEED] * (1 - of_rows.BOUND) - of_rows.SPEED_FLOOR
        true &= c.acceleration[i] >= found[:, ACCELERATION] * (1 - of_rows.BOUND) - of_rows.ACCELERATION_FLOOR
        if (true & (found[:, LEAST] >= found[:, ASKED])).all():
            return np.ones(len(rows), dtype=bool), []
    FALLBACKS["checker rows"] += 1
    answer: tuple[BoolArray, list[Finding]] = original(stage, phases, certificate, rows, ranges)
    return answer


def standing(ranges: Ranges) -> FloatArray:
    last = ranges.spline.control[0][-1, :, -1]
    return np.concatenate([last, -last, np.zeros(2 * len(ranges.combinations))])


def ranges(line: Spline, combinations: FloatArray) -> Ranges:
    controls = (line.control[0], combinations @ line.control[1], combinations @ line.control[2])
    piece, s0, s1, top = parts(*controls, of_ranges.TIGHT, of_ranges.ROUNDS, of_ranges.CLOSEST)
    t0 = line.time[piece] + s0 * line.length[piece]
    t1 = np.where(s1 == 1.0, line.time[piece + 1], line.time[piece] + s1 * line.length[piece])
    return Ranges(line, combinations, controls, piece, t0, t1, top)


def sweep(self: Ranges, t0: FloatArray, t1: FloatArray) -> Sweep:
    line, n = self.spline, self.controls[0].shape[1]
    m, (q, qd, qdd) = len(self.combinations), self.controls
    top = sweeps(
        line.time, line.length, q, qd, qdd, self.piece, self.t0, self.t1, self.top, standing(self), line.at_rest,
        np.ascontiguousarray(t0), np.ascontiguousarray(t1),
    )  # fmt: skip
    return Sweep(-top[:, n : 2 * n], top[:, :n], top[:, 2 * n : 2 * n + m], top[:, 2 * n + m :])

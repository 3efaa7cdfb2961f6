"""Arms and laws of frames as tables, from the numbers of the request: `assur.planner.checker.motion` says the columns.

A law is polynomials in time, piece after piece, over the time that matters: ramps of belts and dials (R1), moves of an
indexer (F3), splines through keyframes (F5), all by their control values (V1). What repeats is given for one period.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import motion
from assur.planner.checker.motion import CONTROL, FRAME, NEIGHBOUR, PIECE, POLYNOMIAL, SWING, WIDTH, Tables
from assur.planner.checker.spline import COLUMNS, JOINT, JOINTS, ROOM, curve
from assur.planner.errors import FaultError
from assur.planner.laws import Law
from assur.planner.laws.ramps import Change
from assur.planner.model.scene import Scene
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.trajectory import Trajectory

Way = tuple[float, float, Sequence[float]]
"""Begin, end, and the coefficients of the powers of the time since the begin."""
Piece = tuple[float, float, Sequence[Sequence[float]]]
"""The same of x, y, z and yaw."""
HALF_ULP = 2.0**-53
"""By so much of itself a number rounds."""
ROUNDINGS = 16
"""By how many roundings of V T the place of what is on a frame may be off: V is its greatest speed, T how long its
table spans, from the instant at which the law is stated on. A turn or a travel is a product with a time (3 roundings:
time, product, sum with where it begins), minus what it was when it is stated (2), its control values (2), a time as a
share of the piece (2), a cut between two of them (3), a sine and a product with the reach (1); and how long ramps last,
and how fast they become, rounds by 3 of their own way."""
SHIFT_ROUNDINGS = 2
"""The same of V and the time since time zero: the end of a ramp is a sum of times, and so is a time that is shifted."""


def tables(scene: Scene, trajectory: Trajectory, begin: float, until: float) -> Tables:
    """The tables of a scene and a plan's trajectory, without solids; laws of frames from `begin` to `until`, s."""
    moved: list[tuple[Robot, Trajectory]] = [(scene.robot, trajectory)]
    frames, found = np.zeros((len(scene.frames), FRAME)), list[Piece]()
    for row, frame in zip(frames, scene.frames.values(), strict=True):
        law = frame.law
        if law.link is not None:
            row[: motion.PERIOD] = NEIGHBOUR, *law.valid, len(moved), law.link.link, np.nan
            moved.append((law.link.robot, law.link.trajectory))
            continue
        own = _pieces(law, begin, until)
        degree = max(len(powers) for _, _, coordinates in own for powers in coordinates) - 1
        row[: motion.PERIOD] = POLYNOMIAL, *law.valid, len(found), len(own), degree
        if law.kind in ("swing", "oscillation"):
            row[motion.KIND], row[motion.MEAN], row[motion.AMPLITUDE :] = SWING, law.numbers.pose.yaw, _sway(law)
        if law.kind == "indexer" or (law.kind == "keyframes" and law.numbers.ends == "periodic"):
            row[motion.PERIOD : motion.MEAN] = _again(law)
        found += own
    pieces = np.zeros((len(found), PIECE))
    for row, (begin, end, coordinates) in zip(pieces, found, strict=True):
        row[:CONTROL] = begin, end
        for k, powers in enumerate(coordinates):
            row[CONTROL + k * WIDTH : CONTROL + k * WIDTH + len(powers)] = powers
    motion.control(frames, pieces)
    curves = np.zeros((sum(len(path.time) for _, path in moved), COLUMNS))
    arms, at = [], 0
    for robot, path in moved:
        curve(np.array(path.knots, order="C"), path.n, at, curves)
        arms.append(arm_row(robot, at, at + len(path.time) - 1))
        at += len(path.time)
    return np.array(arms), curves, frames, pieces, np.zeros((0, 1)), np.zeros((0, 3))


def rounding(tables: Tables, reaches: FloatArray, begin: float, until: float) -> FloatArray:
    """Upper bounds (F,), m, of what rounding does from `begin` to `until`, s, to places on each frame, for points
    within `reaches` (F,), m, of its vertical axis (docs/guarantees.md, "Rounding")."""
    frames, pieces, found = tables[2], tables[3], np.zeros(len(tables[2]))
    for f, (row, reach) in enumerate(zip(frames, reaches.tolist(), strict=True)):
        if int(row[motion.KIND]) == NEIGHBOUR:
            speed = _link_speed(tables, int(row[motion.FIRST]), reach)
            found[f] = HALF_ULP * speed * SHIFT_ROUNDINGS * max(abs(begin), abs(until))
            continue
        first, degree = int(row[motion.FIRST]), int(row[motion.DEGREE])
        if degree == 0:
            continue  # it stands still
        own = pieces[first : first + int(row[motion.COUNT])]
        lasts = own[:, motion.END] - own[:, motion.BEGIN]
        control = own[:, CONTROL:].reshape(-1, 4, WIDTH)[:, :, : degree + 1]
        rates = degree * np.abs(np.diff(control, axis=2)).max(axis=2, initial=0.0) / lasts[:, None]
        x, y, z, turning = rates.max(axis=0)
        if int(row[motion.KIND]) == SWING:
            x, y, z, turning = (turning * np.abs(row[motion.AMPLITUDE : motion.AMPLITUDE + 4])).tolist()
        times = np.array([begin, until, own[:, motion.BEGIN].min(), own[:, motion.END].max()])
        late, span = float(np.abs(times).max()), float(times.max() - times.min())
        if int(row[motion.KIND]) == SWING:
            span = late  # its angle counts from time zero
        found[f] = HALF_ULP * (math.hypot(x, y, z) + reach * turning) * (ROUNDINGS * span + SHIFT_ROUNDINGS * late)
    return found


def _link_speed(tables: Tables, arm: int, reach: float) -> float:
    """An upper bound of the speed, m/s, of a point that reaches so far from a link of an arm of the tables: each joint
    counts as if it turned all of the arm, and travelled as well."""
    row, curves = tables[0][arm], tables[1]
    of_arm = curves[int(row[motion.FIRST_KNOT]) : int(row[motion.LAST_KNOT]) + 1, 1:].reshape(-1, JOINTS, JOINT)
    rates = np.abs(of_arm[:, : int(row[motion.AXIS_COUNT]), ROOM : 2 * ROOM]).max(axis=(0, 2))
    bends = np.abs(of_arm[:, :, 0:ROOM]).max()  # how far a joint travels makes an arm longer
    return float(rates.sum()) * (1.0 + reach + float(np.abs(row[motion.NUMBERS :]).sum() + bends))


def arm_row(robot: Robot, first: int = 0, last: int = 0) -> list[float]:
    """A row of the table of arms, with the first and last knot of its trajectory."""
    family, numbers = motion.SCARA, list[float]()
    if isinstance(robot, Scara):
        numbers = [robot.l1, robot.l2, float(robot.arms_rise)]
    elif isinstance(robot, FiveAxisArm):
        family, numbers = motion.FIVE_AXIS, [robot.height, robot.l1, robot.l2, robot.l3]
    elif isinstance(robot, ElbowArm):
        family, numbers = motion.ELBOW, [robot.height, robot.l1, robot.l2]
    elif isinstance(robot, PolarArm):
        family, numbers = motion.POLAR, [robot.height]
    elif isinstance(robot, FiveBar):
        side = 1.0 if robot.assembly == "front" else -1.0
        family, numbers = motion.FIVE_BAR, [robot.separation, *robot.proximal, *robot.distal, side]
    else:
        raise FaultError(f"the checker does not know the kinematics of {robot.name}")
    base = robot.base
    own = [family, len(robot.joints), first, last, base.x, base.y, base.z, base.yaw, len(robot.links), *numbers]
    return own + [0.0] * (motion.ARM - len(own))


def _pieces(law: Law, start: float, until: float) -> list[Piece]:
    """The pieces of a law over [start, until] at least, or as far as it is known."""
    if law.kind == "keyframes":
        return spline_of(law)
    pose = law.numbers.pose
    x, y, z, yaw = pose.x, pose.y, pose.z, pose.yaw
    if law.kind == "fixed":
        return [(start, until, ((x,), (y,), (z,), (yaw,)))]
    if law.kind in ("swing", "oscillation"):
        w = 2.0 * math.pi / law.numbers.period
        return [(start, until, ((x,), (y,), (z,), (w * start + law.numbers.phase, w)))]
    if law.kind == "linear":
        u, v, w = law.numbers.velocity
        begin, end = min(start, law.numbers.at_time), max(until, law.numbers.at_time)
        gone = begin - law.numbers.at_time
        return [(begin, end, ((x + u * gone, u), (y + v * gone, v), (z + w * gone, w), (yaw,)))]
    if law.kind == "turntable":
        ways = ramped(law.numbers.rate, law.numbers.changes, law.numbers.at_time, start, until)
        rise = law.numbers.rise
        return [
            (begin, end, ((x,), (y,), (z + rise * (begin - law.numbers.at_time), rise), (yaw + s[0], *s[1:])))
            for begin, end, s in ways
        ]
    if law.kind == "conveyor":
        ways = ramped(law.numbers.speed, law.numbers.changes, law.numbers.at_time, start, until)
    elif law.kind == "indexer":
        ways = _indexed(law)
        if law.numbers.turns:
            return [(begin, end, ((x,), (y,), (z,), (yaw + s[0], *s[1:]))) for begin, end, s in ways]
    else:
        raise FaultError(f"the checker does not know the law {law.kind}")
    c, s_ = math.cos(yaw), math.sin(yaw)
    return [
        (begin, end, ((x + c * s[0], *(c * a for a in s[1:])), (y + s_ * s[0], *(s_ * a for a in s[1:])), (z,), (yaw,)))
        for begin, end, s in ways
    ]


def travel(law: Law, start: float, until: float) -> list[Way]:
    """How far a belt, or what goes along a line, has gone since its `at_time`, m, in its direction of travel: pieces
    that cover [start, until] at least. The last one goes on for ever, as far as the law is known."""
    if law.kind == "conveyor":
        return ramped(law.numbers.speed, law.numbers.changes, law.numbers.at_time, start, until)
    speed = math.hypot(*law.numbers.velocity)
    return [(start, until, [speed * (start - law.numbers.at_time), speed])]


def ramped(speed: float, changes: tuple[Change, ...], at_time: float, start: float, until: float) -> list[Way]:
    """The travel with changes of speed (R1), 0 at `at_time`: begin, end and coefficients of each piece.

    How long a piece lasts follows from the numbers of the request, not from its ends, which round as times do; and what
    was gone by is summed with what each sum leaves over (Neumaier): errors of thousands of changes would add up."""
    edges: list[tuple[float, float, float, float]] = [(-math.inf, speed, 0.0, 0.0)]
    marks = [(0.0, 0.0)]
    for change in changes:
        past, delta = 0.0, abs(change.speed - speed)
        if delta > 0.0:
            rise = min(change.acceleration / change.jerk, math.sqrt(delta / change.jerk))
            sign = math.copysign(1.0, change.speed - speed)
            reached = min(change.acceleration, math.sqrt(delta * change.jerk))
            parts = [(rise, 0.0, change.jerk), (delta / reached - rise, reached, 0.0), (rise, reached, -change.jerk)]
            for lasts, a, j in parts:
                if lasts > 0.0:
                    edges.append((change.time + past, speed, sign * a / 2.0, sign * j / 6.0))
                    marks.append((change.time, past))
                    speed += sign * (a * lasts + j * lasts**2 / 2.0)
                    past += lasts
            edges.append((change.time + past, change.speed, 0.0, 0.0))
            marks.append((change.time, past))
        speed = change.speed
    anchor = edges[1][0] if len(edges) > 1 else at_time
    gone, total, rest, found = 0.0, 0.0, 0.0, list[Way]()
    for k, (time, v, a, j) in enumerate(edges):
        begin, end = (anchor if k == 0 else time), (edges[k + 1][0] if k + 1 < len(edges) else math.inf)
        if k == 0 or end == math.inf:
            first = min(start, at_time, anchor) if k == 0 else begin
            last = max(until, at_time, begin) if end == math.inf else end
            found.append((first, last, [gone + v * (first - begin), v]))
        else:
            found.append((begin, end, [gone, v, a, j]))
        if k > 0 and end < math.inf:
            (base, past), (following, then) = marks[k : k + 2]
            h = (following - base) + (then - past)
            before, term = total, h * (v + h * (a + h * j))
            total = before + term
            rest += (before - total) + term if abs(before) >= abs(term) else (term - total) + before
            gone = total + rest
    at = next(piece for piece in found if piece[0] <= at_time <= piece[1])
    zero = float(np.polynomial.polynomial.polyval(at_time - at[0], at[2]))
    return [(begin, end, [c[0] - zero, *c[1:]]) for begin, end, c in found if end > begin]


def _indexed(law: Law) -> list[Way]:
    """The move and the dwell of an indexer (F3)."""
    of, powers = law.numbers, [0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0]
    end = of.start + of.move_s
    move = (of.start, end, [of.step * c / of.move_s**k for k, c in enumerate(powers)])
    return [move, (end, end + of.dwell_s, [of.step])] if end + of.dwell_s > end else [move]


def _sway(law: Law) -> tuple[float, float, float, float]:
    """By how much x, y, z and yaw go to either side (F4, F8)."""
    if law.kind == "swing":
        return 0.0, 0.0, 0.0, law.numbers.amplitude
    u, v, w = law.numbers.direction
    share = law.numbers.amplitude / math.sqrt(u * u + v * v + w * w)
    return share * u, share * v, share * w, 0.0


def _again(law: Law) -> tuple[float, float, float, float, float]:
    """After how long a law repeats, and by how much x, y, z and yaw have gone on then (F3, F9)."""
    if law.kind == "keyframes":
        return float(law.numbers.times[-1] - law.numbers.times[0]), 0.0, 0.0, 0.0, _turn(law)
    lasts, step, yaw = law.numbers.move_s + law.numbers.dwell_s, law.numbers.step, law.numbers.pose.yaw
    if law.numbers.turns:
        return lasts, 0.0, 0.0, 0.0, step
    return lasts, step * math.cos(yaw), step * math.sin(yaw), 0.0, 0.0


def _turn(law: Law) -> float:
    """By how much the yaw of keyframes that repeat goes on in a period: whole turns."""
    return 2.0 * math.pi * round((law.numbers.poses[-1].yaw - law.numbers.poses[0].yaw) / (2.0 * math.pi))


def spline_of(law: Law) -> list[Piece]:
    """The cubic spline through keyframes (F5, F9), by the velocities v that make its acceleration continuous (F10):
    v_(i-1)/h_(i-1) + 2 v_i (1/h_(i-1) + 1/h_i) + v_(i+1)/h_i = 3 (d_(i-1)/h_(i-1) + d_i/h_i), d the mean velocities;
    at both ends it is at rest, or does not accelerate, or the last piece is the one before the first."""
    t, x = np.asarray(law.numbers.times), np.array([(p.x, p.y, p.z, p.yaw) for p in law.numbers.poses])
    repeats, many = law.numbers.ends == "periodic", len(t)
    if repeats:
        x[-1, 3] = x[0, 3] + _turn(law)
    h = np.diff(t)
    d = np.diff(x, axis=0) / h[:, None]
    matrix, right = np.zeros((many, many)), np.zeros((many, 4))
    for i in range(0 if repeats else 1, many - 1):
        # the piece before the first is the last, and begins at the last but one of the poses
        for piece, other in ((i - 1, i - 1 if i > 0 else many - 2), (i, i + 1)):
            matrix[i, other] += 1.0 / h[piece]
            matrix[i, i] += 2.0 / h[piece]
            right[i] += 3.0 * d[piece] / h[piece]
    if repeats:
        matrix[-1, 0], matrix[-1, -1] = 1.0, -1.0
    for i, inner, mean in () if repeats else ((0, 1, d[0]), (many - 1, many - 2, d[-1])):
        matrix[i, i] = 1.0
        if law.numbers.ends == "natural":
            matrix[i, i], matrix[i, inner], right[i] = 2.0, 1.0, 3.0 * mean
    v = np.linalg.solve(matrix, right)
    found: list[Piece] = []
    for i in range(many - 1):
        a = (3.0 * d[i] - 2.0 * v[i] - v[i + 1]) / h[i]
        b = (v[i] + v[i + 1] - 2.0 * d[i]) / h[i] ** 2
        found.append((float(t[i]), float(t[i + 1]), np.stack([x[i], v[i], a, b], -1).tolist()))
    return found

"""The eight kinds of laws: each turns the numbers of the request into pieces, sines and a period.

Each raises `InputError` naming the number that is not allowed. Equations F1 to F5, F8 and F9 of docs/kinematics.md.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray, frozen
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws.law import Ends, Law, Numbers, Piece, Repeat, tables
from assur.planner.laws.ramps import Change, ramped
from assur.planner.laws.validity import ALWAYS, FURTHEST_S, RANGES, SHORTEST_S, float_in, interval, placed

# The cubic spline through poses.

WHOLE_TURN_RAD = 1e-12
"""By how much the yaw of a period may miss whole turns, rad: rounding of an angle written in degrees."""


def whole_turns(poses: Sequence[Pose]) -> float:
    """By how much the yaw goes on from the first pose to the last, rad: exact whole turns.

    Raises `InputError` unless the last pose is the first again.
    """
    first, last = poses[0], poses[-1]
    field, allowed = f"keyframes.points[{len(poses) - 1}]", "that of the first point, for the sequence repeats"
    if (last.x, last.y, last.z) != (first.x, first.y, first.z):
        raise InputError(f"{field}.at", last.position.tolist(), allowed)
    turn = math.tau * round((last.yaw - first.yaw) / math.tau)
    if not abs(last.yaw - first.yaw - turn) <= WHOLE_TURN_RAD:
        raise InputError(f"{field}.yaw", last.yaw, f"{allowed}, but for whole turns")
    return turn


def spline(knots: FloatArray, values: FloatArray, ends: str, turn: float) -> FloatArray:
    """Coefficients (K-1, 4, 4), powers of the time since a knot by coordinates, of the C² cubic spline through `values`
    (K, 4). One that repeats has a yaw that goes on by `turn` in a period: a line and what is periodic; a cubic spline
    reproduces lines."""
    # imported here: most scenes have no keyframes, and the web process loads every law
    from scipy.interpolate import CubicSpline

    around, rate = values.copy(), 0.0
    if ends == "periodic":
        rate = turn / knots[-1]
        around[:, 3] -= rate * knots
        around[-1] = around[0]
    pieces: FloatArray = np.ascontiguousarray(CubicSpline(knots, around, bc_type=ends).c[::-1].transpose(1, 0, 2))
    pieces[:, 0], pieces[:, 1, 3] = values[:-1], pieces[:, 1, 3] + rate
    return pieces


Valid = tuple[float, float]
Vector = tuple[float, float, float]
Four = tuple[float, float, float, float]

MOVE = (420.0, -1680.0, 2100.0, -840.0)
"""Coefficients of u², u³, u⁴, u⁵ of the second derivative of a step's law (F3)."""
CORNERS = 0.5 - 0.5 / math.sqrt(5.0), 0.5, 0.5 + 0.5 / math.sqrt(5.0)
"""Where in a move its acceleration is greatest, zero, and least, as shares of its duration (F3)."""
STEEPEST = 7.0
"""Bound of the speed of an indexer's move as a multiple of its mean: the law of degree 7 (F3) has its peak at 2.2 of
it, but its control values differ by this, and the checker bounds it by them."""
SHORTEST_DIRECTION = 1e-3
"""Least length of a direction (no unit): a shorter one was mistaken."""
YAW = (0.0, 0.0, 0.0, 1.0)
"""The shares that coordinates have in what turns."""


def fixed(pose: Pose, valid: Valid = ALWAYS) -> Law:
    """A frame that is always at `pose`."""
    of = checked("fixed", pose=pose)
    return Law("fixed", of, valid, *tables([_still(of.pose)], turns=False))


def linear(pose: Pose, velocity: Vector, at_time: float = 0.0, valid: Valid = ALWAYS) -> Law:
    """A frame that moves with the constant `velocity` (3,) m/s and is at `pose` at `at_time`; it does not turn.

    p = p0 + v (t − at_time).
    """
    of = checked("linear", pose=pose, velocity=velocity, at_time=at_time)
    speed = math.hypot(*of.velocity)
    x, y, z = [part / speed for part in of.velocity] if speed > 0.0 else (1.0, 0.0, 0.0)
    made = tables([(of.at_time, _at(of.pose), (*of.velocity, 0.0), ())], turns=False, line=(x, y, z))
    cosine, sine = math.cos(of.pose.yaw), math.sin(of.pose.yaw)
    way = cosine * x + sine * y, cosine * y - sine * x, z
    return Law("linear", of, valid, *made, way=way, fastest=(speed, 0.0), stated_s=of.at_time)


def conveyor(
    pose: Pose, speed: float, changes: Sequence[Change] = (), at_time: float = 0.0, valid: Valid = ALWAYS
) -> Law:
    """A belt: a frame that is at `pose` at `at_time` and travels along its local x with `speed` until the first of
    `changes`.

    With u = (cos yaw, sin yaw, 0) and s the travel (equation F1): p = p0 + s(t) u. A negative speed runs backwards.
    Refuses changes that overlap.
    """
    of = checked("conveyor", changes, pose=pose, speed=speed, at_time=at_time)
    line = _own_x(of.pose)
    pieces = [
        (begin, *_moved(of.pose, (*line, 0.0), *state))
        for begin, *state in ramped(of.speed, of.changes, of.at_time, "conveyor")
    ]
    made, fastest = tables(pieces, turns=False, line=line), (_fastest(of.speed, of.changes), 0.0)
    return Law("conveyor", of, valid, *made, way=(1.0, 0.0, 0.0), fastest=fastest, stated_s=of.at_time)


def turntable(
    pose: Pose,
    rate: float,
    rise: float = 0.0,
    changes: Sequence[Change] = (),
    at_time: float = 0.0,
    valid: Valid = ALWAYS,
) -> Law:
    """A dial that turns in place with `rate` (rad/s) until the first of `changes` (of the rate), and climbs.

    Its origin is the centre; at `at_time` it is at `pose`. With θ the angle turned since then (equation F2):

        yaw = pose.yaw + θ(t),   z = pose.z + rise (t − at_time)

    `rise` is in m/s and constant: with it, this is a screw. Refuses changes that overlap.
    """
    of = checked("turntable", changes, pose=pose, rate=rate, rise=rise, at_time=at_time)
    pieces = list[Piece]()
    for begin, *state in ramped(of.rate, of.changes, of.at_time, "turntable"):
        (x, y, z, yaw), (*_, turning), powers = _moved(of.pose, YAW, *state)
        z += of.rise * (begin - of.at_time)
        pieces.append((begin, (x, y, z, yaw), (0.0, 0.0, of.rise, turning), powers))
    made, fastest = tables(pieces, turns=True), (abs(of.rise), _fastest(of.rate, of.changes))
    steady = of.rate != 0.0 and of.rise == 0.0 and not changes
    cycle = math.tau / abs(of.rate) if steady else None
    return Law("turntable", of, valid, *made, fastest=fastest, stated_s=of.at_time, cycle_s=cycle)


def indexer(
    pose: Pose,
    step: float,
    move_s: float,
    dwell_s: float,
    kind: str = "turn",
    start: float = 0.0,
    valid: Valid = ALWAYS,
) -> Law:
    """A frame that moves by `step` in `move_s`, rests for `dwell_s`, and so on; at `start` a move begins from `pose`.

    It goes on for ever, before `start` too. Kind `turn`: in place about its origin, `step` in rad; `travel`: along
    its local x, `step` in m. The law of a move, u from 0 to 1 over `move_s`, is the polynomial of least degree that
    begins and ends with no velocity, no acceleration and no jerk (equation F3):

        x = step (35 u⁴ − 84 u⁵ + 70 u⁶ − 20 u⁷)

    Refuses a time that is not positive (the dwell may be zero).
    """
    if kind not in ("turn", "travel"):
        raise InputError("indexer.kind", kind, "one of ('turn', 'travel')")
    of = checked("indexer", pose=pose, step=step, move_s=move_s, dwell_s=dwell_s, start=start)
    of = replace(of, turns=kind == "turn")
    line = (0.0, 0.0, 0.0) if of.turns else _own_x(of.pose)
    shares = YAW if of.turns else (*line, 0.0)
    moved = [0.0, 0.0, *(of.step * a / of.move_s ** (k + 4) for k, a in enumerate(MOVE))]
    pieces: list[Piece] = [(0.0, *_moved(of.pose, shares, 0.0, 0.0, *moved))]
    if of.dwell_s > 0.0:
        pieces.append((of.move_s, *_moved(of.pose, shares, of.step, 0.0)))
    repeat = Repeat(of.start, of.move_s + of.dwell_s, [of.step * share for share in shares])
    corners = [share * of.move_s for share in CORNERS]
    made = tables(pieces, turns=of.turns, corners=corners, repeat=repeat, line=line)
    fastest = STEEPEST * abs(of.step) / of.move_s
    both = (0.0, fastest) if of.turns else (fastest, 0.0)
    return Law("indexer", of, valid, *made, fastest=both, stated_s=of.start)


def swing(pose: Pose, amplitude: float, period: float, phase: float = 0.0, valid: Valid = ALWAYS) -> Law:
    """A gate: a frame that turns in place about `pose`, its pivot and mean yaw, by `amplitude` (rad) to either side.

    With θ = 2π t/period + phase (equation F4): yaw = pose.yaw + amplitude sin θ. What turns on and on is a turntable.
    """
    of = checked("swing", pose=pose, amplitude=amplitude, period=period, phase=phase)
    w = math.tau / of.period
    made = tables([_still(of.pose)], turns=True, waves=[(3, of.amplitude, w, of.phase)])
    return Law("swing", of, valid, *made, fastest=(0.0, w * abs(of.amplitude)), cycle_s=of.period)


def oscillation(
    pose: Pose, direction: Vector, amplitude: float, period: float, phase: float = 0.0, valid: Valid = ALWAYS
) -> Law:
    """A shutter, a lift or a shaker: a frame that travels by `amplitude` (m) to either side of `pose` along `direction`
    (3,); it does not turn.

    The direction is in world axes, and its length does not count. With u the unit vector along it and
    θ = 2π t/period + phase (equation F8): p = pose + amplitude sin θ u.
    """
    of = checked("oscillation", pose=pose, direction=direction, amplitude=amplitude, period=period, phase=phase)
    length = math.hypot(*of.direction)
    if not length >= SHORTEST_DIRECTION:
        raise InputError("oscillation.direction", direction, f"a vector of length {SHORTEST_DIRECTION:g} or more")
    line, w = [part / length for part in of.direction], math.tau / of.period
    waves = [(k, of.amplitude * share, w, of.phase) for k, share in enumerate(line) if share != 0.0]
    made = tables([_still(of.pose)], turns=False, waves=waves, line=line)
    return Law("oscillation", of, valid, *made, fastest=(w * abs(of.amplitude), 0.0), cycle_s=of.period)


def keyframes(
    times: Sequence[float] | FloatArray, poses: Sequence[Pose], ends: Ends = "clamped", valid: Valid = ALWAYS
) -> Law:
    """A frame that is at `poses` (K) at `times` (K,) s; between them a cubic spline in x, y, z and yaw, C².

    At both ends either the velocity is zero (`clamped`) or the acceleration (`natural`), and the law is known from the
    first to the last time. Or the sequence repeats for ever, before the first time, too (`periodic`): the last pose is
    the first, but for whole turns of the yaw, which add up, and the spline is C² there, as everywhere. `valid` may
    narrow that. Yaw is taken as written: going from 350° to 10° turns backwards by 340°. The jerk jumps at the inner
    times, and where a period ends; there the later piece counts.

    In piece i, with τ = t − times[i] (equation F5): x(t) = Σ c_ik τ^k, k = 0..3. Of a periodic law t is the time after
    whole periods were taken away (equation F9).

    Refuses fewer than two poses, times that do not ascend by a millisecond at least, a `valid` that has nothing in
    common with the times, or a period that does not close.
    """
    known = frozen(times, (None,), "keyframes.times")
    poses = tuple(placed(pose, f"keyframes.points[{i}]") for i, pose in enumerate(poses))
    if not 2 <= len(known) == len(poses):
        raise InputError("keyframes.points", len(poses), f"as many as times ({len(known)}), two at least")
    for i, time in enumerate(known.tolist()):
        least = -FURTHEST_S if i == 0 else float(known[i - 1]) + SHORTEST_S
        float_in(time, f"keyframes.points[{i}].time", least, FURTHEST_S)
    if ends not in ("natural", "clamped", "periodic"):
        raise InputError("keyframes.ends", ends, "one of ('natural', 'clamped', 'periodic')")
    valid, repeat, turn, knots = interval(valid, "keyframes.valid"), None, 0.0, known
    if ends == "periodic":
        knots, turn = known - known[0], whole_turns(poses)
        repeat = Repeat(float(known[0]), float(knots[-1]), (0.0, 0.0, 0.0, turn), whole=True)
    else:
        valid = max(valid[0], float(known[0])), min(valid[1], float(known[-1]))
    if not valid[0] < valid[1]:
        raise InputError("keyframes.valid", valid, f"times from {known[0]} to {known[-1]} s")
    cubics = spline(knots, np.array([_at(pose) for pose in poses]), ends, turn)
    pulls = np.stack([2.0 * cubics[:, 2], 6.0 * cubics[:, 3]], -1).tolist()
    pieces = list(zip(knots[:-1].tolist(), cubics[:, 0].tolist(), cubics[:, 1].tolist(), pulls, strict=True))
    turns = any(pose.yaw != poses[0].yaw for pose in poses)
    made = tables(pieces, float(knots[-1]), turns=turns, repeat=repeat)
    of = Numbers(poses[0], times=tuple(known.tolist()), poses=poses, ends=ends)
    return Law("keyframes", of, valid, *made, cycle_s=None if repeat is None else repeat.period)


def slowed(law: Law, share: float) -> Law | None:
    """A belt at a share of its speed; None: the law is no belt of constant speed."""
    of = law.numbers
    if law.kind != "conveyor" or of.changes:
        return None
    return conveyor(of.pose, share * of.speed, (), of.at_time, law.valid)


def checked(kind: str, changes: Sequence[Change] = (), **given: Any) -> Numbers:
    """The numbers of a law of this kind, by name. Raises `InputError` naming the one that is not allowed."""
    known = dict[str, Any]()
    for name, value in given.items():
        field = f"{kind}.{name}"
        if name == "pose":
            known[name] = placed(value, field)
        elif name in ("velocity", "direction"):
            if len(value) != 3:
                raise InputError(field, value, "three numbers")
            known[name] = tuple([float_in(part, f"{field}[{i}]") for i, part in enumerate(value)])
        else:
            known[name] = float_in(value, field, *RANGES.get(name, ()))
    return Numbers(**known, changes=tuple(changes))


def _own_x(pose: Pose) -> Vector:
    """The unit vector along the frame's x axis."""
    return math.cos(pose.yaw), math.sin(pose.yaw), 0.0


def _at(pose: Pose) -> Four:
    return pose.x, pose.y, pose.z, pose.yaw


def _still(pose: Pose) -> Piece:
    """The piece of what does not move."""
    return 0.0, _at(pose), (0.0,) * 4, ()


def _moved(
    pose: Pose, shares: Four, gone: float, speed: float, *pull: float
) -> tuple[Four, Four, Sequence[Sequence[float]]]:
    """Coordinates, rates and powers of what has travelled or turned by `gone`, has this speed and is accelerated by the
    powers `pull`, by the shares that coordinates have in that."""
    x, y, z, yaw = [at + gone * share for at, share in zip(_at(pose), shares, strict=True)]
    u, v, w, turning = [speed * share for share in shares]
    powers = [[share * a for a in pull] for share in shares] if any(pull) else []
    return (x, y, z, yaw), (u, v, w, turning), powers


def _fastest(speed: float, changes: Sequence[Change]) -> float:
    return max(abs(each) for each in (speed, *(change.speed for change in changes)))

"""Does the claim guide the tool as the task asks: along straight lines, along paths, and on traces at their times?

A guide states that the tool is near a point that goes evenly along a chord. Chords follow each other without a gap in
time. On a straight leg they are parts of one line, and shares rise from 0 to 1. Of a path both ends of a chord have to
be points of the path, one behind the other, from its begin to its end; of a trace at their times (Q6). How far the path
leaves a chord is added to what the tool may be off.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.curves import Curve, curve_of
from assur.planner.checker.statement.differences import IDENTITY, SAME, TRACKED_M, Interval, inverse_pose, then
from assur.planner.checker.statement.statement import Statement, same, within
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.model.outcome import LegKind, Traced
from assur.planner.model.scene import WORLD, Move, Trace

REST = 1e-9
"""A joint that is slower rests, rad/s or m/s."""
SPEED_SHARE = 0.01
"""By how much of itself the process speed may be missed."""
STEPS = 4
"""Steps to the nearest place on a path."""
NEAREST_M = 1e-6
"""So near the path the ends of a chord are, m: how far they are off is added to what the tool may be off."""


def require_guides(statement: Statement) -> None:
    """The tool is guided on straight legs, paths and traces, and arrivals state of traces what is so."""
    for number, step in enumerate(statement.scene.task):
        stated = statement.arrivals[number].trace
        if not isinstance(step, Trace):
            statement.require(stated is None, Code.ARRIVAL, f"{step.name} is no trace")
        elif stated is None:
            statement.require(False, Code.ARRIVAL, f"nothing is stated of how {step.name} is traced")
        else:
            _require_trace(statement, number, step, stated)
        if isinstance(step, Move) and step.leg == "cartesian":
            when = statement.way(number)
            how = "along its path" if step.path else "straight"
            agrees = (
                _follows_path(statement, number, step, when) if step.path else _is_straight(statement, number, when)
            )
            statement.require(agrees, Code.GUIDE, f"the tool is not stated to go {how} to {step.name}", when)


def _rows(statement: Statement, first: str, last: str, when: Interval) -> FloatArray | None:
    """The guides of the tool from one frame to another over an interval, in order; None: they leave out a time."""
    frames = statement.frames[first], statement.frames[last]
    own = statement.listed("guides", within(when), same(c.GUIDE_LINK, statement.flange, *statement.tcp[:3], *frames))
    rows = np.array(sorted(own))
    whole = len(rows) > 0 and (rows[0, 0], rows[-1, 1]) == when and (rows[1:, 0] == rows[:-1, 1]).all()
    return rows if whole else None


def _begin(statement: Statement, frame: str, time: float) -> FloatArray:
    """Where the tool is in a frame at a time, (3,)."""
    there = statement.in_world((frame, IDENTITY), time)
    return np.array(then(inverse_pose(there), statement.tool_at(time))[:3])


def _is_straight(statement: Statement, number: int, when: Interval) -> bool:
    """The line begins where the arm rests; else in the frame of the point before."""
    goal_frame, goal = statement.tool_point(number)
    first = WORLD
    if not np.abs(statement.state_at(when[0])[1]).max() <= REST:
        if number == 0:
            return False  # it begins in motion, and in no frame
        first, _ = statement.point(number - 1)
    rows = _rows(statement, first, goal_frame, when)
    if rows is None:
        return False
    ends = np.array([*_begin(statement, first, when[0]), *goal[:3]])
    shares = rows[:, c.GUIDE_SHARE : c.GUIDE_MOST]
    return bool(
        (np.abs(rows[:, c.GUIDE_FROM : c.GUIDE_SHARE] - ends) <= SAME).all()
        and (shares[0, 0], shares[-1, 1]) == (0.0, 1.0)
        and (shares[1:, 0] == shares[:-1, 1]).all()
        and (shares[:, 0] <= shares[:, 1]).all()
        and (rows[:, c.GUIDE_MOST] <= TRACKED_M).all()
    )


def _follows_path(statement: Statement, number: int, step: Move, when: Interval) -> bool:
    """The path begins where the tool is then. Every point of it is near the way, and every point of the way near it."""
    frame, _ = statement.point(number)
    rows = _rows(statement, frame, frame, when)
    if rows is None:
        return False
    chords = _chords(rows)
    points = chords.reshape(-1, 3)
    x, y, z = _begin(statement, frame, when[0]).tolist()
    try:
        curve = curve_of((x, y, z), step.path, step.blend_m)
    except np.linalg.LinAlgError:
        return False  # no circle goes through these points
    far = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    if not (far[-1] > 0.0 and 0.0 < curve.length < np.inf):
        return False
    s = far * (curve.length / far[-1])
    for _ in range(STEPS):
        place, tangent = curve.state(s)
        s = np.clip(s + ((points - place) * tangent).sum(1), 0.0, curve.length)
    s[0], s[-1] = 0.0, curve.length
    places = curve.state(s)[0]
    return bool(
        (chords[1:, 0] == chords[:-1, 1]).all()
        and (np.linalg.norm(points - places, axis=1) <= NEAREST_M).all()
        and (np.diff(s) >= 0.0).all()
        and _go_from_end_to_end(rows)
        and (_off(rows, places, curve.bow(*s.reshape(-1, 2).T)) <= TRACKED_M).all()
    )


def _chords(rows: FloatArray) -> FloatArray:
    """Where chords of a path begin and end, (N, 2, 3)."""
    return rows[:, c.GUIDE_FROM : c.GUIDE_SHARE].reshape(-1, 2, 3)


def _off(rows: FloatArray, places: FloatArray, bow: FloatArray) -> FloatArray:
    """How far the tool may be from where it should be while each row lasts, (N,) m: the ends of the chords are compared
    with `places`, and a place leaves a chord by `bow` (N,)."""
    chords = _chords(rows)
    apart = np.linalg.norm(chords - places.reshape(chords.shape), axis=2).max(1)
    return np.asarray(rows[:, c.GUIDE_MOST] + apart + bow)


def _go_from_end_to_end(rows: FloatArray) -> bool:
    """Whether the tool goes along all of each chord."""
    return bool((rows[:, c.GUIDE_SHARE : c.GUIDE_MOST] == (0.0, 1.0)).all())


def _require_trace(statement: Statement, number: int, step: Trace, stated: Traced) -> None:
    """What is stated of a trace is within what is promised, and the claim states as much."""
    v, name, arrival = step.speed_m_s, step.name, statement.arrivals[number]
    curve = curve_of(step.path.begin, step.path.parts, step.path.blend_m)
    promised = (
        abs(stated.length_m - curve.length) <= SAME
        and v - stated.slowest_m_s <= SPEED_SHARE * v
        and stated.fastest_m_s - v <= SPEED_SHARE * v
        and stated.error_m <= TRACKED_M
        and arrival.matched
    )
    statement.require(promised, Code.ARRIVAL, f"{name} may not be traced as its arrival states")
    for leg in statement.legs(number, tracked=True):
        when, lead = (leg.t0, leg.t1), step.lead_in_m if leg.kind is LegKind.APPROACH else step.lead_out_m
        follows = leg.kind is LegKind.FOLLOW
        lasts, most = (curve.length / v, stated.error_m) if follows else (2.0 * lead / v, TRACKED_M)
        what = f"{leg.kind} of {name} takes another time than its path"
        statement.require(abs(leg.t1 - leg.t0 - lasts) <= SAME, Code.LEGS, what, when)
        rows = _rows(statement, step.target.frame, step.target.frame, when)
        guided = rows is not None and (
            _go_from_end_to_end(rows) and (_off_trace(rows, curve, leg.kind, when, v, lead) <= most).all()
        )
        what = f"the tool is not stated to be where {name} has it in its {leg.kind}"
        statement.require(guided, Code.GUIDE, what, when)
    when, frame = (arrival.time, arrival.until), statement.frames[step.target.frame]
    kept = statement.tool_keeps(frame, 1, stated.slowest_m_s, stated.fastest_m_s, when)
    statement.require(kept, Code.RATE, f"the tool may have another speed on the path of {name}", when)


def _off_trace(rows: FloatArray, curve: Curve, kind: LegKind, when: Interval, v: float, lead: float) -> FloatArray:
    """`_off` for a trace: the places are those at the times of the rows, and a place leaves a chord by its acceleration
    times h²/8."""
    times = rows[:, c.GUIDE_T0 : c.GUIDE_LINK]
    if kind is LegKind.FOLLOW:
        s = np.clip(v * (times - when[0]), 0.0, curve.length)
        return _off(rows, curve.state(s.ravel())[0], curve.bow(s[:, 0], s[:, 1]))
    # a lead goes on along the tangent of the path's end, x the share of its time from where the tool rests
    before = kind is LegKind.APPROACH
    edge, tangent = (each[0] for each in curve.state(np.array([0.0 if before else curve.length])))
    x = np.clip((times - when[0] if before else when[1] - times) * v / (2.0 * lead), 0.0, 1.0)
    gone = lead * (1.0 - x**3 * (2.0 - x)) * (-1.0 if before else 1.0)
    return _off(rows, edge + gone[:, :, None] * tangent, 0.75 * v * v / lead * np.diff(times, axis=1)[:, 0] ** 2 / 8.0)

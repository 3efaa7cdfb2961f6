"""Does the claim guide the tool as the task asks: along straight lines, along paths, and on traces at their times?

A guide states that the tool is near a point that goes evenly along a chord. Chords follow each other without a gap in
time. On a straight leg they are parts of one line, and shares rise from 0 to 1. Of a path both ends of a chord have to
be points of the path, one behind the other, from its begin to its end; of a trace at their times (Q6). How far the path
leaves a chord is added to what the tool may be off.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.arms import flange_row, states_at
from assur.planner.checker.statement.curves import Curve, curve_of
from assur.planner.checker.statement.differences import SAME, TRACKED_M, Difference, Interval, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.poses import IDENTITY, inverse, then
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


def guides_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """Differences of the guides, and of what arrivals state of traces."""
    for number, step in enumerate(handling.scene.task):
        stated = handling.arrivals[number].trace
        if isinstance(step, Trace):
            if stated is None:
                yield Difference(Topic.ARRIVAL, f"nothing is stated of how {step.name} is traced")
            else:
                yield from _trace_agrees(handling, number, step, stated, claim)
            continue
        if stated is not None:
            yield Difference(Topic.ARRIVAL, f"{step.name} is no trace")
        if isinstance(step, Move) and step.leg == "cartesian":
            when = handling.way(number)
            what = "along its path" if step.path else "straight"
            agrees = _follows_path if step.path else _is_straight
            if not agrees(handling, number, when, claim):
                yield Difference(Topic.GUIDE, f"the tool is not stated to go {what} to {step.name}", when)


def _rows(handling: Handling, claim: c.Claim, first: str, last: str, when: Interval) -> FloatArray | None:
    """The guides of the tool from one frame to another over an interval, in order; None: they leave out a time."""
    names = list(handling.scene.frames)
    head = np.array([flange_row(handling.scene.robot), *handling.tcp[:3], names.index(first), names.index(last)])
    own = (np.abs(claim.guides[:, c.GUIDE_LINK : c.GUIDE_FROM] - head) <= SAME).all(1)
    rows = claim.guides[own & (claim.guides[:, c.GUIDE_T0] >= when[0]) & (claim.guides[:, c.GUIDE_T1] <= when[1])]
    rows = rows[np.argsort(rows[:, c.GUIDE_T0], kind="stable")]
    times = rows[:, [c.GUIDE_T0, c.GUIDE_T1]]
    whole = len(rows) > 0 and (times[0, 0], times[-1, 1]) == when and (times[1:, 0] == times[:-1, 1]).all()
    return rows if whole else None


def _is_straight(handling: Handling, number: int, when: Interval, claim: c.Claim) -> bool:
    """The line begins where the arm rests; else in the frame of the point before."""
    goal_frame, goal = handling.tool_point(number)
    first = WORLD
    if not np.abs(states_at(handling.plan.trajectory, when[0])[1]).max() <= REST:
        if number == 0:
            return False  # it begins in motion, and in no frame
        first, _ = handling.point(number - 1)
    rows = _rows(handling, claim, first, goal_frame, when)
    if rows is None:
        return False
    left = then(inverse(handling.in_world((first, IDENTITY), when[0])), handling.tool_at(when[0]))
    ends, shares = np.array([*left[:3], *goal[:3]]), rows[:, [c.GUIDE_SHARE, c.GUIDE_SHARE + 1]]
    return bool(
        (np.abs(rows[:, c.GUIDE_FROM : c.GUIDE_SHARE] - ends) <= SAME).all()
        and (shares[0, 0], shares[-1, 1]) == (0.0, 1.0)
        and (shares[1:, 0] == shares[:-1, 1]).all()
        and (shares[:, 0] <= shares[:, 1]).all()
        and (rows[:, c.GUIDE_MOST] <= TRACKED_M).all()
    )


def _follows_path(handling: Handling, number: int, when: Interval, claim: c.Claim) -> bool:
    """The path begins where the tool is then. Every point of it is near the way, and every point of the way near it."""
    step, (frame, _) = handling.scene.task[number], handling.point(number)
    rows = _rows(handling, claim, frame, frame, when)
    if rows is None or not isinstance(step, Move):
        return False
    left = then(inverse(handling.in_world((frame, IDENTITY), when[0])), handling.tool_at(when[0]))
    begins, ends = _chords(rows)
    points = np.concatenate([begins[:1], ends])
    try:
        curve = curve_of(left[:3], step.path, step.blend_m)
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
    off = np.linalg.norm(points - curve.state(s)[0], axis=1)
    bound = rows[:, c.GUIDE_MOST] + np.maximum(off[:-1], off[1:]) + curve.bow(s[:-1], s[1:])
    return bool(
        (begins[1:] == ends[:-1]).all()
        and (off <= NEAREST_M).all()
        and (np.diff(s) >= 0.0).all()
        and _go_from_end_to_end(rows)
        and (bound <= TRACKED_M).all()
    )


def _chords(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Where chords of a path begin and end, (N, 3) each."""
    return rows[:, c.GUIDE_FROM : c.GUIDE_TO], rows[:, c.GUIDE_TO : c.GUIDE_SHARE]


def _go_from_end_to_end(rows: FloatArray) -> bool:
    """Whether the tool goes along all of each chord."""
    return bool((rows[:, [c.GUIDE_SHARE, c.GUIDE_SHARE + 1]] == (0.0, 1.0)).all())


def _trace_agrees(handling: Handling, number: int, step: Trace, stated: Traced, claim: c.Claim) -> Iterator[Difference]:
    """What is stated of a trace is within what is promised, and the claim states as much."""
    v, name, arrival = step.speed_m_s, step.name, handling.arrivals[number]
    curve = curve_of(step.path.begin, step.path.parts, step.path.blend_m)
    if not (
        abs(stated.length_m - curve.length) <= SAME
        and v - stated.slowest_m_s <= SPEED_SHARE * v
        and stated.fastest_m_s - v <= SPEED_SHARE * v
        and stated.error_m <= TRACKED_M
        and arrival.matched
    ):
        yield Difference(Topic.ARRIVAL, f"{name} may not be traced as its arrival states")
    for leg in [leg for leg in handling.plan.legs if leg.step == number]:
        when, lead = (leg.t0, leg.t1), step.lead_in_m if leg.kind is LegKind.APPROACH else step.lead_out_m
        if leg.kind not in (LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART):
            continue
        follows = leg.kind is LegKind.FOLLOW
        lasts, most = (curve.length / v, stated.error_m) if follows else (2.0 * lead / v, TRACKED_M)
        if not abs(leg.t1 - leg.t0 - lasts) <= SAME:
            yield Difference(Topic.LEGS, f"{leg.kind} of {name} takes another time than its path", when)
        rows = _rows(handling, claim, step.target.frame, step.target.frame, when)
        if rows is None or not (
            _go_from_end_to_end(rows) and (_off_trace(rows, curve, leg.kind, when, v, lead) <= most).all()
        ):
            yield Difference(Topic.GUIDE, f"the tool is not stated to be where {name} has it in its {leg.kind}", when)
    frames = list(handling.scene.frames)
    speed = [flange_row(handling.scene.robot), *handling.tcp[:3], frames.index(step.target.frame), 1.0]
    rates = claim.rates
    if not (
        (rates[:, c.RATE_T0] <= arrival.time)
        & (rates[:, c.RATE_T1] >= arrival.until)
        & (np.abs(rates[:, c.RATE_LINK : c.RATE_LEAST] - np.array(speed)) <= SAME).all(1)
        & (rates[:, c.RATE_LEAST] >= stated.slowest_m_s)
        & (rates[:, c.RATE_MOST] <= stated.fastest_m_s)
    ).any():
        yield Difference(
            Topic.RATE, f"the tool may have another speed on the path of {name}", (arrival.time, arrival.until)
        )


def _off_trace(rows: FloatArray, curve: Curve, kind: LegKind, when: Interval, v: float, lead: float) -> FloatArray:
    """How far the tool may be from where it should be on a trace while each row lasts, (N,) m: the ends of a chord are
    compared with the places at its times, and the place leaves a chord by its acceleration times h²/8."""
    times, chords = rows[:, [c.GUIDE_T0, c.GUIDE_T1]], np.stack(_chords(rows), 1)
    if kind is LegKind.FOLLOW:
        s = np.clip(v * (times - when[0]), 0.0, curve.length)
        places, bow = curve.state(s.ravel())[0].reshape(chords.shape), curve.bow(s[:, 0], s[:, 1])
    else:
        # a lead goes on along the tangent of the path's end, x the share of its time from where the tool rests
        before = kind is LegKind.APPROACH
        edge, tangent = (each[0] for each in curve.state(np.array([0.0 if before else curve.length])))
        x = np.clip((times - when[0] if before else when[1] - times) * v / (2.0 * lead), 0.0, 1.0)
        gone = lead * (1.0 - x**3 * (2.0 - x)) * (-1.0 if before else 1.0)
        places, bow = edge + gone[:, :, None] * tangent, 0.75 * v * v / lead * np.diff(times, axis=1)[:, 0] ** 2 / 8.0
    return np.asarray(rows[:, c.GUIDE_MOST] + np.linalg.norm(chords - places, axis=2).max(1) + bow)

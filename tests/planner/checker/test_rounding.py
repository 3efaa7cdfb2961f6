"""How much the claim checker's places of frames round (R2), against places computed with 60 digits: no more than it
says, and where a request is accepted within what a proof can bear."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.checker.claim.chain import slot_of
from assur.planner.checker.claim.motion import make_curves, make_laws, rounding
from assur.planner.checker.claim.tables import Geometry, Scratch
from assur.planner.checker.claim.verdict import check_claim, prepare
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim, table
from assur.planner.claim.filling import claim_of, with_plan
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import box
from assur.planner.kernels.laws import place_frame
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.laws import Change, Law, Pose, conveyor, fixed, indexer, linear, oscillation, swing, turntable
from assur.planner.laws.law import FARTHEST_PLACE_M, FARTHEST_WAY_M, way
from assur.planner.model.outcome import Leg, LegKind, Plan
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene, WorldBody
from assur.planner.trajectory import Trajectory
from tests.planner.cells import cell, frame, go, solid
from tests.planner.checker.hand_made import no_rows

DIGITS = 60
STEP = (0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0)
"""Coefficients of u, u², ... u⁷ of the law of a step (F3)."""
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803")
REACH = 0.3
"""How far the point whose place is compared is from the frame's axis, m."""


def decimal(value: Fraction) -> Decimal:
    return Decimal(value.numerator) / Decimal(value.denominator)


def wave(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Cosine and sine, by their series."""
    x = angle.remainder_near(2 * PI)
    cosine, sine, term = Decimal(0), Decimal(0), Decimal(1)
    for k in range(80):
        if k % 2 == 0:
            cosine += term if k % 4 == 0 else -term
        else:
            sine += term if k % 4 == 1 else -term
        term *= x / (k + 1)
    return cosine, sine


def travel(speed: float, changes: tuple[Change, ...], at: float, t: float) -> Fraction:
    """What has been gone by since `at`, with changes whose ramps reach their acceleration."""

    def gone(until: Fraction) -> Fraction:
        v, here, total = Fraction(speed), None, Fraction()
        for change in changes:
            start, delta = Fraction(change.time), Fraction(change.speed) - v
            limit, jerk = Fraction(change.acceleration), Fraction(change.jerk)
            assert abs(delta) >= limit**2 / jerk
            sign, rise = (1 if delta > 0 else -1), limit / jerk
            level = abs(delta) / limit - rise
            for lasts, a, j in ((rise, Fraction(), jerk), (level, limit, Fraction()), (rise, limit, -jerk)):
                if here is None:
                    here = start
                total += v * (min(start, until) - here)
                here = min(start, until)
                h = max(min(until, start + lasts) - start, Fraction())
                total += h * (v + h * (sign * a / 2 + h * sign * j / 6))
                here, start = here + h, start + lasts
                v += sign * (a * lasts + j * lasts**2 / 2)
        return total + v * (until - (Fraction() if here is None else here))

    return gone(Fraction(t)) - gone(Fraction(at))


def exact(law: Law, t: float) -> tuple[Decimal, Decimal, Decimal]:
    """The place of the point `REACH` along the frame's x axis at a time."""
    of = law.numbers
    x, y, z, yaw = (Decimal(value) for value in (of.pose.x, of.pose.y, of.pose.z, of.pose.yaw))
    c, s = wave(yaw)
    if law.kind == "linear":
        since = Fraction(t) - Fraction(of.at_time)
        x, y, z = (at + decimal(Fraction(v) * since) for at, v in zip((x, y, z), of.velocity, strict=True))
    elif law.kind == "conveyor":
        way_ = decimal(travel(of.speed, of.changes, of.at_time, t))
        x, y = x + c * way_, y + s * way_
    elif law.kind == "turntable":
        c, s = wave(yaw + decimal(travel(of.rate, of.changes, of.at_time, t)))
        z += decimal(Fraction(of.rise) * (Fraction(t) - Fraction(of.at_time)))
    elif law.kind in ("swing", "oscillation"):
        turns = Fraction(t) / Fraction(of.period)
        sine = Decimal(of.amplitude) * wave(2 * PI * decimal(turns - math.floor(turns)) + Decimal(of.phase))[1]
        if law.kind == "swing":
            c, s = wave(yaw + sine)
        else:
            size = sum((Decimal(part) ** 2 for part in of.direction), Decimal()).sqrt()
            x, y, z = (at + sine * Decimal(part) / size for at, part in zip((x, y, z), of.direction, strict=True))
    else:
        assert law.kind == "indexer"
        period = Fraction(of.move_s) + Fraction(of.dwell_s)
        whole = math.floor((Fraction(t) - Fraction(of.start)) / period)
        share = min((Fraction(t) - Fraction(of.start) - whole * period) / Fraction(of.move_s), Fraction(1))
        step = Fraction(of.step) * (whole + sum(Fraction(a) * share ** (k + 1) for k, a in enumerate(STEP)))
        if of.turns:
            c, s = wave(yaw + decimal(step))
        else:
            x, y = x + c * decimal(step), y + s * decimal(step)
    return x + Decimal(REACH) * c, y + Decimal(REACH) * s, z


def scene_with(law: Law, start: float = 0.0) -> Scene:
    """A cell in which a small body is so far from the axis of a frame."""
    part = WorldBody(solid("part", box(0.02, 0.02, 0.02)), "moved", Pose(x=REACH - 0.01))
    return cell(go(0.35, 0.1), frames=(frame("moved", law),), bodies=(part,), time=start)


def at_rest(law: Law, t: float) -> tuple[Scene, Claim, Geometry, Scratch]:
    """The claim of an arm that rests for a second, and its motions."""
    scene = cell(go(0.35, 0.1), frames=(frame("moved", law),), time=t)
    q = np.tile(scene.start.q, (2, 1))
    path = Trajectory(np.array([t, t + 1.0]), q, 0.0 * q, 0.0 * q)
    resting = Plan(path, (Leg(LegKind.MOVE, 0, t, t + 1.0),), (), no_rows())
    claim = with_plan(claim_of(scene), resting, (Phase(t, t + 1.0, LegKind.MOVE, 0),))
    geometry, scratch = prepare(claim)
    assert make_laws(claim, geometry, scratch)
    assert make_curves(claim, geometry, scratch)
    return scene, claim, geometry, scratch


def off(law: Law, t: float) -> tuple[float, float]:
    """By how much the claim checker's place of that point is off at a time, m, and what it says that this may be."""
    scene, claim, geometry, scratch = at_rest(law, t)
    on = len(claim.links) + list(scene.frames).index("moved")
    slot = slot_of(claim, geometry, scratch, on, t, t)
    assert slot >= 0
    found = scratch.jets[slot, on, :, 0].tolist()
    return distance(found[:3], found[3:6], law, t), float(rounding(geometry, on, 0, REACH))


def distance(origin: list[float], ahead: list[float], law: Law, t: float) -> float:
    """By how much the point is off that is so far ahead of an origin, m."""
    with localcontext() as context:
        context.prec = DIGITS
        place = [Decimal(x) + Decimal(REACH) * Decimal(d) for x, d in zip(origin, ahead, strict=True)]
        squares = [(one - right) ** 2 for one, right in zip(place, exact(law, t), strict=True)]
        return float(sum(squares, Decimal()).sqrt())


def placed_off(law: Law, t: float) -> float:
    """By how much the place of that point is off by the planner's tables, m."""
    placed = np.empty((1, POSE_COLUMNS))
    place_frame(law.row, law.side, t, placed, 0)
    found = placed[0].tolist()
    return distance(found[:3], [found[3], found[6], 0.0], law, t)


ROUNDED_M = 2e-9
"""What a place of an accepted request may round by at most, m: a thousandth of what points are met within."""
INDEXED_M = 2e-8
"""What the claim checker says of an index at most: what its rate rounds by in a move is carried on in the dwell."""
FIXED_M = 1e-13
"""What coordinates of some metres round by themselves."""
NUMBER = st.floats(-1.0, 1.0)
TIME = st.floats(-9e4, 9e4)


def ramped(draw: st.DrawFn, size: float, time: float) -> tuple[float, tuple[Change, ...]]:
    """A speed, and changes of it whose ramps reach their acceleration, the first some time before `time`."""
    speeds = [size * draw(NUMBER) for _ in range(draw(st.integers(1, 5)))]
    changes, at, before = list[Change](), time - 100.0 * len(speeds), speeds[0]
    for speed in speeds[1:]:
        if abs(speed - before) >= 0.1 * size:
            changes.append(Change(at, speed, 0.05 * size, 0.05 * size))
            before, at = speed, at + 50.0 + 40.0 * draw(st.floats(0.0, 1.0))
    return speeds[0], tuple(changes)


@st.composite
def laws(draw: st.DrawFn) -> tuple[Law, float]:
    """A law and a time at which it is evaluated, some of them far beyond what is accepted."""
    t, at, size = draw(TIME), draw(TIME), 10.0 ** draw(st.floats(-2.0, 2.9))
    pose = Pose(*(draw(NUMBER) for _ in range(4)))
    kind = draw(st.integers(0, 6))
    if kind == 0:
        return linear(pose, (size * draw(NUMBER), size * draw(NUMBER), size * draw(NUMBER)), at), t
    if kind == 1:
        speed, changes = ramped(draw, size, t)
        return conveyor(pose, speed, changes, at), t
    if kind == 2:
        rate, changes = ramped(draw, size, t)
        return turntable(pose, rate, 0.01 * draw(NUMBER), changes, at), t
    period = 10.0 ** draw(st.floats(-2.5, 1.0))
    if kind == 3:
        return swing(pose, 3.0 * draw(NUMBER), period, 10.0 * draw(NUMBER)), t
    if kind == 4:
        return oscillation(pose, (1.0, draw(NUMBER), draw(NUMBER)), draw(NUMBER), period, draw(NUMBER)), t
    step, dwell = 3.0 * draw(NUMBER), draw(st.floats(0.0, 2.0))
    return indexer(pose, step, period, dwell, "turn" if kind == 5 else "travel", at), t


@settings(max_examples=300)
@given(laws())
def test_no_place_rounds_by_more_than_the_checker_says(one: tuple[Law, float]) -> None:
    law, t = one
    size, said = off(law, t)
    assert size <= said + FIXED_M


@settings(max_examples=200)
@given(laws())
def test_no_place_of_the_tables_rounds_by_more_either(one: tuple[Law, float]) -> None:
    law, t = one
    assert placed_off(law, t) <= off(law, t)[1] + FIXED_M


@settings(max_examples=200)
@given(laws())
def test_what_is_accepted_rounds_within_what_is_kept_for_it(one: tuple[Law, float]) -> None:
    law, t = one
    if way(law, REACH, t, t + 1.0) <= FARTHEST_WAY_M:
        size, said = off(law, t)
        assert said <= (INDEXED_M if law.kind == "indexer" else ROUNDED_M)
        assert size <= ROUNDED_M + FIXED_M
    elif way(law, REACH, t, t) > FARTHEST_WAY_M:
        with pytest.raises(InputError, match="a way of at most 200000 m, speed times time") as error:
            scene_with(law, t)
        assert error.value.field == "frames.moved"


@pytest.mark.parametrize("along", ["turn", "travel"])
@pytest.mark.parametrize("later", [0, 5, 40])
def test_a_point_of_an_index_that_takes_a_millisecond_is_met_where_it_begins_to_move(along: str, later: int) -> None:
    """Half a radian, or half a metre, in 1 ms: the terms of its rate are 500 times as large as it is."""
    law = indexer(Pose(0.3, 0.1, 0.1, 0.2), 0.5, 1e-3, 1.999, along, 0.5)
    corner = 0.5 + 2.0 * later
    assert point_codes(law, corner - 1e-3) == point_codes(law, corner) == set()
    assert point_codes(law, corner + 2e-4) == {Code.POINT}


def test_what_both_ends_of_a_period_differ_by_counts_for_as_long_as_an_interval_may_be() -> None:
    """A slight pull all along: at the end of its period the frame is elsewhere, and faster than as it begins."""
    period, pull = 2.0, 2e-10
    scene, claim, geometry, _ = at_rest(indexer(Pose(), 0.1, 0.3, period - 0.3, "travel"), 0.0)
    on, pieces = len(claim.links) + list(scene.frames).index("moved"), claim.laws.copy()
    pieces[:, c.LAW_POWER] += pull
    pulled = claim._replace(laws=pieces)
    other, scratch = prepare(pulled)
    assert make_laws(pulled, other, scratch)
    more = [rounding(other, on, order, 0.0) - rounding(geometry, on, order, 0.0) for order in range(2)]
    assert more == pytest.approx([pull * period**2 / 2.0 + pull * period * period, pull * period], rel=1e-3)


def point_codes(law: Law, t: float) -> set[Code]:
    """What is found of the tool of an arm at rest that is said to be at rest on a frame at a time, but for rows."""
    scene, claim, geometry, scratch = at_rest(law, t)
    tool, on = len(scene.robot.links) - 1, len(claim.links) + list(scene.frames).index("moved")
    hand = scratch.jets[slot_of(claim, geometry, scratch, tool, t, t), tool, :, 0].copy()
    base = scratch.jets[slot_of(claim, geometry, scratch, on, t, t), on, :, 0].copy()
    (x, y, z), c, s = hand[:3] - base[:3], base[3], base[4]
    yaw = math.atan2(hand[4], hand[3]) - math.atan2(s, c)
    place = (c * x + s * y, c * y - s * x, z, yaw)
    point = (t, t, on - len(claim.links), tool, 0.0, 0.0, 0.0, 0.0, *place, 0.0, -1.0, *[1e-6] * 4)
    findings = check_claim(claim._replace(points=table("points", [point]))).findings
    return {each.code for each in findings} - {Code.COVER}


def test_the_roundings_of_a_thousand_changes_do_not_add_up() -> None:
    """A belt that goes to and fro for hours, a day after time zero; and a table that turns so."""
    rng, begin = np.random.default_rng(4), 86_400.0
    times = begin + np.cumsum(rng.uniform(9.0, 12.0, 1000))
    speeds = rng.uniform(0.5, 2.0, 1000) * np.where(np.arange(1000) % 2, 1.0, -1.0)
    changes = tuple(Change(t, v, 0.7, 1.3) for t, v in zip(times.tolist(), speeds.tolist(), strict=True))
    for law in (conveyor(Pose(), 1.0, changes, begin), turntable(Pose(), 1.0, 0.0, changes, begin)):
        for t in (begin + 37.1, float(times[500]) + 0.1, float(times[-1]) + 20.0):
            size, said = off(law, t)
            assert size <= said <= ROUNDED_M


def test_a_fast_dial_that_was_stated_two_days_ago_is_off_by_nanometres_and_refused() -> None:
    """1,000 rad/s for 180,000 s: the gaps of what is 300 mm from its axis would be wrong by more than `ROUNDED_M`."""
    worst = 0.0
    for k in range(40):
        law = turntable(Pose(0.4, 0.0, 0.1), 1000.0, at_time=-90_000.0)
        size, said = off(law, 90_000.0 + 0.37 * k)
        assert size <= said
        worst = max(worst, size)
    assert worst > ROUNDED_M
    with pytest.raises(InputError) as error:
        scene_with(law, 90_000.0)
    assert error.value.field == "frames.moved"
    reach = REACH - 0.01 + math.hypot(0.01, 0.01)
    assert f"at up to {1000.0 * reach:.6g} m/s, its pose is stated at -90000 s, and the plan is from 90000 s" in str(
        error.value
    )
    scene_with(turntable(law.numbers.pose, 1000.0, at_time=250.0), 500.0)


def test_bodies_on_frames_that_are_fixed_on_frames_may_be_so_far_away_and_no_farther() -> None:
    scene = scene_with(fixed(Pose()))
    for away, kept in ((FARTHEST_PLACE_M - 1.0, True), (FARTHEST_PLACE_M + 1.0, False)):
        bodies = (replace(scene.bodies[0], pose=Pose(0.0, away, 0.0)),)
        if kept:
            replace(scene, bodies=bodies)
        else:
            with pytest.raises(InputError, match=r"bodies within 10000 m of the frame's origin"):
                replace(scene, bodies=bodies)


def test_a_body_near_the_axis_and_a_frame_that_bears_nothing_may_turn_on() -> None:
    dial = turntable(Pose(0.4, 0.0, 0.1), 1000.0, at_time=-90_000.0)
    assert way(dial, 1e-3, 90_000.0, 90_000.0) < FARTHEST_WAY_M
    assert way(dial, REACH, 90_000.0, 90_000.0) > FARTHEST_WAY_M
    bare = cell(go(0.35, 0.1), frames=(frame("moved", dial),), time=90_000.0)
    assert bare.frames["moved"].law is dial
    assert way(fixed(Pose(5.0)), 1.0, 0.0, 1e5) == 0.0

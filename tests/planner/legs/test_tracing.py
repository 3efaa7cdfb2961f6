"""Traces: where the tool should be within 0.01 mm at every instant, its speed in the frame within 1 %, or why not."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.checked import check
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws import Frame, Law, Uncertainty, conveyor, fixed, keyframes, swing, turntable
from assur.planner.laws.ramps import Change
from assur.planner.model.outcome import LegKind, NotPlanned, Planned
from assur.planner.model.path import ArcTo, LineTo, Path, PathPart, SplineThrough
from assur.planner.model.refusal import BeyondRange, MotionLimit, OutOfReach, Reason, Singular
from assur.planner.model.scene import Move, Scene, Target, Trace
from assur.planner.pipeline import plan
from assur.planner.relaxation.changes import changes
from assur.scenes.requests import scene_of
from tests.planner.cells import CRANKED, CUP, cell, frame

TRACED_M, SPEED_SHARE = 1e-5, 0.01
V = 0.1
LAWS: dict[str, Law] = {
    "belt": conveyor(Pose(-0.05, 0.35, 0.06, 0.2), 0.12),
    "belt that slows down": conveyor(Pose(-0.05, 0.35, 0.06, 0.2), 0.12, changes=(Change(0.8, 0.05, 0.5, 5.0),)),
    "dial": turntable(Pose(0.32, 0.12, 0.06), 0.5),
    "swing": swing(Pose(0.32, 0.12, 0.06), 0.15, 2.5),
    "table": fixed(Pose(0.3, 0.2, 0.06, 0.4)),
}
LINES_AND_ARCS: tuple[PathPart, ...] = (
    LineTo((0.03, 0.0, 0.05)),
    ArcTo((0.05, 0.02, 0.05), (0.03, 0.04, 0.05)),
    LineTo((0.0, 0.04, 0.05)),
    ArcTo((-0.02, 0.04, 0.07), (0.0, 0.04, 0.09)),  # stands upright
)
POINTS = ((0.02, 0.01, 0.05), (0.04, -0.01, 0.06), (0.05, 0.01, 0.05), (0.03, 0.03, 0.05))


def tracing(parts: tuple[PathPart, ...], where: Law, *, speed: float = V, blend: float = 0.0, **more: Any) -> Scene:
    """A trace of parts from (0, 0, 50) mm in a frame that moves so."""
    begin = more.pop("begin", (0.0, 0.0, 0.05))
    lead, after = more.pop("lead", 0.004), more.pop("after", ())
    step = Trace("bead", Target("moving", Pose(*begin)), Path(begin, parts, blend), speed, lead, lead)
    margin = more.pop("margin", 0.05)
    return cell(step, *after, frames=(frame("moving", where),), singularity_margin=margin, **more)


def planned(scene: Scene) -> Planned:
    found = plan(scene)
    assert isinstance(found, Planned), found.sentence
    assert check(scene, found.plan).findings == ()
    return found


def refused(scene: Scene) -> NotPlanned:
    # few candidates: why the first of them is refused does not change
    found = plan(replace(scene, options=replace(scene.options, max_candidates=24)))
    assert isinstance(found, NotPlanned)
    assert found.refusal is not None
    return found


def seen(scene: Scene, made: Planned, t: FloatArray) -> FloatArray:
    """The tool point (T, 3) as it is seen from the frame of the first step."""
    p, yaw = scene.robot.forward(made.plan.trajectory.evaluate(t))
    tcp, law = scene.tool.tcp, scene.frames["moving"].law.motion(t)
    x = p[:, 0] + np.cos(yaw) * tcp.x - np.sin(yaw) * tcp.y - law.p[:, 0]
    y = p[:, 1] + np.sin(yaw) * tcp.x + np.cos(yaw) * tcp.y - law.p[:, 1]
    c, s = np.cos(law.yaw), np.sin(law.yaw)
    return np.stack([c * x + s * y, c * y - s * x, p[:, 2] + tcp.z - law.p[:, 2]], -1)


def times(made: Planned) -> FloatArray:
    arrival = made.plan.arrivals[0]
    return np.linspace(arrival.time, arrival.until, 20001)


@pytest.mark.parametrize("tool", [CUP, CRANKED], ids=["cup", "cranked"])
@pytest.mark.parametrize("where", LAWS)
def test_lines_and_arcs_are_traced_in_every_frame(where: str, tool: Any) -> None:
    """The checker derives the curve for itself. What is stated of the trace is so, by differences."""
    scene = tracing(LINES_AND_ARCS, LAWS[where], tool=tool)
    made = planned(scene)
    t, trace = times(made), made.plan.arrivals[0].trace
    assert t[-1] - t[0] == pytest.approx((0.06 + 0.04 * math.pi) / V, abs=1e-9)
    assert trace is not None
    speed = np.linalg.norm(np.gradient(seen(scene, made, t), t, axis=0), axis=1)[1:-1]
    assert (1.0 - SPEED_SHARE) * V <= trace.slowest_m_s <= speed.min() + 1e-6
    assert speed.max() - 1e-6 <= trace.fastest_m_s <= (1.0 + SPEED_SHARE) * V
    assert trace.error_m <= TRACED_M


def test_a_spline_is_the_natural_one_through_its_points() -> None:
    """The same curve by another spline of the project, which knows nothing of arc lengths."""
    every = np.array([(0.0, 0.0, 0.05), *POINTS])
    chord = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(every, axis=0), axis=1)))
    law = keyframes(tuple(chord.tolist()), tuple(Pose(*row) for row in every.tolist()), "natural")
    fine = law.motion(np.linspace(0.0, chord[-1], 400_001)).p
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1)))
    path = Path((0.0, 0.0, 0.05), (SplineThrough(POINTS),))
    assert path.length == pytest.approx(length[-1], abs=1e-8)
    s = np.linspace(0.0, path.length, 2001)
    place = np.stack([np.interp(s, length, fine[:, k]) for k in range(3)], -1)
    assert np.abs(path.curve.at(s)[0] - place).max() < 1e-7


def test_the_speed_is_reached_before_the_path_and_given_up_behind_it_straight_on() -> None:
    scene = tracing(LINES_AND_ARCS, LAWS["belt"], tool=CUP, lead=0.006)
    made = planned(scene)
    own = {leg.kind: leg for leg in made.plan.legs if leg.step == 0}
    for kind, edge, way in (
        (LegKind.APPROACH, (0.0, 0.0, 0.05), (1.0, 0.0, 0.0)),
        (LegKind.DEPART, (0.0, 0.04, 0.09), (1.0, 0.0, 0.0)),
    ):
        leg = own[kind]
        assert leg.t1 - leg.t0 == pytest.approx(2 * 0.006 / V, abs=1e-9)
        t = np.linspace(leg.t0, leg.t1, 2001)
        w = seen(scene, made, t) - np.array(edge)
        along = w @ np.array(way)
        assert np.linalg.norm(w - along[:, None] * np.array(way), axis=1).max() < TRACED_M
        outer = along[0] if kind is LegKind.APPROACH else along[-1]
        assert outer == pytest.approx(-0.006 if kind is LegKind.APPROACH else 0.006, abs=1e-7)
        speed = np.gradient(along, t)
        assert abs(speed[0 if kind is LegKind.APPROACH else -1]) < 1e-3 * V


def test_corners_are_rounded_within_what_is_stated() -> None:
    square = (LineTo((0.04, 0.0, 0.05)), LineTo((0.04, 0.04, 0.05)), LineTo((0.0, 0.04, 0.05)))
    scene = tracing(square, LAWS["belt"], tool=CUP, blend=1.5e-3, speed=0.06)
    made = planned(scene)
    w = seen(scene, made, times(made))
    for corner in ((0.04, 0.0, 0.05), (0.04, 0.04, 0.05)):
        nearest = np.linalg.norm(w - np.array(corner), axis=1).min()
        assert nearest == pytest.approx(1.5e-3, abs=1.1e-5)
    x, y = w[:, 0], w[:, 1]
    off = np.minimum.reduce([np.abs(y), np.abs(x - 0.04), np.abs(y - 0.04)])
    assert off.max() <= 1.5e-3 + TRACED_M


def test_a_straight_leg_goes_on_from_the_end_of_a_lead_out_without_a_stop() -> None:
    after = Move("up", Target("moving", Pose(0.05, 0.02, 0.12)), leg="cartesian")
    scene = tracing((LineTo((0.04, 0.0, 0.05)),), LAWS["belt"], tool=CUP, after=(after,))
    made = planned(scene)
    assert next(leg.kind for leg in made.plan.legs if leg.step == 1) is LegKind.MOVE
    assert made.plan.arrivals[1].matched


def test_where_on_the_path_the_arm_is_lost_is_told() -> None:
    gone = refused(tracing((LineTo((0.45, 0.0, 0.05)),), fixed(Pose(0.3, 0.0, 0.06)), tool=CUP))
    far = gone.refusal
    assert far is not None
    assert far.reason is Reason.OUT_OF_REACH
    assert isinstance(far.facts, OutOfReach)
    # links of 325 and 275 mm reach 600 mm; the lead-out of 4 mm ends 754 mm from the base
    assert far.facts.path_m == pytest.approx(0.3, abs=1e-5)
    assert far.facts.path_part == "path"
    assert far.facts.path_at_m == pytest.approx((0.3, 0.0, 0.05), abs=1e-5)
    assert far.amount is not None
    assert far.amount.value == pytest.approx(0.154, abs=1e-6)
    assert "300 mm along the path, at [300.0, 0.0, 50.0] mm in moving" in gone.sentence
    assert "up to 154 mm out of reach" in gone.sentence


def test_a_path_too_near_a_singularity_is_told_where_it_comes_too_near() -> None:
    # the path and its lead-out of 4 mm end 599.9 mm from the base: within reach, and not by the margin
    near = refused(tracing((LineTo((0.2959, 0.0, 0.05)),), fixed(Pose(0.3, 0.0, 0.06)), tool=CUP)).refusal
    assert near is not None
    assert near.reason is Reason.NEAR_SINGULARITY
    assert isinstance(near.facts, Singular)
    # sin θ2 = 0.05 between links of 325 and 275 mm
    reach = math.sqrt(0.325**2 + 0.275**2 + 2 * 0.325 * 0.275 * math.sqrt(1 - 0.05**2))
    # that is on the lead-out, or just before it
    assert near.facts.path_m == pytest.approx(reach - 0.3, abs=1e-5)
    # the nearest place counts for the margin, not the first: sin θ2 at 599.9 mm
    cosine = (0.5999**2 - 0.325**2 - 0.275**2) / (2 * 0.325 * 0.275)
    assert near.facts.margin == pytest.approx(math.sqrt(1 - cosine**2), rel=0.05)


def test_a_lead_out_that_leaves_the_reach_is_told_as_such() -> None:
    gone = refused(tracing((LineTo((0.298, 0.0, 0.05)),), fixed(Pose(0.3, 0.0, 0.06)), tool=CUP, margin=0.0))
    assert gone.refusal is not None
    assert isinstance(gone.refusal.facts, OutOfReach)
    assert gone.refusal.facts.path_part == "lead-out"
    assert "on the lead-out, 2 mm behind the end of the path, at [300.0, 0.0, 50.0] mm in moving" in gone.sentence
    assert "up to 2 mm out of reach" in gone.sentence


def test_a_lead_in_that_begins_out_of_reach_is_told_as_such() -> None:
    gone = refused(tracing((LineTo((-0.05, 0.0, 0.05)),), fixed(Pose(0.598, 0.0, 0.06)), tool=CUP, margin=0.0))
    assert gone.refusal is not None
    assert isinstance(gone.refusal.facts, OutOfReach)
    assert gone.refusal.facts.path_part == "lead-in"
    assert "on the lead-in, 4 mm before the path begins, at [4.0, 0.0, 50.0] mm in moving" in gone.sentence
    assert "2 mm out of reach" in gone.sentence


def test_where_on_the_path_a_joint_ends_is_told() -> None:
    # the flange is 60 mm above the tool point and no higher than 250 mm: the frame is at 60 mm, so up to z = 130 mm
    found = refused(tracing((LineTo((0.0, 0.0, 0.2)),), fixed(Pose(0.3, 0.2, 0.06)), tool=CUP)).refusal
    assert found is not None
    assert found.reason is Reason.JOINT_LIMIT
    assert isinstance(found.facts, BeyondRange)
    assert found.facts.path_m == pytest.approx(0.08, abs=2e-3)
    # the path goes on to z = 200 mm and its lead-out to 204 mm: the flange to 60 + 60 + 204 mm
    assert found.facts.value == pytest.approx(0.324, abs=1e-4)
    assert found.facts.limit == 0.25


def test_where_on_the_path_a_joint_is_too_fast_is_told() -> None:
    parts = (LineTo((0.05, 0.0, 0.05)), ArcTo((0.052, 0.002, 0.05), (0.05, 0.004, 0.05)), LineTo((0.0, 0.004, 0.05)))
    answer = refused(tracing(parts, LAWS["table"], tool=CUP, speed=0.4, lead=0.03))
    found = answer.refusal
    assert found is not None
    assert found.reason is Reason.MOTION_LIMIT
    assert isinstance(found.facts, MotionLimit)
    assert found.joint is not None
    assert found.facts.rate is not None
    assert found.facts.path_m == pytest.approx(0.053, abs=6e-3)
    assert found.facts.value is not None
    assert found.facts.limit is not None
    assert found.facts.value > found.facts.limit
    assert found.facts.speed_m_s == 0.4
    assert f"to go along the path at 400 mm/s, {found.joint} would need a {found.facts.rate} of" in answer.sentence
    assert "but its limit is" in answer.sentence


def test_a_lower_process_speed_is_found_where_a_trace_is_too_fast() -> None:
    # a rounded right angle asks for a jerk that grows with the speed's third power
    parts = (LineTo((0.05, 0.0, 0.05)), LineTo((0.05, 0.05, 0.05)))
    scene = tracing(parts, fixed(Pose(0.3, 0.1, 0.06)), tool=CUP, blend=1e-3, speed=0.3, lead=0.03, margin=0.0)
    scene = replace(scene, options=replace(scene.options, max_candidates=24, explain_budget_s=30.0))
    found = plan(scene)
    assert isinstance(found, NotPlanned)
    assert found.reason is Reason.MOTION_LIMIT
    assert found.relaxation is not None, (found.sentence, found.tried)
    assert found.relaxation.what == "process speed"
    speed = float(found.relaxation.value.split()[0]) / 1e3
    step = scene.task[0]
    assert isinstance(step, Trace)
    assert speed < step.speed_m_s
    assert isinstance(plan(replace(scene, task=(replace(step, speed_m_s=speed),))), Planned)
    larger = [each for each in changes(scene, 0, None, found.refusal) if each[0] == "blend"]
    assert [value for _, value, _ in larger] == ["1.5 mm", "2 mm", "4 mm"]


def test_a_path_without_corners_has_no_larger_blend() -> None:
    scene = tracing((LineTo((0.05, 0.0, 0.05)),), fixed(Pose(0.3, 0.1, 0.06)), tool=CUP)
    kinds = {kind for kind, _, _ in changes(scene, 0, None)}
    assert "process speed" in kinds
    assert "blend" not in kinds


@pytest.mark.parametrize(
    ("parts", "blend", "field", "word"),
    [
        ((LineTo((0.0, 0.0, 0.0)),), 0.0, "path[0].to", "0.01 mm apart"),
        ((ArcTo((0.0, 0.0, 0.0), (0.1, 0.0, 0.0)),), 0.0, "path[0].via", "0.01 mm apart"),
        ((ArcTo((0.1, 0.0, 0.0), (0.0, 0.0, 0.0)),), 0.0, "path[0].to", "0.01 mm apart"),
        ((ArcTo((0.05, 0.0, 0.0), (0.1, 0.0, 0.0)),), 0.0, "path[0].via", "or a line"),
        ((ArcTo((0.2, 0.0, 0.0), (0.1, 0.0, 0.0)),), 0.0, "path[0].via", "or a line"),
        ((ArcTo((0.05, 1e-6, 0.0), (0.1, 0.0, 0.0)),), 0.0, "path[0].via", "circle of 100 m"),
        ((LineTo((0.1, 0.0, 0.0)), LineTo((0.1, 0.1, 0.0))), 0.0, "path[1]", "corner of 90 deg"),
        ((LineTo((0.1, 0.0, 0.0)), LineTo((0.0, 1e-3, 0.0))), 1e-3, "path[1]", "at most"),
        ((SplineThrough(((0.1, 0.0, 0.0), (0.1, 0.0, 0.0))),), 0.0, "path[0].points", "0.01 mm apart"),
        ((), 0.0, "path", "at least one part"),
        ((LineTo((0.1, 0.0, 0.0)),), -1.0, "blend_m", "from 0 on"),
        ((LineTo((0.1, 0.0, 0.0)),), math.nan, "blend_m", "from 0 on"),
    ],
)
def test_a_path_that_cannot_be_is_refused_at_its_part(
    parts: tuple[PathPart, ...], blend: float, field: str, word: str
) -> None:
    with pytest.raises(InputError) as error:
        Path((0.0, 0.0, 0.0), parts, blend)
    assert error.value.field == field
    assert word in error.value.allowed


@pytest.mark.parametrize("name", ["speed_m_s", "lead_in_m", "lead_out_m"])
@pytest.mark.parametrize("value", [0.0, -0.1, math.nan, math.inf])
def test_a_trace_needs_speed_and_leads(name: str, value: float) -> None:
    path = Path((0.0, 0.0, 0.0), (LineTo((0.1, 0.0, 0.0)),))
    given: dict[str, Any] = {"speed_m_s": 0.1, "lead_in_m": 0.01, "lead_out_m": 0.01, name: value}
    with pytest.raises(InputError, match="above 0"):
        Trace("x", Target("world", Pose()), path, **given)


def test_a_hand_with_pitch_and_roll_keeps_them_on_the_path() -> None:
    request = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rv-m1", "tool": {"tcp_mm": [0, 0, 0]}},
        "start": {"joints": {"j1_deg": 0, "j2_deg": 80, "j3_deg": -100, "j4_deg": -40, "j5_deg": 0}},
        "frames": {"moving": {"linear": {"at_mm": [280, -80, 150], "velocity_mm_s": [0, 20, 0]}}},
        "task": [
            {
                "trace": {
                    "start": {"frame": "moving", "at_mm": [0, 0, 0], "pitch_deg": -80, "roll_deg": 10},
                    "path": [
                        {"line": {"to_mm": [30, 0, 0]}},
                        {"arc": {"via_mm": [50, 20, 0], "to_mm": [30, 40, 0]}},
                    ],
                    "speed_mm_s": 30,
                    "lead_in_mm": 10,
                    "lead_out_mm": 10,
                }
            }
        ],
        "options": {"stop": "first", "budget_s": 60, "max_candidates": 60},
    }
    scene = scene_of(request)
    made = planned(scene)
    t = times(made)
    q = made.plan.trajectory.evaluate(t)
    # pitch and roll of the hand are sums of its joints
    assert np.abs(q[:, 1] + q[:, 2] + q[:, 3] - math.radians(-80)).max() < 1e-4
    assert np.abs(q[:, 4] - math.radians(10)).max() < 1e-4
    w = seen(scene, made, t)
    line = t - t[0] <= 1.0
    assert np.abs(w[line][:, 1]).max() < TRACED_M
    assert np.abs(np.hypot(w[~line][:, 0] - 0.03, w[~line][:, 1] - 0.02) - 0.02).max() < TRACED_M


def test_what_is_not_known_of_the_belt_is_told_at_the_end_of_the_path() -> None:
    belt = Frame("moving", LAWS["belt"], Uncertainty(position_m=1e-4, speed_m_s=1e-3))
    step = tracing((LineTo((0.04, 0.0, 0.05)),), LAWS["belt"], tool=CUP).task[0]
    made = planned(cell(step, frames=(belt,), tool=CUP))
    arrival = made.plan.arrivals[0]
    assert arrival.error is not None
    assert arrival.error.position_m == pytest.approx(1e-4 + 1e-3 * arrival.until, abs=3e-6)

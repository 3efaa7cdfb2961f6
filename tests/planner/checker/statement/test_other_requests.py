"""A claim of one request is refused for another one, with a digest that was made to fit."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from assur.planner.checker.verdict import Code
from assur.planner.frames.motion import Pose
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import LegKind, Missed, Plan, Traced
from assur.planner.trajectory import Trajectory
from assur.scenes.requests import cell_of
from tests.planner.checker.statement.cases import Case, Document, case_of, differences, sealed, step

DEMO, FLOW = "demo, more uncertain", "dense-flow, more uncertain"
TRACE, BLENDS, TILTS = "bead-on-belt", "parabolic-blend", "rv-m1, straight way"
Edit = Callable[[Document], object]
T = Code


def other(name: str, change: Edit) -> Case:
    """The plan and the claim of a case, with another request."""
    case = case_of(name)
    request = copy.deepcopy(case.request)
    change(request)
    scene = cell_of(request).scene
    assert scene.digest != case.scene.digest
    return Case(request, scene, sealed(scene, case.plan), case.claim)


def heavier(request: Document) -> None:
    """A part that leaves a smaller share of the accelerations."""
    next(body for body in request["bodies"] if "mass_kg" in body).update(mass_kg=5.0)


def higher_arch(request: Document) -> None:
    """An arch that is 1 mm higher."""
    step(request, 0)["arch"]["top_mm"] += 1


def kept_yaw(request: Document) -> None:
    """The yaw that the tool has in place of any."""
    to = step(request, 0)["to"]
    del to["yaw_free"]
    to["yaw_keep"] = True


def other_path(request: Document) -> None:
    """The path of a move along another arc."""
    step(request, 1)["path"][0]["arc"]["via_mm"][0] += 0.1


POST = {"name": "post", "shape": {"sphere": {"radius_mm": 10}}, "pose": {"at_mm": [0, -900, 0]}}
REFUSED: tuple[tuple[str, str, Code, Edit], ...] = (
    ("a window along the belt", DEMO, T.WINDOW, lambda r: step(r, 0).update(window_mm=[-300, -290])),
    ("a window in time", DEMO, T.WINDOW, lambda r: step(r, 1).update(window_s=[0.0, 0.1])),
    ("a longer dwell", DEMO, T.ARRIVAL, lambda r: step(r, 0).update(dwell_ms=90)),
    ("another grasp", DEMO, T.SEAT, lambda r: step(r, 0).update(grasp_mm=[0, 0, 11])),
    ("another place", DEMO, T.SEAT, lambda r: step(r, 1)["to"].update(at_mm=[150.1, 0, 10])),
    ("another yaw", DEMO, T.POINT, lambda r: step(r, 1)["to"].update(yaw_deg=1)),
    ("no approach", DEMO, T.LEGS, lambda r: step(r, 1).update(approach={"mm": 0})),
    ("a lower approach", DEMO, T.POINT, lambda r: step(r, 0).update(approach={"mm": 29})),
    ("a smaller contact tolerance", DEMO, T.CONTACT, lambda r: step(r, 0).update(contact_tolerance_mm=0.5)),
    ("a step more", DEMO, T.ARRIVAL, lambda r: r["task"].append({"move": {"to": {"at_mm": [350, 0, 121]}}})),
    ("a step less", DEMO, T.ARRIVAL, lambda r: r["task"].pop()),
    ("another start", DEMO, T.START, lambda r: r["start"]["joints"].update(j1_deg=17.3)),
    ("an earlier end", DEMO, T.END, lambda r: r["options"].update(latest_end_s=0.5)),
    ("a longer standstill", DEMO, T.PHASE, lambda r: r["options"].update(stay_safe_s=0.4)),
    ("lower accelerations", DEMO, T.LIMIT, lambda r: r["robot"]["limits"].update(acceleration=0.59)),
    ("a longer tool", DEMO, T.SEAT, lambda r: r["robot"]["tool"].update(tcp_mm=[0, 0, -101])),
    ("a body more", DEMO, T.SOLID, lambda r: r["bodies"].append(POST)),
    ("a body 0.1 mm aside", DEMO, T.SEAT, lambda r: r["bodies"][0]["pose"].update(at_mm=[0.1, 350, 25])),
    ("a larger distance", DEMO, T.DISTANCE, lambda r: r["options"]["clearance_mm"].update(near=1.6)),
    ("a heavier part", "heavy-casting", T.LIMIT, heavier),
    ("a later start", DEMO, T.UNCERTAINTY, lambda r: r["execution"].update(start_tolerance_ms=3)),
    ("a faster belt", DEMO, T.LAW, lambda r: r["frames"]["belt"]["conveyor"].update(speed_mm_s=250.1)),
    ("no belt correction", FLOW, T.UNCERTAINTY, lambda r: r["execution"].update(belt_correction=False)),
    ("a smaller tolerance", FLOW, T.ARRIVAL, lambda r: step(r, 0).update(tolerance_mm=0.01)),
    ("a higher approach", DEMO, T.POINT, lambda r: step(r, 0).update(approach={"mm": 35})),
    ("a straight way", DEMO, T.GUIDE, lambda r: step(r, 2).update(leg="cartesian")),
    ("a stop above", DEMO, T.POINT, lambda r: step(r, 0)["approach"].update(stop=True)),
    ("a point to be flown by", "rv-m1", T.POINT, lambda r: step(r, 0)["to"].update(at_mm=[0, 0, 45.1])),
    ("another pitch", "rv-m1", T.ARRIVAL, lambda r: step(r, 0)["to"].update(pitch_deg=-89)),
    ("a straight way of the hand", "rv-m1", T.JOINTS, lambda r: step(r, 1).update(leg="cartesian")),
    ("a higher arch", "standard-cycle", T.ARCH, higher_arch),
    ("an arch", DEMO, T.LEGS, lambda r: step(r, 2).update(arch={"top_mm": 150})),
    ("another path", "circular-legs", T.GUIDE, other_path),
    ("a faster trace", TRACE, T.ARRIVAL, lambda r: step(r, 0).update(speed_mm_s=153)),
    ("another trace", TRACE, T.ARRIVAL, lambda r: step(r, 0)["path"][1]["arc"]["via_mm"].__setitem__(0, 50.02)),
    ("a longer lead-in", TRACE, T.LEGS, lambda r: step(r, 0).update(lead_in_mm=9)),
    ("a rest at the point", DEMO, T.JOINTS, lambda r: step(r, 2).update(match="position")),
    ("a yaw that is kept", "round-the-base", T.DIRECTION, kept_yaw),
    ("blends that last longer", BLENDS, T.BLEND, lambda r: r["options"].update(acceleration_time_ms=239)),
    ("a via elsewhere", BLENDS, T.BLEND, lambda r: step(r, 0)["to"].update(at_mm=[200, 200.1, -200])),
    ("another support", DEMO, T.CONTACT, lambda r: step(r, 1).update(contact_with=["belt-bed"])),
)


@pytest.mark.parametrize(("name", "topic", "change"), [each[1:] for each in REFUSED], ids=[each[0] for each in REFUSED])
def test_a_claim_of_another_request_is_refused(name: str, topic: Code, change: Edit) -> None:
    assert topic in {each.code for each in differences(other(name, change))}


def with_leg(plan: Plan, which: int, **changes: Any) -> Plan:
    """A plan with another leg."""
    legs = list(plan.legs)
    legs[which] = replace(legs[which], **changes)
    return replace(plan, legs=tuple(legs))


def with_arrival(plan: Plan, which: int, **changes: Any) -> Plan:
    """A plan with another arrival."""
    arrivals = list(plan.arrivals)
    arrivals[which] = replace(arrivals[which], **changes)
    return replace(plan, arrivals=tuple(arrivals))


def farther_along(plan: Plan) -> Plan:
    """The plan that states that a control point is 2 µm farther along its belt."""
    along = plan.arrivals[0].along_m
    assert along is not None
    return with_arrival(plan, 0, along_m=along + 2e-6)


def other_pitch(plan: Plan) -> Plan:
    """The plan that states another pitch where any is allowed."""
    pitch = plan.arrivals[1].pitch
    assert pitch is not None
    return with_arrival(plan, 1, pitch=pitch + 1e-4)


PLANS: tuple[tuple[str, Code, Callable[[Plan], Plan]], ...] = (
    ("a leg of no step", T.LEGS, lambda p: with_leg(p, -1, step=99)),
    ("a leg of another step", T.LEGS, lambda p: with_leg(p, 0, step=1)),
    ("a leg of another kind", T.LEGS, lambda p: with_leg(p, 0, kind=LegKind.FOLLOW)),
    ("a leg that begins later", T.LEGS, lambda p: with_leg(p, 1, t0=p.legs[1].t0 + 1e-3)),
    ("a leg less", T.LEGS, lambda p: replace(p, legs=p.legs[:-1])),
    ("no legs", T.LEGS, lambda p: replace(p, legs=())),
    ("an arrival less", T.ARRIVAL, lambda p: replace(p, arrivals=p.arrivals[:-1])),
    ("an arrival twice", T.ARRIVAL, lambda p: replace(p, arrivals=(p.arrivals[0], *p.arrivals))),
    ("an arrival at another time", T.ARRIVAL, lambda p: with_arrival(p, 0, time=p.arrivals[0].time + 1e-3)),
    ("an arrival that is turned", T.ARRIVAL, lambda p: with_arrival(p, 0, yaw_offset=1.0)),
    # what is uncertain of a part in the gripper follows from it
    ("an arrival without an error", T.ARRIVAL, lambda p: with_arrival(p, 0, error=None)),
    ("an arrival of another name", T.ARRIVAL, lambda p: with_arrival(p, 0, control_point="elsewhere")),
    ("an arrival elsewhere", T.ARRIVAL, lambda p: with_arrival(p, 0, pose=moved(p.arrivals[0].pose))),
    (
        "an arrival farther along",
        T.ARRIVAL,
        farther_along,
    ),
    ("a velocity that is not matched", T.ARRIVAL, lambda p: with_arrival(p, 0, matched=False)),
    ("an arrival with a pitch", T.ARRIVAL, lambda p: with_arrival(p, 0, pitch=0.0)),
    ("an arrival that is traced", T.ARRIVAL, lambda p: with_arrival(p, 0, trace=Traced(1.0, 0.1, 0.1, 0.0))),
    ("a via that is met, and missed", T.BLEND, lambda p: with_arrival(p, 2, missed_by=Missed((0.0,) * 4, 0.0))),
    ("a smaller error", T.ERROR, lambda p: with_arrival(p, 1, error=smaller(p.arrivals[1].error))),
)


def moved(pose: Pose) -> Pose:
    """A pose 2 µm aside."""
    return replace(pose, x=pose.x + 2e-6)


def smaller(error: ArrivalError | None) -> ArrivalError:
    """An error that is 1 µm smaller than another one."""
    assert error is not None
    return replace(error, position_m=error.position_m - 1e-6)


def missed_less(plan: Plan) -> Plan:
    """The plan that states that a joint misses its via by another amount."""
    missed = plan.arrivals[0].missed_by
    assert missed is not None
    return with_arrival(plan, 0, missed_by=replace(missed, joints=(missed.joints[0] + 1e-6, *missed.joints[1:])))


def missed_nearer(plan: Plan) -> Plan:
    """The plan that states that its via is missed by less."""
    missed = plan.arrivals[0].missed_by
    assert missed is not None
    return with_arrival(plan, 0, missed_by=replace(missed, distance_m=missed.distance_m - 1e-5))


def no_parabola(plan: Plan) -> Plan:
    """The plan in which a joint is elsewhere at a knot."""
    path = plan.trajectory
    q = path.q.copy()
    middle = float(path.time[len(path.time) // 2])
    q[path.time == middle, 0] += 1e-4
    return replace(plan, trajectory=Trajectory(path.time, q, path.qd, path.qdd, jumps=True))


def traced(plan: Plan, **changes: float) -> Plan:
    """The plan that states something else of its trace."""
    trace = plan.arrivals[0].trace
    assert trace is not None
    return with_arrival(plan, 0, trace=replace(trace, **changes))


OTHER_PLANS: tuple[tuple[str, str, Code, Callable[[Plan], Plan]], ...] = (
    ("another miss of a joint", BLENDS, T.BLEND, missed_less),
    ("a miss that is too small", BLENDS, T.BLEND, missed_nearer),
    ("a via that is not missed", BLENDS, T.BLEND, lambda p: with_arrival(p, 0, missed_by=None)),
    ("a piece that is no parabola", BLENDS, T.BLEND, no_parabola),
    ("a longer trace", TRACE, T.ARRIVAL, lambda p: traced(p, length_m=0.3)),
    ("a faster trace", TRACE, T.ARRIVAL, lambda p: traced(p, fastest_m_s=0.2)),
    ("a slower trace", TRACE, T.ARRIVAL, lambda p: traced(p, slowest_m_s=0.1)),
    ("a narrower range of speeds", TRACE, T.RATE, lambda p: traced(p, slowest_m_s=0.15)),
    ("a wide trace", TRACE, T.ARRIVAL, lambda p: traced(p, error_m=1.1e-5)),
    ("a trace that is nearer", TRACE, T.GUIDE, lambda p: traced(p, error_m=1e-6)),
    ("a trace of which nothing is stated", TRACE, T.ARRIVAL, lambda p: with_arrival(p, 0, trace=None)),
    ("no pitch", TILTS, T.ARRIVAL, lambda p: with_arrival(p, 0, pitch=None)),
    (
        "another pitch that is free",
        TILTS,
        T.JOINTS,
        other_pitch,
    ),
    ("a move called arch", DEMO, T.ARCH, lambda p: with_leg(p, 0, kind=LegKind.ARCH)),
    ("a via on a belt", BLENDS, T.ARRIVAL, lambda p: with_arrival(p, 0, along_m=0.0)),
)


@pytest.mark.parametrize(
    ("name", "topic", "change"), [each[1:] for each in OTHER_PLANS], ids=[each[0] for each in OTHER_PLANS]
)
def test_a_plan_that_states_what_is_not_so_is_refused(name: str, topic: Code, change: Callable[[Plan], Plan]) -> None:
    case = case_of(name)
    assert topic in {each.code for each in differences(case, plan=sealed(case.scene, change(case.plan)))}


@pytest.mark.parametrize(("topic", "change"), [each[1:] for each in PLANS], ids=[each[0] for each in PLANS])
def test_a_plan_that_does_not_do_the_task_is_refused(topic: Code, change: Callable[[Plan], Plan]) -> None:
    case = case_of(FLOW)
    assert topic in {each.code for each in differences(case, plan=sealed(case.scene, change(case.plan)))}


def test_the_digests_of_request_and_plan_are_compared() -> None:
    case = case_of(DEMO)
    wrong = replace(case.plan, certificate=replace(case.plan.certificate, digest=64 * "0"))
    assert {each.code for each in differences(case, plan=wrong)} == {Code.DIGEST}
    scene = replace(case.scene, digest="sha256:" + 64 * "0")
    assert {each.code for each in differences(replace(case, scene=scene))} == {Code.DIGEST}


ASKED: tuple[tuple[str, Code, Edit], ...] = (
    ("a larger margin to singular positions", Code.SINGULARITY, lambda r: r["options"].update(singularity_margin=0.6)),
    ("the other working mode", Code.ELBOW, lambda r: r["options"].update(elbow="left")),
)
"""Other requests, which ask for more of the arm's posture."""


@pytest.mark.parametrize(("topic", "change"), [each[1:] for each in ASKED], ids=[each[0] for each in ASKED])
def test_another_posture_than_is_asked_for_is_reported(topic: Code, change: Edit) -> None:
    assert topic in {each.code for each in differences(other(DEMO, change))}

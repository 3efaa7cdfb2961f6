"""Traces before the checker: its curves by another derivation, and tampering with what a trace promises."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.checked import check
from assur.planner.checker import Code, Finding
from assur.planner.checker.statement.curves import Bezier, Turn, curve_of
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws import conveyor
from assur.planner.model.outcome import Plan, Planned, Traced
from assur.planner.model.path import ArcTo, LineTo, Path, PathPart, SplineThrough
from assur.planner.model.scene import Scene, Target, Trace
from assur.planner.pipeline import plan
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CUP, cell, frame
from tests.planner.checker.hand_made import sealed

V = 0.1
BEGIN = (0.0, 0.0, 0.05)
PARTS: tuple[PathPart, ...] = (
    LineTo((0.03, 0.0, 0.05)),
    ArcTo((0.05, 0.02, 0.05), (0.03, 0.04, 0.05)),
    SplineThrough(((0.0, 0.045, 0.05), (-0.02, 0.04, 0.06))),
)
SHORTER = (*PARTS[:2], SplineThrough(((-0.02, 0.04, 0.06),)))
"""The same without a point of the spline."""


def scene_of(
    parts: tuple[PathPart, ...] = PARTS,
    speed: float = V,
    yaw: float = 0.3,
    lead: float = 0.004,
    begin: tuple[float, float, float] = (0.0, 0.0, 0.05),
) -> Scene:
    step = Trace("bead", Target("belt", Pose(*begin, yaw)), Path(begin, parts), speed, lead, lead)
    return cell(step, frames=(frame("belt", conveyor(Pose(-0.05, 0.35, 0.06), 0.12)),), tool=CUP)


@cache
def made(scene_number: int = 0) -> Plan:
    found = plan((scene_of(), scene_of(SHORTER), scene_of(yaw=0.3005))[scene_number])
    assert isinstance(found, Planned), found.sentence
    return found.plan


def findings_of(scene: Scene, changed: Plan) -> list[Finding]:
    """What is found, but for the rows of the certificate, which are of another motion."""
    findings = check(scene, sealed(scene, changed)).findings
    return [each for each in findings if each.code not in (Code.COVER, Code.ROW)]


def told(scene: Scene, changed: Plan) -> dict[Code, str]:
    """The same by code, in words."""
    return {each.code: each.what for each in findings_of(scene, changed)}


def off_the_path(scene: Scene, changed: Plan, least: float, most: float) -> bool:
    """Whether the tool is found to be off its path, by more than is allowed, and by an amount, m, that is in a range;
    and whether the step is named."""
    found = [each for each in findings_of(scene, changed) if each.code == Code.GUIDE]
    amounts = [each.amount for each in found]
    assert {(each.what, each.unit) for each in found} == {("bead: the tool leaves its way", "m")}
    return min(amounts) > 0.0 and least <= max(amounts) <= most


def shifted(changed: Plan, row: int, off: float) -> Plan:
    """The first joint is `off` rad elsewhere at one knot."""
    path = changed.trajectory
    q = path.q.copy()
    q[row, 0] += off
    return replace(changed, trajectory=Trajectory(path.time, q, path.qd, path.qdd))


def inside(changed: Plan) -> int:
    """A knot in the middle of the path."""
    first = changed.arrivals[0]
    return int(np.searchsorted(changed.trajectory.time, (first.time + first.until) / 2))


def test_a_right_trace_is_right() -> None:
    assert told(scene_of(), made()) == {}


@pytest.mark.parametrize("off", [1.2e-5, -1.2e-5])
def test_a_tool_that_goes_beside_the_path_with_its_speed_is_found(off: float) -> None:
    """The very motion of a path that is 12 µm beside."""
    beside = scene_of(begin=(0.0, 0.0, 0.05 + off), parts=tuple(lifted(part, off) for part in PARTS))
    found = plan(beside)
    assert isinstance(found, Planned), found.sentence
    assert off_the_path(scene_of(), found.plan, 0.0, 1.2e-5)


def lifted(part: PathPart, off: float) -> PathPart:
    def up(point: tuple[float, float, float]) -> tuple[float, float, float]:
        return point[0], point[1], point[2] + off

    if isinstance(part, LineTo):
        return LineTo(up(part.to))
    if isinstance(part, ArcTo):
        return ArcTo(up(part.via), up(part.to))
    return SplineThrough(tuple(up(point) for point in part.points))


def test_a_tool_that_is_far_off_its_path_is_found_with_the_step_and_how_far() -> None:
    assert off_the_path(scene_of(), shifted(made(), inside(made()), 0.1), 5e-5, 0.2)


def test_a_stretch_left_out_in_the_same_time_is_found() -> None:
    """The shorter way, slower by so much that it takes as long, with legs that last as they should."""
    long, short = curve_of(BEGIN, PARTS, 0.0).length, curve_of(BEGIN, SHORTER, 0.0).length
    slow = V * short / long
    lead = 0.004 * slow / V
    found = plan(scene_of(SHORTER, slow, lead=lead))
    assert isinstance(found, Planned), found.sentence
    trace = Traced(length_m=long, slowest_m_s=0.99 * V, fastest_m_s=1.01 * V, error_m=1e-5)
    first, *others = found.plan.arrivals
    tampered = replace(found.plan, arrivals=(replace(first, trace=trace), *others))
    assert Code.LEGS not in told(scene_of(), tampered)
    assert off_the_path(scene_of(), tampered, 0.0, 0.1)


def test_a_speed_that_swings_while_the_place_is_kept_is_found() -> None:
    """Two extra knots 1 ms beside each other, 3 µm off: the place is kept within 0.01 mm, the speed is not."""
    path = made().trajectory
    first = made().arrivals[0]
    t = (first.time + first.until) / 2 + np.array([0.0, 1e-3, 2e-3])
    rows = [np.concatenate([[x], *(path.evaluate(np.array([x]), k)[0] for k in range(3))]) for x in t]
    rows[1][1] += 8e-6
    gone = (path.time > t[0]) & (path.time < t[2])
    table = np.concatenate([path.knots[~gone], rows])
    changed = replace(made(), trajectory=Trajectory.of_knots(np.ascontiguousarray(table[np.argsort(table[:, 0])])))
    found = told(scene_of(), changed)
    assert Code.RATE in found


def test_another_yaw_is_found() -> None:
    found = told(scene_of(), made(2))
    assert set(found) == {Code.POINT}


COORDINATE = st.floats(-0.2, 0.2).map(lambda x: round(x, 4))
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE)
PART = st.one_of(
    st.builds(LineTo, POINT),
    st.builds(ArcTo, POINT, POINT),
    st.builds(SplineThrough, st.lists(POINT, min_size=1, max_size=4).map(tuple)),
)


@given(parts=st.lists(PART, min_size=1, max_size=5), blend=st.floats(1e-4, 0.02))
@settings(max_examples=100, deadline=None)
def test_both_derivations_of_a_path_are_the_same_curve(parts: list[PathPart], blend: float) -> None:
    try:
        path = Path((0.0, 0.0, 0.0), tuple(parts), blend)
    except InputError:
        return
    own = curve_of(path.begin, path.parts, path.blend_m)
    assert own.length == pytest.approx(path.length, rel=1e-8)
    for begin, cut in zip(own.edges.tolist(), own.parts, strict=False):
        length = cut.end - cut.begin
        s = np.linspace(0.0, length, 33)[1:-1]
        p, tangent, bend = path.curve.at(begin + s)
        assert np.abs(cut.state(s)[0] - p).max() < 1e-8
        assert np.abs(own.state(begin + s)[0] - p).max() < 1e-8
        assert (np.linalg.norm(bend, axis=1) <= cut.part.bend * (1 + 1e-6) + 1e-6).all()
        step = 1e-6 * length
        ahead, back = (path.curve.at(begin + s + off)[0] for off in (step, -step))
        assert np.abs((ahead - back) / (2 * step) - tangent).max() < 1e-3
        assert np.abs(cut.state(s)[1] - tangent).max() < 1e-3


def test_an_arc_and_a_straight_polynomial_have_their_curvature() -> None:
    arc = curve_of((0.1, 0.0, 0.0), (ArcTo((0.0, 0.1, 0.0), (-0.1, 0.0, 0.0)),), 0.0)
    (cut,) = arc.parts
    assert isinstance(cut.part, Turn)
    assert cut.part.bend == pytest.approx(10.0)
    assert arc.length == pytest.approx(0.1 * np.pi)
    assert Bezier(np.outer(np.arange(4), [0.01, 0.0, 0.0])).bend == pytest.approx(0.0, abs=1e-9)
    # a cusp has no bound
    assert Bezier(np.array([[0.0, 0, 0], [1.0, 0, 0], [0.0, 0, 0], [1.0, 0.0, 0]])).bend == np.inf

"""Paths in a request: what they become, and at which field what cannot be is refused."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from assur.planner.model.path import ArcTo, LineTo, SplineThrough
from assur.planner.model.scene import Move, Trace
from assur.scenes.requests import plan_document, scene_of
from tests.changed import GONE, changed
from tests.scenes.bad_requests import Bad

REQUEST: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -60]}},
    "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 300, "j4_deg": 0}},
    "frames": {
        "belt": {"conveyor": {"at_mm": [0, 300, 60], "speed_mm_s": 100}},
        "tray": {"fixed": {"frame": "belt", "at_mm": [10, 0, 0], "yaw_deg": 90}},
    },
    "bodies": [
        {"name": "part", "shape": {"box": {"size_mm": [10, 10, 10]}}, "pose": {"frame": "tray", "at_mm": [5, 0, 5]}}
    ],
    "task": [
        {
            "trace": {
                "start": {"frame": "belt", "at_mm": [0, 0, 40], "yaw_deg": 0},
                "path": [
                    {"line": {"to_mm": [50, 0, 40]}},
                    {"arc": {"via_mm": [70, 20, 40], "to_mm": [50, 40, 40]}},
                    {"spline": {"through_mm": [[20, 45, 40], [0, 40, 40]]}},
                ],
                "speed_mm_s": 100,
            }
        },
        {
            "move": {
                "to": {"at_mm": [350, 100, 150]},
                "leg": "cartesian",
                "path": [{"line": {"to_mm": [350, 0, 150]}}, {"arc": {"via_mm": [400, 50, 150]}}],
                "blend_mm": 5,
            }
        },
    ],
}


def trace_of(**trace: Any) -> Trace:
    """The trace of the request, with some of it replaced."""
    step = scene_of(changed(REQUEST, {f"task[0].trace.{key}": value for key, value in trace.items()})).task[0]
    assert isinstance(step, Trace)
    return step


def test_a_path_is_read_in_si_and_in_its_frame() -> None:
    step = trace_of()
    assert step.path.begin == (0.0, 0.0, 0.04)
    assert step.path.parts == (
        LineTo((0.05, 0.0, 0.04)),
        ArcTo((0.07, 0.02, 0.04), (0.05, 0.04, 0.04)),
        SplineThrough(((0.02, 0.045, 0.04), (0.0, 0.04, 0.04))),
    )
    assert (step.target.frame, step.speed_m_s) == ("belt", 0.1)
    # a peak of 3 m/s² over a rise of 50 ms
    assert step.lead_in_m == step.lead_out_m == pytest.approx(0.1 / 2 * 0.05)


def test_a_slow_trace_has_a_lead_of_40_ms() -> None:
    assert trace_of(speed_mm_s=20).lead_in_m == pytest.approx(0.02 / 2 * 0.04)


def test_points_beside_a_body_and_in_a_frame_that_goes_with_another_are_in_the_frame_that_moves() -> None:
    for start in (
        {"frame": "tray", "at_mm": [5, 0, 40], "yaw_deg": 0},
        {"body": "part", "at_mm": [0, 0, 35], "yaw_deg": 0},
    ):
        step = trace_of(start=start, path=[line(55, 0, 40) if "frame" in start else line(50, 0, 35)])
        (part,) = step.path.parts
        assert isinstance(part, LineTo)
        # the tray is turned by 90°: its x is the belt's y
        assert step.path.begin == pytest.approx((0.01, 0.005, 0.04))
        assert part.to == pytest.approx((0.01, 0.055, 0.04))
        assert step.target.frame == "belt"
        assert step.target.pose.yaw == pytest.approx(math.pi / 2)


def test_the_last_part_of_a_move_ends_at_its_to() -> None:
    step = scene_of(REQUEST).task[1]
    assert isinstance(step, Move)
    assert step.path == (LineTo((0.35, 0.0, 0.15)), ArcTo((0.4, 0.05, 0.15), (0.35, 0.1, 0.15)))
    assert step.blend_m == 0.005


def legs(*parts: dict[str, Any], **before: Any) -> dict[str, Any]:
    """A move to (350, 0, 150) mm, and from there along parts to (350, 100, 150) mm."""
    path = {"to": {"at_mm": [350, 100, 150]}, "leg": "cartesian", "path": list(parts), "blend_mm": 5}
    return {"task": [{"move": {"to": {"at_mm": [350, 0, 150]}, **before}}, {"move": path}]}


def line(*to_mm: float) -> dict[str, Any]:
    return {"line": {"to_mm": list(to_mm)}}


def arc(*via_mm: float, **more: list[float]) -> dict[str, Any]:
    return {"arc": {"via_mm": list(via_mm), **more}}


TRACE, MOVE = "task[0].trace", "task[1].move"
PATH = f"{TRACE}.path"
BAD: tuple[Bad, ...] = (
    Bad("no parts", {PATH: []}, said="1"),
    Bad("a part of no kind", {PATH: [{}]}, "[0]", "line, arc, spline"),
    Bad("a line to nowhere", {PATH: [{"line": {}}]}, "[0].line.to_m", "must be given"),
    Bad("a line of no length", {PATH: [line(0, 0, 40)]}, "[0].line.to_mm", "0.01 mm apart"),
    Bad(
        "an arc that is a line",
        {PATH: [arc(10, 0, 40, to_mm=[20, 0, 40])]},
        "[0].arc.via_mm",
        "a point beside the line from (0, 0, 40) mm to (20, 0, 40) mm, on a circle of 100 m at most; or a line",
    ),
    Bad("a corner", {PATH: [line(50, 0, 40), line(50, 50, 40)]}, "[1]", "the corner of 90 deg"),
    Bad(
        "a spline that stands",
        {PATH: [{"spline": {"through_mm": [[9, 0, 40]] * 2}}]},
        "[0].spline.through_mm",
        "0.01 mm",
    ),
    Bad("a point of two numbers", {PATH: [line(1, 2)]}, "[0].line.to_mm", "3"),
    Bad("a point without unit", {PATH: [{"line": {"to": [1, 2, 3]}}]}, "[0].line.to", "to_m"),
    Bad("no speed", {f"{TRACE}.speed_mm_s": 0}, said="0"),
    Bad("a speed backwards", {f"{TRACE}.speed_mm_s": -5}, said="0"),
    Bad("a speed beyond all", {f"{TRACE}.speed_mm_s": 1e9}, said="100"),
    Bad("a speed left out", {f"{TRACE}.speed_mm_s": GONE}, f"{TRACE}.speed_m_s", "given"),
    Bad("a lead of nothing", {f"{TRACE}.lead_in_mm": 0}, said="0"),
    Bad("a blend below nothing", {f"{TRACE}.blend_mm": -1}, said="0"),
    Bad("a yaw left out", {f"{TRACE}.start.yaw_deg": GONE}, f"{TRACE}.start.yaw_rad", "must be given"),
    Bad("a misspelt frame", {f"{TRACE}.start.frame": "bolt"}, said="belt"),
    Bad("a path of joints", {f"{MOVE}.leg": "joint"}, f"{MOVE}.path", "leg: cartesian"),
    Bad("a path to a via", {f"{MOVE}.via": True}, f"{MOVE}.path", "without via"),
    Bad("a last line with an end", {f"{MOVE}.path": [line(350, 100, 150)]}, "[0].line.to_mm", "ends at the move's"),
    Bad("a blend without a path", {f"{MOVE}.path": GONE}, f"{MOVE}.blend_mm"),
    Bad("an arc on the line from before", legs(arc(350, 40, 150)), "[1].move.path[0].arc.via_mm", "from (350, 0, 150)"),
    Bad("an arc through its beginning", legs(arc(350, 0, 150)), "[1].move.path[0].arc.via_mm", "where the arc begins"),
    Bad("an arc through its end", legs(arc(350, 100, 150)), "[1].move.path[0].arc.via_mm", "where the arc ends"),
    Bad(
        "a line from where it ends",
        legs({"line": {}}, to={"at_mm": [350, 100, 150]}),
        "[1].move.to.at_mm",
        "where the part begins",
    ),
    Bad(
        "a corner that goes back",
        legs(line(350, 50, 150), line(350, 0, 150), {"line": {}}),
        "[1].move.path[1]",
        "a corner of 170 deg at most",
    ),
)
ANYWHERE = (
    ([line(350, 0, 150), arc(350, 50, 150)], "path[1].arc.via_mm", "to (350, 100, 150) mm, on a circle"),
    ([line(350, 100, 150), {"line": {}}], "to.at_mm", "0.01 mm apart"),
    ([arc(350, 100, 150)], "path[0].arc.via_mm", "0.01 mm apart"),
    ([{"spline": {"through_mm": [[300, 9, 150]] * 2}}], "path[0].spline.through_mm", "0.01 mm apart"),
)
"""Parts that are wrong wherever the leg begins."""
BAD += tuple(
    Bad(f"{field} after {name}", changes, f"{MOVE}.{field}", said)
    for parts, field, said in ANYWHERE
    for name, changes in (("a trace", {f"{MOVE}.path": parts}), ("a via", legs(*parts, via=True)))
)


@pytest.mark.parametrize("bad", BAD, ids=lambda bad: bad.name)
def test_what_cannot_be_is_refused_at_its_field(bad: Bad) -> None:
    replace(bad, on=REQUEST).refused()


def test_a_leg_that_begins_in_another_frame_or_at_a_via_is_not_refused_for_where_it_begins() -> None:
    for before in ({"via": True}, {"to": {"frame": "belt", "at_mm": [350, 0, 150]}}):
        assert len(scene_of(changed(REQUEST, legs(arc(350, 40, 150), **before))).task) == 2


def test_a_first_leg_whose_points_are_on_a_line_is_refused_without_a_search() -> None:
    for via, proved in (([300, 50, 100], True), ([320, 50, 100], None)):
        to = {"at_mm": [300, 100, 100], "yaw_deg": 0}
        made = changed(
            REQUEST,
            {
                "start": {"tool": {"at_mm": [300, 0, 100], "yaw_deg": 0}, "elbow": "right"},
                "task": [{"move": {"leg": "cartesian", "to": to, "path": [arc(*via)]}}],
                "options": {"stop": "first", "max_candidates": 50, "budget_s": 60},
            },
        )
        answer: Any = plan_document(made)
        assert answer.get("proved") is proved
        assert answer["census"]["candidates"] == 0 or not proved

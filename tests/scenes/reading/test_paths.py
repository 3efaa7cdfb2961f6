"""Paths in a request: what they become, and at which field what cannot be is refused."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.planner.model.path import ArcTo, LineTo, SplineThrough
from assur.planner.model.scene import Move, Trace
from assur.scenes.requests import plan_document, scene_of

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


def request(**trace: Any) -> dict[str, Any]:
    """The request with some of the trace replaced; None: left out."""
    made = copy.deepcopy(REQUEST)
    step = made["task"][0]["trace"]
    for key, value in trace.items():
        if value is None:
            del step[key]
        else:
            step[key] = value
    return made


def moving(**move: Any) -> dict[str, Any]:
    made = copy.deepcopy(REQUEST)
    made["task"][1]["move"].update(move)
    return made


def trace_of(made: dict[str, Any]) -> Trace:
    step = scene_of(made).task[0]
    assert isinstance(step, Trace)
    return step


def test_a_path_is_read_in_si_and_in_its_frame() -> None:
    step = trace_of(REQUEST)
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
    assert trace_of(request(speed_mm_s=20)).lead_in_m == pytest.approx(0.02 / 2 * 0.04)


def test_points_beside_a_body_and_in_a_frame_that_goes_with_another_are_in_the_frame_that_moves() -> None:
    for start in (
        {"frame": "tray", "at_mm": [5, 0, 40], "yaw_deg": 0},
        {"body": "part", "at_mm": [0, 0, 35], "yaw_deg": 0},
    ):
        points = {"line": {"to_mm": [55, 0, 40] if "frame" in start else [50, 0, 35]}}
        step = trace_of(request(start=start, path=[points]))
        (line,) = step.path.parts
        assert isinstance(line, LineTo)
        # the tray is turned by 90°: its x is the belt's y
        assert step.path.begin == pytest.approx((0.01, 0.005, 0.04))
        assert line.to == pytest.approx((0.01, 0.055, 0.04))
        assert step.target.frame == "belt"
        assert step.target.pose.yaw == pytest.approx(math.pi / 2)


def test_the_last_part_of_a_move_ends_at_its_to() -> None:
    step = scene_of(REQUEST).task[1]
    assert isinstance(step, Move)
    assert step.path == (LineTo((0.35, 0.0, 0.15)), ArcTo((0.4, 0.05, 0.15), (0.35, 0.1, 0.15)))
    assert step.blend_m == 0.005


TRACE, MOVE = "task[0].trace", "task[1].move"


@pytest.mark.parametrize(
    ("made", "field", "word"),
    [
        (request(path=[]), f"{TRACE}.path", "1"),
        (request(path=[{}]), f"{TRACE}.path[0]", "line, arc, spline"),
        (request(path=[{"line": {}}]), f"{TRACE}.path[0].line.to_m", "must be given"),
        (request(path=[{"line": {"to_mm": [0, 0, 40]}}]), f"{TRACE}.path[0].line.to_mm", "0.01 mm apart"),
        (
            request(path=[{"arc": {"via_mm": [10, 0, 40], "to_mm": [20, 0, 40]}}]),
            f"{TRACE}.path[0].arc.via_mm",
            "a point beside the line from (0, 0, 40) mm to (20, 0, 40) mm, on a circle of 100 m at most; or a line",
        ),
        (
            request(path=[{"line": {"to_mm": [50, 0, 40]}}, {"line": {"to_mm": [50, 50, 40]}}]),
            f"{TRACE}.path[1]",
            "the corner of 90 deg",
        ),
        (
            request(path=[{"spline": {"through_mm": [[9, 0, 40], [9, 0, 40]]}}]),
            f"{TRACE}.path[0].spline.through_mm",
            "0.01 mm apart",
        ),
        (request(path=[{"line": {"to_mm": [float("nan"), 0, 40]}}]), f"{TRACE}.path[0].line.to_mm[0]", "finite"),
        (request(path=[{"line": {"to_mm": [1, 2]}}]), f"{TRACE}.path[0].line.to_mm", "3"),
        (request(path=[{"line": {"to": [1, 2, 3]}}]), f"{TRACE}.path[0].line.to", "to_m"),
        (request(speed_mm_s=0), f"{TRACE}.speed_mm_s", "0"),
        (request(speed_mm_s=-5), f"{TRACE}.speed_mm_s", "0"),
        (request(speed_mm_s=1e9), f"{TRACE}.speed_mm_s", "100"),
        (request(speed_mm_s=None), f"{TRACE}.speed", "given"),
        (request(lead_in_mm=0), f"{TRACE}.lead_in_mm", "0"),
        (request(blend_mm=-1), f"{TRACE}.blend_mm", "0"),
        (request(start={"frame": "belt", "at_mm": [0, 0, 40]}), f"{TRACE}.start.yaw_rad", "must be given"),
        (request(start={"frame": "bolt", "at_mm": [0, 0, 40], "yaw_deg": 0}), f"{TRACE}.start.frame", "belt"),
        (moving(leg="joint"), f"{MOVE}.path", "leg: cartesian"),
        (moving(via=True), f"{MOVE}.path", "without via"),
        (moving(path=[{"line": {"to_mm": [350, 100, 150]}}]), f"{MOVE}.path[0].line.to_mm", "ends at the move's"),
    ],
)
def test_what_cannot_be_is_refused_at_its_field(made: dict[str, Any], field: str, word: str) -> None:
    with pytest.raises(InputError) as error:
        scene_of(made)
    assert error.value.field.startswith(field)
    assert word in error.value.allowed


def legs(*parts: dict[str, Any], before: dict[str, Any] | None = None) -> dict[str, Any]:
    """A move to (350, 0, 150) mm, or what is given, and from there along parts to (350, 100, 150) mm."""
    made = copy.deepcopy(REQUEST)
    first = {"to": {"at_mm": [350, 0, 150]}} if before is None else before
    path = {"to": {"at_mm": [350, 100, 150]}, "leg": "cartesian", "path": list(parts), "blend_mm": 5}
    made["task"] = [{"move": first}, {"move": path}]
    return made


@pytest.mark.parametrize(
    ("made", "field", "words"),
    [
        (legs({"arc": {"via_mm": [350, 40, 150]}}), f"{MOVE}.path[0].arc.via_mm", "beside the line from (350, 0, 150)"),
        (legs({"arc": {"via_mm": [350, 0, 150]}}), f"{MOVE}.path[0].arc.via_mm", "(350, 0, 150) mm is where the arc b"),
        (legs({"arc": {"via_mm": [350, 100, 150]}}), f"{MOVE}.path[0].arc.via_mm", "mm is where the arc ends"),
        (legs({"line": {}}, before={"to": {"at_mm": [350, 100, 150]}}), f"{MOVE}.to.at_mm", "where the part begins"),
        (
            legs({"line": {"to_mm": [350, 50, 150]}}, {"line": {"to_mm": [350, 0, 150]}}, {"line": {}}),
            f"{MOVE}.path[1]",
            "a corner of 170 deg at most",
        ),
    ],
)
def test_a_leg_whose_beginning_is_known_is_refused_at_its_part(made: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(InputError) as error:
        scene_of(made)
    assert error.value.field == field
    assert words in error.value.allowed


@pytest.mark.parametrize(
    ("parts", "field", "words"),
    [
        (
            ({"line": {"to_mm": [350, 0, 150]}}, {"arc": {"via_mm": [350, 50, 150]}}),
            f"{MOVE}.path[1].arc.via_mm",
            "to (350, 100, 150) mm, on a circle",
        ),
        (({"line": {"to_mm": [350, 100, 150]}}, {"line": {}}), f"{MOVE}.to.at_mm", "0.01 mm apart"),
        (({"arc": {"via_mm": [350, 100, 150]}},), f"{MOVE}.path[0].arc.via_mm", "0.01 mm apart"),
        (({"spline": {"through_mm": [[300, 9, 150], [300, 9, 150]]}},), f"{MOVE}.path[0].spline", "0.01 mm apart"),
    ],
)
def test_what_is_wrong_wherever_a_leg_begins_is_refused_at_its_part(
    parts: tuple[dict[str, Any], ...], field: str, words: str
) -> None:
    for made in (moving(path=list(parts)), legs(*parts, before={"to": {"at_mm": [350, 0, 150]}, "via": True})):
        with pytest.raises(InputError) as error:
            scene_of(made)
        assert error.value.field.startswith(field)
        assert words in error.value.allowed


def test_a_leg_that_begins_in_another_frame_or_at_a_via_is_not_refused_for_where_it_begins() -> None:
    arc = {"arc": {"via_mm": [350, 40, 150]}}
    for before in (
        {"to": {"at_mm": [350, 0, 150]}, "via": True},
        {"to": {"frame": "belt", "at_mm": [350, 0, 150]}},
    ):
        assert len(scene_of(legs(arc, before=before)).task) == 2


def test_a_first_leg_whose_points_are_on_a_line_is_refused_without_a_search() -> None:
    for via, proved in (([300, 50, 100], True), ([320, 50, 100], None)):
        made = copy.deepcopy(REQUEST)
        made["start"] = {"tool": {"at_mm": [300, 0, 100], "yaw_deg": 0}, "elbow": "right"}
        to = {"at_mm": [300, 100, 100], "yaw_deg": 0}
        made["task"] = [{"move": {"leg": "cartesian", "to": to, "path": [{"arc": {"via_mm": via}}]}}]
        made["options"] = {"stop": "first", "max_candidates": 50, "budget_s": 60}
        answer: Any = plan_document(made)
        assert answer.get("proved") is proved
        assert answer["census"]["candidates"] == 0 or not proved


def test_a_blend_without_a_path_is_refused() -> None:
    made = moving()
    del made["task"][1]["move"]["path"]
    with pytest.raises(InputError) as error:
        scene_of(made)
    assert error.value.field == f"{MOVE}.blend_mm"

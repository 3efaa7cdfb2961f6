"""Frames of a document move as their words say, checked by formulas of this file's own."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.laws import Frame
from assur.scenes.requests import request_digest, scene_of
from tests.changed import changed
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST


def frame(law: dict[str, Any], **beside: Any) -> Frame:
    """The frame of a document, in a whole request."""
    return scene_of(changed(GOOD_REQUEST, {"frames.tested": {**law, **beside}})).frames["tested"]


def at(law: dict[str, Any], t: float) -> tuple[list[float], float]:
    """Position, mm, and yaw, degrees, at time t."""
    motion = frame(law).law.motion(np.array(t))
    return (1e3 * motion.p).tolist(), math.degrees(float(motion.yaw))


STOP = {"at_s": 1, "speed_mm_s": 0, "acceleration_mm_s2": 1000, "jerk_mm_s3": 20000}
"""From 200 to 0 mm/s at 1000 mm/s² with ramps of 50 ms: 200 + 50 ms, symmetric, so 100 mm/s on average."""
SLOWER = {"at_s": 0, "rate_deg_s": 0, "acceleration_deg_s2": 600, "jerk_deg_s3": 60000}
"""60 deg/s at 600 deg/s² with ramps of 10 ms: 110 ms at 30 deg/s on average."""
STOPS = {"conveyor": {"at_m": [0, 0, 0], "speed_mm_s": 200, "changes": [STOP]}}
DIAL = {"at_mm": [1, 2, 3], "yaw_deg": 10, "rate_deg_s": 60, "rise_mm_s": 2, "at_s": 1}
TURNING = {"indexer": {"at_m": [0, 0, 0], "step_deg": 45, "move_s": 0.5, "dwell_s": 1.5, "start_s": 1}}
TRAVELLING = {"indexer": {"at_m": [0, 0, 0], "yaw_deg": 90, "step_mm": 100, "move_s": 0.5, "dwell_s": 0.5}}
PIVOT = {"pivot_mm": [420, 120, 160], "yaw_deg": 20, "amplitude_deg": 50, "period_s": 1.6, "phase_deg": 90}
SWAYING = {"at_mm": [1, 2, 300], "yaw_deg": 90, "direction": [0, 0.6, 0.8], "amplitude_mm": 100, "period_ms": 1600}
ALONG = {"at_mm": [100, 0, 0], "yaw_deg": 30, "velocity_mm_s": [10, -20, 5], "at_s": 2}
POINTS: list[dict[str, Any]] = [{"time_s": t, "at_mm": [100 * t, 0, 0], "yaw_deg": 10 * t} for t in (0, 1, 3)]
ROUND: list[dict[str, Any]] = [
    {"time_s": 1, "at_mm": [0, 0, 0]},
    {"time_s": 1.5, "at_mm": [100, 50, 0]},
    {"time_s": 3, "at_mm": [0, 0, 0]},
]
AGAIN: dict[str, Any] = {"keyframes": {"points": ROUND, "repeat": True}}
WINDING: dict[str, Any] = {
    "keyframes": {"points": [{**ROUND[0], "yaw_deg": 90}, ROUND[1], {**ROUND[2], "yaw_deg": 450}], "repeat": True}
}
PLACES: dict[str, tuple[dict[str, Any], dict[float, tuple[list[float], float]]]] = {
    "fixed": ({"fixed": {"at_mm": [1, 2, 3], "yaw_deg": 90}}, {7.0: ([1, 2, 3], 90)}),
    "linear, stated at a time": ({"linear": ALONG}, {4.0: ([120, -40, 10], 30)}),
    "a conveyor along its own x": (
        {"conveyor": {"at_mm": [0, 350, 50], "yaw_deg": 90, "speed_mm_s": 250, "at_s": 1}},
        {3.0: ([0, 850, 50], 90)},
    ),
    "a conveyor that stops": (STOPS, {1.25: ([200 + 25, 0, 0], 0), 9.0: ([200 + 25, 0, 0], 0)}),
    "a turntable that rises": ({"turntable": DIAL}, {2.5: ([1, 2, 6], 100)}),
    "a turntable that changes its rate": (
        {"turntable": {"at_m": [0, 0, 0], "rate_deg_s": 60, "changes": [SLOWER]}},
        {5.0: ([0, 0, 0], 30 * 0.11)},
    ),
    "an indexer that turns": (TURNING, {t: ([0, 0, 0], yaw) for t, yaw in ((1, 0), (1.5, 45), (3, 45), (3.5, 90))}),
    "an indexer that travels": (TRAVELLING, {0.5: ([0, 100, 0], 90)}),
    "a swing about its pivot": ({"swing": PIVOT}, {0.0: ([420, 120, 160], 70), 0.4: ([420, 120, 160], 20)}),
    "an oscillation along a direction of the world": (
        {"oscillation": {**SWAYING, "phase_deg": 90}},
        {0.0: ([1, 62, 380], 90), 0.4: ([1, 2, 300], 90), 0.8: ([1, -58, 220], 90)},
    ),
    "keyframes": ({"keyframes": {"points": POINTS}}, {t: ([100 * t, 0, 0], 10 * t) for t in (0, 1, 3)}),
    "keyframes that repeat in both directions of time": (
        AGAIN,
        {t: ([100, 50, 0], 0) for t in (-1998.5, -0.5, 1.5, 3.5, 2001.5)},
    ),
    "keyframes that wind": (WINDING, {t: ([0, 0, 0], yaw) for t, yaw in ((1, 90), (3, 450), (5, 810))}),
}


@pytest.mark.parametrize("name", PLACES)
def test_a_frame_is_where_its_words_put_it(name: str) -> None:
    law, places = PLACES[name]
    for t, (position, yaw) in places.items():
        found, turned = at(law, t)
        assert found == pytest.approx(position, abs=1e-6)
        assert turned == pytest.approx(yaw, abs=1e-9)


def test_keyframes_are_not_known_beyond_them_unless_they_repeat() -> None:
    law = {"keyframes": {"points": POINTS}}
    assert frame(law).law.valid == (0.0, 3.0)
    assert np.isnan(at(law, 3.1)[0]).all()
    assert frame(AGAIN).law.valid == (-math.inf, math.inf)
    assert at({"keyframes": {"points": POINTS, "ends": "natural"}}, 0.5) != at(law, 0.5)


def keyframes(**given: Any) -> dict[str, Any]:
    """The good request with another frame, of these keyframes."""
    made: dict[str, Any] = changed(GOOD_REQUEST, {"frames.tested": {"keyframes": {"points": ROUND, **given}}})
    return made


def test_how_keyframes_end_is_said_once() -> None:
    assert request_digest(keyframes(repeat=True)) == request_digest(keyframes(repeat=True, ends="periodic"))
    assert request_digest(keyframes()) == request_digest(keyframes(repeat=False, ends="clamped"))
    assert request_digest(keyframes()) != request_digest(keyframes(repeat=True))
    for given in ({"ends": "periodic"}, {"ends": "clamped", "repeat": True}, {"ends": "natural", "repeat": True}):
        with pytest.raises(InputError, match=r"tested\.keyframes\.ends: .*periodic with repeat: true") as caught:
            scene_of(keyframes(**given))
        assert caught.value.value == given["ends"]


@pytest.mark.parametrize(
    ("change", "key"),
    [({"at_mm": [0, 0, 1e-9]}, "at_mm"), ({"yaw_deg": 359}, "yaw_deg"), ({"at_mm": [0, 0, 1], "yaw_deg": 1}, "at_mm")],
)
def test_a_last_pose_that_is_not_the_first_is_refused_where_it_stands(change: dict[str, Any], key: str) -> None:
    points = [*ROUND[:-1], {**ROUND[-1], **change}]
    with refused_at(
        f"frames.tested.keyframes.points[2].{key}",
        "that of the first point, for the sequence repeats",
        value=change[key],
    ):
        scene_of(keyframes(points=points, repeat=True))


def changing(**given: Any) -> dict[str, Any]:
    """A belt that stops at 1 s and starts again at 2 s, with what is given of the first change."""
    again = {"at_s": 2, "speed_mm_s": 250, "acceleration_mm_s2": 500, "jerk_mm_s3": 5000}
    changes = [{"at_s": 1, "speed_mm_s": 0, **given}, again]
    made: dict[str, Any] = changed(GOOD_REQUEST, {"frames.belt.conveyor.changes": changes})
    return made


def test_a_change_without_acceleration_or_jerk_takes_stated_ones_and_the_answer_says_so() -> None:
    known = {"acceleration_mm_s2": 5000, "jerk_mm_s3": 50000}
    assumed = {
        "acceleration_mm_s2": "belt: acceleration of its changes 5 m/s^2, assumed where none is given: ",
        "jerk_mm_s3": "belt: jerk of its changes 50 m/s^3, assumed where none is given: ",
    }
    told = scene_of(changing(**known))
    assert not any("belt" in line for line in told.assumptions)
    for stated in ((), ("jerk_mm_s3",), ("acceleration_mm_s2",)):
        scene = scene_of(changing(**{key: known[key] for key in stated}))
        lines = [line for line in scene.assumptions if line.startswith("belt")]
        assert lines == [text + "a belt with a servo drive" for key, text in assumed.items() if key not in stated]
        t = np.linspace(0, 4, 99)
        np.testing.assert_array_equal(scene.frames["belt"].law.motion(t).p, told.frames["belt"].law.motion(t).p)
        assert scene.digest == told.digest


def test_a_dial_that_changes_its_rate_takes_those_of_a_dial() -> None:
    scene = scene_of(changed(GOOD_REQUEST, {"frames.dial.turntable.changes": [{"at_s": 1, "rate_deg_s": 0}]}))
    lines = [line for line in scene.assumptions if line.startswith("dial")]
    drive = "a dial of 500 mm with a servo drive"
    assert lines == [
        f"dial: acceleration of its changes 20 rad/s^2, assumed where none is given: {drive}",
        f"dial: jerk of its changes 200 rad/s^3, assumed where none is given: {drive}",
    ]
    # from π/3 rad/s to 0, less than 20²/200: two phases of √(π/3/200) each
    end = 1.0 + 2.0 * math.sqrt(math.pi / 600)
    law = scene.frames["dial"].law
    assert law.motion(np.array([end - 1e-3, end + 1e-9])).yaw_d.tolist() == [pytest.approx(1e-4, rel=0.01), 0.0]


def test_uncertainty_and_validity_belong_to_the_frame() -> None:
    made = frame({"fixed": {"at_m": [0, 0, 0]}}, uncertainty={"position_mm": 0.5, "speed_mm_s": 2}, valid_s=[0, 4])
    assert (made.uncertainty.position_m, made.uncertainty.speed_m_s) == (0.0005, 0.002)
    assert made.uncertainty.shift_s == (0.0, 0.0)
    assert made.law.valid == (0.0, 4.0)
    assert np.isnan(made.law.motion(np.array([-0.1, 4.1])).p).all()


def test_the_world_is_always_there_and_does_not_move() -> None:
    world = scene_of(GOOD_REQUEST).frames["world"]
    assert world.law.motion(np.array([0.0, 1e4])).p.tolist() == [[0.0] * 3] * 2


def on(below: str, x: float, y: float, yaw: float) -> dict[str, Any]:
    """A frame that is fixed on another."""
    return {"fixed": {"frame": below, "at_mm": [x, y, 5], "yaw_deg": yaw}}


def nested() -> dict[str, Any]:
    """A request with a nest on a tray, which goes with the belt, and one on a table; the nest is named before both."""
    frames = {
        "nest": on("tray", 30, 40, -20),
        "tray": on("belt", 100, -50, 60),
        **GOOD_REQUEST["frames"],
        "slot": on("table", 10, 0, 90),
        "table": {"fixed": {"frame": "world", "at_mm": [300, -200, 0], "yaw_deg": 45}},
    }
    made: dict[str, Any] = changed(GOOD_REQUEST, {"frames": frames})
    return made


@pytest.mark.parametrize("t", [0.0, 1.7])
def test_a_frame_on_a_frame_is_where_both_poses_together_put_it(t: float) -> None:
    request = nested()
    shape = {"sphere": {"radius_mm": 8}}
    request["bodies"] += [
        {"name": "in-nest", "shape": shape, "pose": {"frame": "nest", "at_mm": [1, 2, 3], "yaw_deg": 10}},
        {"name": "in-slot", "shape": shape, "pose": {"frame": "slot", "at_mm": [0, 0, 0]}},
        {"name": "beside", "shape": shape, "pose": {"body": "in-nest", "at_mm": [0, 0, 20]}},
    ]
    scene = scene_of(request)

    def where(name: str) -> tuple[complex, float, float]:
        body = scene.index[name]
        motion = scene.frames[body.frame].law.motion(np.array(t)).at(body.pose)
        return complex(*motion.p[:2]), float(motion.p[2]), float(motion.yaw)

    def turned(deg: float) -> complex:
        return complex(math.cos(math.radians(deg)), math.sin(math.radians(deg)))

    # by complex numbers, mm: the belt is at (250 t, 350, 50) and runs along x
    spot = 250 * t + 350j + (100 - 50j) + turned(60) * ((30 + 40j) + turned(-20) * (1 + 2j))
    assert where("in-nest")[0] == pytest.approx(spot / 1000)
    assert where("in-nest")[1:] == pytest.approx((0.063, math.radians(50)))
    assert where("beside")[1:] == pytest.approx((0.083, math.radians(50)))
    assert where("in-slot")[0] == pytest.approx((300 - 200j + turned(45) * 10) / 1000)
    assert where("in-slot")[1:] == pytest.approx((0.005, math.radians(135)))
    assert [scene.index[name].frame for name in ("in-nest", "in-slot", "beside")] == ["belt", "table", "belt"]


def test_a_step_in_a_frame_on_a_belt_has_the_belts_way_and_uncertainty() -> None:
    request = nested()
    to = {"frame": "nest", "at_mm": [0, 0, 60], "yaw_deg": 0}
    request["task"] = [{"follow": {"to": to, "duration_ms": 50, "window_mm": [0, 400]}}]
    scene = scene_of(request)
    target = scene.task[0].target
    assert target is not None
    assert target.frame == "belt"
    assert scene.frames["belt"].uncertainty.speed_m_s == 0.002
    assert (target.pose.z, target.pose.yaw) == pytest.approx((0.07, math.radians(40)))


def test_a_frame_may_be_called_as_being_fixed_in_the_world() -> None:
    made = frame({"fixed": {"frame": "world", "at_mm": [1, 2, 3]}}, uncertainty={"position_mm": 0.5})
    assert made.uncertainty.position_m == 0.0005

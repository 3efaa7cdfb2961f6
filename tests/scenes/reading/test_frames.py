"""Frames of a document move as their words say, checked by formulas of this file's own."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from assur.planner.frames import Frame
from assur.scenes.requests import scene_of
from tests.scenes.bad_requests import GOOD_REQUEST


def frame(law: dict[str, Any], **beside: Any) -> Frame:
    """The frame of a document, in a whole request."""
    request = copy.deepcopy(GOOD_REQUEST)
    request["frames"]["tested"] = {**law, **beside}
    return scene_of(request).frames["tested"]


def at(law: dict[str, Any], t: float) -> tuple[list[float], float]:
    """Position and yaw at time t."""
    motion = frame(law).law.motion(np.array(t))
    return motion.p.tolist(), float(motion.yaw)


def test_fixed_stays() -> None:
    position, yaw = at({"fixed": {"at_mm": [1, 2, 3], "yaw_deg": 90}}, 7.0)
    assert position == pytest.approx([1e-3, 2e-3, 3e-3])
    assert yaw == pytest.approx(math.pi / 2)


def test_linear_is_where_it_is_said_at_the_time_it_is_said() -> None:
    position, yaw = at({"linear": {"at_mm": [100, 0, 0], "yaw_deg": 30, "velocity_mm_s": [10, -20, 5], "at_s": 2}}, 4.0)
    assert position == pytest.approx([0.12, -0.04, 0.01])
    assert yaw == pytest.approx(math.radians(30))


def test_a_conveyor_travels_along_its_own_x() -> None:
    position, _ = at({"conveyor": {"at_mm": [0, 350, 50], "yaw_deg": 90, "speed_mm_s": 250, "at_s": 1}}, 3.0)
    assert position == pytest.approx([0.0, 0.85, 0.05])


def test_a_conveyor_stops_when_it_is_told_to() -> None:
    stop = {"at_s": 1, "speed_mm_s": 0, "acceleration_mm_s2": 1000, "jerk_mm_s3": 20000}
    law = {"conveyor": {"at_m": [0, 0, 0], "speed_mm_s": 200, "changes": [stop]}}
    # From 200 to 0 mm/s at 1000 mm/s2 with ramps of 50 ms: 200 + 50 ms, symmetric, so 100 mm/s on average.
    assert at(law, 1.25)[0][0] == pytest.approx(0.2 + 0.1 * 0.25, abs=1e-12)
    assert at(law, 9.0) == at(law, 1.25)


def test_a_turntable_turns_and_rises() -> None:
    law = {"turntable": {"at_mm": [1, 2, 3], "yaw_deg": 10, "rate_deg_s": 60, "rise_mm_s": 2, "at_s": 1}}
    position, yaw = at(law, 2.5)
    assert position == pytest.approx([1e-3, 2e-3, 6e-3])
    assert yaw == pytest.approx(math.radians(100))


def test_a_turntable_changes_its_rate() -> None:
    change = {"at_s": 0, "rate_deg_s": 0, "acceleration_deg_s2": 600, "jerk_deg_s3": 60000}
    law = {"turntable": {"at_m": [0, 0, 0], "rate_deg_s": 60, "changes": [change]}}
    # 60 deg/s at 600 deg/s2 with ramps of 10 ms: 110 ms at 30 deg/s on average.
    assert at(law, 5.0)[1] == pytest.approx(math.radians(30 * 0.11), abs=1e-12)


def test_an_indexer_turns_or_travels_by_steps() -> None:
    turning = {"indexer": {"at_m": [0, 0, 0], "step_deg": 45, "move_s": 0.5, "dwell_s": 1.5, "start_s": 1}}
    assert [round(math.degrees(at(turning, t)[1]), 9) for t in (1.0, 1.5, 3.0, 3.5)] == [0, 45, 45, 90]
    travelling = {"indexer": {"at_m": [0, 0, 0], "yaw_deg": 90, "step_mm": 100, "move_s": 0.5, "dwell_s": 0.5}}
    assert at(travelling, 0.5)[0] == pytest.approx([0, 0.1, 0])


def test_a_swing_swings_about_its_pivot() -> None:
    law = {"swing": {"pivot_mm": [420, 120, 160], "yaw_deg": 20, "amplitude_deg": 50, "period_s": 1.6, "phase_deg": 90}}
    position, yaw = at(law, 0.4)
    assert position == pytest.approx([0.42, 0.12, 0.16])
    assert yaw == pytest.approx(math.radians(20 + 50 * math.sin(math.radians(180))), abs=1e-12)
    assert at(law, 0.0)[1] == pytest.approx(math.radians(70))


def test_keyframes_pass_their_points_and_are_not_known_beyond_them() -> None:
    points: list[dict[str, Any]] = [{"time_s": t, "at_mm": [100 * t, 0, 0], "yaw_deg": 10 * t} for t in (0, 1, 3)]
    law = {"keyframes": {"points": points}}
    for point in points:
        position, yaw = at(law, float(point["time_s"]))
        assert position == pytest.approx([float(point["at_mm"][0]) / 1000, 0, 0], abs=1e-12)
        assert yaw == pytest.approx(math.radians(point["yaw_deg"]))
    assert frame(law).law.valid == (0.0, 3.0)
    assert np.isnan(at(law, 3.1)[0]).all()
    natural = {"keyframes": {"points": points, "ends": "natural"}}
    assert at(natural, 0.5) != at(law, 0.5)


def test_uncertainty_and_validity_belong_to_the_frame() -> None:
    made = frame({"fixed": {"at_m": [0, 0, 0]}}, uncertainty={"position_mm": 0.5, "speed_mm_s": 2}, valid_s=[0, 4])
    assert (made.uncertainty.position_m, made.uncertainty.speed_m_s) == (0.0005, 0.002)
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
    request = copy.deepcopy(GOOD_REQUEST)
    request["frames"] = {
        "nest": on("tray", 30, 40, -20),
        "tray": on("belt", 100, -50, 60),
        **request["frames"],
        "slot": on("table", 10, 0, 90),
        "table": {"fixed": {"frame": "world", "at_mm": [300, -200, 0], "yaw_deg": 45}},
    }
    return request


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

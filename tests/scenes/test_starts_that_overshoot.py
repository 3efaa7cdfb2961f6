"""A start in motion that must exceed a limit is proved to; one that need not is never refused for it.

Ruckig is the second opinion: its fastest change to a velocity far below brakes as hard as a joint can.
"""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest
import ruckig

from assur.planner.checker.refusals.judging import check_refusal
from assur.planner.checker.refusals.windows import overshoots
from assur.planner.checker.statement.differences import SAME
from assur.planner.checker.statement.limits import SHARES
from assur.planner.model.refusal import Overshoot, Refusal, Stage
from assur.planner.model.scene import Scene
from assur.planner.model.witness import PROVED_SHARE
from assur.scenes.requests import cell_of, check_document, plan_document
from tests.scenes.refused_cells import moving

Document = dict[str, Any]
FAR = 1e3
"""rad/s. A velocity to which no joint comes while it brakes, so that the braking is not eased before it turns round."""


def braked(v: float, a: float, acceleration: float, jerk: float) -> tuple[float, float]:
    """The greatest velocity and position of the fastest change from (0, v, a) to -FAR."""
    asked = ruckig.InputParameter(1)
    asked.control_interface = ruckig.ControlInterface.Velocity
    asked.current_position, asked.current_velocity, asked.current_acceleration = [0.0], [v], [a]
    asked.target_velocity, asked.target_acceleration = [-FAR], [0.0]
    asked.max_acceleration, asked.max_jerk = [acceleration], [jerk]
    found = ruckig.Trajectory(1)
    assert ruckig.Ruckig(1).calculate(asked, found) in (ruckig.Result.Working, ruckig.Result.Finished)
    low = max(a, 0.0) / jerk  # from here on the velocity falls; `position_extrema` is wrong of such motions
    fastest, high = found.at_time(low)[1][0], found.duration
    for _ in range(100):
        middle = (low + high) / 2.0
        low, high = (middle, high) if found.at_time(middle)[1][0] > 0.0 else (low, middle)
    return max(v, fastest), max(0.0, found.at_time(low)[0][0])


def refused(scene: Scene) -> list[Refusal]:
    """All refusals of a start that must exceed a limit."""
    return [each.refusal(Stage.START, 0) for each in overshoots(scene)]


def claims(request: Document) -> set[tuple[str | None, str | None]]:
    """Joint and rate of all refusals of a start, each of which the checker confirms."""
    scene = cell_of(request).scene
    found: set[tuple[str | None, str | None]] = set()
    for refusal in refused(scene):
        assert isinstance(refusal.facts, Overshoot)
        assert check_refusal(scene, refusal, None).ok
        found.add((refusal.joint, refusal.facts.rate))
    return found


def test_planner_and_checker_agree_on_random_starts_with_ruckig() -> None:
    """Of j1 and of j3, which slides."""
    rng, refused, kept = np.random.default_rng(2), 0, 0
    for _ in range(150):
        q1, v1, a1 = (float(x) for x in rng.uniform([-170, -7, -70], [170, 7, 70]))
        q3, v3, a3 = (float(x) for x in rng.uniform([100, -2, -20], [300, 2, 20]))
        request = moving({"j1_deg": q1, "j3_mm": q3}, {"j1_rad_s": v1, "j3_m_s": v3}, {"j1_rad_s": a1, "j3_m_s": a3})
        must: set[tuple[str | None, str | None]] = set()
        for joint, q, v, a, (low, high), most, acceleration, jerk in (
            ("j1", math.radians(q1), v1, a1, (-math.radians(170), math.radians(170)), 7.0, 70.0, 1000.0),
            ("j3", q3 / 1e3, v3, a3, (0.1, 0.3), 2.0, 20.0, 400.0),
        ):
            for sign, end in ((1.0, high), (-1.0, -low)):
                fastest, farthest = braked(sign * v, sign * a, acceleration, jerk)
                must |= {(joint, "velocity")} if fastest > most else set()
                must |= {(joint, None)} if sign * q + farthest > end else set()
        assert claims(request) == must, (q1, v1, a1, q3, v3, a3)
        refused, kept = refused + bool(must), kept + (not must)
    assert refused > 30
    assert kept > 30


ON = math.degrees(3 * 0.07 - 1000 * 0.07**3 / 6 + 0.55**2 / 140)
"""deg. How far j1 goes on from 3 rad/s: 70 ms to -70 rad/s², and then 0.55 rad/s at that."""
DOWN = 1e3 * (16 * 0.08**2 / 2 - 400 * 0.08**3 / 6)
"""mm. How far j3 goes on from rest at -16 m/s², until it is at rest again."""


@pytest.mark.parametrize(
    ("of_joint", "limit"),
    [(lambda x: moving({}, {"j1_rad_s": x}, {"j1_rad_s": 50}), 7.0 - 1.25),
     (lambda x: moving({}, {"j1_rad_s": -x}, {"j1_rad_s": -50}), 7.0 - 1.25),
     (lambda x: moving({"j1_deg": x}, {"j1_rad_s": 3}, {}), 170.0 - ON),
     (lambda x: moving({"j3_mm": 400.0 - x}, {}, {"j3_m_s": -16}), 300.0 - DOWN)],
)  # fmt: skip
def test_nothing_is_refused_at_the_boundary_and_all_beyond_it(of_joint: Any, limit: float) -> None:
    for inside in (limit, limit * (1.0 - 1e-12), limit * (1.0 - 1e-3)):
        assert not claims(of_joint(inside))
    assert claims(of_joint(limit * (1.0 + 1e-5)))


def test_it_is_proved_of_all_starts_that_a_plan_may_have_in_its_place() -> None:
    """Velocity and acceleration may be less by 2e-9, and limits exceeded by their shares."""
    least = 7.0 * (1.0 + PROVED_SHARE) + 2.0 * SAME - (50.0 - 2.0 * SAME) ** 2 / (2.0 * 1000.0 * (1.0 + SHARES[3]))
    assert not claims(moving({}, {"j1_rad_s": least - SAME}, {"j1_rad_s": 50}))
    assert claims(moving({}, {"j1_rad_s": least + SAME}, {"j1_rad_s": 50})) == {("j1", "velocity")}


def test_the_amounts_are_those_of_the_start() -> None:
    fast = plan_document(moving({}, {"j1_rad_s": 6.99}, {"j1_rad_s": 50}))
    assert (fast["reason"], fast["proved"], fast["refusal"]["joint"]) == ("MOTION_LIMIT", True, "j1")
    assert fast["refusal"]["facts"]["value"] == pytest.approx(8.24)
    assert fast["refusal"]["facts"]["limit"] == pytest.approx(7.0)
    assert (fast["refusal"]["amount"], fast["refusal"]["unit"]) == (pytest.approx(1.24), "rad/s")
    late = plan_document(moving({"j1_deg": 169}, {"j1_rad_s": 3}, {}))
    assert (late["reason"], late["proved"], late["refusal"]["joint"]) == ("JOINT_LIMIT", True, "j1")
    assert math.degrees(late["refusal"]["facts"]["value"]) == pytest.approx(177.88, abs=0.005)
    assert "177.88 deg" in late["sentence"]
    assert "7.88 deg too much" in late["sentence"]
    assert late["relaxation"] is None
    assert late["tried"] == []


HELD: Document = {"name": "lid", "shape": {"box": {"size_mm": [20, 20, 20]}}, "mass_kg": 4}


def holding(q1: float, place_ms: float | None) -> Document:
    """A start with 4 kg in the gripper, which leave half of the acceleration; the part is put down after a dwell."""
    place = {"part": "lid", "to": {"at_mm": [300, 250, 200], "yaw_deg": 90}, "dwell_ms": place_ms}
    steps = [] if place_ms is None else [{"place": {**place, "approach": {"mm": 10}, "depart": {"mm": 10}}}]
    request = moving(
        {"j1_deg": q1}, {"j1_rad_s": 3}, {}, *steps, bodies=[copy.deepcopy(HELD)],
        start={"holding": {"part": "lid", "grasp_mm": [0, 0, 0]}},
    )  # fmt: skip
    request["robot"]["limits"] = {"acceleration_by_load": [{"mass_kg": 2, "share": 1.0}, {"mass_kg": 4, "share": 0.5}]}
    return request


def test_a_load_that_is_kept_lowers_what_brakes() -> None:
    """Half of the braking goes 17.5° on from 3 rad/s, all of it 8.9°."""
    between = 158.0
    assert claims(holding(between, None)) == {("j1", None)}
    assert claims(holding(between, 500)) == {("j1", None)}
    # after a dwell that is shorter than the braking the part may be gone
    assert not claims(holding(between, 20))
    assert claims(holding(165.0, 20)) == {("j1", None)}
    assert not claims(moving({"j1_deg": between}, {"j1_rad_s": 3}, {}))


def test_a_crank_of_a_five_bar_and_an_arm_that_tilts_are_proved_as_well() -> None:
    rates = {"j1_rad_s": 0.0, "j2_rad_s": 0.0, "j3_m_s": 0.0}
    joint = {"velocity_deg_s": 400, "acceleration_rad_s2": 90, "jerk_rad_s3": 4000}
    five_bar: Document = {
        "separation_mm": 85, "proximal_mm": [200, 200], "distal_mm": [260, 260], "assembly": "front",
        "joints": [{"name": "j1", "range_deg": [-50, 60], **joint}, {"name": "j2", "range_deg": [-190, 50], **joint},
                   {"name": "j3", "range_mm": [60, 160], "velocity_m_s": 1, "acceleration_m_s2": 9, "jerk_m_s3": 600}],
        "bodies": [], "self_pairs": [],
    }  # fmt: skip
    request = moving({}, {}, {}, {"move": {"to": {"at_mm": [250, 0, 100]}}})
    request["robot"] = {"five_bar": five_bar, "tool": {"tcp_mm": [0, 0, 0]}}
    request["start"] = {
        "joints": {"j1_deg": 50, "j2_deg": -50, "j3_mm": 140},
        "velocity": rates | {"j1_rad_s": 6.0},
        "acceleration": {f"{name}2": 0.0 for name in rates},
    }
    found = plan_document(request)
    assert (found["reason"], found["proved"], found["refusal"]["joint"]) == ("JOINT_LIMIT", True, "j1")
    assert check_document(request, found)["ok"]


def test_nothing_is_claimed_of_a_plan_that_may_end_in_motion() -> None:
    request = moving({"j1_deg": 169}, {"j1_rad_s": 3}, {})
    proved = refused(cell_of(request).scene)[0]
    assert check_refusal(cell_of(request).scene, proved, None).ok
    request["options"]["end"] = "moving"
    scene = cell_of(request).scene
    assert not refused(scene)
    assert not check_refusal(scene, proved, None).ok

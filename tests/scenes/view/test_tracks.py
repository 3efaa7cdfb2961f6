"""Poses that are drawn are where the planner's kinematics and the time laws say, within 0.1 mm, at any time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.reading.plan import motion_of
from assur.scenes.view.distances import distances
from assur.scenes.view.document import OFF, curves
from assur.scenes.view.poses import WITHIN_M, Track, carrier_poses, instants
from assur.scenes.view.quaternions import rotated
from assur.scenes.view.tracks import Tracks, tracks
from tests.scenes.cells.answers import answer
from tests.scenes.view.shown import cell, scene

EVERY_FAMILY = ("demo", "five-bar", "rv-m1", "elbow-arm", "polar-arm", "lab-arm", "two-robots", "parabolic-blend")
INSTANTS = 400


def made(name: str) -> tuple[Tracks, Trajectory]:
    """The tracks of the answer to a shipped scenario."""
    trajectory, legs, arrivals = motion_of(answer(name), cell(name).conventions)
    return tracks(scene(name), trajectory, phases(scene(name), legs, arrivals), arrivals), trajectory


def reaches(shown: Tracks) -> FloatArray:
    """The greatest distance of a point of any body from the origin of each carrier, m."""
    found = np.zeros(len(shown.carriers))
    for body in shown.bodies:
        for seat in body["seats"]:
            far = float(np.linalg.norm(seat["at_m"])) + shown.meshes[body["mesh"]].reach
            found[seat["carrier"]] = max(found[seat["carrier"]], far)
    return found


def farthest_off(of: Scene, trajectory: Trajectory, track: Track, number: int, reach: float) -> float:
    """How far a point at `reach` m from the origin of a carrier, along any of its axes, is drawn from where it is, m,
    at most, at many random times between the instants that were looked at."""
    t = np.random.default_rng(1).uniform(trajectory.start, trajectory.end, INSTANTS)
    position, rotation = carrier_poses(of, trajectory, t)[number]
    worst, axes = 0.0, reach * np.eye(3)
    for k, (p, r) in enumerate(zip(*track.at(t), strict=True)):
        off = p + rotated(r, axes) - position[k] - rotated(rotation[k], axes)
        worst = max(worst, float(np.linalg.norm(off, axis=1).max()))
    return worst


@pytest.mark.parametrize("name", EVERY_FAMILY)
def test_every_point_that_is_drawn_is_within_a_tenth_of_a_millimetre(name: str) -> None:
    shown, trajectory = made(name)
    reach = reaches(shown)
    for number, track in enumerate(shown.carriers):
        assert farthest_off(scene(name), trajectory, track, number, reach[number]) <= WITHIN_M


def test_a_track_with_half_of_its_samples_is_found_out() -> None:
    shown, trajectory = made("demo")
    flange = shown.carriers[shown.flange]
    every = slice(None, None, 2)
    fewer = replace(flange, time=flange.time[every], position=flange.position[every], rotation=flange.rotation[every])
    assert farthest_off(scene("demo"), trajectory, fewer, shown.flange, reaches(shown)[shown.flange]) > WITHIN_M


@pytest.mark.parametrize("name", ["demo", "crowded", "rv-m1", "carton"])
def test_the_smallest_distance_that_is_shown_is_that_of_the_answer(name: str) -> None:
    said = answer(name)["margins"]["nearest"]
    trajectory, legs, arrivals = motion_of(answer(name), cell(name).conventions)
    pairs = distances(scene(name), trajectory, phases(scene(name), legs, arrivals), (said["time_s"],))
    least = min(each.gap_m for each in pairs)
    assert said["gap_m"] - 1e-9 <= least <= said["gap_m"] + 5e-5
    at = [each for each in pairs if each.time == said["time_s"]]
    assert min(each.gap_m for each in at) <= said["gap_m"] + 5e-5


@pytest.mark.parametrize("name", ["demo", "crowded", "rv-m1", "five-bar"])
def test_the_two_points_of_a_pair_are_as_far_apart_as_the_pair(name: str) -> None:
    trajectory, legs, arrivals = motion_of(answer(name), cell(name).conventions)
    pairs = distances(scene(name), trajectory, phases(scene(name), legs, arrivals))
    assert len(pairs) > 40
    for each in pairs:
        one, other = each.points
        assert abs(float(np.linalg.norm(one - other)) - each.gap_m) < 1e-6


def test_a_part_is_on_its_belt_then_in_the_gripper_then_on_the_dial() -> None:
    shown, _ = made("demo")
    (part,) = [body for body in shown.bodies if body["kind"] == "part"]
    assert [shown.carriers[seat["carrier"]].name for seat in part["seats"]] == ["belt", "flange", "dial"]
    ends = [arrival["until_s"] - shown.start for arrival in answer("demo")["arrivals"]]
    assert [seat["from_s"] for seat in part["seats"][1:]] == ends[:2]


def test_curves_show_both_sides_of_what_jumps_and_no_joint_beyond_its_limits() -> None:
    _, trajectory = made("demo")
    drawn = curves(scene("demo"), trajectory)
    assert (np.diff(drawn.time) == 0.0).any()
    span = scene("demo").robot.limits
    for order, limit in enumerate((span.velocity, span.acceleration, span.jerk), start=1):
        assert (np.abs(drawn.joints[:, order]) <= limit * (1 + 1e-3)).all()
    inner = np.random.default_rng(2).uniform(trajectory.start, trajectory.end, 500)
    for order, whole in enumerate((span.upper - span.lower, span.velocity, span.acceleration, span.jerk)):
        true = trajectory.evaluate(inner, order)
        for joint in range(trajectory.n):
            line = np.interp(inner, drawn.time, drawn.joints[:, order, joint])
            assert np.abs(line - true[:, joint]).max() <= 1.2 * OFF * whole[joint]


def test_instants_hold_every_knot_as_near_as_32_bits_have_it() -> None:
    _, trajectory = made("demo")
    t = instants(trajectory, trajectory.start, trajectory.end)
    since = (trajectory.edges - trajectory.start).astype(np.float32)
    assert set(since) <= set((t - trajectory.start).astype(np.float32))
    assert np.diff(t).max() <= 0.001 + 1e-6
    assert (np.diff((t - trajectory.start).astype(np.float32)) > 0.0).all()

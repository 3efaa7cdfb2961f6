"""The animated model: read as its specification says, it shows every body where the planner says that it is."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from assur.planner.model.attachments import Attachments
from assur.planner.model.phases import phases
from assur.planner.trajectory import Trajectory
from assur.scenes.exports import glb
from assur.scenes.exports.documents import export_document
from assur.scenes.exports.glb import Gltf
from assur.scenes.reading.plan import motion_of
from assur.scenes.scenarios import shipped, shipped_scenarios
from assur.scenes.view import display_meshes
from assur.scenes.view.display_meshes import mesh_of
from assur.scenes.view.poses import drawing_errors
from assur.scenes.view.tracks import tracks
from tests.refused import refused_at
from tests.scenes.cells.answers import answer
from tests.scenes.exports.glb_reader import Z_UP, Glb, in_cell
from tests.scenes.view.shown import cell, scene

Array = NDArray[np.float64]
WITHIN_M = 1e-4
MOST_BYTES = 200_000
INSTANTS = 300
PLANNED = [name for name in shipped_scenarios() if shipped(name).expect["status"] == "planned"]
CARRIED = ("demo", "belt-to-belt", "two-robots", "beside-a-neighbour", "loader", "full-dial", "carton", "transfer")
"""Scenarios with held parts, belts, dials and neighbours."""


@cache
def exported(name: str) -> dict[str, Any]:
    """The model of the answer to a shipped scenario, as an export."""
    scenario = shipped(name)
    return export_document(scenario.request, answer(name), {"format": "glb"}, folder=scenario.folder)


@cache
def model(name: str) -> Glb:
    return Glb.of(base64.b64decode(exported(name)["file"]))


def moved(name: str) -> tuple[Trajectory, Any]:
    """The motion of an answer, and its phases."""
    trajectory, legs, arrivals = motion_of(answer(name), cell(name).conventions)
    return trajectory, phases(scene(name), legs, arrivals)


def times(name: str) -> Array:
    """Times of the cell's clock, at random, within the motion."""
    trajectory, _ = moved(name)
    return np.sort(np.random.default_rng(5).uniform(trajectory.start, trajectory.end, INSTANTS))


def corners_below(file: Glb, node: int) -> Array:
    """The origin of a node, and the vertices (V, 3) of all that hangs below it, in its axes."""
    found = [np.zeros((1, 3))]
    inverse = np.linalg.inv(file.placed(node, np.zeros(1))[0])
    for child in file.document["nodes"][node].get("children", ()):
        below = inverse @ file.placed(child, np.zeros(1))[0]
        if below[:3, :3].any():
            found.append(below[:3, 3] + file.vertices(child) @ below[:3, :3].T)
    return np.concatenate(found)


def links_off(file: Glb, name: str) -> float:
    """How far the origin of a link, or a vertex of what is on it, is from where the planner's kinematics has it, m, at
    most."""
    t, (trajectory, _) = times(name), moved(name)
    robot, worst = scene(name).robot, 0.0
    position, rotation = robot.placements(trajectory.evaluate(t))
    for k, link in enumerate(robot.links):
        (node,) = [n for n in file.named(link) if "mesh" not in file.document["nodes"][n]]
        p, r = in_cell(file.placed(node, t - trajectory.start))
        corners = corners_below(file, node)
        drawn = p[:, None] + np.einsum("tij,vj->tvi", r, corners)
        true = position[:, None, k] + np.einsum("tij,vj->tvi", rotation[:, k], corners)
        worst = max(worst, float(np.linalg.norm(drawn - true, axis=-1).max()))
    return worst


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANNED)
def test_links_are_where_forward_kinematics_has_them(name: str) -> None:
    assert links_off(model(name), name) <= WITHIN_M
    file = exported(name)
    assert (file["format"], file["encoding"], file["jerk_raised"]) == ("glb", "base64", 1.0)
    assert len(base64.b64decode(file["file"])) <= MOST_BYTES


def place(name: str, attached: Attachments, body: str, t: float, trajectory: Trajectory) -> tuple[Array, float]:
    """Where the model of the planner has a body of the surroundings at a time: position, and its turn about z; of what
    is held by a tool that is upright."""
    of, held = scene(name), attached.held
    if held is not None and held.part == body:
        flange = of.robot.links.index("flange")
        p, r = of.robot.placements(trajectory.evaluate(np.clip(t, trajectory.start, trajectory.end)))
        assert r[flange][2] == pytest.approx([0.0, 0.0, 1.0])
        return p[flange] + r[flange] @ held.in_flange.position, np.arctan2(r[flange][1, 0], r[flange][0, 0]) + float(
            held.in_flange.yaw
        )
    frame, pose = attached.pose_of(of, body)
    motion = of.frames[frame].law.motion(np.array(t)).at(pose)
    return np.asarray(motion.p), float(motion.yaw)


@pytest.mark.parametrize("name", CARRIED)
def test_every_body_is_shown_once_and_where_it_is_held_or_carried(name: str) -> None:
    file, t, (trajectory, of_plan) = model(name), times(name), moved(name)
    starts = np.array([phase.t0 for phase in of_plan])
    seen = set[str]()
    for world in scene(name).bodies:
        nodes = file.named(world.name)
        placed = [file.placed(node, t - trajectory.start) for node in nodes]
        mesh = mesh_of(world.body).vertices
        for k, time in enumerate(t.tolist()):
            there = [each for each, node in zip(placed, nodes, strict=True) if each[k, :3, :3].any()]
            assert len(there) == 1
            node = nodes[next(i for i, each in enumerate(placed) if each is there[0])]
            attached = of_plan[int(np.searchsorted(starts, time, side="right")) - 1].attached
            p, yaw = place(name, attached, world.name, time, trajectory)
            c, s = np.cos(yaw), np.sin(yaw)
            true = p + mesh @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T
            drawn = (there[0][k, :3, 3] + file.vertices(node) @ there[0][k, :3, :3].T) @ Z_UP.T
            assert np.abs(true - drawn).max() <= WITHIN_M
        seen.add("several seats" if len(nodes) > 1 else "one seat")
    held = any(phase.attached.held is not None for phase in of_plan)
    assert seen == ({"several seats", "one seat"} if held else {"one seat"})


def test_every_body_of_the_arm_and_the_tool_hangs_below_its_link() -> None:
    file, robot = model("demo"), scene("demo").robot
    for each in robot.bodies:
        (node,) = file.named(each.body.name)
        above = file.document["nodes"][file.parents[node]]["name"]
        assert above == robot.links[each.link]
        assert file.vertices(node) == pytest.approx(mesh_of(each.body).vertices, abs=1e-7)


def test_up_is_y_and_units_are_metres() -> None:
    file, trajectory = model("demo"), moved("demo")[0]
    (flange,) = file.named("flange")
    position, _ = scene("demo").robot.placements(trajectory.evaluate(trajectory.start))
    x, y, z = position[scene("demo").robot.links.index("flange")]
    assert file.placed(flange, np.zeros(1))[0, :3, 3] == pytest.approx([x, z, -y], abs=1e-4)


def test_belts_and_dials_have_marks_that_move_with_them() -> None:
    file = model("demo")
    for frame in ("belt", "dial"):
        (node,) = file.named(f"marks of {frame}")
        assert file.document["nodes"][file.parents[node]]["name"] == frame
        one, other = file.placed(node, np.array([0.0, 1.0]))
        assert np.abs(one - other).max() > 0.05
    assert not file.named("marks of world")


def test_what_it_says_of_itself_is_so() -> None:
    export, file = exported("two-robots"), model("two-robots")
    assert "PICTURE OF THE MOTION" in export["statement"][0]
    keys = {k: len(time) for (k, path), (time, *_) in file.samplers.items() if path != "scale"}
    still = len([n for n, node in enumerate(file.document["nodes"]) if file.parents.get(n) in file.named("cell")
                 and n not in keys and "mesh" not in node])  # fmt: skip
    assert export["statement"][1].startswith(f"{sum(keys.values()) + still} keys")
    assert f"{len(base64.b64decode(export['file']))} bytes" in export["statement"][2]
    extras = file.document["scenes"][0]["extras"]
    assert extras["certificate_digest"] == export["certificate_digest"]
    assert extras["duration_s"] == export["duration_s"]
    assert {material["name"] for material in file.document["materials"]} >= {"robot", "part", "neighbour"}


def test_a_model_with_half_of_its_keys_is_found_out() -> None:
    file = model("demo")
    every = slice(None, None, 2)
    fewer = {key: (time[every], values[every], how) for key, (time, values, how) in file.samplers.items()}
    spoilt = replace(file)
    spoilt.__dict__["samplers"] = fewer
    assert links_off(spoilt, "demo") > WITHIN_M


def test_keys_are_added_where_steps_are_too_long_and_what_stays_off_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    request, plan = shipped("demo").request, answer("demo")
    monkeypatch.setattr(glb, "STEP_S", 0.01)
    trajectory, of_plan = moved("demo")
    coarse = tracks(scene("demo"), trajectory, of_plan, step_s=0.01)
    drawn = tuple(track.in_single_precision(coarse.start) for track in coarse.carriers)
    assert drawing_errors(scene("demo"), trajectory, drawn, coarse.start, coarse.end, 0.01).max() > WITHIN_M
    file = Glb.of(base64.b64decode(export_document(request, plan, {"format": "glb"})["file"]))
    assert links_off(file, "demo") <= WITHIN_M
    monkeypatch.setattr(glb, "FINER", 0)
    with refused_at("format", match=r"poses within 0\.1 mm"):
        export_document(request, plan, {"format": "glb"})


def test_a_mesh_with_fewer_triangles_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    request, plan = shipped("demo").request, answer("demo")
    whole = model("demo").triangles()
    monkeypatch.setattr(display_meshes, "MOST_TRIANGLES", 64)
    export = export_document(request, plan, {"format": "glb"})
    assert any("is drawn with fewer triangles" in line for line in export["statement"])
    assert Glb.of(base64.b64decode(export["file"])).triangles() < whole


def test_a_model_has_no_ticks() -> None:
    with refused_at("tick_ms", match="keys where they are needed"):
        export_document(shipped("demo").request, answer("demo"), {"format": "glb", "tick_ms": 1})


def test_corners_of_large_meshes_have_32_bits_and_all_is_aligned() -> None:
    made = Gltf()
    small = made.corners(np.array([[0, 1, 2]]))
    large = made.corners(np.array([[0, 1, 1 << 16]]))
    made.times(np.array([0.0, 0.1]))
    file = Glb.of(made.packed({}))
    assert [file.array(each).ravel().tolist() for each in (small, large)] == [[0, 1, 2], [0, 1, 1 << 16]]
    assert all(view["byteOffset"] % 4 == 0 for view in file.document["bufferViews"])
    broken = bytearray(made.packed({}))
    struct.pack_into("<I", broken, 8, 7)
    with pytest.raises(AssertionError):
        Glb.of(bytes(broken))
    assert json.loads(json.dumps(file.document)) == file.document

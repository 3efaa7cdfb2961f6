"""Bodies with pitch and roll: planner, viewer, animated model and judge have the same solid at the same place."""

from __future__ import annotations

import base64
import copy
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from assur.planner.errors import InputError
from assur.planner.geometry.shapes import support
from assur.scenes.exports.documents import export_document
from assur.scenes.requests import check_document, scene_of, view_document
from assur.scenes.view.display_meshes import mesh_of
from benchmarks.judge.cell import Cell
from benchmarks.judge.poses import Document
from benchmarks.judge.product import as_si
from benchmarks.judge.promises import broken_promises
from benchmarks.judge.simulation import simulated
from tests.scenes.bad_requests import GOOD_REQUEST
from tests.scenes.cells.answers import planned
from tests.scenes.exports.glb_reader import Z_UP, Glb
from tests.scenes.view.shown import drawn

SHAPES: dict[str, Document] = {
    "box": {"box": {"size_mm": [100, 60, 30]}},
    "cylinder": {"cylinder": {"radius_mm": 20, "height_mm": 90}},
    "rail": {"cylinder": {"radius_mm": 20, "height_mm": 90, "axis": "x"}},
    "bar": {"capsule": {"radius_mm": 10, "length_mm": 90, "axis": "y"}},
    "bracket": {"mesh": {"asset": "bracket", "unit": "mm"}},
    "housing": {"mesh": {"asset": "housing", "unit": "mm"}},
}
YAW, PITCH, ROLL = 25.0, -60.0, 35.0
TILT = {"pitch_deg": PITCH, "roll_deg": ROLL}
TURN = Rotation.from_euler("ZYX", [YAW, PITCH, ROLL], degrees=True).as_matrix()
"""R_z(yaw) R_y(pitch) R_x(roll)."""


def leaning(**pose: Any) -> Document:
    """A move past a bar that stands 77 mm beside the way, or leans across it."""
    bar = {"name": "bar", "shape": {"box": {"size_mm": [10, 10, 260]}}, "pose": {"at_mm": [480, 0, 100], **pose}}
    lamp = {"name": "lamp", "shape": {"sphere": {"radius_mm": 5}}, "pose": {"body": "bar", "at_mm": [0, 0, 135]}}
    cup = {"name": "cup", "shape": {"cylinder": {"radius_mm": 15, "height_mm": 100}}, "at_mm": [0, 0, -50]}
    return {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100], "bodies": [cup]}},
        "start": {"tool": {"at_mm": [350, -200, 60], "yaw_deg": 0}, "elbow": "right"},
        "bodies": [bar, lamp],
        "task": [{"move": {"to": {"at_mm": [350, 200, 60]}}}],
        "options": {
            "stop": "first",
            "budget_s": 60,
            "max_candidates": 200,
            "report": "full",
            "clearance_mm": {"travel": 5, "near": 5},
        },
    }


def tilted(shape: Document) -> Document:
    """The good request with one more body, which is tilted."""
    request = copy.deepcopy(GOOD_REQUEST)
    pose = {"at_mm": [0, -500, 200], "yaw_deg": YAW, **TILT}
    request["bodies"].append({"name": "tilted", "shape": shape, "pose": pose})
    return request


def farthest(points: NDArray[np.float64], about: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((points @ about.T).max(axis=0))


@pytest.mark.parametrize("name", SHAPES)
def test_the_shape_is_turned_by_roll_then_pitch_then_yaw(name: str) -> None:
    upright = scene_of(tilted(SHAPES[name]) | {"bodies": [*GOOD_REQUEST["bodies"], _upright(SHAPES[name])]})
    found = scene_of(tilted(SHAPES[name])).index["tilted"]
    assert found.frame == "world"
    assert found.pose.yaw == pytest.approx(np.radians(YAW))
    rng = np.random.default_rng(1)
    yaw = Rotation.from_euler("z", YAW, degrees=True).as_matrix()
    for n in rng.normal(size=(30, 3)):
        there = max(support(piece, yaw.T @ n) for piece in found.body.pieces)
        assert there == pytest.approx(max(support(p, TURN.T @ n) for p in upright.index["tilted"].body.pieces))
    mesh, plain = mesh_of(found.body).vertices @ yaw.T, mesh_of(upright.index["tilted"].body).vertices @ TURN.T
    np.testing.assert_allclose(mesh, plain, atol=1e-12)


def _upright(shape: Document) -> Document:
    return {"name": "tilted", "shape": shape, "pose": {"at_mm": [0, -500, 200]}}


@pytest.mark.parametrize("name", [name for name in SHAPES if name != "housing"])
def test_the_judge_has_the_same_solid(name: str) -> None:
    request = tilted(SHAPES[name])
    solid = Cell.of(as_si(request)).solids["tilted"]
    body = scene_of(request).index["tilted"].body
    assert not solid.exact
    assert (solid.offset[2] - solid.half_z, solid.offset[2] + solid.half_z) == pytest.approx(body.heights, abs=2e-6)
    assert solid.radius + np.hypot(*solid.offset[:2]) >= body.radius - 2e-6


def test_what_is_relative_to_a_tilted_body_stays_upright() -> None:
    scene = scene_of(leaning(pitch_deg=-60))
    pose = scene.index["lamp"].pose
    assert (pose.x, pose.y, pose.z, pose.yaw) == pytest.approx((0.48, 0.0, 0.235, 0.0))


def test_a_plan_keeps_clear_of_a_body_that_leans_into_its_way_and_the_judge_agrees() -> None:
    upright, leans = leaning(), leaning(pitch_deg=-60)
    rng = np.random.default_rng(0)
    answer = planned(leans)
    assert simulated(as_si(leans), answer, 4, rng)[0].faults == []
    assert broken_promises(as_si(leans), answer) == []
    ignorant = planned(upright)
    assert simulated(as_si(upright), ignorant, 4, rng)[0].faults == []
    assert {fault.kind for fault in simulated(as_si(leans), ignorant, 4, rng)[0].faults} >= {"collision"}
    assert broken_promises(as_si(leans), ignorant) != []


def test_a_plan_for_the_upright_body_is_refused_where_the_body_leans() -> None:
    ignorant = {**planned(leaning()), "request_digest": scene_of(leaning(pitch_deg=-60)).digest}
    verdict = check_document(leaning(pitch_deg=-60), ignorant)
    assert not verdict["ok"]


def test_viewer_and_model_draw_the_body_as_it_leans() -> None:
    request = leaning(yaw_deg=YAW, **TILT)
    answer = planned(request)
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = np.array([0.48, 0.0, 0.1]) + signs * [0.005, 0.005, 0.13] @ TURN.T
    ways = np.random.default_rng(2).normal(size=(40, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]

    view = dict(view_document(request, answer))
    (body,) = [each for each in view["bodies"] if each["name"] == "bar"]
    np.testing.assert_allclose(farthest(drawn(view, body, 0.0), ways), farthest(corners, ways), atol=1e-5)

    file = Glb.of(base64.b64decode(export_document(request, answer, {"format": "glb"})["file"]))
    (node,) = file.named("bar")
    there = file.placed(node, np.zeros(1))[0]
    points = (there[:3, 3] + file.vertices(node) @ there[:3, :3].T) @ Z_UP.T
    np.testing.assert_allclose(farthest(points, ways), farthest(corners, ways), atol=1e-5)


@pytest.mark.parametrize("key", ["pitch_deg", "roll_deg"])
def test_a_part_that_a_step_picks_stays_upright(key: str) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["bodies"][1]["pose"][key] = 10
    with pytest.raises(InputError) as refused:
        scene_of(request)
    assert refused.value.field == f"bodies[1].pose.{key}"
    assert (refused.value.value, refused.value.allowed) == (10, "0: a step picks part, and parts stay upright")
    request["bodies"][1]["pose"][key] = 0
    scene_of(request)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), None, "free", 1e6])
def test_a_tilt_is_a_number(value: Any) -> None:
    with pytest.raises(InputError) as refused:
        scene_of(leaning(roll_deg=value))
    assert refused.value.field == "bodies[0].pose.roll_deg"

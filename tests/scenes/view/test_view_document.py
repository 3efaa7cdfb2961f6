"""The document that a viewer plays: its form, its size, and that all in it is where the planner says."""

from __future__ import annotations

import copy
import json

import numpy as np
import pytest
from pydantic import TypeAdapter

from assur.scenes.requests import cell_of
from assur.scenes.scenarios import shipped, shipped_scenarios
from assur.scenes.schema.view import ViewDocument
from assur.scenes.view.display_meshes import MOST_OF_ALL, MOST_TRIANGLES, Mesh, displays, reduced, written
from assur.scenes.view.document import view_of
from assur.scenes.view.packing import floats, unpacked, words
from tests.refused import refused_at
from tests.scenes.cells.answers import answer
from tests.scenes.view.shown import cell, drawn, scene, view

MOST_BYTES = 400_000
"""Of a view of a shipped scenario."""


@pytest.mark.parametrize("name", shipped_scenarios())
def test_the_view_of_every_scenario_is_one_and_small(name: str) -> None:
    shown = view(name)
    TypeAdapter(ViewDocument).validate_python(shown)
    text = json.dumps(shown, allow_nan=False)
    assert json.loads(text) == shown
    assert len(text) <= MOST_BYTES
    assert sum(mesh["faces"]["shape"][0] for mesh in shown["meshes"]) <= MOST_OF_ALL
    assert shown["moves"] == (shown["curves"] is not None)


def test_every_body_of_the_robot_is_drawn_where_its_link_is() -> None:
    shown, robot = view("demo"), scene("demo").robot
    start = shown["start_s"]
    names = {body.body.name: body for body in robot.bodies}
    trajectory = answer("demo")["trajectory"]
    assert [joint.sign for joint in cell("demo").conventions] == [1] * 4
    for time, q in zip(trajectory["time_s"], trajectory["position"], strict=True):
        position, rotation = robot.placements(np.array(q))
        for body in shown["bodies"]:
            if body["name"] not in names:
                continue
            mesh = shown["meshes"][body["mesh"]]
            local = np.array(mesh["low_m"]) + unpacked(mesh["vertices"]) * np.array(mesh["step_m"])
            link = names[body["name"]].link
            there = position[link] + local @ rotation[link].T
            assert np.abs(drawn(shown, body, time - start) - there).max() <= 1.1e-4


def test_control_points_are_met_where_the_answer_says() -> None:
    from tests.scenes.view.shown import carrier_at

    shown = view("demo")
    for point, arrival in zip(shown["control_points"], answer("demo")["arrivals"], strict=True):
        assert point["time_s"] == pytest.approx(arrival["time_s"] - shown["start_s"])
        pose = carrier_at(shown["carriers"][point["carrier"]], point["time_s"])
        assert pose.of(np.array([point["at_m"]]))[0] == pytest.approx(arrival["at_m"], abs=2e-4)


def test_limits_are_lower_while_a_heavy_part_is_held() -> None:
    shown = view("heavy-casting")
    (held,) = shown["held"]
    spans = shown["curves"]["limits"]
    assert [span["from_s"] for span in spans] == [0.0, held["from_s"], held["to_s"]]
    assert [span["to_s"] for span in spans] == [held["from_s"], held["to_s"], shown["lasts_s"]]
    for span, part in zip(spans, (None, "casting", None), strict=True):
        limits = scene("heavy-casting").limits_with(part)
        for rate in ("velocity", "acceleration", "jerk"):
            assert span[rate] == getattr(limits, rate).tolist()
    assert spans[1]["acceleration"] < spans[0]["acceleration"]


def test_what_is_shown_of_a_refusal_without_a_motion_is_the_cell() -> None:
    shown = view("heavy-casting-refused")
    assert (shown["status"], shown["moves"], shown["curves"]) == ("not_planned", False, None)
    assert shown["refusal"]["sentence"] == answer("heavy-casting-refused")["sentence"]
    assert {body["kind"] for body in shown["bodies"]} >= {"robot", "part"}


def test_an_answer_with_the_digest_of_its_certificate_can_be_shown() -> None:
    brief = copy.deepcopy(answer("demo"))
    brief["certificate"] = {key: brief["certificate"][key] for key in ("digest", "rows", "covers")}
    assert view_of(cell("demo"), brief) == view("demo")


def test_an_answer_to_another_request_is_refused_by_its_digest() -> None:
    other = shipped("demo").request
    other["options"]["seed"] = 7
    with refused_at("plan.request_digest"):
        view_of(cell_of(other), answer("demo"))


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"status": "perhaps"}, "plan.status"),
        ({"trajectory": {}}, "plan.trajectory.joint_names"),
        ({"census": None}, "plan.census"),
        ({"margins": {"nearest": 3}}, "plan.margins.nearest"),
        ({"legs": [{"kind": "FLY"}]}, "plan.legs[0].kind"),
    ],
)
def test_what_is_no_answer_is_refused_by_its_field(change: dict[str, object], field: str) -> None:
    with refused_at(field):
        view_of(cell("demo"), {**answer("demo"), **change})


def ball(rows: int) -> Mesh:
    """A fine ball of radius 0.1 m."""
    from scipy.spatial import ConvexHull

    from assur.planner.geometry.shapes import Hull

    points = np.random.default_rng(3).normal(size=(rows, 3))
    points *= 0.1 / np.linalg.norm(points, axis=1, keepdims=True)
    hull = ConvexHull(points)
    shape = Hull(points, hull.simplices)
    return Mesh(shape.vertices, shape.faces)


def test_a_mesh_of_many_triangles_is_reduced_and_says_by_how_much() -> None:
    fine = ball(20_000)
    shown = reduced(fine, MOST_TRIANGLES)
    assert shown.triangles == len(fine.faces) > 30_000
    assert 500 < len(shown.mesh.faces) <= MOST_TRIANGLES
    assert 0.0 < shown.off_m < 0.01
    near = np.linalg.norm(fine.vertices[:, None] - shown.mesh.vertices[None, :500], axis=-1).min(0)
    assert near.max() <= shown.off_m


def test_all_meshes_together_are_bounded() -> None:
    many = tuple(Mesh(fine.vertices + k, fine.faces) for fine in [ball(3_000)] for k in range(12))
    assert sum(len(each.mesh.faces) for each in displays(many)) <= MOST_OF_ALL


def test_a_mesh_on_its_grid_is_where_it_was() -> None:
    fine = ball(300)
    text = written(fine)
    back = np.array(text["low_m"]) + unpacked(text["vertices"]) * np.array(text["step_m"])
    assert np.abs(back - fine.vertices).max() <= 0.51 * max(text["step_m"])
    assert (unpacked(text["faces"]) == fine.faces).all()


def test_what_does_not_fit_into_its_numbers_is_refused() -> None:
    from assur.planner.errors import FaultError

    with pytest.raises(FaultError):
        words([1 << 16])
    with pytest.raises(FaultError):
        words([-1])
    with pytest.raises(FaultError):
        floats([np.nan])
    assert unpacked(words([[1, 2]])).tolist() == [[1.0, 2.0]]

"""A user's robot: a file like a shipped one, every number plain or with status and source, errors where they stand."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes import load
from assur.scenes.catalogue import FOLDER, load_robot
from assur.scenes.faults import DocumentError
from assur.scenes.requests import cell_of, load_scenario, plan_scenario, request_digest, scene_of, validate
from tests.refused import refused_at
from tests.scenes.meshes.solids import SOLIDS, binary_stl
from tests.scenes.reading.test_robots import inline

OWN = "the robot's data are the request's own"
TEXT = (FOLDER / "fanuc-sr-3ia.yaml").read_text()
JOINTS = {"j1_deg": 10, "j2_deg": 20, "j3_mm": 50, "j4_deg": 30}
FILE = {"file": "robots/my-arm.yaml", "tool": {"tcp_mm": [0, 0, 0]}}


def request(**robot: Any) -> dict[str, Any]:
    """A move of a robot that is in a file."""
    return {
        "schema": "assur/1",
        "robot": {**FILE, **robot},
        "start": {"joints": JOINTS},
        "task": [{"move": {"to": {"at_mm": [300, 0, 100]}}}],
        "options": {"stop": "first", "max_candidates": 50, "budget_s": 20},
    }


def written(folder: Path, text: str = TEXT) -> Path:
    """A robot's file in a folder below the scenario's."""
    (folder / "robots").mkdir(exist_ok=True)
    file = folder / "robots" / "my-arm.yaml"
    file.write_text(text)
    return file


def stated(value: Any, status: str = "estimated") -> dict[str, Any]:
    return {"value": value, "status": status, "source": "a ruler"}


THING = {"name": "thing", "shape": {"sphere": {"radius_mm": 5}}, "at_mm": [0, 0, 0]}
UPSIDE_DOWN = {**inline()["robot"]["scara"]["joints"][0], "range_deg": stated([150, -150])}


def changed(**changes: Any) -> dict[str, Any]:
    """A request with a written-out SCARA, fields of its arm changed."""
    document = inline()
    document["robot"]["scara"].update(changes)
    return document


def test_a_stated_number_is_the_same_number() -> None:
    plain, document = inline(), inline()
    arm = document["robot"]["scara"]
    arm["l1_mm"] = stated(300)
    del arm["l2_mm"]
    arm["l2_m"] = stated(0.25)
    arm["joints"][0]["range_deg"] = stated([-150, 150])
    arm["joints"][2]["zero_mm"] = stated(400)
    arm["joints"][3]["jerk_deg_s3"] = stated(60000)
    arm["bodies"] = stated(arm["bodies"])
    here, there = cell_of(plain).scene, cell_of(document).scene
    for name in ("lower", "upper", "velocity", "acceleration", "jerk"):
        assert np.array_equal(getattr(here.robot.limits, name), getattr(there.robot.limits, name))
    assert np.array_equal(here.start.q, there.start.q)
    for mine, other in zip(here.robot.placements(here.start.q), there.robot.placements(here.start.q), strict=True):
        assert np.array_equal(mine, other)
    for one, two in zip(here.robot.bodies, there.robot.bodies, strict=True):
        assert (one.link, one.body.name) == (two.link, two.body.name)
        assert np.array_equal(one.body.pieces[0].position, two.body.pieces[0].position)


def test_a_plain_number_is_digested_as_a_number_and_a_statement_with_its_status_and_source() -> None:
    plain = validate(inline())
    arm = plain.canonical()["robot"]["scara"]
    assert set(arm) == {"l1_m", "l2_m", "joints", "bodies", "self_pairs", "axis_order", "tool_frame"}
    assert (arm["l1_m"], arm["joints"][2]["range_m"], arm["joints"][2]["zero_m"]) == (0.3, [0.0, 0.2], 0.4)
    assert [body["name"] for body in arm["bodies"]] == ["post", "rod"]
    in_mm, in_m = changed(l1_mm=stated(300)), changed(l1_m=stated(0.3))
    del in_m["robot"]["scara"]["l1_mm"]
    assert validate(in_m).canonical()["robot"]["scara"]["l1_m"] == stated(0.3)
    assert request_digest(in_mm) == request_digest(in_m) != plain.digest


def test_assumptions_say_what_was_stated_as_it_was_written_and_that_other_numbers_were_not() -> None:
    unknown = (
        "not known are rated load (accelerations are not scaled with the load), maximum load (no mass is refused), "
        "maximum inertia about C (none is refused)"
    )
    assert cell_of(inline()).scene.assumptions == (OWN, f"inline-scara: {unknown}")
    assert cell_of(changed(l1_mm=stated(300), name="mine")).scene.assumptions == (
        "mine: length of link 1 300 mm, estimated: a ruler",
        "mine: numbers without a status are the request's own",
        f"mine: {unknown}",
    )
    assert cell_of(changed(l1_mm=stated(300, "vendor"))).scene.assumptions == (
        "inline-scara: numbers without a status are the request's own",
        f"inline-scara: {unknown}",
    )
    (solids, rest, _) = cell_of(changed(bodies=stated(inline()["robot"]["scara"]["bodies"]))).scene.assumptions
    assert solids == (
        "inline-scara: solids in mm, estimated: a ruler: post cylinder 50 x 400 at 0, 0, 200; "
        "rod cylinder 9 x 300 at 0, 0, 150"
    )
    assert rest.endswith("are the request's own")


def test_a_robot_that_requests_repeat_is_built_once_and_its_numbers_keep_the_units_of_each_request() -> None:
    in_mm, in_m = changed(l1_mm=stated(300)), changed(l1_m=stated(0.3))
    del in_m["robot"]["scara"]["l1_mm"]
    first, again, other = scene_of(in_mm), scene_of(in_m), scene_of(changed(l1_mm=stated(301)))
    assert first.robot is again.robot is not other.robot
    assert first.tool is again.tool
    assert ("300 mm" in first.assumptions[0], "0.3 m" in again.assumptions[0]) == (True, True)
    moved = changed(l1_mm=stated(300))
    moved["robot"]["base"] = {"at_mm": [1, 0, 0]}
    assert scene_of(moved).robot.base.x == 0.001


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        ({"box": {"size_m": [0.1, 0.2, 0.3]}}, "box 100 x 200 x 300"),
        ({"sphere": {"radius_mm": 5}}, "sphere 5"),
        ({"capsule": {"radius_mm": 5, "length_mm": 20}}, "capsule 5 x 20"),
        ({"mesh": {"asset": "bracket", "unit": "mm"}}, "mesh"),
    ],
)
def test_every_shape_of_a_solid_can_be_said(shape: dict[str, Any], said: str) -> None:
    solid = {"name": "thing", "link": "base", "shape": shape, "at_mm": [1, 2, 3]}
    assumption = cell_of(changed(bodies=stated([solid]))).scene.assumptions[0]
    assert assumption.endswith(f"a ruler: thing {said} at 1, 2, 3")


@pytest.mark.parametrize(
    ("change", "field", "allowed"),
    [
        ({"l1_mm": stated("300")}, "l1_mm.value", "a number"),
        ({"l1_mm": stated(-300)}, "l1_mm.value", "at least 0.01 (mm)"),
        ({"l1_mm": stated(300, "sure")}, "l1_mm.status", "'vendor', 'vendor_config'"),
        ({"l1_mm": {"value": 300, "status": "vendor"}}, "l1_mm.source", "which must be given"),
        ({"l1_mm": {"value": 300, "status": "vendor", "source": ""}}, "l1_mm.source", "at least 1 character"),
        ({"l1_mm": {"value": 300, "source": "x"}}, "l1_mm.status", "one of vendor, vendor_config"),
        ({"l1_mm": {"status": "vendor", "source": "x"}}, "l1_mm.value", "which must be given"),
        ({"l1_mm": {**stated(300), "page": 3}}, "l1_mm.page", "one of source, status, value"),
        ({"l1_mm": stated(None)}, "l1_mm.value", "a value"),
        ({"l1_mm": stated(stated(300))}, "l1_mm.value", "a number"),
        ({"l1_mm": stated(float("nan"))}, "l1_mm.value", "a finite number"),
        ({"bodies": stated("none")}, "bodies.value", "a list"),
        ({"bodies": stated([{"name": "x"}])}, "bodies.value[0].shape", "which must be given"),
        ({"bodies": stated([{**THING, "link": "base", "color": 1}])}, "bodies.value[0].color", "one of at_m/at_mm"),
        ({"l1_mm": {**stated(300), "[stated]": 1}}, "l1_mm.[stated]", "one of source, status, value"),
        ({"axis_order": stated("rprr")}, "axis_order", "'prrr' or 'rrrp'"),
        ({"about": ""}, "about", "at least 1 character"),
        ({"name": "My Arm"}, "name", "text that matches"),
        ({"colour": "grey"}, "colour", "one of about"),
        ({"bodies": stated([{**THING, "link": "link4"}])}, "bodies.value[0].link", "one of base, link1"),
        ({"joints": [UPSIDE_DOWN] * 3}, "joints[0].range_deg.value", "two ends, the lower first"),
    ],
)
def test_a_statement_that_is_not_right_is_refused_where_it_stands(
    change: dict[str, Any], field: str, allowed: str
) -> None:
    with refused_at(f"robot.scara.{field}", allowed):
        scene_of(changed(**change))


def scenario(folder: Path, document: dict[str, Any]) -> Path:
    path = folder / "cell.yaml"
    path.write_text(json.dumps({"about": "a test", "request": document}))
    return path


def test_a_robot_in_a_file_is_the_robot_that_is_written_out(tmp_path: Path) -> None:
    file = written(tmp_path)
    loaded = load(scenario(tmp_path, request()))
    assert loaded["robot"] == {**load_robot(file).document, "tool": FILE["tool"]}
    by_file = cell_of(request(), folder=tmp_path)
    by_name = cell_of({**request(), "robot": {"model": "fanuc-sr-3ia", "tool": FILE["tool"]}})
    assert by_file.scene.digest == request_digest(loaded) != by_name.scene.digest
    assert by_file.conventions == by_name.conventions
    assert by_file.scene.assumptions == by_name.scene.assumptions
    assert np.array_equal(by_file.scene.robot.limits.jerk, by_name.scene.robot.limits.jerk)
    answer = plan_scenario(load_scenario(scenario(tmp_path, request())))
    assert answer["status"] == "planned"
    assert answer["request_digest"] == request_digest(loaded)


def test_a_neighbour_may_be_in_a_file_too(tmp_path: Path) -> None:
    written(tmp_path)
    rows = [[0.1, 0.2, 0.05, 0.3]] * 2
    trajectory = {"joint_names": ["j1", "j2", "j3", "j4"], "joint_units": ["rad", "rad", "m", "rad"], "time_s": [0, 1]}
    trajectory |= {"position": rows, "velocity": [[0.0] * 4] * 2, "acceleration": [[0.0] * 4] * 2}
    other = {"name": "other", "robot": {**FILE, "base": {"at_mm": [2000, 0, 0]}}, "trajectory": trajectory}
    scene = cell_of({**request(), "neighbours": [other]}, folder=tmp_path).scene
    assert "other/base-column" in scene.index
    (tmp_path / "robots" / "my-arm.yaml").unlink()
    with refused_at("neighbours[0].robot.file"):
        cell_of(
            {**request(), "robot": {"model": "fanuc-sr-3ia", "tool": FILE["tool"]}, "neighbours": [other]},
            folder=tmp_path,
        )


def test_a_robot_is_in_a_file_or_named_or_written_out(tmp_path: Path) -> None:
    written(tmp_path)
    with pytest.raises(InputError, match=r"^robot\.file.*a request never names a file"):
        cell_of(request())
    for more in ({"model": "fanuc-sr-3ia"}, {"scara": inline()["robot"]["scara"]}):
        with pytest.raises(InputError, match="exactly one of model, file, scara"):
            cell_of(request(**more), folder=tmp_path)
    robots: list[Any] = [None, [], {"file": 3}]
    others: list[Any] = [{}, [3], [{"robot": 3}]]
    for strange in (*({"robot": robot} for robot in robots), *({"neighbours": other} for other in others)):
        with pytest.raises(InputError):
            cell_of({**request(), **strange}, folder=tmp_path)
    with pytest.raises(InputError, match="a mapping"):
        cell_of([], folder=tmp_path)


def test_a_mesh_beside_the_robots_file_is_its_own(tmp_path: Path) -> None:
    mesh = "{mesh: {file: base.stl, unit: mm}}"
    file = written(tmp_path, TEXT.replace("{cylinder: {radius_mm: 70, height_mm: 175}}", mesh))
    with pytest.raises(DocumentError) as refused:
        load_robot(file)
    assert refused.value.field == "my-arm.yaml: scara.bodies.value[0].shape.mesh.file"
    (file.parent / "base.stl").write_bytes(binary_stl(SOLIDS["bracket"]))
    body = cell_of(request(), folder=tmp_path).scene.robot.bodies[0].body
    assert body.name == "base-column"
    assert len(body.pieces) == 2
    solid = load(scenario(tmp_path, request()))["robot"]["scara"]["bodies"]["value"][0]
    assert set(solid["shape"]["mesh"]) == {"data", "format", "unit"}


BAD: list[tuple[str, str, str, str]] = [
    # what is replaced in the file, by what, field, and what is allowed
    ("value: 720,", "value: fast,", "scara.joints[0].velocity_deg_s.value", "a number"),
    ("value: [0, 200]", "value: [200, 0]", "scara.joints[2].range_mm.value", "two ends, the lower first"),
    ("link: quill", "link: hand", "scara.bodies.value[3].link", "'base', 'link1'"),
    ("l2_mm: {value", "l2: {value", "scara.l2", "did you mean l2_m"),
    ("sign: -1", "sign: 0", "scara.joints[2].sign", "1 or -1"),
    ("scara:", "skara:", "", "did you mean scara?"),
    ("status: estimated\n", "status: estimated\n    status: vendor\n", "scara.bodies.status", "each key once"),
    ("name: j2", "name: j1", "scara.joints[1].name", "a name that no other joint has"),
    ("  joints:\n", "  joints:\n\t- 3\n", "", "YAML: indent with spaces"),
]


@pytest.mark.parametrize(("old", "new", "field", "allowed"), BAD, ids=[row[1] for row in BAD])
def test_an_error_names_file_line_field_value_and_what_is_allowed(
    tmp_path: Path, old: str, new: str, field: str, allowed: str
) -> None:
    assert old in TEXT
    file = written(tmp_path, TEXT.replace(old, new, 1))
    place = TEXT.count("\n", 0, TEXT.index(old)) + 1
    for read in (lambda: load_robot(file), lambda: plan_scenario(load_scenario(scenario(tmp_path, request())))):
        with pytest.raises(DocumentError) as caught:
            read()
        assert caught.value.field.startswith("my-arm.yaml")
        assert caught.value.field == ("my-arm.yaml" + (f": {field}" if field else ""))
        assert allowed in str(caught.value)
        assert caught.value.line is not None
        assert abs(caught.value.line - place) <= (0 if field else 1) + new.count("\n")


def test_a_file_that_is_no_robot_says_what_one_begins_with(tmp_path: Path) -> None:
    for text in ("[1, 2]", "3", "model: fanuc-sr-3ia", ""):
        with pytest.raises(DocumentError) as caught:
            load_robot(written(tmp_path, text))
        assert caught.value.field.startswith("my-arm.yaml")
    with pytest.raises(OSError, match="No such file"):
        load_robot(tmp_path / "none.yaml")


def test_a_document_that_is_built_is_not_changed() -> None:
    document = changed(bodies=stated(inline()["robot"]["scara"]["bodies"]))
    before = copy.deepcopy(document)
    cell_of(document)
    assert document == before

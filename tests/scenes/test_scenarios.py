"""Scenario files: read with their lines, files only below their own folder, expectations that are really looked at."""

from __future__ import annotations

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.faults import DocumentError
from assur.scenes.requests import (
    load_scenario,
    plan_scenario,
    scene_of,
    shipped,
    shipped_scenarios,
    unmet,
    validate,
)
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST
from tests.scenes.meshes.solids import SOLIDS, binary_stl

DEMO = Path("scenes") / "cells" / "demo.yaml"


def written(folder: Path, request: Any, name: str = "cell.yaml", **more: Any) -> Path:
    """A scenario file of this request."""
    document = {"about": "a test", "request": request, "expect": {"status": "planned"}, **more}
    (folder / name).write_text(json.dumps(document, indent=1))
    return folder / name


def test_each_shipped_scenario_says_why_it_exists_and_is_a_valid_request() -> None:
    found = shipped_scenarios()
    assert "demo" in found
    for name, about in found.items():
        assert len(about) > 20
        assert "\n" not in about
        validate(shipped(name).request)


@pytest.mark.parametrize("name", ["nowhere", "../cells/demo", "demo.yaml", "", "DEMO"])
def test_no_other_scenario_is_opened(name: str) -> None:
    with refused_at("scenario"):
        shipped(name)


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("speed_mm_s: 250", "speed: 250", "request.frames.belt.conveyor.speed"),
        ("status: planned", "status: perhaps", "expect.status"),
        ("about: >", "abuot: >", "abuot"),
        ("seed: 0", "seed: one", "request.options.seed"),
        ("dwell_ms: 80", "dwell_ms: 80\n        wait: 3", "request.task[0].pick.wait"),
    ],
)
def test_a_fault_is_told_with_its_line(tmp_path: Path, old: str, new: str, field: str) -> None:
    text = DEMO.read_text()
    assert text.count(old) == 1
    spoilt = text.replace(old, new)
    (tmp_path / "cell.yaml").write_text(spoilt)
    with pytest.raises(DocumentError) as caught:
        load_scenario(tmp_path / "cell.yaml")
    last = new.rsplit("\n", maxsplit=1)[-1]
    line = next(i for i, row in enumerate(spoilt.splitlines(), 1) if last.strip() in row)
    assert (caught.value.field, caught.value.line) == (field, line)
    assert pickle.loads(pickle.dumps(caught.value)).line == line


def test_a_field_that_is_missing_is_told_at_the_line_of_what_lacks_it(tmp_path: Path) -> None:
    lines = [row for row in DEMO.read_text().splitlines() if "tcp_mm" not in row]
    (tmp_path / "cell.yaml").write_text("\n".join(lines))
    with pytest.raises(DocumentError) as caught:
        load_scenario(tmp_path / "cell.yaml")
    assert caught.value.field == "request.robot.tool.tcp_m"
    assert "tool:" in lines[(caught.value.line or 0) - 1]


def test_a_fault_of_meaning_gets_its_line_too(tmp_path: Path) -> None:
    spoilt = DEMO.read_text().replace("frame: dial, at_mm: [150", "frame: disc, at_mm: [150")
    (tmp_path / "cell.yaml").write_text(spoilt)
    with pytest.raises(DocumentError) as caught:
        plan_scenario(load_scenario(tmp_path / "cell.yaml"))
    assert caught.value.field == "request.task[1].place.to.frame"
    assert "disc" in spoilt.splitlines()[(caught.value.line or 0) - 1]


def with_mesh(name: str) -> dict[str, Any]:
    request = copy.deepcopy(GOOD_REQUEST)
    request["bodies"][1]["shape"]["mesh"] = {"file": name, "unit": "mm"}
    return request


def test_a_scenario_may_name_mesh_files_below_its_own_folder(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "part.STL").write_bytes(binary_stl(SOLIDS["bracket"]))
    scenario = load_scenario(written(tmp_path, with_mesh("meshes/part.STL")))
    scene = scene_of(scenario.request, folder=scenario.folder)
    assert len(scene.index["part"].body.pieces) == 2
    with refused_at("bodies[1].shape.mesh.file"):
        scene_of(scenario.request)


def test_the_digest_of_a_request_with_a_file_depends_on_what_is_in_the_file(tmp_path: Path) -> None:
    digests = set()
    for solid in ("bracket", "tray"):
        (tmp_path / "part.stl").write_bytes(binary_stl(SOLIDS[solid]))
        digests.add(scene_of(with_mesh("part.stl"), folder=tmp_path).digest)
    assert len(digests) == 2


def test_a_mesh_file_that_is_too_long_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import assur.scenes.files as module

    (tmp_path / "part.stl").write_bytes(binary_stl(SOLIDS["bracket"]))
    monkeypatch.setattr(module, "MAX_MESH_BYTES", 100)
    with pytest.raises(InputError, match="up to 100 bytes"):
        scene_of(with_mesh("part.stl"), folder=tmp_path)


ANSWER: dict[str, Any] = {
    "status": "planned",
    "duration_s": 1.5,
    "arrivals": [{"control_point": "a", "matched": True}, {"control_point": "b", "matched": False}],
    "margins": {"binds": "j2 acceleration"},
    "census": {"lines": [{"bodies": ["gate", "cup"]}]},
    "relaxation": None,
}


@pytest.mark.parametrize(
    ("expect", "faults"),
    [
        ({}, 0),
        ({"duration_s": {"max": 1.5}}, 0),
        ({"duration_s": {"min": 1, "max": 2}}, 0),
        ({"matched": ["a"], "mentions": ["gate", "j2"]}, 0),
        ({"status": "not_planned"}, 1),
        ({"duration_s": {"max": 1.4}}, 1),
        ({"duration_s": {"min": 1.6}}, 1),
        ({"matched": ["b"]}, 1),
        ({"matched": ["c"]}, 1),
        ({"mentions": ["fence"]}, 1),
        ({"reason": "TIMED_OUT"}, 1),
        ({"proved": True}, 1),
        ({"relaxation": "window"}, 1),
    ],
)
def test_each_expectation_can_hold_and_can_fail(expect: dict[str, Any], faults: int) -> None:
    assert len(unmet({"status": "planned", **expect}, ANSWER)) == faults


def test_a_duration_that_is_not_there_meets_no_expectation() -> None:
    refused = {"status": "not_planned", "arrivals": []}
    assert unmet({"status": "not_planned", "duration_s": {"max": 9}}, refused) == ["there is no duration_s"]


def test_what_follows_from_another_status_is_not_said() -> None:
    expect = {"status": "planned", "duration_s": {"min": 1, "max": 2}, "matched": ["a"]}
    refused = {"status": "not_planned", "reason": "OUT_OF_REACH", "arrivals": []}
    assert unmet(expect, refused) == ["status is not_planned, not planned"]
    assert unmet({"status": "not_planned", "reason": "OUT_OF_REACH"}, ANSWER) == ["status is planned, not not_planned"]


def test_a_mesh_file_that_does_not_exist_is_told_so_by_its_own_name(tmp_path: Path) -> None:
    scenario = load_scenario(written(tmp_path, with_mesh("nowhere.stl")))
    with pytest.raises(InputError, match="this one does not") as caught:
        scene_of(scenario.request, folder=scenario.folder)
    assert caught.value.value == "nowhere.stl"
    assert str(tmp_path) not in str(caught.value)


@pytest.mark.parametrize(
    ("content", "unit", "field", "words"),
    [
        (b"no mesh at all", "mm", "file", "an STL file, binary or text; there is: neither length"),
        (binary_stl(SOLIDS["bracket"])[:-50], "mm", "file", "STL"),
        (binary_stl(SOLIDS["bracket"]), "m", "unit", "m large; is the unit right?"),
    ],
)
def test_a_mesh_that_is_wrong_is_blamed_on_its_file(
    tmp_path: Path, content: bytes, unit: str, field: str, words: str
) -> None:
    (tmp_path / "part.stl").write_bytes(content)
    request = with_mesh("part.stl")
    request["bodies"][1]["shape"]["mesh"]["unit"] = unit
    scenario = load_scenario(written(tmp_path, request))
    with refused_at(f"request.bodies[1].shape.mesh.{field}", words, value="part.stl" if field == "file" else "m"):
        plan_scenario(scenario)


def test_what_is_expected_may_be_left_out_but_not_half_said(tmp_path: Path) -> None:
    file = written(tmp_path, GOOD_REQUEST)
    document = json.loads(file.read_text())
    del document["expect"]
    file.write_text(json.dumps(document))
    scenario = load_scenario(file)
    assert scenario.expect == {}
    assert unmet(scenario.expect, {"status": "not_planned"}) == []
    file.write_text(json.dumps({**document, "expect": {}}))
    with pytest.raises(DocumentError) as caught:
        load_scenario(file)
    assert caught.value.field == "expect.status"
    assert caught.value.allowed == "one of planned, not_planned, which must be given"


@pytest.mark.parametrize("schema", ["assur-task/2", "assur-cell", "assur-cells/1"])
def test_a_schema_that_no_file_has_is_named(schema: str, tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(f"schema: {schema}\nsteps: []\n")
    with refused_at("schema", "assur-task/1 or assur-cell/1", line=1, value=schema):
        load_scenario(tmp_path / "a.yaml")

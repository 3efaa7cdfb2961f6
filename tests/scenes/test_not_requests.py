"""Files that are no scenarios: what they are is named, and what reads them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.scenes import load
from assur.scenes.faults import NOTHING, DocumentError
from assur.scenes.files import json_in
from assur.scenes.plan_file import plan_file_in
from assur.scenes.requests import load_robot, load_scenario, plan_document, validate
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST
from tests.scenes.tasks.test_joining import CELL, TASK

OTHERS = [
    ("report.html", "\ufeff\n<!DOCTYPE html>\n<html>{: [", "a web page", "a browser shows it"),
    ("arm.urdf", '<?xml version="1.0"?>\n<!-- an arm -->\n<robot name="x"/>', "a robot in URDF", "assur robots import"),
    ("x.xml", "<a/>", "XML", "plan file in JSON"),
    ("part.stl", "solid part\nendsolid part\n", "a mesh", "shape: {mesh: {file: part.stl, unit: mm}}"),
    ("m.csv", "# 2 points\n# more\ntime_s,j1_deg\n0,1\n", "motion over time in CSV", "check-trajectory FILE m.csv"),
    ("arm.yaml", "scara: {links: []}\n", "a robot's file", "assur robots arm.yaml shows it"),
]


@pytest.mark.parametrize(("name", "content", "what", "use"), OTHERS)
def test_another_file_is_named_with_what_reads_it(tmp_path: Path, name: str, content: str, what: str, use: str) -> None:
    (tmp_path / name).write_text(content, encoding="utf-8")
    with pytest.raises(DocumentError) as caught:
        load_scenario(tmp_path / name)
    assert (caught.value.field, caught.value.value, caught.value.more) == (name, what, ())
    assert "a scenario or a task in YAML" in caught.value.allowed
    assert use in caught.value.allowed


KINDS = {
    "a web page": "<!DOCTYPE html>\n<html>{: [",
    "a task file": TASK,
    "a cell file": CELL,
    "a scenario": "about: x\nrequest: {schema: assur/1}\n",
    "a plan file": '{"schema":"assur-plan/1","request":{"schema":"assur/1"},"plan":{"x":null}}',
    "a proof bundle": '{"schema": "assur-bundle/3", "arms": [{"slide": null}]}',
    "an answer without its request": '{"schema":"assur/1","status":"planned","x":null}',
    "a request": '{"schema":"assur/1","robot":{"model":null}}',
    "a robot's file": "# ours\nscara: {links: []}\n",
}


@pytest.mark.parametrize("what", KINDS)
def test_a_file_in_place_of_a_robot_or_of_json_is_named(tmp_path: Path, what: str) -> None:
    path = tmp_path / "file"
    path.write_text(KINDS[what], encoding="utf-8")
    if what != "a robot's file":
        with pytest.raises(DocumentError) as caught:
            load_robot(path)
        assert (caught.value.field, caught.value.value, caught.value.more) == ("file", what, ())
        assert caught.value.allowed.startswith("a robot: YAML with one of scara, ")
    if not KINDS[what].startswith("{"):
        with pytest.raises(DocumentError) as caught:
            json_in(path, "a plan file, as JSON")
        assert (caught.value.field, caught.value.value, caught.value.allowed) == ("file", what, "a plan file, as JSON")


def test_a_robot_whose_source_names_another_document_is_a_robot(tmp_path: Path) -> None:
    path = tmp_path / "arm.yaml"
    path.write_text("scara:\n  source: of the robot in {schema: assur-cell/1}\n", encoding="utf-8")
    with pytest.raises(DocumentError) as caught:
        load_robot(path)
    assert caught.value.value != "a cell file"


@pytest.mark.parametrize(
    ("document", "what"),
    [({"schema": "assur/1", "status": "planned"}, "an answer"), ({"schema": "assur/1", "task": []}, "a request")],
)
def test_in_place_of_a_plan_file_an_answer_or_a_request_is_named(document: dict[str, object], what: str) -> None:
    with pytest.raises(DocumentError, match=f"as `assur plan --out` writes it; this is {what} without") as caught:
        plan_file_in(document)
    assert (caught.value.field, caught.value.value) == ("schema", "assur/1")


@pytest.mark.parametrize(("text", "schema"), [(TASK, "assur-task/1"), (CELL, "assur-cell/1")])
def test_a_task_and_a_cell_without_their_schema_have_one_fault(tmp_path: Path, text: str, schema: str) -> None:
    path = tmp_path / "file.yaml"
    path.write_text(text.replace(f"schema: {schema}\n", ""), encoding="utf-8")
    for read in (load_scenario, load):
        with pytest.raises(DocumentError) as caught:
            read(path)
        assert (caught.value.field, caught.value.value, caught.value.line) == ("schema", NOTHING, 1)
        assert (caught.value.more, caught.value.left_out) == ((), 0)
        assert caught.value.allowed.startswith(f"schema: {schema}, which must be given")


@pytest.mark.parametrize("schema", [np.array([1, 2]), np.array(["assur/1", "assur-task/1"]), ["assur/1"], 3])
def test_a_schema_that_is_no_text_is_refused_there(schema: object) -> None:
    for read in (validate, plan_document):
        with refused_at("schema"):
            read({**GOOD_REQUEST, "schema": schema})


@pytest.mark.parametrize("field", ["robot", "bodies", "x"])
def test_deep_nesting_beside_files_is_refused(tmp_path: Path, field: str) -> None:
    deep: dict[str, object] = {}
    for _ in range(5000):
        deep = {"a": deep}
    with pytest.raises(InputError) as caught:
        plan_document({**GOOD_REQUEST, field: deep}, folder=tmp_path)
    assert (caught.value.field, caught.value.value) == (f"{field}.a.a.a", "deeper nesting")


def test_a_proof_bundle_is_no_request() -> None:
    with pytest.raises(InputError, match="this is a proof bundle, which assur prove reads"):
        validate({"schema": "assur-bundle/3", "arms": [{"slide": None}]})

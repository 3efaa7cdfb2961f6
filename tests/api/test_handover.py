"""The hand-over to a controller that runs another plan, on the command line and over HTTP: as in Python."""

from __future__ import annotations

import json
from pathlib import Path

import httpx
import pytest
import yaml

from assur.api.cli.border import BAD_INPUT, RIGHT
from assur.scenes.exports.documents import export_document
from assur.scenes.plan_file import PlanFile
from tests.api.test_command_line import run
from tests.scenes.exports.test_handover import following, running

ASKED = {"format": "ros2", "lead_ms": 10}


def in_python() -> str:
    held = following()
    export = export_document(held.request, held.plan, {**ASKED, "after": running().document})
    return str(export["file"])


@pytest.fixture
def files(tmp_path: Path) -> tuple[str, str]:
    names = tmp_path / "running.json", tmp_path / "next.json"
    for name, held in zip(names, (running(), following()), strict=True):
        name.write_text(json.dumps(held.document))
    return str(names[0]), str(names[1])


def test_on_the_command_line(files: tuple[str, str], tmp_path: Path) -> None:
    ran, held = files
    options = ("--format", "ros2", "--lead-ms", "10", "--after", ran)
    code, output, errors = run("export", held, *options)
    assert (code, errors) == (RIGHT, "")
    assert output == in_python()
    out, proof = str(tmp_path / "motion.yaml"), str(tmp_path / "proved.json")
    code, output, _ = run("export", held, *options, "--out", out, "--plan-out", proof)
    assert code == RIGHT
    assert "stamps are 10 ms later" in output
    assert "points are those of the plan that runs until 0.3 s" in output
    assert run("check", proof)[0] == RIGHT
    assert len(yaml.safe_load(Path(out).read_text())["points"]) > 2


@pytest.mark.parametrize(
    ("options", "field"),
    [
        (("--lead-ms", "-1"), "lead_ms"),
        (("--lead-ms", "nan"), "lead_ms"),
        (("--after", "no-such-file.json"), "--after"),
        (("--after", "{held}"), "start.at_s"),
        (("--after", "{answer}"), "after.schema"),
    ],
)
def test_what_is_wrong_is_named(files: tuple[str, str], tmp_path: Path, options: tuple[str, str], field: str) -> None:
    answer = tmp_path / "answer.json"
    answer.write_text(json.dumps(running().plan))
    value = options[1].format(held=files[1], answer=answer)
    code, output, errors = run("export", files[1], "--format", "ros2", options[0], value)
    assert (code, output, field in errors) == (BAD_INPUT, "", True), errors


def test_a_file_that_is_read_is_not_written(files: tuple[str, str]) -> None:
    before = Path(files[0]).read_bytes()
    code, _, errors = run("export", files[1], "--format", "ros2", "--after", files[0], "--out", files[0])
    assert (code, "--out" in errors) == (BAD_INPUT, True)
    assert Path(files[0]).read_bytes() == before


def test_over_http(client: httpx.Client) -> None:
    held = following()
    body = {"request": held.request, "plan": held.plan, **ASKED, "after": running().document}
    found = client.post("/v1/plans/export", json=body)
    assert (found.status_code, found.json()["file"]) == (200, in_python())
    wrong = client.post("/v1/plans/export", json={**body, "after": PlanFile({}, running().plan).document})
    assert (wrong.status_code, wrong.json()["errors"][0]["field"].startswith("after.request")) == (422, True)
    schema = client.get("/openapi.json").json()["components"]["schemas"]["ExportQuestion"]["properties"]
    assert {"lead_s", "lead_ms", "after"} <= schema.keys()

"""Exports, and verdicts on trajectories of others, on the command line and over HTTP: as in Python."""

from __future__ import annotations

import base64
import html
import json
from pathlib import Path
from typing import Any

import httpx
import pytest
from typer.testing import CliRunner

import assur
from assur.api.cli.border import BAD_INPUT, RIGHT, WRONG
from assur.api.command_line import app
from assur.api.workers.jobs import FIRST_PLAN
from assur.scenes import plan
from assur.scenes.exports.documents import check_trajectory_document, export_document
from assur.scenes.plan_file import PlanFile
from assur.scenes.report.report import ONLY_PROVED
from assur.scenes.requests import assumptions_of
from tests.api.test_command_line import run


@pytest.fixture(scope="module")
def answer() -> dict[str, Any]:
    return plan(FIRST_PLAN)


@pytest.fixture
def files(tmp_path: Path, answer: dict[str, Any]) -> tuple[str, str]:
    cell, made = tmp_path / "cell.json", tmp_path / "plan.json"
    cell.write_text(json.dumps(FIRST_PLAN))
    made.write_text(json.dumps(answer))
    return str(cell), str(made)


def test_an_export_and_its_proof_pass_assur_check(tmp_path: Path, files: tuple[str, str]) -> None:
    cell, made = files
    out, proof = (str(tmp_path / name) for name in ("motion.csv", "proof.json"))
    options = ("--format", "csv", "--tick-ms", "2", "--jerk", "report")
    outs = ("--out", out, "--plan-out", proof)
    code, output, errors = run("export", cell, made, *options, *outs)
    assert (code, errors) == (RIGHT, "")
    assert "highest jerk and the limit that it is proved against" in output
    assert run("check", proof)[0] == RIGHT
    code, output, _ = run("check-trajectory", cell, out, "--jerk", "report")
    assert code == RIGHT
    assert "smallest clearance" in output
    code, output, _ = run("check-trajectory", cell, out, "--jerk", "report", "--plan", made, "--json")
    assert (code, json.loads(output)["judged_as"]) == (RIGHT, "plan")
    lines = Path(out).read_text().splitlines()
    row = next(i for i, line in enumerate(lines) if line.startswith("time_s")) + 20
    cells = lines[row].split(",")
    cells[2] = "9000"
    Path(out).write_text("\n".join([*lines[:row], ",".join(cells), *lines[row + 1 :]]))
    code, output, _ = run("check-trajectory", cell, out, "--jerk", "report")
    assert code == WRONG
    assert "j1 breaks its velocity limit" in output.splitlines()[2]


@pytest.fixture(scope="module")
def proof(answer: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The plan file of an export on ticks, whose request has a higher limit of jerk."""
    folder = tmp_path_factory.mktemp("proof")
    (folder / "plan.json").write_text(json.dumps(PlanFile(FIRST_PLAN, answer).document))
    out = folder / "proved.json"
    options = ("--format", "ros2", "--tick-ms", "2", "--jerk", "report", "--out", str(folder / "m.yaml"))
    assert run("export", str(folder / "plan.json"), *options, "--plan-out", str(out))[0] == RIGHT
    return out


def test_the_proof_of_an_export_is_reported_and_viewed(client: httpx.Client, proof: Path, tmp_path: Path) -> None:
    out, document = tmp_path / "report.html", json.loads(proof.read_text())
    assert run("report", str(proof), "--out", str(out))[0] == RIGHT
    page = out.read_text(encoding="utf-8")
    assert '<span class="chip good">checked</span>' in page
    for assumption in assumptions_of(document["request"]):
        assert html.escape(assumption) in page
    assert html.escape(ONLY_PROVED) in page
    assert ">Margins<" not in page
    assert client.post("/v1/plans/report", json=document).status_code == 200
    view = client.post("/v1/plans/view", json=document)
    assert (view.status_code, view.json()["census"], view.json()["candidates"]) == (200, [], 0)
    assert [leg["kind"] for leg in view.json()["legs"]] == [leg["kind"] for leg in document["plan"]["legs"]]


@pytest.mark.parametrize(("key", "put"), [("legs", None), ("certificate", None), ("seed", 0), ("margins", {})])
def test_what_is_neither_an_answer_nor_a_proved_plan_is_not_viewed(
    client: httpx.Client, proof: Path, key: str, put: Any
) -> None:
    document = json.loads(proof.read_text())
    if put is None:
        del document["plan"][key]
    else:
        document["plan"][key] = put
    response = client.post("/v1/plans/view", json=document)
    assert (response.status_code, response.json()["errors"][0]["field"].startswith("plan.")) == (422, True)


def test_an_answer_of_a_proof_says_what_it_does_not_hold(proof: Path, tmp_path: Path) -> None:
    held = assur.load_answer(proof)
    assert held.request is not None
    assert held.assumptions == assumptions_of(held.request) != []
    assert (len(held.arrivals), held.duration_s) == (1, held.trajectory.duration_s)
    for name in ("margins", "warnings"):
        with pytest.raises(assur.InputError, match=rf"answer\.{name}: got 'nothing'.*what the exported answer states"):
            getattr(held, name)
    bare = assur.Answer(held.document)
    with pytest.raises(assur.InputError, match=r"answer\.assumptions"):
        _ = bare.assumptions
    assert assur.check(held.request, held)["ok"]
    assert "Proof" in held.report(tmp_path / "page.html").read_text(encoding="utf-8")


def test_without_out_the_file_is_printed_and_nothing_else(files: tuple[str, str], answer: dict[str, Any]) -> None:
    code, output, errors = run("export", *files, "--format", "ros2-json")
    assert (code, errors) == (RIGHT, "")
    assert output == export_document(FIRST_PLAN, answer, {"format": "ros2-json"})["file"]


def test_a_model_is_written_as_bytes(tmp_path: Path, files: tuple[str, str], answer: dict[str, Any]) -> None:
    out = tmp_path / "plan.glb"
    code, output, errors = run("export", *files, "--format", "glb", "--out", str(out))
    assert (code, errors) == (RIGHT, "")
    assert "within" in output
    file = export_document(FIRST_PLAN, answer, {"format": "glb"})["file"]
    assert out.read_bytes() == base64.b64decode(file)
    assert out.read_bytes()[:4] == b"glTF"
    result = CliRunner().invoke(app, ["export", *files, "--format", "glb"])
    assert result.stdout_bytes == out.read_bytes()
    code, _, errors = run("export", *files, "--format", "glb", "--tick-ms", "1")
    assert (code, "tick_ms" in errors) == (BAD_INPUT, True)


def test_what_cannot_be_read_or_written_is_told(tmp_path: Path, files: tuple[str, str]) -> None:
    cell, made = files
    nowhere = str(tmp_path / "no" / "x.csv")
    code, _, errors = run("export", cell, made, "--format", "csv", "--out", nowhere)
    assert (code, "--out" in errors) == (BAD_INPUT, True)
    code, _, errors = run("check-trajectory", cell, nowhere)
    assert (code, "TRAJECTORY" in errors) == (BAD_INPUT, True)
    (tmp_path / "x.csv").write_bytes(b"time_s\n\xff")
    code, _, errors = run("check-trajectory", cell, str(tmp_path / "x.csv"))
    assert (code, "line 2" in errors) == (BAD_INPUT, True)


def test_over_http_as_in_python(client: httpx.Client, answer: dict[str, Any]) -> None:
    asked = {"format": "ros2", "tick_ms": 4, "jerk": "report"}
    found = client.post("/v1/plans/export", json={"request": FIRST_PLAN, "plan": answer, **asked})
    assert found.status_code == 200
    assert found.json() == json.loads(json.dumps(export_document(FIRST_PLAN, answer, asked)))
    question = {"file": found.json()["file"], "format": "ros2", "jerk": "report"}
    verdict = client.post("/v1/trajectories/check", json={"request": FIRST_PLAN, **question})
    assert verdict.status_code == 200
    assert verdict.json() == json.loads(json.dumps(check_trajectory_document(FIRST_PLAN, question)))
    assert verdict.json()["ok"] is True
    with_legs = client.post("/v1/trajectories/check", json={"request": FIRST_PLAN, "plan": answer, **question})
    assert (with_legs.json()["ok"], with_legs.json()["judged_as"]) == (True, "plan")


def test_the_description_has_what_is_asked_and_answered(client: httpx.Client) -> None:
    described = client.get("/openapi.json").json()
    schemas = described["components"]["schemas"]
    assert schemas["ExportQuestion"]["required"][:2] == ["request", "plan"]
    assert {"file", "statement", "jerk", "plan", "request"} <= schemas["ExportAnswer"]["properties"].keys()
    assert {"first", "clearance", "findings"} <= schemas["TrajectoryVerdict"]["properties"].keys()

"""The file that holds request and answer: what writes it, what takes it, and what is refused of it."""

from __future__ import annotations

import copy
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import assur
from assur.api.cli.border import BAD_INPUT, RIGHT, WRONG
from assur.api.command_line import app
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner.errors import InputError
from assur.scenes import bounds
from assur.scenes.meshes.assets import asset
from assur.scenes.plan_file import FORM, PlanFile
from assur.scenes.requests import plan_document, request_digest, scene_of
from tests.api.test_command_line import run
from tests.changed import GONE, changed

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def answer() -> dict[str, Any]:
    return plan_document(FIRST_PLAN)


@pytest.fixture
def held(answer: dict[str, Any]) -> dict[str, Any]:
    """A plan file, to change at will."""
    return copy.deepcopy(PlanFile(FIRST_PLAN, answer, "small", "It moves.").document)


@pytest.fixture
def written(tmp_path: Path, held: dict[str, Any]) -> Path:
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(held))
    return path


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    path = tmp_path / "cell.json"
    path.write_text(json.dumps(FIRST_PLAN))
    return path


def test_the_file_has_request_and_answer_and_what_the_cell_is(tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    assert run("plan", "transfer", "--out", str(out))[0] == RIGHT
    held = json.loads(out.read_bytes())
    assert list(held) == ["schema", "title", "about", "request", "plan"]
    assert (held["schema"], held["title"]) == (FORM, "transfer")
    assert held["about"] == assur.scenarios()["transfer"]
    assert held["request"] == assur.load("transfer") == assur.load(out) == assur.load_answer(out).request
    assert held["plan"]["request_digest"] == request_digest(held["request"])
    assert run("check", "transfer", str(out))[0] == RIGHT


def test_the_meshes_of_the_cell_are_in_it(tmp_path: Path) -> None:
    folder, elsewhere = tmp_path / "cell", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    request = copy.deepcopy(FIRST_PLAN)
    request["bodies"][1]["shape"] = {"mesh": {"file": "bracket.stl", "unit": "mm"}}
    (folder / "bracket.stl").write_bytes(asset("bracket"))
    (folder / "cell.json").write_text(json.dumps(request))
    out = elsewhere / "plan.json"
    assert run("plan", str(folder / "cell.json"), "--out", str(out))[0] == RIGHT
    assert run("check", str(folder / "cell.json"), str(out))[0] == RIGHT
    (folder / "bracket.stl").unlink()
    assert run("check", str(out))[0] == RIGHT
    assert run("report", str(out), "--out", str(elsewhere / "report.html"))[0] == RIGHT


def test_check_report_and_export_take_the_file_alone(written: Path, tmp_path: Path) -> None:
    code, output, errors = run("check", str(written))
    assert (code, errors) == (RIGHT, "")
    assert "plan right" in output
    page, motion, proof = (tmp_path / name for name in ("report.html", "motion.csv", "proof.json"))
    assert run("report", str(written), "--out", str(page))[0] == RIGHT
    text = page.read_text(encoding="utf-8")
    assert "<title>small" in text
    assert "It moves." in text
    given = ("--format", "csv", "--out", str(motion), "--plan-out", str(proof))
    assert run("export", str(written), *given)[0] == RIGHT
    assert run("check", str(proof))[0] == RIGHT
    assert run("check-trajectory", str(written), str(motion), "--plan", str(written))[0] == RIGHT


def test_it_is_a_cell_wherever_one_is_taken(written: Path, cell: Path) -> None:
    words = [run("plan", str(path))[1].partition("\n")[2].partition("candidates")[0] for path in (written, cell)]
    assert words[0] == words[1]
    assert run("ik", str(written), "--at-mm", "400", "0", "250", "--yaw-deg", "0")[0] == RIGHT


def test_its_name_need_not_end_in_json(written: Path) -> None:
    renamed = written.rename(written.with_name("kept.plan"))
    assert run("check", str(renamed))[0] == RIGHT
    assert assur.load(renamed) == FIRST_PLAN


def test_a_cell_that_is_held_is_compared_with_that_of_the_file(written: Path, cell: Path) -> None:
    for command in (["check"], ["report"], ["export", "--format", "csv"]):
        assert run(command[0], str(cell), str(written), *command[1:], *out_of(command[0], written))[0] == RIGHT
        code, _, errors = run(command[0], "transfer", str(written), *command[1:], *out_of(command[0], written))
        assert code == BAD_INPUT
        assert errors.startswith("assur: PLAN: request.robot")
        assert "this file has a plan for another request" in errors
    other = {**FIRST_PLAN, "bodies": FIRST_PLAN["bodies"][:1]}
    cell.write_text(json.dumps(other))
    code, _, errors = run("check", str(cell), str(written))
    assert code == BAD_INPUT
    assert errors.startswith("assur: PLAN: request.bodies[1]: got ")
    assert "allowed: what FILE has there: nothing; this file has a plan for another request" in errors


def out_of(command: str, beside: Path) -> list[str]:
    return [] if command == "check" else ["--out", str(beside.with_name("out"))]


def test_an_answer_alone_is_still_checked_against_a_cell(cell: Path, tmp_path: Path, answer: dict[str, Any]) -> None:
    alone = tmp_path / "answer.json"
    alone.write_text(json.dumps(answer))
    code, output, _ = run("check", str(cell), str(alone))
    assert (code, "plan right" in output) == (RIGHT, True)


def test_a_cell_alone_is_nothing_to_check_or_export(cell: Path) -> None:
    for command in (["check"], ["export", "--format", "csv"]):
        code, _, errors = run(command[0], str(cell), *command[1:])
        assert code == BAD_INPUT
        assert errors.startswith("assur: PLAN: it is missing")
        assert "a plan file, as `assur plan --out` writes it" in errors


def test_a_request_and_an_answer_that_do_not_belong_together_are_refused(written: Path, held: dict[str, Any]) -> None:
    held["request"]["bodies"].pop()
    written.write_text(json.dumps(held))
    for command in (["check"], ["report", *out_of("report", written)], ["export", "--format", "csv"]):
        code, _, errors = run(command[0], str(written), *command[1:])
        assert code == BAD_INPUT
        assert errors.startswith("assur: plan.request_digest: got ")
        assert "its plan is an answer to another request" in errors
    # a digest that is forged does not help: the certificate names what it is about
    held["plan"]["request_digest"] = request_digest(held["request"])
    written.write_text(json.dumps(held))
    assert run("check", str(written))[0] == WRONG


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"schema": "assur-plan/2"}, "schema: got"),
        ({"request": GONE}, "request: it is missing"),
        ({"plan": GONE}, "plan: it is missing"),
        ({"request": None}, "request: got null"),
        ({"plan": []}, "plan: got []"),
        ({"more": 1}, "more: got 1; allowed: one of schema, title, about, request, plan"),
        ({"title": 7}, "title: got 7; allowed: a text"),
        ({"about": "x" * 5000}, "about: got"),
        ({"plan": {"status": "maybe"}}, "plan.request_digest"),
        ({"plan.request_digest": GONE}, "plan.request_digest: it is missing"),
        ({"plan.trajectory.time_s[0]": math.inf}, "plan.trajectory.time_s[0]: got"),
        ({"request": {"schema": "assur/1"}}, "request.robot: it is missing"),
        ({"request": {**FIRST_PLAN, "seed": 1}}, "request.seed: got 1"),
    ],
)
def test_a_field_that_is_not_right_is_named(
    written: Path, held: dict[str, Any], change: dict[str, Any], told: str
) -> None:
    written.write_text(json.dumps(changed(held, change)))
    code, output, errors = run("check", str(written))
    assert (code, output) == (BAD_INPUT, "")
    assert told in errors.splitlines()[0]
    keys_missing = ["robot", "start", "task"] if "request.robot" in told else []
    assert errors.count("\n") == max(1, len(keys_missing))
    assert all(f"request.{key}: it is missing" in errors for key in keys_missing)


def test_a_file_that_is_too_long_is_refused_before_it_is_read_to_its_end(tmp_path: Path) -> None:
    huge = tmp_path / "huge.json"
    with huge.open("wb") as file:
        file.write(b'{"schema": "assur-plan/1", "request": {')
        file.truncate(1 << 40)  # no such disk: what would read it all would not end
    for given in ([str(huge)], ["transfer", str(huge)]):
        code, _, errors = run("check", *given)
        assert code == BAD_INPUT
        assert f"more than {bounds.MAX_PLAN_FILE_BYTES} bytes" in errors
    with pytest.raises(InputError, match="more than"):
        assur.load(huge)


def test_a_request_may_not_be_as_long_as_a_plan_file(tmp_path: Path, held: dict[str, Any]) -> None:
    long = tmp_path / "long.json"
    long.write_text(json.dumps(FIRST_PLAN) + " " * bounds.MAX_JSON_BYTES)
    code, _, errors = run("plan", str(long))
    assert (code, f"at most {bounds.MAX_JSON_BYTES} bytes, for it is no plan file" in errors) == (BAD_INPUT, True)
    long.write_text(json.dumps(held) + " " * bounds.MAX_JSON_BYTES)
    assert run("check", str(long))[0] == RIGHT


def test_what_could_not_be_read_again_is_not_written(
    cell: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("assur.api.documents.MAX_PLAN_FILE_BYTES", 1000)
    out = tmp_path / "plan.json"
    code, _, errors = run("plan", str(cell), "--out", str(out))
    assert (code, "--out" in errors, out.exists()) == (BAD_INPUT, True, False)


def test_a_plan_file_names_no_other_file(written: Path, held: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "bracket.stl").write_bytes(asset("bracket"))
    held["request"]["bodies"][1]["shape"] = {"mesh": {"file": "bracket.stl", "unit": "mm"}}
    written.write_text(json.dumps(held))
    code, _, errors = run("check", str(written))
    assert (code, "request.bodies[1].shape.mesh" in errors) == (BAD_INPUT, True)


def test_a_neighbour_is_given_by_a_plan_file(tmp_path: Path, held: dict[str, Any]) -> None:
    request = copy.deepcopy(FIRST_PLAN)
    far = {**FIRST_PLAN["robot"], "base": {"at_mm": [3000, 0, 0]}}
    request["neighbours"] = [{"name": "other", "robot": far, "plan": {"file": "other.json"}}]
    digests = []
    for document in (held, held["plan"]):
        (tmp_path / "other.json").write_text(json.dumps(document))
        digests.append(scene_of(request, folder=tmp_path).digest)
    assert digests[0] == digests[1]


def test_standard_output_has_words_or_the_answer_or_the_plan_file(cell: Path, tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    code, words, _ = run("plan", str(cell), "--out", str(out))
    assert (code, "plan checked" in words) == (RIGHT, True)
    code, answer, _ = run("plan", str(cell), "--json", "--out", str(out))
    assert (code, json.loads(answer)["status"]) == (RIGHT, "planned")
    assert json.loads(answer) == json.loads(out.read_bytes())["plan"]
    code, held, errors = run("plan", str(cell), "--out", "-")
    assert (code, json.loads(held)["schema"], errors) == (RIGHT, FORM, "")
    code, _, errors = run("plan", str(cell), "--out", "-", "--json")
    assert (code, "--json" in errors) == (BAD_INPUT, True)


def test_a_file_that_a_command_reads_is_not_overwritten(cell: Path, written: Path, tmp_path: Path) -> None:
    other = str(tmp_path / "other.csv")
    for path, arguments in (
        (cell, ["plan", str(cell), "--out", str(cell)]),
        (written, ["report", str(written), "--out", str(written)]),
        (
            written,
            [
                "report",
                str(cell),
                str(written),
                "--out",
                str(written.parent / ".." / written.parent.name / written.name),
            ],
        ),
        (written, ["export", str(written), "--format", "csv", "--out", str(written)]),
        (written, ["export", str(written), "--format", "csv", "--plan-out", str(written)]),
    ):
        before = path.read_bytes()
        code, _, errors = run(*arguments)
        assert (code, "another file than those" in errors) == (BAD_INPUT, True), arguments
        assert path.read_bytes() == before
    code, _, errors = run("export", str(written), "--format", "csv", "--out", other, "--plan-out", other)
    assert (code, errors.startswith("assur: --plan-out: ")) == (BAD_INPUT, True)


def test_what_is_piped_is_read(written: Path) -> None:
    data = written.read_bytes()
    for arguments in (["check", "-"], ["check", str(written), "-"], ["export", "-", "--format", "csv"]):
        assert CliRunner().invoke(app, arguments, input=data).exit_code == RIGHT
    told = CliRunner().invoke(app, ["check", "-"], input=b"")
    assert (told.exit_code, "an empty file" in told.stderr) == (BAD_INPUT, True)
    command = [sys.executable, "-m", "assur.api.command_line", "check", "-"]
    real = subprocess.run(command, cwd=ROOT, input=data, capture_output=True, check=False)
    assert (real.returncode, b"plan right" in real.stdout) == (RIGHT, True)


def test_the_service_takes_the_file_as_it_is(client: Any, held: dict[str, Any]) -> None:
    for address, more in (("check", {}), ("view", {}), ("report", {}), ("export", {"format": "csv"})):
        assert client.post(f"/v1/plans/{address}", json={**held, **more}).status_code == 200
        wrong = client.post(f"/v1/plans/{address}", json={**held, **more, "schema": "assur-plan/2"})
        assert wrong.status_code == 422
        assert wrong.json()["errors"][0]["field"] == "schema"

"""The commands `bundle` and `prove`."""

from __future__ import annotations

import builtins
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from assur.api.cli.border import BAD_INPUT, RIGHT, WRONG
from assur.scenes.plan_file import PlanFile
from assur.scenes.scenarios import shipped
from tests.api.test_command_line import run
from tests.planner.trajectory.changed import changed as changed_path
from tests.scenes.cells.answers import answer

NAME = "standard-cycle"


@pytest.fixture
def plan_file(tmp_path: Path) -> Path:
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(PlanFile(dict(shipped(NAME).request), answer(NAME)).document))
    return file


def test_a_plan_becomes_a_bundle_that_is_shown(plan_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "bundle.json"
    code, told, _ = run("bundle", str(plan_file), "--out", str(out))
    assert (code, told.startswith("proof bundle of plan: ")) == (RIGHT, True)
    code, told, _ = run("prove", str(out))
    assert (code, told.splitlines()[0]) == (RIGHT, "bundle shown")
    _, only_names, *lines = told.splitlines()
    assert only_names.endswith("Its digests are names: neither plan nor request was read.")
    code, said, _ = run("prove", str(out), "--json")
    verdict = json.loads(said)
    assert (code, verdict["shown"], list(verdict)) == (RIGHT, True, ["shown", "claims"])
    claims = verdict["claims"]
    assert [line.partition(": ")[0] for line in lines] == list(claims)
    texts = dict(line.split(": ", 1) for line in lines)
    assert texts["plan_digest"] == claims["plan_digest"]
    assert texts["deepest contact, m"] == f"{claims['deepest contact, m']:.6g}"
    velocity = claims["limits of each joint, velocity"]
    assert texts["limits of each joint, velocity"] == ", ".join(f"{x:.6g}" for x in velocity)
    document = json.loads(out.read_text())
    assert velocity == document["limits"][0]["velocity"]
    for limits in document["limits"]:
        limits["jerk"] = []
    out.write_text(json.dumps(document))
    assert "limits of each joint, jerk: not limited" in run("prove", str(out))[1].splitlines()


def test_a_bundle_that_claims_too_much_is_not_shown(plan_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "bundle.json"
    run("bundle", str(plan_file), "--out", str(out))
    document = json.loads(out.read_text())
    document["required"]["travel"] = 1.0
    out.write_text(json.dumps(document))
    code, told, _ = run("prove", str(out))
    lines = told.splitlines()
    assert (code, lines[0]) == (WRONG, "bundle not shown")
    assert lines[1].startswith("a row of ")
    assert lines[-1].startswith("claims that are not shown: ")
    code, told, _ = run("prove", str(out), "--json")
    assert (code, json.loads(told)) == (WRONG, {"shown": False, "not_shown": lines[1:]})


def test_what_is_no_bundle_is_bad_input(plan_file: Path, tmp_path: Path) -> None:
    code, told, wrong = run("prove", str(plan_file))
    assert (code, told) == (BAD_INPUT, "")
    allowed = "a proof bundle, as `assur bundle PLAN` makes it of a plan file"
    assert wrong == f'assur: plan.json: got "a plan file"; allowed: {allowed}\n'
    code, _, wrong = run("prove", str(tmp_path / "none.json"))
    assert (code, "a file that exists" in wrong) == (BAD_INPUT, True)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"", '"an empty file"; allowed: '),
        (b" \n", '"an empty file"; allowed: '),
        (b"\xb9\x00\x17", '"no text: byte 0 is not UTF-8"; allowed: '),
        (b'{"schema": "a', '"a text that ends before its value is complete, at line 1, column 12"; allowed: '),
        (b"{} {}", '"more text behind the end of the value, at line 1, column 4"; allowed: '),
    ],
)
def test_a_file_that_is_empty_binary_or_cut_is_named_and_told_in_words(tmp_path: Path, data: bytes, told: str) -> None:
    file = tmp_path / "given.json"
    file.write_bytes(data)
    for command, what in (
        (("prove",), "a proof bundle"),
        (("plan",), "a request or a plan file"),
        (("check",), "a request or a plan file"),
        (("check", "demo"), "an answer or a plan file"),
        (("bundle",), "a request or a plan file"),
    ):
        code, output, wrong = run(*command, str(file))
        assert (code, output) == (BAD_INPUT, "")
        assert wrong.startswith(f"assur: given.json: got {told}{what}, as JSON"), wrong


def test_a_whole_number_of_thousands_of_digits_is_repeated_in_part(tmp_path: Path) -> None:
    file = tmp_path / "given.json"
    for digits in (16, 400, 5000):
        file.write_text(f'{{"schema": 1{"0" * digits}}}')
        code, _, wrong = run("prove", str(file))
        assert (code, len(wrong) < 200, "whole ones of up to 15 digits" in wrong) == (BAD_INPUT, True, True), wrong


def test_an_answer_that_is_not_so_has_no_bundle(plan_file: Path, tmp_path: Path) -> None:
    document = json.loads(plan_file.read_text())
    document["plan"]["duration_s"] += 1.0
    plan_file.write_text(json.dumps(document))
    code, _, wrong = run("bundle", str(plan_file), "--out", str(tmp_path / "bundle.json"))
    assert (code, (tmp_path / "bundle.json").exists()) == (BAD_INPUT, False)
    assert "duration" in wrong


def test_a_motion_that_goes_on_where_it_is_needed_at_rest_has_no_bundle() -> None:
    from dataclasses import replace

    from assur.planner.errors import InputError
    from assur.scenes.bundle import bundle_of
    from tests.prover.bundles import planned

    scene, plan = planned(NAME)
    path = plan.trajectory
    qd = path.qd.copy()
    qd[-1, 0] = 1e-10
    scene = replace(scene, options=replace(scene.options, stay_safe_s=1.0))
    with pytest.raises(InputError, match="not at rest when it ends"):
        bundle_of(scene, replace(plan, trajectory=changed_path(path, qd=qd)))


def test_without_the_extra_it_is_said_what_to_install(plan_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, globals: Mapping[str, object] | None = None, *rest: Any) -> Any:  # noqa: A002
        if name == "assur.prover.prove":
            raise ImportError(name)
        return real(name, globals, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    code, told, wrong = run("prove", str(plan_file))
    assert (code, told) == (BAD_INPUT, "")
    assert "pip install 'assur[proof]'" in wrong

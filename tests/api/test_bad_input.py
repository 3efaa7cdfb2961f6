"""Bad input of every kind: a clear refusal of the right class that names the field; never a 500, never a traceback."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx
import pytest

from assur.api.cli.border import BAD_INPUT
from assur.api.problems import MEDIA_TYPE, Problem
from assur.api.web.settings import CHECK_BODY_BYTES, PLAN_BODY_BYTES
from assur.api.workers.jobs import FIRST_PLAN
from assur.scenes.faults import MOST_FAULTS
from tests.api.bad_bodies import BAD_BODIES, BAD_CALLS, BadBody
from tests.api.test_command_line import run as in_parts
from tests.scenes.bad_requests import BAD_REQUESTS, GOOD_REQUEST, Bad

JSON = {"content-type": "application/json"}


def problem(answer: Any, status: int) -> dict[str, Any]:
    """The problem in `answer`, which must be one, strict, short, and without anything of ours in it."""
    assert answer.status_code == status, answer.text[:500]
    assert answer.headers["content-type"] == MEDIA_TYPE
    assert len(answer.content) < 20_000
    assert "Traceback" not in answer.text
    document: dict[str, Any] = json.loads(answer.content, parse_constant=_refuse)
    assert document["status"] == status
    assert document["type"].startswith("urn:assur:problem:")
    return document


def _refuse(name: str) -> None:
    raise AssertionError(f"{name} in a problem")


def test_the_request_that_the_kinds_start_from_is_not_bad_itself(client: httpx.Client) -> None:
    answer = client.post("/v1/plans", json=GOOD_REQUEST)
    assert answer.status_code == 200, answer.text


@pytest.mark.parametrize("bad", BAD_BODIES, ids=lambda bad: bad.name)
def test_a_bad_body_is_refused_over_http(client: httpx.Client, bad: BadBody) -> None:
    document = problem(client.post("/v1/plans", content=bad.body, headers=JSON), bad.status)
    assert document["errors"][0]["field"] == bad.field
    assert document["errors"][0]["allowed"] != ""


def test_a_budget_above_the_services_is_told_with_the_setting_that_it_is_above(
    client: httpx.Client, small: dict[str, Any]
) -> None:
    document = problem(client.post("/v1/plans", json={**small, "options": {"budget_s": 31}}), 422)
    assert document["errors"][0]["allowed"] == "at most 30 s, which is ASSUR_MAX_BUDGET_S of this service"


def test_a_body_that_is_no_json_is_told_with_line_and_column(client: httpx.Client) -> None:
    document = problem(client.post("/v1/plans", content=b'{"schema":\n  }', headers=JSON), 400)
    assert document["errors"][0]["value"] == "no value, at line 2, column 3"


SOME = pytest.mark.parametrize("bad", BAD_REQUESTS[::12], ids=lambda bad: bad.name)
"""A few of the requests that tests/scenes/test_bad_requests.py reads: service and command line read them as it does."""


@SOME
def test_a_bad_request_is_refused_over_http_and_in_a_check(client: httpx.Client, bad: Bad) -> None:
    told = Problem.of_input(bad.refused()).document()["errors"]
    for address, body in (
        ("/v1/plans", bad.document()),
        ("/v1/plans/check", {"request": bad.document(), "plan": {}}),
    ):
        assert problem(client.post(address, json=body), 422)["errors"] == told


def test_options_of_a_scene_that_are_wrong_are_errors_each_with_its_value(client: httpx.Client) -> None:
    options = {"options": {"stop": "last", "budgets": 3, "elbow": None}}
    document = problem(client.post("/v1/scenes/demo/plans", json=options), 422)
    assert {each["field"]: each["value"] for each in document["errors"]} == {
        f"options.{name}": value for name, value in options["options"].items()
    }


@pytest.mark.parametrize(("address", "body", "field"), BAD_CALLS, ids=lambda value: str(value)[:40])
def test_a_bad_call_is_refused_by_the_name_of_its_field(
    client: httpx.Client, address: str, body: Any, field: str
) -> None:
    document = problem(client.post(address, json=body), 404 if "nowhere" in address else 422)
    assert document["errors"][0]["field"] == field


@pytest.mark.parametrize("bad", [bad for bad in BAD_BODIES if bad.status == 400], ids=lambda bad: bad.name)
def test_a_body_that_is_no_json_is_refused_in_a_check_too(client: httpx.Client, bad: BadBody) -> None:
    problem(client.post("/v1/plans/check", content=bad.body, headers=JSON), 400)


@pytest.mark.parametrize(("address", "limit"), [("/v1/plans", PLAN_BODY_BYTES), ("/v1/plans/check", CHECK_BODY_BYTES)])
def test_a_body_above_its_cap_is_refused_declared_or_not(client: httpx.Client, address: str, limit: int) -> None:
    declared = problem(client.post(address, content=b" " * (limit + 1), headers=JSON), 413)
    chunks = (b" " * 65_536 for _ in range(limit // 65_536 + 1))
    counted = problem(client.post(address, content=chunks, headers=JSON), 413)
    assert str(limit) in declared["detail"]
    assert declared == counted


def test_a_body_at_its_cap_is_read(client: httpx.Client) -> None:
    body = json.dumps(FIRST_PLAN).encode().ljust(PLAN_BODY_BYTES)
    assert client.post("/v1/plans", content=body, headers=JSON).status_code == 200


@pytest.mark.parametrize(
    "declared",
    [
        "",
        "text/plain",
        "text/json",
        "application/x-www-form-urlencoded",
        "multipart/form-data; boundary=x",
        "application/json; charset=utf-16",
        "application/json; charset=latin-1",
        "application/jsonp",
        "application/json, text/plain",
        "application/yaml",
    ],
)
def test_a_body_that_is_not_declared_to_be_json_is_refused(client: httpx.Client, declared: str) -> None:
    headers = {"content-type": declared}
    document = problem(client.post("/v1/plans", content=json.dumps(FIRST_PLAN), headers=headers), 415)
    assert (document["errors"][0]["field"], document["errors"][0]["value"]) == ("Content-Type", declared)


@pytest.mark.parametrize(
    "declared", ["application/json; charset=UTF-8", "Application/JSON", "application/problem+json"]
)
def test_a_body_that_is_declared_to_be_json_in_other_words_is_read(client: httpx.Client, declared: str) -> None:
    answer = client.post("/v1/plans", content=json.dumps(FIRST_PLAN), headers={"content-type": declared})
    assert answer.status_code == 200


def test_a_compressed_body_is_refused(client: httpx.Client) -> None:
    document = problem(client.post("/v1/plans", content=b"x", headers={**JSON, "content-encoding": "gzip"}), 415)
    assert (document["errors"][0]["field"], document["errors"][0]["value"]) == ("Content-Encoding", "gzip")


def run(*arguments: str) -> tuple[int, str]:
    """Exit code and everything that the command printed."""
    code, output, errors = in_parts(*arguments)
    assert "Traceback" not in output + errors
    return code, output + errors


def assert_only_faults(output: str) -> None:
    """Each line of what was printed is a fault, and there are not too many."""
    lines = output.splitlines()
    assert 1 <= len(lines) <= MOST_FAULTS + 1
    assert all(line.startswith("assur: ") for line in lines)


@pytest.mark.parametrize("bad", [bad for bad in BAD_BODIES if not bad.service_only], ids=lambda bad: bad.name)
def test_a_bad_body_in_a_file_is_refused_on_the_command_line(tmp_path: Path, bad: BadBody) -> None:
    file = tmp_path / "request.json"
    file.write_bytes(bad.body)
    code, output = run("plan", str(file))
    assert code == BAD_INPUT
    assert_only_faults(output)


@SOME
def test_a_bad_request_in_a_file_is_refused_on_the_command_line(tmp_path: Path, bad: Bad) -> None:
    file = tmp_path / "request.json"
    file.write_text(json.dumps(bad.document()))
    code, output = run("plan", str(file))
    assert code == BAD_INPUT
    assert output.startswith(f"assur: {bad.field}: ")
    assert bad.said in output
    told = [line.split(": ")[1] for line in output.splitlines()]
    assert told == [each["field"] for each in bad.refused().errors]


@pytest.mark.parametrize("bad", BAD_BODIES, ids=lambda bad: bad.name)
def test_a_bad_plan_in_a_file_is_refused_by_the_check_command(tmp_path: Path, bad: BadBody) -> None:
    file = tmp_path / "plan.json"
    file.write_bytes(bad.body)
    code, output = run("check", "demo", str(file))
    assert code == BAD_INPUT
    assert_only_faults(output)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("x.yaml", b"\x00\x01"),
        ("x.yaml", b"\xff\xfe"),
        ("x.yaml", b"a: 1\na: 2\n"),
        ("x.yaml", b"- 1\n- 2\n"),
        ("x.yaml", b"about: x\n"),
        ("x.yaml", b"about: x\nrequest: {}\nexpect: {}\n"),
        ("x.yaml", b"about: x\nrequest: 1\nexpect: {}\n"),
        ("x.yaml", b"a: " + b"x" * (1 << 20)),
        ("x", b"{"),
        ("x.txt", b"hello"),
        ("x.json", b"about: x\n"),
        ("x.JSON", b"{"),
    ],
    ids=lambda value: value.decode("latin-1")[:30] if isinstance(value, bytes) else value,
)
def test_a_bad_scenario_file_is_refused_a_line_for_each_fault(tmp_path: Path, name: str, content: bytes) -> None:
    file = tmp_path / name
    file.write_bytes(content)
    code, output = run("plan", str(file))
    assert code == BAD_INPUT
    assert_only_faults(output)


@pytest.mark.parametrize("command", ["plan", "check"])
def test_what_is_not_a_file_is_refused_in_one_line(tmp_path: Path, command: str) -> None:
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "dangling").symlink_to("nowhere")
    for name in (str(tmp_path), str(tmp_path / "nowhere.yaml"), "/dev/zero", "", "x" * 5000, "a\x00b"):
        rest = ["plan.json"] if command == "check" else []
        code, output = run(command, name, *rest)
        assert code == BAD_INPUT, name
        assert output.startswith("assur: FILE: "), name
        assert output.count("\n") == 1
    for name in ("loop", "dangling"):
        assert run("plan", str(tmp_path / name))[0] == BAD_INPUT
    assert run("check", "demo", str(tmp_path))[0] == BAD_INPUT
    assert run("check", "demo", str(tmp_path / "nowhere.json"))[0] == BAD_INPUT


@pytest.mark.parametrize(
    "arguments",
    [
        ["nowhere"],
        ["plan"],
        ["plan", "demo", "more"],
        ["plan", "demo", "--certificate", "none"],
        ["plan", "demo", "--colour"],
        ["check"],
        ["check", "demo", "plan.json", "more"],
        ["serve", "--port", "65536"],
        ["serve", "--port", "http"],
        ["schema", "x"],
    ],
    ids=" ".join,
)
def test_wrong_usage_is_bad_input(arguments: list[str]) -> None:
    code, output = run(*arguments)
    assert code == BAD_INPUT
    assert "Usage" in output


@pytest.mark.parametrize("value", ["nowhere/plan.json", "/dev/null/plan.json", "."])
def test_an_output_that_cannot_be_written_is_refused_before_anything_is_planned(value: str) -> None:
    code, output = run("plan", "demo", "--out", value)
    assert code == BAD_INPUT
    assert "--out" in output

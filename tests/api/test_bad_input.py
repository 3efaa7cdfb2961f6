"""Bad input of every kind: a clear refusal of the right class that names the field; never a 500, never a traceback."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient
from typer.testing import CliRunner

from api.command_line import BAD_INPUT, app
from api.jobs import FIRST_PLAN
from api.problems import MEDIA_TYPE
from api.settings import CHECK_BODY_BYTES, PLAN_BODY_BYTES
from tests.api.bad_bodies import BAD_BODIES, BadBody
from tests.scenes.bad_requests import BAD_REQUESTS, BAD_TEXTS, GOOD_REQUEST, Bad, BadText

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


def test_there_are_at_least_sixty_kinds() -> None:
    kinds = {bad.name for bad in BAD_REQUESTS} | {text.name for text in BAD_TEXTS} | {bad.name for bad in BAD_BODIES}
    assert len(kinds) >= 60


def test_the_request_that_the_kinds_start_from_is_not_bad_itself(client: TestClient) -> None:
    answer = client.post("/v1/plans", json=GOOD_REQUEST)
    assert answer.status_code == 200, answer.text


@pytest.mark.parametrize("bad", BAD_BODIES, ids=lambda bad: bad.name)
def test_a_bad_body_is_refused_over_http(client: TestClient, bad: BadBody) -> None:
    document = problem(client.post("/v1/plans", content=bad.body, headers=JSON), bad.status)
    assert document["errors"][0]["field"].endswith(bad.field)
    assert document["errors"][0]["allowed"] != ""


@pytest.mark.parametrize("bad", BAD_REQUESTS, ids=lambda bad: bad.name)
def test_a_bad_request_is_refused_over_http(client: TestClient, bad: Bad) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    bad.change(request)
    document = problem(client.post("/v1/plans", json=request), 422)
    assert document["errors"][0]["field"] == bad.field


@pytest.mark.parametrize("bad", BAD_TEXTS, ids=lambda bad: bad.name)
def test_a_bad_text_is_refused_over_http(client: TestClient, bad: BadText) -> None:
    answer = client.post("/v1/plans", content=bad.data, headers=JSON)
    assert answer.status_code in (400, 413, 422)
    document = problem(answer, answer.status_code)
    if bad.field is not None and len(bad.data) <= PLAN_BODY_BYTES:
        assert document["errors"][0]["field"] == bad.field


@pytest.mark.parametrize("bad", BAD_REQUESTS, ids=lambda bad: bad.name)
def test_a_bad_request_is_refused_in_a_check_too(client: TestClient, bad: Bad) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    bad.change(request)
    document = problem(client.post("/v1/plans/check", json={"request": request, "plan": {}}), 422)
    assert document["errors"][0]["field"].endswith(bad.field)


@pytest.mark.parametrize(
    "body",
    [
        b"{}",
        b"[]",
        b'{"request": {}}',
        b'{"plan": {}}',
        b'{"request": {}, "plan": {}, "more": {}}',
        json.dumps({"request": FIRST_PLAN, "plan": {}}).encode(),
        json.dumps({"request": FIRST_PLAN, "plan": []}).encode(),
        json.dumps({"request": FIRST_PLAN, "plan": None}).encode(),
        json.dumps({"request": FIRST_PLAN, "plan": {"status": "planned", "trajectory": {}}}).encode(),
        json.dumps({"request": None, "plan": None}).encode(),
    ],
    ids=lambda body: body.decode()[-40:],
)
def test_a_check_of_something_else_than_a_request_and_a_plan_is_refused(client: TestClient, body: bytes) -> None:
    document = problem(client.post("/v1/plans/check", content=body, headers=JSON), 422)
    assert document["errors"][0]["field"] != ""


@pytest.mark.parametrize("bad", [bad for bad in BAD_BODIES if bad.status == 400], ids=lambda bad: bad.name)
def test_a_body_that_is_no_json_is_refused_in_a_check_too(client: TestClient, bad: BadBody) -> None:
    problem(client.post("/v1/plans/check", content=bad.body, headers=JSON), 400)


@pytest.mark.parametrize(("address", "limit"), [("/v1/plans", PLAN_BODY_BYTES), ("/v1/plans/check", CHECK_BODY_BYTES)])
def test_a_body_above_its_cap_is_refused_declared_or_not(client: TestClient, address: str, limit: int) -> None:
    declared = problem(client.post(address, content=b" " * (limit + 1), headers=JSON), 413)
    chunks = (b" " * 65_536 for _ in range(limit // 65_536 + 1))
    counted = problem(client.post(address, content=chunks, headers=JSON), 413)
    assert str(limit) in declared["detail"]
    assert declared == counted


def test_a_body_at_its_cap_is_read(client: TestClient) -> None:
    body = json.dumps(FIRST_PLAN).encode().ljust(PLAN_BODY_BYTES)
    assert client.post("/v1/plans", content=body, headers=JSON).status_code == 200


@pytest.mark.parametrize("declared", ["many", "-1", "9" * 30, "1e3"])
def test_a_length_that_is_no_length_is_refused(client: TestClient, declared: str) -> None:
    headers = {**JSON, "content-length": declared}
    assert client.post("/v1/plans", content=b"{}", headers=headers).status_code == 413


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
def test_a_body_that_is_not_declared_to_be_json_is_refused(client: TestClient, declared: str) -> None:
    headers = {"content-type": declared}
    document = problem(client.post("/v1/plans", content=json.dumps(FIRST_PLAN), headers=headers), 415)
    assert document["errors"][0]["field"] == "Content-Type"


@pytest.mark.parametrize("declared", ["application/json; charset=UTF-8", "Application/JSON", "application/problem+json"])
def test_a_body_that_is_declared_to_be_json_in_other_words_is_read(client: TestClient, declared: str) -> None:
    answer = client.post("/v1/plans", content=json.dumps(FIRST_PLAN), headers={"content-type": declared})
    assert answer.status_code == 200


def test_a_compressed_body_is_refused(client: TestClient) -> None:
    document = problem(client.post("/v1/plans", content=b"x", headers={**JSON, "content-encoding": "gzip"}), 415)
    assert document["errors"][0]["field"] == "Content-Encoding"


@pytest.mark.parametrize("query", ["certificate=none", "certificate=", "certificate=full&certificate=x", "certificate=%00"])
def test_a_parameter_that_is_not_allowed_is_refused_by_name(client: TestClient, query: str) -> None:
    document = problem(client.post(f"/v1/plans?{query}", json=FIRST_PLAN), 422)
    assert document["errors"][0]["field"] == "certificate"


@pytest.mark.parametrize("query", ["certficate=digest", "budget_s=1", "certificate=full&x=1"])
def test_a_parameter_that_is_not_known_is_refused_by_name(client: TestClient, query: str) -> None:
    document = problem(client.post(f"/v1/plans?{query}", json=FIRST_PLAN), 422)
    assert document["errors"][0]["field"] in ("certficate", "budget_s", "x")


def run(*arguments: str) -> tuple[int, str]:
    """Exit code and everything that the command printed."""
    result = CliRunner().invoke(app, list(arguments))
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert "Traceback" not in result.output
    return result.exit_code, result.output


@pytest.mark.parametrize("bad", [bad for bad in BAD_BODIES if bad.status != 413], ids=lambda bad: bad.name)
def test_a_bad_body_in_a_file_is_refused_on_the_command_line(tmp_path: Path, bad: BadBody) -> None:
    if bad.body.startswith(b'{"scenario"') or "budget above" in bad.name or "in the twin unit" in bad.name:
        pytest.fail("kept apart below") if False else None
    file = tmp_path / "request.json"
    file.write_bytes(bad.body)
    code, output = run("plan", str(file))
    assert code == BAD_INPUT
    assert output.startswith("assur: ")
    assert output.count("\n") == 1


@pytest.mark.parametrize("bad", BAD_REQUESTS, ids=lambda bad: bad.name)
def test_a_bad_request_in_a_file_is_refused_on_the_command_line(tmp_path: Path, bad: Bad) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    bad.change(request)
    file = tmp_path / "request.json"
    file.write_text(json.dumps(request))
    code, output = run("plan", str(file))
    assert code == BAD_INPUT
    assert output.startswith(f"assur: {bad.field}: ")
    assert output.count("\n") == 1

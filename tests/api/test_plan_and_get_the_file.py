"""`POST /v1/plans?format=…`: the file of a plan in one call, the same as that of an export of the answer."""

from __future__ import annotations

import base64
import json
from typing import Any

import httpx
import pytest

from assur.api.workers.file_jobs import HEADERS, MEDIA_TYPES
from assur.api.workers.jobs import FIRST_PLAN
from assur.scenes.exports.documents import check_trajectory_document

OUT_OF_REACH = {**FIRST_PLAN, "task": [{"move": {"to": {"at_m": [1.5, 0.0, 0.25]}}}]}


@pytest.mark.parametrize("form", sorted(MEDIA_TYPES.keys() - {"report"}))
def test_the_file_is_that_of_an_export_of_the_answer(client: httpx.Client, form: str) -> None:
    answer = client.post("/v1/plans", json=FIRST_PLAN).json()
    export = client.post("/v1/plans/export", json={"request": FIRST_PLAN, "plan": answer, "format": form}).json()
    found = client.post("/v1/plans", params={"format": form}, json=FIRST_PLAN)
    assert found.status_code == 200
    told = export["file"].encode() if export["encoding"] == "text" else base64.b64decode(export["file"])
    assert found.content == told
    headers = {name: found.headers[name] for name in HEADERS}
    assert headers == {
        "Assur-Status": "planned",
        "Assur-Verdict": "right",
        "Assur-Duration-S": str(export["duration_s"]),
        "Assur-Request-Digest": answer["request_digest"],
        "Assur-Certificate-Digest": export["certificate_digest"],
    }
    assert found.headers["Content-Type"].startswith(MEDIA_TYPES[form])
    assert found.headers["Content-Disposition"] == f'attachment; filename="plan.{export["ending"]}"'


def test_the_response_is_as_large_as_the_file_and_not_as_the_answer(client: httpx.Client) -> None:
    plain = {"Accept-Encoding": "identity"}
    answer = client.post("/v1/plans", json={"scenario": "demo"}, headers=plain)
    found = client.post("/v1/plans", params={"format": "csv"}, json={"scenario": "demo"}, headers=plain)
    assert (found.status_code, found.headers["Assur-Status"]) == (200, "planned")
    assert float(found.headers["Assur-Duration-S"]) == pytest.approx(answer.json()["duration_s"])
    assert int(found.headers["Content-Length"]) == len(found.content) < len(answer.content) / 2


def test_ticks_and_jerk_are_those_of_an_export_and_the_file_is_proved(client: httpx.Client) -> None:
    parameters = {"format": "ros2", "tick_ms": "4", "jerk": "report"}
    found = client.post("/v1/plans", params=parameters, json=FIRST_PLAN)
    assert found.status_code == 200
    question = {"file": found.text, "format": "ros2", "jerk": "report"}
    assert check_trajectory_document(FIRST_PLAN, question)["ok"] is True
    same = client.post("/v1/plans", params={**parameters, "tick_ms": ""}, json=FIRST_PLAN)
    assert (same.status_code, same.json()["errors"][0]["field"]) == (422, "tick_ms")
    refused = client.post("/v1/plans", params={"format": "csv", "tick_ms": "40"}, json=FIRST_PLAN)
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "tick_ms")
    assert "limits: {jerk:" in refused.json()["errors"][0]["allowed"]


@pytest.mark.parametrize("form", ["csv", "glb", "ros2-json"])
def test_where_there_is_no_plan_there_is_no_file_but_the_answer(client: httpx.Client, form: str) -> None:
    found = client.post("/v1/plans", params={"format": form}, json=OUT_OF_REACH)
    assert (found.status_code, found.headers["Content-Type"]) == (409, "application/json")
    plain = client.post("/v1/plans", json=OUT_OF_REACH).json()
    assert found.json() == {**plain, "elapsed_s": found.json()["elapsed_s"]}
    assert found.headers["Assur-Status"] == found.json()["status"] == "not_planned"
    assert "Assur-Verdict" not in found.headers


@pytest.mark.parametrize(("request_", "status"), [(FIRST_PLAN, "planned"), (OUT_OF_REACH, "not_planned")])
def test_a_report_is_the_page_of_either_answer(client: httpx.Client, request_: dict[str, Any], status: str) -> None:
    found = client.post("/v1/plans", params={"format": "report"}, json=request_)
    assert (found.status_code, found.headers["Assur-Status"], found.headers["Assur-Verdict"]) == (200, status, "right")
    assert found.headers["Content-Type"] == "text/html; charset=utf-8"
    assert found.text.startswith("<!doctype html>")


def test_an_export_takes_an_answer_with_the_digest_of_its_certificate(client: httpx.Client) -> None:
    asked = {"format": "csv", "request": FIRST_PLAN}
    full = client.post("/v1/plans", json=FIRST_PLAN).json()
    digest = client.post("/v1/plans?certificate=digest", json=FIRST_PLAN).json()
    assert "normal" not in digest["certificate"]
    found = [client.post("/v1/plans/export", json={**asked, "plan": plan}) for plan in (full, digest)]
    assert [each.status_code for each in found] == [200, 200]
    assert found[0].json() == found[1].json()
    assert client.post("/v1/plans/check", json={"request": FIRST_PLAN, "plan": found[1].json()["plan"]}).json()["ok"]
    other = json.loads(json.dumps(digest))
    other["certificate"]["rows"] = "many"
    refused = client.post("/v1/plans/export", json={**asked, "plan": other})
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "plan.certificate.rows")
    check = client.post("/v1/plans/check", json={"request": FIRST_PLAN, "plan": digest})
    assert (check.status_code, check.json()["errors"][0]["field"]) == (422, "plan.certificate")
    moved = json.loads(json.dumps(digest))
    moved["trajectory"]["position"][3][0] += 0.01  # what the digest was made of is another motion
    refuted = client.post("/v1/plans/export", json={**asked, "plan": moved})
    assert (refuted.status_code, refuted.json()["errors"][0]["field"]) == (422, "plan")


def test_the_legs_of_a_digest_answer_judge_a_trajectory(client: httpx.Client) -> None:
    digest = client.post("/v1/plans?certificate=digest", json=FIRST_PLAN).json()
    file = client.post("/v1/plans?format=csv", json=FIRST_PLAN).text
    question = {"request": FIRST_PLAN, "plan": digest, "file": file, "format": "csv"}
    verdict = client.post("/v1/trajectories/check", json=question).json()
    assert (verdict["ok"], verdict["judged_as"]) == (True, "plan")

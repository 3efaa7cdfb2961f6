"""The service as its callers see it: what is right is answered, and the same each time."""

from __future__ import annotations

import json
import re
from typing import Any

import httpx
import pytest

from assur.api.documents import to_json
from assur.api.problems import MEDIA_TYPE
from assur.api.web.settings import Settings
from assur.scenes.requests import shipped_scenarios, validate, view_document, with_options

TIMES = ("elapsed_s", "first_s")
"""What differs between two runs of the same request."""


def planned(client: httpx.Client, body: dict[str, Any], **parameters: str) -> dict[str, Any]:
    answer = client.post("/v1/plans", json=body, params=parameters)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/json"
    document: dict[str, Any] = answer.json()
    return document


def test_a_request_is_planned_and_the_answer_has_what_a_controller_needs(
    client: httpx.Client, small: dict[str, Any]
) -> None:
    answer = planned(client, small)
    assert answer["status"] == "planned"
    trajectory = answer["trajectory"]
    knots = len(trajectory["time_s"])
    assert knots >= 2
    for name in ("position", "velocity", "acceleration"):
        assert [len(knot) for knot in trajectory[name]] == [len(trajectory["joint_names"])] * knots
    expected = {
        "duration_s",
        "arrivals",
        "legs",
        "margins",
        "certificate",
        "census",
        "assumptions",
        "seed",
        "elapsed_s",
    }
    assert expected | {"notice"} <= set(answer)
    assert not {"warnings", "lower_bound_s"} & set(answer)
    full = planned(client, with_options(small, {"report": "full"}))
    assert full.keys() - answer.keys() == {"warnings", "lower_bound_s"}


def test_a_view_over_http_is_the_view_in_python_with_the_certificate_in_full_or_as_a_digest(
    client: httpx.Client, small: dict[str, Any]
) -> None:
    answer = planned(client, small)
    shown = client.post("/v1/plans/view", json={"request": small, "plan": answer})
    assert shown.status_code == 200
    assert shown.json() == json.loads(json.dumps(view_document(small, answer)))
    brief = {**answer, "certificate": {key: answer["certificate"][key] for key in ("digest", "rows", "covers")}}
    assert client.post("/v1/plans/view", json={"request": small, "plan": brief}).json() == shown.json()


def test_the_same_request_and_seed_give_the_same_bytes_but_for_the_times(
    client: httpx.Client, small: dict[str, Any]
) -> None:
    first, second = (planned(client, small) for _ in range(2))
    for name in TIMES:
        first.pop(name, None), second.pop(name, None)
    assert to_json(first) == to_json(second)


def test_the_schema_is_json_schema(client: httpx.Client) -> None:
    schema = client.get("/v1/schema").json()
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert "task" in schema["properties"]


def test_the_service_lives_and_is_ready(client: httpx.Client) -> None:
    assert client.get("/livez").json() == {"live": True}
    assert client.get("/readyz").json() == {"ready": True, "workers": 1}


def test_the_reference_pages_need_nothing_from_elsewhere(client: httpx.Client) -> None:
    for address in ("/docs", "/redoc"):
        page = client.get(address)
        assert page.status_code == 200
        loaded = re.findall(r"""(?:src|href)\s*=\s*["']([^"']+)["']""", page.text)
        assert len(loaded) >= 1
        for source in loaded:
            assert source.startswith("/"), source
            assert client.get(source).status_code == 200, source
        assert "//cdn" not in page.text
        assert "fonts.googleapis" not in page.text


def resolved(document: dict[str, Any], reference: str) -> Any:
    found: Any = document
    for key in reference.removeprefix("#/").split("/"):
        found = found[key]
    return found


def references(part: Any) -> list[str]:
    if isinstance(part, dict):
        own = [part["$ref"]] if isinstance(part.get("$ref"), str) else []
        return own + [found for value in part.values() for found in references(value)]
    return [found for value in part for found in references(value)] if isinstance(part, list) else []


def test_every_reference_in_the_description_leads_to_a_component(client: httpx.Client) -> None:
    described = client.get("/openapi.json").json()
    found = references(described)
    assert len(found) > 10
    for reference in found:
        assert resolved(described, reference) is not None


def untyped(part: Any, path: str = "") -> list[str]:
    """Places in a schema where a field has no type, or is an object of which nothing is said."""
    if isinstance(part, list):
        return [found for i, item in enumerate(part) for found in untyped(item, f"{path}[{i}]")]
    if not isinstance(part, dict):
        return []
    found = [found for key, value in part.items() for found in untyped(value, f"{path}.{key}")]
    for name, field in part.get("properties", {}).items():
        if not {"type", "$ref", "anyOf", "oneOf", "enum", "const"} & field.keys() or (
            field.get("type") == "object" and not {"properties", "additionalProperties"} & field.keys()
        ):
            found.append(f"{path}.{name}")
    return found


def test_every_field_of_the_answers_is_typed_so_that_a_client_can_be_generated(client: httpx.Client) -> None:
    described = client.get("/openapi.json").json()
    parts = described["components"]["schemas"]
    answers = described["paths"]["/v1/plans"]["post"]["responses"]["200"]["content"]["application/json"]["schema"]
    assert answers["discriminator"]["propertyName"] == "status"
    assert {reference.rpartition("/")[2] for reference in references(answers)} == {"PlannedAnswer", "NotPlannedAnswer"}
    verdict = described["paths"]["/v1/plans/check"]["post"]["responses"]["200"]["content"]["application/json"]["schema"]
    waiting, known = ["PlannedAnswer", "NotPlannedAnswer", "IkAnswer", "ViewDocument"], set()
    waiting.append(verdict["$ref"].rpartition("/")[2])
    while waiting:
        name = waiting.pop()
        known.add(name)
        waiting += {r.rpartition("/")[2] for r in references(parts[name])} - known
    assert {"Trajectory", "Certificate", "CertificateDigest", "Margins", "CensusLine", "Arrival", "Leg"} <= known
    assert {"Solution", "Collision", "Unreached", "ToolPose"} <= known
    assert [place for name in sorted(known) for place in untyped(parts[name], name)] == []


def test_a_field_that_is_not_typed_is_found() -> None:
    assert untyped({"properties": {"a": {}, "b": {"type": "object"}, "c": {"type": "number"}}}, "X") == ["X.a", "X.b"]


def test_the_example_in_the_description_is_the_demo_in_full(client: httpx.Client) -> None:
    described = client.get("/openapi.json").json()
    body = described["paths"]["/v1/plans"]["post"]["requestBody"]["content"]["application/json"]
    (in_full,) = (example["value"] for example in body["examples"].values())
    assert planned(client, in_full, certificate="digest")["status"] == "planned"
    assert in_full == client.get("/v1/scenes/demo").json()


def test_every_answer_bears_an_id_and_is_not_kept_by_caches(client: httpx.Client) -> None:
    answers = [client.get("/livez"), client.get("/nowhere"), client.post("/v1/plans", json={})]
    assert len({answer.headers["x-request-id"] for answer in answers}) == 3
    for answer in answers:
        assert answer.headers["cache-control"] == "no-store"
        assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    ("method", "address", "status"),
    [
        ("GET", "/nowhere", 404),
        ("GET", "/v1/scenes/nowhere", 404),
        ("GET", "/v1/scenes/..%2f..%2fpyproject.toml", 404),
        ("GET", "/v1/plans", 405),
        ("PUT", "/v1/plans", 405),
        ("DELETE", "/v1/robots", 405),
        ("POST", "/v1/robots", 405),
        ("POST", "/livez", 405),
        ("POST", "/v1/plans/", 404),
        ("GET", "/static-offline-docs/../../app.py", 404),
    ],
)
def test_an_address_or_method_that_is_not_there_is_a_problem(
    client: httpx.Client, method: str, address: str, status: int
) -> None:
    answer = client.request(method, address)
    assert answer.status_code == status
    assert answer.headers["content-type"] == MEDIA_TYPE
    assert answer.json()["status"] == status
    assert (status == 405) == ("allow" in answer.headers)


@pytest.mark.parametrize(
    ("method", "address", "allowed"),
    [
        ("HEAD", "/docs", "GET"),
        ("POST", "/redoc", "GET"),
        ("POST", "/openapi.json", "GET, HEAD"),
        ("POST", "/static-offline-docs/swagger-ui.css", "GET, HEAD"),
        ("POST", "/v1/jobs/x", "DELETE, GET"),
    ],
)
def test_a_method_that_is_not_allowed_is_answered_with_those_that_are(
    client: httpx.Client, method: str, address: str, allowed: str
) -> None:
    answer = client.request(method, address)
    assert (answer.status_code, answer.headers["allow"]) == (405, allowed)


def test_a_service_with_the_usual_settings_takes_every_shipped_scenario(client: httpx.Client) -> None:
    for name in shipped_scenarios():
        options = validate(client.get(f"/v1/scenes/{name}").json()).options
        assert options.budget_s <= Settings().max_budget_s, name
        assert options.explain_budget_s <= Settings().max_budget_s, name

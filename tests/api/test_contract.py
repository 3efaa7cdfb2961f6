"""The description of the service: valid, and held to by the service in some hundred cases of schemathesis."""

from __future__ import annotations

import httpx
import pytest
from openapi_spec_validator import validate as validate_description

from assur.api.web.settings import Settings
from benchmarks.contract import PHASES, failures_of, round_of
from tests.api.running import running

QUICK = "^(list_scenes|show_scene|plan_scene|start_scene_job|show_job|show_live|list_robots)$"
SMALL_BUDGETS = Settings(workers=1, queue=10_000, queue_wait_s=3600.0, max_budget_s=0.05, grace_s=30.0)


def test_the_description_is_valid(client: httpx.Client) -> None:
    validate_description(client.get("/openapi.json").json())


def test_every_operation_has_a_name_a_tag_and_the_id_of_the_request_in_each_answer(client: httpx.Client) -> None:
    described = client.get("/openapi.json").json()
    operations = [operation for item in described["paths"].values() for operation in item.values()]
    names = [operation["operationId"] for operation in operations]
    assert len(set(names)) == len(names)
    assert all(name.replace("_", "").isalpha() and name.islower() for name in names)
    tags = {tag["name"] for tag in described["tags"]}
    for operation in operations:
        assert set(operation["tags"]) <= tags
        assert len(operation["tags"]) == 1
        assert all("X-Request-Id" in response["headers"] for response in operation["responses"].values())


def test_every_link_leads_to_an_operation(client: httpx.Client) -> None:
    paths = client.get("/openapi.json").json()["paths"]
    operations = {operation["operationId"] for item in paths.values() for operation in item.values()}
    links = [
        link["operationId"]
        for item in paths.values()
        for operation in item.values()
        for response in operation["responses"].values()
        for link in response.get("links", {}).values()
    ]
    assert len(links) > 10
    assert set(links) <= operations


@pytest.mark.slow
def test_some_hundred_cases_of_all_phases_find_nothing() -> None:
    with running(SMALL_BUDGETS) as client:
        done = round_of(str(client.base_url), 1, 5, PHASES, 60.0, QUICK)
    assert failures_of(done) == []
    assert done["report"]["test_cases"]["generated"] > 100

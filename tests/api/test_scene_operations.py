"""Plans and jobs of shipped scenarios, which are operations of their own; budgets that nobody states; methods told."""

from __future__ import annotations

import time
from typing import Any

import httpx

from assur.api.web.settings import Settings
from assur.scenes.requests import with_options
from tests.api.running import running


def test_a_scenario_is_planned_by_its_address_as_by_its_name(client: httpx.Client) -> None:
    by_address = client.post("/v1/scenes/demo/plans?certificate=digest").json()
    by_name = client.post("/v1/plans?certificate=digest", json={"scenario": "demo"}).json()
    by_request = client.post("/v1/plans?certificate=digest", json=client.get("/v1/scenes/demo").json()).json()
    assert by_address["status"] == "planned"
    assert by_address["certificate"] == by_name["certificate"] == by_request["certificate"]


def test_options_of_a_body_take_the_place_of_those_of_the_scenario(client: httpx.Client) -> None:
    own = client.get("/v1/scenes/demo").json()["options"].get("seed", 0)
    for body, seed in (({}, own), ({"options": {}}, own), ({"options": {"seed": 7, "budget_ms": 5000}}, 7)):
        assert client.post("/v1/scenes/demo/plans?certificate=digest", json=body).json()["seed"] == seed


def test_an_option_of_a_body_takes_the_place_of_its_twin() -> None:
    request = {"options": {"budget_s": 5, "clearance_mm": {"travel": 1, "near": 0}, "seed": 1}}
    found = with_options(request, {"budget_ms": 20, "clearance_m": {"travel": 0, "near": 0}})
    assert found["options"] == {"seed": 1, "budget_ms": 20, "clearance_m": {"travel": 0, "near": 0}}


def test_a_scenario_is_a_job_too(client: httpx.Client) -> None:
    taken = client.post("/v1/scenes/demo/jobs", json={"options": {"stop": "first"}})
    assert taken.status_code == 202
    job = client.get(str(taken.url.join(taken.headers["location"])))
    assert job.json()["id"] == taken.json()["id"]
    while job.json()["state"] == "working":
        time.sleep(0.1)
        job = client.get(f"/v1/jobs/{taken.json()['id']}")
    assert job.json()["outcome"] == "planned"


def test_an_address_tells_all_its_methods(client: httpx.Client) -> None:
    for address, allowed in (("/v1/jobs/0", "DELETE, GET"), ("/v1/scenes/parse", "POST"), ("/v1/plans", "POST")):
        assert client.put(address).headers["allow"] == allowed
    assert client.get("/v1/scenes/parse").status_code == 405


def test_who_is_silent_about_the_budget_gets_the_lesser_of_default_and_largest(small: dict[str, Any]) -> None:
    with running(Settings(workers=1, max_budget_s=0.5, grace_s=30.0)) as client:
        small["options"] = {"stop": "budget", "elbow": "auto"}
        answer = client.post("/v1/plans?certificate=digest", json=small)
        assert answer.status_code == 200
        assert answer.json()["census"] is not None
        scene = client.get("/v1/scenes/demo").json()
        assert scene["options"].get("budget_s", 0.5) <= 0.5
        assert client.post("/v1/plans", json=scene).status_code == 200
        assert client.post("/v1/plans", json={"scenario": "demo"}).status_code == 200
        small["options"]["budget_s"] = 0.6
        assert client.post("/v1/plans", json=small).status_code == 422
        described = client.get("/openapi.json").json()["components"]["schemas"]["OptionsDocument"]["properties"]
        assert described["budget_s"]["maximum"] == 0.5
        assert described["budget_ms"]["maximum"] == 500

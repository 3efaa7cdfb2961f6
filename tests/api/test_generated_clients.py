"""Clients that others generate from the description of the service: they are whole, and plan."""

from __future__ import annotations

import compileall
import importlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from assur.scenes.requests import shipped_scenarios


@pytest.fixture(scope="module")
def description(client: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("described") / "openapi.json"
    path.write_bytes(client.get("/openapi.json").content)
    return path


@pytest.fixture(scope="module")
def package(description: Path) -> Iterator[str]:
    """The name of a client that openapi-python-client makes, without a warning."""
    folder = description.parent
    options = folder / "options.yaml"
    options.write_text("post_hooks: []\n", encoding="utf-8")  # they only format
    command = [sys.executable, "-m", "openapi_python_client", "generate", "--path", str(description)]
    command += ["--meta", "none", "--output-path", str(folder / "scara_client"), "--config", str(options)]
    made = subprocess.run(command, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    assert "arning" not in made.stdout + made.stderr, made.stdout
    sys.path.insert(0, str(folder))
    yield "scara_client"
    sys.path.remove(str(folder))


def test_a_generated_client_has_every_operation_and_compiles(package: str, description: Path) -> None:
    folder = description.parent / package
    assert compileall.compile_dir(folder, quiet=1)
    described = json.loads(description.read_text(encoding="utf-8"))
    operations = {operation["operationId"] for item in described["paths"].values() for operation in item.values()}
    written = {path.stem for path in (folder / "api").rglob("*.py")} - {"__init__"}
    assert written == operations


def test_a_generated_client_plans_a_request_and_a_scenario_and_has_a_plan_checked(
    package: str, client: httpx.Client
) -> None:
    def part(name: str) -> Any:
        return importlib.import_module(f"{package}.{name}")

    with part("client").Client(base_url=str(client.base_url), timeout=120) as to:
        models = part("models")
        demo = client.get("/v1/scenes/demo").json()
        request = models.Request.from_dict(demo)
        assert request.to_dict() == demo
        answer = part("api.plans.plan").sync(client=to, body=request)
        assert isinstance(answer, models.PlannedAnswer)
        assert answer.status == "planned"
        both = models.CheckPlanBody.from_dict({"request": demo, "plan": answer.to_dict()})
        assert part("api.plans.check_plan").sync(client=to, body=both).ok is True
        named = part("api.plans.plan_scene").sync("demo", client=to)
        assert isinstance(named, models.PlannedAnswer)
        assert named.duration_s == answer.duration_s
        refused = part("api.plans.plan_scene").sync("nowhere", client=to)
        assert isinstance(refused, models.Problem)
        assert refused.status == 404


def test_models_can_be_generated_that_read_every_shipped_scenario(description: Path, client: httpx.Client) -> None:
    made = description.parent / "scara_models.py"
    command = [sys.executable, "-m", "datamodel_code_generator", "--input", str(description), "--output", str(made)]
    command += [
        "--input-file-type",
        "openapi",
        "--output-model-type",
        "pydantic_v2.BaseModel",
        "--formatters",
        "builtin",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    sys.path.insert(0, str(description.parent))
    try:
        models = importlib.import_module("scara_models")
    finally:
        sys.path.pop(0)
    for name in list(shipped_scenarios())[:10]:
        models.Request.model_validate(client.get(f"/v1/scenes/{name}").json())

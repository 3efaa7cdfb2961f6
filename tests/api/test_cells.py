"""Cells by digest over HTTP: kept once, planned with many tasks, refused where they are none."""

from __future__ import annotations

import asyncio
import copy
import hashlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

import assur
from assur.scenes.set_values import with_values
from tests.api.running import PATIENT, running
from tests.api.test_python_cell_files import FAULTS, FIRST, HOME, START, TASKS
from tests.scenes.meshes.solids import SOLIDS, binary_stl
from tests.scenes.tasks.test_joining import documents

Document = dict[str, Any]
TIMES = ("elapsed_s", "first_s")
CELL = documents()[0]
BODY = json.dumps(CELL).encode()
DIGEST = hashlib.sha256(BODY).hexdigest()
ADDRESS = f"v1/cells/{DIGEST}"
JSON = {"Content-Type": "application/json"}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[httpx.Client, Path]]:
    folder = tmp_path_factory.mktemp("meshes") / "kept"
    with running(replace(PATIENT, mesh_folder=str(folder), mesh_quota_mib=1)) as client:
        yield client, folder


def put(client: httpx.Client, cell: Document) -> tuple[httpx.Response, str]:
    body = json.dumps(cell).encode()
    digest = hashlib.sha256(body).hexdigest()
    return client.put(f"v1/cells/{digest}", content=body, headers=JSON), digest


def timeless(answer: Document) -> Document:
    return {key: value for key, value in answer.items() if key not in TIMES}


def test_a_cell_is_put_once_and_planned_with_tasks_as_their_requests_are(service: tuple[httpx.Client, Path]) -> None:
    client, folder = service
    for unknown in (client.get(ADDRESS), client.post(f"{ADDRESS}/plans", json={"start": START, "steps": HOME})):
        assert (unknown.status_code, unknown.json()["type"]) == (404, "urn:assur:problem:cell-unknown")
        assert f"PUT /v1/{ADDRESS[3:]}" in unknown.json()["detail"]
    assert client.head(ADDRESS).status_code == 404
    first, again = client.put(ADDRESS, content=BODY, headers=JSON), client.put(ADDRESS, content=BODY, headers=JSON)
    assert (first.status_code, again.status_code) == (201, 200)
    assert first.json()["sha256"] == client.get(ADDRESS).json()["sha256"] == DIGEST
    assert first.json()["bytes"] == len(BODY) == (folder / f"{DIGEST}.cell").stat().st_size
    assert client.head(ADDRESS).status_code == 200
    cell = assur.Cell(CELL)
    for name, task in TASKS.items():
        answer = client.post(f"{ADDRESS}/plans", json=task, params={"certificate": "digest"})
        assert answer.status_code == 200, (name, answer.text)
        request = client.post("v1/plans", json=cell.request(**task), params={"certificate": "digest"})
        assert timeless(answer.json()) == timeless(request.json()), name
        assert answer.json()["status"] == "planned", name


WHOLE_TASKS: list[tuple[Document, str, str]] = [
    ({"schema": "assur-task/2", "start": START, "steps": HOME}, "schema", "assur-task/1"),
    ({"cell": {"file": "cell.yaml"}, "start": START, "steps": HOME}, "cell", "no cell"),
    ({"start": START, "steps": HOME, "robot": {}}, "robot", "one of "),
    ({"start": START, "steps": HOME, "options": {"budget_s": 1e6}}, "options.budget_s", "at most"),
    ({"start": START, "steps": HOME, "set": {"options.budget_s": 1e6}}, "options.budget_s", "at most"),
    (
        {"start": START, "steps": HOME, "set": {"positions.home.frame": "bolt"}},
        "set.positions.home.frame",
        "one of belt",
    ),
    ({}, "steps", "must be given"),
    ({"steps": HOME}, "start", "must be given"),
]
OF_CELL = [fault for fault in FAULTS if "task" not in fault[0] and "nan" not in str(fault[0])]


@pytest.mark.parametrize(
    ("task", "field", "allowed"),
    [*WHOLE_TASKS, *[({"start": START, "steps": HOME, "options": FIRST, **change}, f, a) for change, f, a in OF_CELL]],
)
def test_a_fault_of_a_task_names_its_field(
    service: tuple[httpx.Client, Path], task: Document, field: str, allowed: str
) -> None:
    client, _ = service
    client.put(ADDRESS, content=BODY, headers=JSON)
    refused = client.post(f"{ADDRESS}/plans", json={key: value for key, value in task.items() if value is not None})
    assert refused.status_code == 422, refused.text
    errors = {error["field"]: error["allowed"] for error in refused.json()["errors"]}
    assert allowed in errors[field], errors


def test_what_is_no_cell_is_refused_and_not_kept(service: tuple[httpx.Client, Path]) -> None:
    client, folder = service
    before = sorted(path.name for path in folder.glob("*.cell"))
    frames = {"belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": "fast"}}}
    for change, field in (
        ({"schema": "assur/1"}, "schema"),
        ({"robot": {"model": "rh-6", "tool": {"tcp_mm": [0, 0, 0]}}}, "robot.model"),
        ({"colour": "red"}, "colour"),
        ({"frames": frames}, "frames.belt.conveyor.speed_mm_s"),
        ({"bodies": [*CELL["bodies"], *CELL["bodies"]]}, "bodies[1].name"),
        ({"positions": {"home": {"frame": "bolt", "at_mm": [0, 0, 0]}}}, "positions.home.frame"),
        ({"slots": {"box": {**CELL["slots"]["box"], "body": "tabel"}}}, "slots.box.body"),
        ({"kinds": {"k": {"shape": {"mesh": {"asset": "none", "unit": "mm"}}}}}, "kinds.k.shape.mesh.asset"),
        ({"options": {"seed": -1}}, "options.seed"),
    ):
        refused, _ = put(client, {**copy.deepcopy(CELL), **change})
        assert refused.status_code == 422, (change, refused.text)
        assert refused.json()["errors"][0]["field"] == field, refused.text
    for body, status in ((b"[1]", 422), (b"{", 400), (b"", 400)):
        digest = hashlib.sha256(body).hexdigest()
        assert client.put(f"v1/cells/{digest}", content=body, headers=JSON).status_code == status
    assert client.put(f"v1/cells/{'0' * 64}", content=BODY, headers=JSON).json()["errors"][0]["field"] == "body"
    assert client.put("v1/cells/abc", content=BODY, headers=JSON).json()["errors"][0]["field"] == "sha256"
    assert client.put(ADDRESS, content=BODY).status_code == 415
    assert sorted(path.name for path in folder.glob("*.cell")) == before


def test_an_answer_is_as_small_as_it_is_wanted(service: tuple[httpx.Client, Path]) -> None:
    client, _ = service
    client.put(ADDRESS, content=BODY, headers=JSON)

    def asked(**parameters: str) -> httpx.Response:
        return client.post(f"{ADDRESS}/plans", json=TASKS["a part"], params={"certificate": "digest", **parameters})

    whole = asked().json()
    part = asked(fields="duration_s,trajectory.time_s,trajectory.position,sentence").json()
    assert part == {
        "status": "planned",
        "duration_s": whole["duration_s"],
        "trajectory": {key: whole["trajectory"][key] for key in ("time_s", "position")},
    }
    rounded = asked(fields="trajectory.position", digits="4").json()["trajectory"]["position"]
    for row, exact in zip(rounded, whole["trajectory"]["position"], strict=True):
        assert row == [float(f"{value:.4g}") for value in exact]
    assert timeless(asked(digits="17").json()) == timeless(whole)
    for wrong, field in (
        ({"fields": "sttus"}, "fields"),
        ({"fields": "duration_s.x"}, "fields"),
        ({"fields": "trajectory.tim_s"}, "fields"),
        ({"fields": ""}, "fields"),
        ({"fields": ",".join(["status"] * 65)}, "fields"),
        ({"digits": "2"}, "digits"),
        ({"digits": "1.5"}, "digits"),
        ({"digits": "18"}, "digits"),
        ({"digits": "99999"}, "digits"),
        ({"form": "csv"}, "form"),
        ({"certificate": "none"}, "certificate"),
    ):
        refused = asked(**wrong)
        assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, field), wrong
    assert "did you mean status?" in asked(fields="sttus").json()["detail"]
    assert "allowed: legs, which is a list and given whole" in asked(fields="legs.kind").json()["detail"]
    assert (
        "allowed: margins.binds, which is a value and given whole" in asked(fields="margins.binds.x").json()["detail"]
    )


def test_a_cell_is_used_with_the_meshes_that_it_names(service: tuple[httpx.Client, Path]) -> None:
    client, folder = service
    content = binary_stl(SOLIDS["tray"])
    mesh = hashlib.sha256(content).hexdigest()
    cell = copy.deepcopy(CELL)
    tray = {"mesh": {"sha256": mesh, "format": "stl", "unit": "mm"}}
    cell["bodies"].append({"name": "tray", "shape": tray, "pose": {"at_mm": [-300, -300, 0]}})
    refused, digest = put(client, cell)
    assert refused.json()["errors"][0]["field"] == "bodies[1].shape.mesh.sha256"
    client.put(f"v1/meshes/{mesh}", content=content, headers={"Content-Type": "model/stl"})
    assert put(client, cell)[0].status_code == 201
    answer = client.post(f"v1/cells/{digest}/plans", json=TASKS["a part"])
    assert answer.json()["status"] == "planned", answer.text
    assert (folder / f"{mesh}.mesh").exists()
    (folder / f"{digest}.cell").unlink()
    gone = client.post(f"v1/cells/{digest}/plans", json=TASKS["a part"])
    assert gone.json()["type"] == "urn:assur:problem:cell-unknown"


def test_the_file_of_a_plan_comes_in_one_call(service: tuple[httpx.Client, Path]) -> None:
    client, _ = service
    client.put(ADDRESS, content=BODY, headers=JSON)
    task = TASKS["a part"]
    request = assur.Cell(CELL).request(**task)
    for how in ({"format": "csv", "tick_ms": "8", "jerk": "report"}, {"format": "ros2"}):
        file = client.post(f"{ADDRESS}/plans", json=task, params=how)
        beside = client.post("v1/plans", json=request, params=how)
        assert file.status_code == 200, file.text
        assert file.headers["Assur-Verdict"] == "right"
        assert file.content == beside.content
        for name in ("Content-Type", "Assur-Request-Digest", "Assur-Certificate-Digest"):
            assert file.headers[name] == beside.headers[name]
    for wrong, field in (({"format": "pdf"}, "format"), ({"format": "csv", "fields": "status"}, "fields")):
        refused = client.post(f"{ADDRESS}/plans", json=task, params=wrong)
        assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, field)


def test_a_client_sends_a_cell_and_plans_tasks_in_it(service: tuple[httpx.Client, Path]) -> None:
    with assur.Client(str(service[0].base_url)) as client:
        digest, cell = client.put_cell(CELL), assur.Cell(CELL)
        task = TASKS["a part in a slot"]
        there, here = client.plan_task(digest, **task), cell.plan(**task)
        assert timeless(dict(there)) == timeless(dict(here))
        assert there.request == here.request
        assert there.next_task(HOME)["start"]["at_s"] == there["trajectory"]["time_s"][-1]
        assert client.check(there.request or {}, there)["ok"]
        again = client.plan_task(digest, **there.next_task(HOME))
        assert again["trajectory"]["position"][0] == there["trajectory"]["position"][-1]
        small = client.plan_task(digest, **task, fields=["duration_s", "trajectory.position"], digits=5)
        assert small.document == {
            "status": "planned",
            "duration_s": float(f"{here.duration_s:.5g}"),
            "trajectory": {"position": [[float(f"{q:.5g}") for q in row] for row in here["trajectory"]["position"]]},
        }
        for wrong in ("status", [], [3]):
            with pytest.raises(assur.InputError, match=r"fields: .*a list of names"):
                client.plan_task(digest, **task, fields=wrong)  # type: ignore[arg-type]
        with pytest.raises(assur.InputError, match=r"digits: .*from 3 to 17"):
            client.plan_task(digest, **task, digits=2)
        with pytest.raises(assur.InputError, match=r"parts\[0\]\.kind: .*one of the kinds: bracket"):
            client.plan_task(digest, start=START, steps=HOME, parts=[{"name": "a", "kind": "x"}])
        with pytest.raises(assur.ServiceError, match="PUT /v1/cells/"):
            client.plan_task("0" * 64, start=START, steps=HOME)
    with assur.Client(str(service[0].base_url)) as other:
        assert other.plan_task(digest, **task).request is None
        assert other.plan_task(digest, **task, cell=CELL).request == here.request
        assert other.plan_task(digest, **task, cell=assur.Cell(CELL)).request == here.request
        # another text of the same cell, as another program may have sent it, makes the same request
        same = dict(reversed(CELL.items()))
        assert other.plan_task(digest, **task, cell=same).request == here.request
        assert other.plan_task(digest, **task, cell=same, fields=["status", "request_digest"]).request == here.request
        with pytest.raises(assur.InputError, match=r"^fields: .*request_digest among them"):
            other.plan_task(digest, **task, cell=same, fields=["status"])
        for path, value in (("options.clearance_mm.near", 0.9), ("kinds", {}), ("bodies", [])):
            with pytest.raises(assur.InputError, match=rf"^cell: .*with the digest {digest}"):
                other.plan_task(digest, **task, cell=with_values(CELL, {path: value}))


def test_an_awaited_client_refuses_another_cell_than_that_of_the_task(service: tuple[httpx.Client, Path]) -> None:
    async def planned() -> None:
        async with assur.AsyncClient(str(service[0].base_url)) as client:
            digest = await client.put_cell(CELL)
            moved = with_values(CELL, {"bodies.table.pose.at_mm.0": 351})
            with pytest.raises(assur.InputError, match=rf"^cell: .*with the digest {digest}"):
                await client.plan_task(digest, **TASKS["a part in a slot"], cell=moved)

    asyncio.run(planned())


def test_an_unknown_parameter_is_refused_with_all_that_there_are(service: tuple[httpx.Client, Path]) -> None:
    client, _ = service
    client.put(ADDRESS, content=BODY, headers=JSON)
    known = "format, tick_s, tick_ms, jerk"
    for address, allowed in (
        (f"{ADDRESS}/plans", f"certificate, fields, digits, {known}"),
        ("v1/plans", f"certificate, {known}"),
    ):
        refused = client.post(address, json=TASKS["a part"], params={"colour": "red"})
        assert refused.json()["errors"] == [
            {"field": "colour", "value": "red", "allowed": f"a known parameter: {allowed}"}
        ]


def test_a_key_gives_the_answer_again_and_is_for_one_task(service: tuple[httpx.Client, Path]) -> None:
    client, _ = service
    client.put(ADDRESS, content=BODY, headers=JSON)
    key = {"Idempotency-Key": "a-task"}
    first = client.post(f"{ADDRESS}/plans", json=TASKS["a part"], headers=key)
    assert client.post(f"{ADDRESS}/plans", json=TASKS["a part"], headers=key).content == first.content
    other = client.post(f"{ADDRESS}/plans", json=TASKS["no parts"], headers=key)
    assert other.json()["type"] == "urn:assur:problem:key-reused"


def test_a_service_without_a_folder_keeps_no_cells() -> None:
    with running(PATIENT) as client:
        for response in (client.put(ADDRESS, content=BODY, headers=JSON), client.post(f"{ADDRESS}/plans", json={})):
            assert response.json()["type"] == "urn:assur:problem:no-mesh-folder"


def test_the_description_has_the_fields_of_cells_and_of_tasks_without_their_cell(
    service: tuple[httpx.Client, Path],
) -> None:
    described = service[0].get("openapi.json").json()
    found, address = described["components"]["schemas"], described["paths"]["/v1/cells/{sha256}/plans"]["post"]
    body = address["requestBody"]["content"]["application/json"]["schema"]
    assert body == {"$ref": "#/components/schemas/Task"}
    assert found["Task"]["properties"]["steps"]["items"] == {"$ref": "#/components/schemas/StepInTask"}
    assert found["StepInTask"]["properties"].keys() == {*found["StepDocument"]["properties"], "transfer"}
    assert "cell" not in found["Task"]["properties"]
    assert found["Cell"]["properties"]["kinds"]["additionalProperties"] == {"$ref": "#/components/schemas/KindDocument"}

"""Meshes by digest over HTTP: kept once, named by requests, refused where they are not what they are said to be."""

from __future__ import annotations

import asyncio
import base64
import copy
import hashlib
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

from assur.api.python.client import Client
from assur.api.web.app import create_app
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner.errors import InputError
from assur.scenes.meshes.folder import LEAST_BYTES, LOCK
from tests.api.running import PATIENT, running
from tests.scenes.meshes.solids import SOLIDS, binary_stl, torus

TRAY = binary_stl(SOLIDS["tray"])
DIGEST = hashlib.sha256(TRAY).hexdigest()


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[httpx.Client, Path]]:
    folder = tmp_path_factory.mktemp("meshes") / "kept"
    with running(replace(PATIENT, mesh_folder=str(folder), mesh_quota_mib=1)) as client:
        yield client, folder


def naming(digest: str, unit: str = "mm") -> dict[str, Any]:
    request = copy.deepcopy(FIRST_PLAN)
    request["bodies"][1]["shape"] = {"mesh": {"sha256": digest, "format": "stl", "unit": unit}}
    return request


def test_a_mesh_is_put_once_named_by_its_digest_and_planned_around(service: tuple[httpx.Client, Path]) -> None:
    client, folder = service
    address = f"v1/meshes/{DIGEST}"
    assert client.get(address).json()["type"] == "urn:assur:problem:mesh-unknown"
    assert client.head(address).status_code == 404
    refused = client.post("v1/plans", json=naming(DIGEST))
    assert refused.status_code == 422
    (error,) = refused.json()["errors"]
    assert error["field"] == "bodies[1].shape.mesh.sha256"
    assert error["value"] == DIGEST
    assert f"PUT /v1/meshes/{DIGEST}" in error["allowed"]
    first = client.put(address, content=TRAY, headers={"Content-Type": "model/stl"})
    assert (first.status_code, first.json()["bytes"], first.json()["cover"]) == (201, len(TRAY), None)
    again = client.put(address, content=TRAY, params={"format": "stl", "unit": "mm"})
    assert again.status_code == 200
    assert again.json()["cover"]["pieces"] == 5
    assert sorted(path.suffix for path in folder.glob(f"{DIGEST}*")) == [".cover", ".mesh"]
    assert client.get(address).json()["sha256"] == DIGEST
    assert client.head(address).status_code == 200
    answer = client.post("v1/plans", json=naming(DIGEST)).json()
    inline = naming(DIGEST)
    inline["bodies"][1]["shape"] = {"mesh": {"data": base64.b64encode(TRAY).decode(), "format": "stl", "unit": "mm"}}
    beside = client.post("v1/plans", json=inline).json()
    assert answer["status"] == beside["status"] == "planned"
    assert answer["trajectory"] == beside["trajectory"]
    assert answer["certificate"]["normal"] == beside["certificate"]["normal"]
    assert client.post("v1/plans/check", json={"request": naming(DIGEST), "plan": answer}).json()["ok"]


def told(client: httpx.Client) -> str:
    """The metrics, numbers without an exponent."""
    return re.sub(r"\d\.\d+e\+\d+", lambda found: str(float(found[0])), client.get("metrics").text)


def test_what_is_not_the_mesh_is_refused(service: tuple[httpx.Client, Path]) -> None:
    client, folder = service
    before = sorted(folder.iterdir())
    other = hashlib.sha256(b"other").hexdigest()
    wrong = client.put(f"v1/meshes/{other}", content=TRAY)
    assert wrong.status_code == 422
    assert DIGEST in wrong.json()["detail"]
    for name in ("abc", DIGEST.upper(), "..%2f..%2fetc%2fpasswd"):
        assert client.put(f"v1/meshes/{name}", content=TRAY).status_code in (404, 422)
    assert client.put(f"v1/meshes/{DIGEST}", content=TRAY, params={"format": "stl"}).status_code == 422
    assert client.put(f"v1/meshes/{DIGEST}", content=TRAY, params={"form": "stl"}).status_code == 422
    assert client.put(f"v1/meshes/{DIGEST}", content=TRAY, headers={"Content-Encoding": "gzip"}).status_code == 415
    assert sorted(folder.iterdir()) == before
    empty = client.put(f"v1/meshes/{hashlib.sha256(b'').hexdigest()}", content=b"")
    assert (empty.status_code, empty.json()["errors"][0]["field"]) == (422, "body")
    assert f"assur_mesh_folder_bytes {float(LEAST_BYTES * sum(file.name != LOCK for file in before))}" in told(client)
    nonsense = b"solid nonsense"
    digest = hashlib.sha256(nonsense).hexdigest()
    unread = client.put(f"v1/meshes/{digest}", content=nonsense, params={"format": "stl", "unit": "mm"})
    assert unread.status_code == 422
    large = b"x" * (1 << 20)
    full = client.put(f"v1/meshes/{hashlib.sha256(large).hexdigest()}", content=large)
    assert (full.status_code, full.json()["type"]) == (507, "urn:assur:problem:mesh-folder-full")


def test_the_client_uploads_a_mesh_and_gets_what_requests_say(service: tuple[httpx.Client, Path]) -> None:
    content = binary_stl(SOLIDS["bracket"])
    with Client(str(service[0].base_url)) as client:
        mesh = client.upload_mesh(content, "stl", "mm")
        request = copy.deepcopy(FIRST_PLAN)
        request["bodies"][1]["shape"] = {"mesh": mesh}
        assert client.plan(request)["status"] == "planned"


def test_a_budget_that_ends_while_a_mesh_is_covered_is_an_answer_until_it_is_covered(
    service: tuple[httpx.Client, Path],
) -> None:
    client, _ = service
    request = copy.deepcopy(FIRST_PLAN)
    data = base64.b64encode(binary_stl(torus(20, 10))).decode()
    request["bodies"][1]["shape"] = {"mesh": {"data": data, "format": "stl", "unit": "mm"}}
    request["options"] |= {"budget_s": 0.01, "explain_budget_s": 0.0}
    said = []
    for _ in range(300):
        answer = client.post("v1/plans", json=request).json()
        assert answer["status"] in ("planned", "not_planned")
        if "before the cell was built" not in answer.get("sentence", ""):
            break
        assert answer["reason"] == "TIMED_OUT"
        assert answer["cut_by_clock"]
        said.append(answer["sentence"])
    else:
        pytest.fail("the cover was never finished")
    assert any('the mesh of "part" was being covered by convex pieces' in text for text in said)


def test_a_service_without_a_folder_says_so() -> None:
    async def asked() -> list[httpx.Response]:
        door = httpx.ASGITransport(create_app(PATIENT))
        async with httpx.AsyncClient(transport=door, base_url="http://127.0.0.1") as client:
            return [await client.put(f"/v1/meshes/{DIGEST}", content=TRAY), await client.get(f"/v1/meshes/{DIGEST}")]

    for response in asyncio.run(asked()):
        assert response.status_code == 404
        assert response.json()["type"] == "urn:assur:problem:no-mesh-folder"
        assert "ASSUR_MESH_FOLDER" in response.json()["detail"]


def test_a_folder_that_cannot_be_written_ends_the_start(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(InputError, match="ASSUR_MESH_FOLDER"):
        create_app(replace(PATIENT, mesh_folder=str(tmp_path / "file")))

"""Answers leave compressed for those who can read that, and constant ones with a mark."""

from __future__ import annotations

import gzip
import json
from typing import Any

import httpx
import pytest

from assur.api.web.representation import AT_ONCE, CONSTANT, takes_gzip

TIMES = ("elapsed_s", "first_s")
CONSTANTS = (
    "/v1/schema", "/v1/robots", "/v1/scenes", "/v1/scenes/demo", "/v1/scenes/demo/text", "/v1/version",
    "/openapi.json", "/docs", "/studio", "/studio/studio.js", "/static-offline-docs/swagger-ui-bundle.js",
)  # fmt: skip


def raw(client: httpx.Client, method: str, path: str, **headers: str) -> tuple[httpx.Response, bytes]:
    """An answer, and its body as it came."""
    request = client.build_request(method, path, headers={"Accept-Encoding": "identity", **headers})
    answer = client.send(request, stream=True)
    try:
        return answer, b"".join(answer.iter_raw())
    finally:
        answer.close()


@pytest.mark.parametrize("path", CONSTANTS)
def test_a_constant_document_is_sent_once_to_whoever_keeps_it(client: httpx.Client, path: str) -> None:
    first, body = raw(client, "GET", path)
    assert first.status_code == 200
    assert first.headers["cache-control"] == "no-cache"
    again, nothing = raw(client, "GET", path, **{"If-None-Match": first.headers["etag"]})
    assert (again.status_code, nothing) == (304, b"")
    assert again.headers["etag"] == first.headers["etag"]
    other, whole = raw(client, "GET", path, **{"If-None-Match": '"another"'})
    assert (other.status_code, whole) == (200, body)


@pytest.mark.parametrize("path", ["/livez", "/readyz", "/v1/jobs/x", "/v1/scenes/no-such-scene", "/metrics"])
def test_what_changes_is_not_kept(client: httpx.Client, path: str) -> None:
    answer, _ = raw(client, "GET", path)
    assert "etag" not in answer.headers
    assert answer.headers["cache-control"] == "no-store"


def test_the_body_is_the_same_compressed_or_not(client: httpx.Client) -> None:
    plain, body = raw(client, "GET", "/v1/schema")
    packed, data = raw(client, "GET", "/v1/schema", **{"Accept-Encoding": "br, gzip;q=0.5"})
    assert "content-encoding" not in plain.headers
    assert packed.headers["content-encoding"] == "gzip"
    assert int(packed.headers["content-length"]) == len(data) < len(body) / 2
    assert gzip.decompress(data) == body
    assert "Accept-Encoding" in plain.headers["vary"]
    assert "Accept-Encoding" in packed.headers["vary"]


def test_large_bodies_are_compressed_too_and_small_ones_are_not(client: httpx.Client) -> None:
    _, body = raw(client, "GET", "/static-offline-docs/swagger-ui-bundle.js")
    packed, data = raw(client, "GET", "/static-offline-docs/swagger-ui-bundle.js", **{"Accept-Encoding": "gzip"})
    assert len(body) > AT_ONCE
    assert packed.headers["content-encoding"] == "gzip"
    assert gzip.decompress(data) == body
    small, _ = raw(client, "GET", "/livez", **{"Accept-Encoding": "gzip"})
    assert "content-encoding" not in small.headers


def test_events_are_not_held_back(client: httpx.Client, small: dict[str, Any]) -> None:
    job = client.post("/v1/jobs", json=small).json()["id"]
    events, data = raw(client, "GET", f"/v1/jobs/{job}/events", **{"Accept-Encoding": "gzip"})
    assert "content-encoding" not in events.headers
    assert b"event: done" in data
    answer, packed = raw(client, "GET", f"/v1/jobs/{job}/answer", **{"Accept-Encoding": "gzip"})
    assert answer.headers["content-encoding"] == "gzip"
    there = json.loads(gzip.decompress(packed))
    again = client.post("/v1/plans", json=small).json()
    assert {**there, **dict.fromkeys(TIMES)} == {**again, **dict.fromkeys(TIMES)}


@pytest.mark.parametrize(
    ("asked", "taken"),
    [
        (["gzip"], True), (["deflate", "GZIP;q=0.2"], True), (["*"], True), (["*;q=0"], False), (["br"], False),
        (["gzip;q=0"], False), (["gzip;q=0.000, *"], False), ([], False), (["gzip;level=9"], False),
    ],
)  # fmt: skip
def test_gzip_is_sent_only_to_those_who_take_it(asked: list[str], taken: bool) -> None:
    assert takes_gzip(asked) is taken


def test_no_address_that_plans_counts_as_constant() -> None:
    for path in ("/v1/plans", "/v1/jobs/v1/scenes", "/livez", "/metrics", "/v1/schema/x"):
        assert CONSTANT.fullmatch(path) is None

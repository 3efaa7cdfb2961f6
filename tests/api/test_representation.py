"""Answers leave compressed for those who can read that, and constant ones with a mark."""

from __future__ import annotations

import asyncio
import gzip
import json
from typing import Any

import httpx
import pytest
from starlette.responses import Response
from starlette.types import ASGIApp, Message

from assur.api.web import representation
from assur.api.web.representation import AT_ONCE, CONSTANT, PIECE, Representation, takes_gzip

pytestmark = pytest.mark.anyio

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
        (["gzip"], True), (["deflate", "GZIP;Q=0.2"], True), (["*"], True), (["*;q=0"], False), (["br"], False),
        (["gzip;q=0"], False), (["gzip;q=0.000, *"], False), ([], False), (["gzip;level=9"], False),
    ],
)  # fmt: skip
def test_gzip_is_sent_only_to_those_who_take_it(asked: list[str], taken: bool) -> None:
    assert takes_gzip(asked) is taken


def test_no_address_that_plans_counts_as_constant() -> None:
    for path in ("/v1/plans", "/v1/jobs/v1/scenes", "/livez", "/metrics", "/v1/schema/x"):
        assert CONSTANT.fullmatch(path) is None


async def test_a_large_answer_that_is_kept_is_compressed_once_for_all_who_ask(monkeypatch: pytest.MonkeyPatch) -> None:
    body, packed = b"plan " * AT_ONCE, list[bytes]()
    pack = representation._compress

    def counted(data: bytes) -> bytes:
        packed.append(data)
        return pack(data)

    monkeypatch.setattr(representation, "_compress", counted)

    app = Representation(Response(body, media_type="text/plain"))
    answers = await asyncio.gather(*(sent(app) for _ in range(5)), sent(app))
    assert {gzip.decompress(b"".join(pieces)) for pieces in answers} == {body}
    assert len(packed) == 1
    other = Representation(Response(body[1:], media_type="text/plain"))
    assert gzip.decompress(b"".join(await sent(other))) == body[1:]
    assert len(packed) == 2


async def test_of_large_answers_only_so_much_is_kept_compressed(monkeypatch: pytest.MonkeyPatch) -> None:
    bodies = [bytes([65 + number]) * (AT_ONCE + 1) for number in range(4)]
    monkeypatch.setattr(representation, "PACKED_BYTES", 2 * len(bodies[0]))

    app = Representation(Response(b""))
    for each in bodies:
        assert gzip.decompress(await app._gzip("", each)) == each
    assert [each for each, _ in app._packed.values()] == bodies[2:]


async def test_a_large_body_leaves_in_pieces_and_others_have_their_turn_between() -> None:
    body = bytes(range(256)) * 4 * (PIECE // 256) + b"the end"

    turns = 0

    async def others() -> None:
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    beside = asyncio.ensure_future(others())
    pieces = await sent(Representation(Response(body)))
    beside.cancel()
    assert b"".join(pieces) == body
    assert [len(each) for each in pieces] == [PIECE] * 4 + [7]
    assert turns >= 4
    assert await sent(Representation(Response(b""))) == [b""]


async def sent(app: ASGIApp) -> list[bytes]:
    """The pieces of the body that `app` sends to a caller that reads gzip."""
    pieces: list[bytes] = []

    async def receive() -> Message:
        return {"type": "http.disconnect"}

    async def send(message: Message) -> None:
        if message["type"] == "http.response.body":
            pieces.append(message["body"])

    headers = [(b"accept-encoding", b"gzip")]
    await app({"type": "http", "method": "GET", "path": "/kept", "headers": headers}, receive, send)
    return pieces

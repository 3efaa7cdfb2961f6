"""How an answer that is whole leaves: compressed, if its caller can read that; and one that is always the same with a
mark, so that it is not sent again to a caller who has it.

What is sent as it comes, server-sent events, passes untouched.
"""

from __future__ import annotations

import asyncio
import gzip
import hashlib
import re
from collections import OrderedDict

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from assur.api.web.header_values import values_of

LEVEL = 1
"""Of gzip. On answers of 50 to 120 kB: 18 to 33 % of the size in 0.4 to 0.8 ms; level 6, 16 to 30 % in three times that
(docs/decisions/0031-operations.md)."""
SMALLEST = 1024
"""Bodies below this are not compressed: they fit into a packet or two as they are."""
AT_ONCE = 65536
"""Bodies up to this are compressed on the event loop, in less than 1 ms; larger ones in a thread."""
COMPRESSIBLE = re.compile(r"(?:text/(?!event-stream)|application/(?:[\w.+-]*\+)?(?:json|yaml|javascript)|image/svg)")
WEIGHT = re.compile(r"\s*q\s*=\s*([01](?:\.[0-9]{0,3})?)\s*", re.IGNORECASE)
"""Weight of a coding in `Accept-Encoding`."""
STREAM = "text/event-stream"
PIECE = 65536
"""A body is written in pieces of this size, each when the client has taken enough of those before, and others have
their turn between: to copy a large one takes long, and as much memory for each client that does not read it."""
CONSTANT = re.compile(
    r"/(?:docs|redoc|openapi\.json|studio(?:/[^/]+)?|static-offline-docs/.+|v1/(?:schema|robots|version|scenes(?:/.+)?))"
)
"""Addresses whose answer changes with the build only."""
REVALIDATED = "no-cache"
"""May be kept, and is requested again each time, which costs a 304."""
PACKED_BYTES = 16 << 20
"""So much of the latest bodies is kept with what they are compressed: constant ones, and large ones, which may be
requested many times."""


class Representation:
    """ASGI middleware: `ETag`, `Cache-Control` and 304 of constant documents, and gzip of whole bodies."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._packed: OrderedDict[str | int, tuple[bytes, asyncio.Future[bytes]]] = OrderedDict()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["method"] == "HEAD":
            await self._app(scope, receive, send)
            return
        held: Message | None = None
        parts: list[bytes] = []

        async def sending(message: Message) -> None:
            nonlocal held
            if message["type"] == "http.response.start" and _whole(message):
                held = message
                return
            if held is None:
                await send(message)
                return
            if message.get("body"):
                parts.append(message["body"])
            if not message.get("more_body", False):
                start, held = held, None
                body = await self._represented(scope, start, parts[0] if len(parts) == 1 else b"".join(parts))
                await send(start)
                for at in range(0, max(len(body), 1), PIECE):
                    piece, more = body[at : at + PIECE], at + PIECE < len(body)
                    await send({"type": "http.response.body", "body": piece, "more_body": more})
                    if more:
                        await asyncio.sleep(0)  # the turn of others, also where the system takes all at once

        await self._app(scope, receive, sending)

    async def _represented(self, scope: Scope, start: Message, body: bytes) -> bytes:
        """The body to be sent; changes the head `start` accordingly. What may be kept says that it varies."""
        mark, wanted = "", scope["headers"]
        if start["status"] == 200 and scope["method"] == "GET" and CONSTANT.fullmatch(scope["path"]):
            headers = MutableHeaders(raw=list(start["headers"]))
            start["headers"] = headers.raw
            mark = headers.setdefault("ETag", f'W/"{hashlib.sha256(body).hexdigest()[:32]}"')
            headers.setdefault("Cache-Control", REVALIDATED)
            headers.add_vary_header("Accept-Encoding")
            if _known(mark, values_of(wanted, b"if-none-match")):
                start["status"] = 304
                for name in ("Content-Length", "Content-Type"):
                    if name in headers:
                        del headers[name]
                return b""
        if len(body) < SMALLEST or not takes_gzip(values_of(wanted, b"accept-encoding")):
            return body
        headers = MutableHeaders(raw=list(start["headers"]))
        if not COMPRESSIBLE.match(headers.get("content-type", "")) or "content-encoding" in headers:
            return body
        body = await self._gzip(mark, body)
        headers["Content-Encoding"] = "gzip"
        headers["Content-Length"] = str(len(body))
        start["headers"] = headers.raw
        return body

    async def _gzip(self, mark: str, body: bytes) -> bytes:
        """The body compressed. Large bodies and constant ones, which have a `mark`, are compressed in a thread, once
        for all requests of about the same time. A body without a mark is known by being the same object: an answer that
        is kept is."""
        if not mark and len(body) <= AT_ONCE:
            return _compress(body)
        key = mark or id(body)
        _, packing = self._packed.get(key, (body, None))
        if packing is None:
            packing = asyncio.ensure_future(asyncio.to_thread(_compress, body))
            self._packed[key] = body, packing
            while len(self._packed) > 1 and sum(len(each) for each, _ in self._packed.values()) > PACKED_BYTES:
                self._packed.popitem(last=False)
        self._packed.move_to_end(key)
        return await asyncio.shield(packing)


def _compress(body: bytes) -> bytes:
    return gzip.compress(body, LEVEL, mtime=0)


def _whole(start: Message) -> bool:
    """Whether the body behind a head is collected before it is sent."""
    return not any(kind.startswith(STREAM) for kind in values_of(start["headers"], b"content-type"))


def _known(mark: str, known: list[str]) -> bool:
    """Whether the caller has a document with this mark (RFC 9110, 13.1.2: compared weakly)."""
    marks = {each.strip().removeprefix("W/") for line in known for each in line.split(",")}
    return bool(known) and ("*" in marks or mark.removeprefix("W/") in marks)


def takes_gzip(accepted: list[str]) -> bool:
    """Whether a caller that sent these `Accept-Encoding` reads gzip (RFC 9110, 12.5.3)."""
    weights: dict[str, float] = {}
    for each in ",".join(accepted).split(","):
        name, _, rest = each.partition(";")
        found = WEIGHT.fullmatch(rest)
        weights[name.strip().lower()] = float(found[1]) if found else (0.0 if rest.strip() else 1.0)
    return weights.get("gzip", weights.get("x-gzip", weights.get("*", 0.0))) > 0

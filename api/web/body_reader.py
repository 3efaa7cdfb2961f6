"""Reading a body: declared as JSON, no larger than its cap however it is sent, and in time."""

from __future__ import annotations

import asyncio
import re

from starlette.requests import ClientDisconnect, Request

from assur.api.problems import FieldError, Problem, shown
from assur.api.web.addresses import network
from assur.api.workers.admission import busy
from assur.scenes.faults import NOTHING

IN_ALL_BYTES = 128 << 20
"""So much of bodies that are not complete is held at a time: what has come, not what was announced."""
OF_ONE_BYTES = IN_ALL_BYTES // 2
"""The same for one client address, of IPv6 its network: the others always have as much."""
FIRST_S = 3.0
"""A body may take so long before its rate counts, s."""
LEAST_BYTES_S = 1024
"""Least rate of a body from then on, bytes/s since its begin."""

_JSON = re.compile(r"application/(?:[a-z0-9.+-]+\+)?json(?:\s*;\s*charset=\"?utf-8\"?)?\s*", re.IGNORECASE)


def _require_json(request: Request) -> None:
    """Raises the problem of a body that is not declared to be plain JSON in UTF-8."""
    declared = request.headers.getlist("content-type")
    if len(declared) != 1 or not _JSON.fullmatch(declared[0]):
        value = shown(", ".join(declared)) if declared else NOTHING
        error = FieldError("Content-Type", value, "application/json, once, without a charset or with charset=utf-8")
        raise Problem("wrong-media-type", "Send Content-Type: application/json, in UTF-8.", (error,))


def _require_plain(request: Request) -> None:
    """Raises the problem of a body that is compressed."""
    if request.headers.get("content-encoding", "identity").lower() != "identity":
        error = FieldError("Content-Encoding", shown(request.headers["content-encoding"]), "none")
        raise Problem("wrong-media-type", "Send the body as it is, not compressed.", (error,))


def _too_large(limit: int) -> Problem:
    error = FieldError("body", f"more than {limit} bytes", f"at most {limit} bytes")
    return Problem("too-large", f"A body here has at most {limit} bytes.", (error,))


class Reading:
    """The bytes of incomplete bodies that are held. Slow bodies hold little, so they hinder no other client."""

    def __init__(self, in_all: int = IN_ALL_BYTES, of_one: int = OF_ONE_BYTES) -> None:
        self._in_all, self._of_one = in_all, of_one
        self._held: dict[str, int] = {}
        self._held_in_all = 0
        self.bodies = 0
        """Bodies that arrive."""

    def take(self, address: str, size: int) -> None:
        """Counts `size` more bytes of a client. Raises `Problem`: busy, where there is no room for them."""
        held = self._held.get(address, 0) + size
        if self._held_in_all + size > self._in_all or held > self._of_one:
            raise busy(1.0, "Too many bodies arrive at a time.")
        self._held[address] = held
        self._held_in_all += size

    def give_back(self, address: str, size: int) -> None:
        """Counts `size` bytes no longer."""
        self._held_in_all -= size
        left = self._held.pop(address, 0) - size
        if left:
            self._held[address] = left


async def read_body(request: Request, limit: int, within_s: float, reading: Reading, *, json: bool = True) -> bytes:
    """The body of `request`. `json`: it must be declared to be that; else it may be of any type.

    Raises `Problem`: wrong-media-type; too-large, before reading where the length is declared; too-slow; busy where
    `reading` has no room.
    """
    if json:
        _require_json(request)
    _require_plain(request)
    length = request.headers.get("content-length", "0")
    if not (length.isascii() and length.isdigit() and len(length) <= 15 and int(length) <= limit):
        raise _too_large(limit)
    peer = request.scope.get("client")
    address = network(peer[0] if peer else "")
    loop = asyncio.get_running_loop()
    began = loop.time()
    body = bytearray()
    reading.bodies += 1
    try:
        async with asyncio.timeout(min(within_s, FIRST_S)) as clock:
            while True:
                message = await request.receive()
                if message["type"] != "http.request":
                    raise ClientDisconnect
                chunk = message.get("body", b"")
                reading.take(address, len(chunk))
                body += chunk
                if len(body) > limit:
                    raise _too_large(limit)
                if not message.get("more_body"):
                    break
                clock.reschedule(began + min(within_s, FIRST_S + len(body) / LEAST_BYTES_S))
    except TimeoutError as late:
        raise Problem("too-slow", f"The body was not complete after {loop.time() - began:.1f} s.") from late
    finally:
        reading.bodies -= 1
        reading.give_back(address, len(body))
    return bytes(body)

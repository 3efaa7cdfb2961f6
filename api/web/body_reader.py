"""Reading a body: declared as JSON, no larger than its cap however it is sent, and in time."""

from __future__ import annotations

import asyncio
import re

from starlette.requests import Request

from assur.api.problems import FieldError, Problem

READERS = 32
"""So many bodies are read at a time; with their caps this bounds the memory that unread requests take."""

_JSON = re.compile(r"application/(?:[a-z0-9.+-]+\+)?json(?:\s*;\s*charset=\"?utf-8\"?)?\s*", re.IGNORECASE)


def _require_json(request: Request) -> None:
    """Raises the problem of a body that is not declared to be plain JSON in UTF-8."""
    declared = request.headers.getlist("content-type")
    if len(declared) != 1 or not _JSON.fullmatch(declared[0]):
        error = FieldError("Content-Type", "absent" if not declared else "another type", "application/json")
        raise Problem("wrong-media-type", "Send Content-Type: application/json, in UTF-8.", (error,))


def _require_plain(request: Request) -> None:
    """Raises the problem of a body that is compressed."""
    if request.headers.get("content-encoding", "identity").lower() != "identity":
        error = FieldError("Content-Encoding", "an encoding", "none")
        raise Problem("wrong-media-type", "Send the body as it is, not compressed.", (error,))


def _too_large(limit: int) -> Problem:
    error = FieldError("body", f"more than {limit} bytes", f"at most {limit} bytes")
    return Problem("too-large", f"A body here has at most {limit} bytes.", (error,))


async def read_body(
    request: Request, limit: int, within_s: float, readers: asyncio.Semaphore, *, json: bool = True
) -> bytes:
    """The body of `request`. `json`: it must be declared to be that; else it may be of any type.

    Raises `Problem`: wrong-media-type; too-large, before reading where the length is declared; too-slow; busy when
    `readers` is used up.
    """
    if json:
        _require_json(request)
    _require_plain(request)
    length = request.headers.get("content-length", "0")
    if not (length.isascii() and length.isdigit() and len(length) <= 15 and int(length) <= limit):
        raise _too_large(limit)
    if readers.locked():
        raise Problem("busy", "Too many bodies arrive at a time. Come again in 1 s.", headers={"Retry-After": "1"})
    body = bytearray()
    try:
        async with readers, asyncio.timeout(within_s):
            async for chunk in request.stream():
                body += chunk
                if len(body) > limit:
                    raise _too_large(limit)
    except TimeoutError as late:
        raise Problem("too-slow", f"The body was not complete after {within_s:g} s.") from late
    return bytes(body)

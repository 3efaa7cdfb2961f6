"""Documents as bytes, the same on the command line and over HTTP, their digests, and the responses with them."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

import pydantic_core

from assur.api.problems import MEDIA_TYPE, Problem
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_PLAN_FILE_BYTES

if TYPE_CHECKING:
    from starlette.responses import Response

    from assur.scenes.plan_file import PlanFile


def to_json(document: Any) -> bytes:
    """`document` as compact JSON in ASCII.

    Raises `ValueError` for a number that is not finite: such a one is our fault and never leaves the house as null.
    """
    try:
        text = pydantic_core.to_json(document, inf_nan_mode="constants")
    except pydantic_core.PydanticSerializationError:
        text = b"NaN"
    # Pydantic's writer is ten times as fast as Python's, and numbers read back the same to the bit. It would write a
    # NaN, and more than ASCII: whatever looks like one of these is left to Python's.
    if b"NaN" in text or b"Infinity" in text or not text.isascii():
        return json.dumps(document, allow_nan=False, separators=(",", ":")).encode("ascii")
    return text


def digest_of(*parts: str | bytes) -> str:
    """The SHA-256 of some parts, in hexadecimal digits. Each part counts with its length: two lists of parts have the
    same digest only if they are equal."""
    found = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        found.update(b"%d\n" % len(data) + data)
    return found.hexdigest()


def plan_file_bytes(held: PlanFile, field: str) -> bytes:
    """A plan file as it is written. Raises `InputError` that names `field` where it would be too long to be read."""
    data = to_json(held.document) + b"\n"
    if len(data) > MAX_PLAN_FILE_BYTES:
        allowed = f"a plan file of up to {MAX_PLAN_FILE_BYTES} bytes: meshes with fewer triangles, or a shorter task"
        raise InputError(field, f"{len(data)} bytes", allowed)
    return data


def json_response(document: Any, status: int = 200, headers: dict[str, str] | None = None) -> Response:
    """A document as its response; bytes are JSON already."""
    from starlette.responses import Response  # the command line needs none

    body = document if isinstance(document, bytes) else to_json(document)
    return Response(body, status, headers, media_type="application/json")


def problem_response(problem: Problem) -> Response:
    """`problem` as its response."""
    from starlette.responses import Response

    return Response(to_json(problem.document()), problem.status, headers=problem.headers, media_type=MEDIA_TYPE)

"""Documents as bytes, the same on the command line and over HTTP, and the responses that carry them."""

from __future__ import annotations

import json
from typing import Any

from starlette.responses import Response

from api.problems import MEDIA_TYPE, Problem


def to_json(document: Any) -> bytes:
    """`document` as compact JSON in ASCII.

    Raises `ValueError` for a number that is not finite: such a one is our fault and never leaves the house as null.
    """
    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode("ascii")


def json_response(body: bytes) -> Response:
    """A document that is JSON already."""
    return Response(body, media_type="application/json")


def problem_response(problem: Problem) -> Response:
    """`problem` as its response."""
    return Response(to_json(problem.document()), problem.status, headers=problem.headers, media_type=MEDIA_TYPE)

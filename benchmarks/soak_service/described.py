"""The statuses that a service describes for its addresses, from its own /openapi.json."""

from __future__ import annotations

from typing import Any

from benchmarks.soak_service.row import RowError
from benchmarks.soak_service.served import Service


def description(service: Service) -> dict[str, Any]:
    """The description of a running service."""
    client = service.client()
    reply = client.get("/openapi.json")
    client.close()
    document = reply.document()
    if reply.status != 200 or not isinstance(document, dict):
        raise RowError(f"/openapi.json was answered with {reply.status} {reply.fault}".strip())
    return document


def statuses(document: dict[str, Any], method: str, path: str) -> set[int]:
    """The statuses that the description has for an operation; all of a hundred where it says 5XX, all for default."""
    found: set[int] = set()
    for status in document["paths"][path][method.lower()]["responses"]:
        if status == "default":
            found |= set(range(100, 600))
        elif status.upper().endswith("XX"):
            found |= set(range(100 * int(status[0]), 100 * int(status[0]) + 100))
        else:
            found.add(int(status))
    return found

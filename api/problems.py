"""What went wrong, as RFC 9457 has it: `application/problem+json`.

A problem never repeats what it cannot print: no non-finite number, no long text, no control character.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.faults import NOTHING, DocumentError

MEDIA_TYPE = "application/problem+json"
SHOWN_CHARACTERS = 80
"""Longest text of a request that a problem repeats."""
SHOWN_NUMBERS = 6
"""Longest list of numbers of a request that a problem repeats: a window, a point."""
LONGEST_ALLOWED = 2000
"""Longest list of what is allowed that a problem gives, characters."""

STATUS = {
    "bad-syntax": (400, "The body is not the JSON that this service accepts"),
    "unauthorized": (401, "The request has no key of this service"),
    "not-found": (404, "There is nothing here"),
    "job-lost": (404, "There is no such job here"),
    "cell-unknown": (404, "There is no cell with this digest"),
    "mesh-unknown": (404, "There is no mesh with this digest"),
    "no-mesh-folder": (404, "This service keeps no meshes and no cells"),
    "no-page": (404, "There is no page about this answer"),
    "no-simulations": (404, "This service makes no simulations"),
    "method-not-allowed": (405, "This address does not know that method"),
    "job-not-done": (409, "The job has no answer"),
    "key-in-use": (409, "The request with this key is still worked on"),
    "too-slow": (408, "The request did not arrive in time"),
    "too-large": (413, "The body is too large"),
    "wrong-media-type": (415, "The body is not declared to be JSON"),
    "bad-input": (422, "A field holds a value that is not allowed"),
    "no-websockets": (400, "This service has no WebSockets"),
    "key-reused": (422, "This key was sent with another request"),
    "simulation-fault": (422, "The simulation ended with an error"),
    "quarantined": (422, "This request ended three workers, and is not tried again for a time"),
    "too-many-requests": (429, "This client has its share already"),
    "fault": (500, "The fault is ours"),
    "worker-crashed": (503, "The worker of this request died, and there is no other"),
    "busy": (503, "No worker is free in time"),
    "not-ready": (503, "Not every worker has planned yet"),
    "draining": (503, "The service is about to stop"),
    "mesh-folder-fault": (503, "The folder for meshes cannot be written"),
    "mesh-folder-full": (507, "The folder for meshes is full"),
    "worker-timeout": (504, "The worker did not end within its budget and was killed"),
}
"""Kinds of problem: the end of `type`, with HTTP status and title."""


@dataclass(frozen=True, slots=True)
class FieldError:
    """A field (dotted path), what it held (already fit to print; NOTHING: absent), what would be accepted, and the line
    of the text that has the field, if it was written in one."""

    field: str
    value: Any
    allowed: str
    line: int | None = None

    def document(self) -> dict[str, Any]:
        """The error as an element of `errors`; without `value` where the request has no such field."""
        value = {} if self.value is NOTHING else {"value": self.value}
        line = {} if self.line is None else {"line": self.line}
        return {"field": self.field, **value, "allowed": self.allowed, **line}

    def __str__(self) -> str:
        got = "it is missing" if self.value is NOTHING else f"got {json.dumps(self.value, ensure_ascii=False)}"
        return f"{self.field}: {got}; allowed: {self.allowed}"


class Problem(Exception):
    """A request that ends with a problem of a `kind` listed in `STATUS`; `detail` is a sentence of our own; `left_out`:
    the number of errors beyond those in `errors`; `again_s`: it may be sent again after so long, s."""

    def __init__(
        self,
        kind: str,
        detail: str,
        errors: Sequence[FieldError] = (),
        headers: Mapping[str, str] | None = None,
        left_out: int = 0,
        again_s: int | None = None,
    ) -> None:
        super().__init__(f"{kind}: {detail}")
        self.kind = kind
        self.detail = detail
        self.errors = tuple(errors)
        self.headers = dict(headers or {}) | ({} if again_s is None else {"Retry-After": str(again_s)})
        self.left_out = left_out

    @property
    def status(self) -> int:
        return STATUS[self.kind][0]

    def document(self) -> dict[str, Any]:
        """The problem as the document that is sent."""
        status, title = STATUS[self.kind]
        document: dict[str, Any] = {
            "type": f"urn:assur:problem:{self.kind}",
            "title": title,
            "status": status,
            "detail": self.detail,
        }
        if self.errors:
            document["errors"] = [error.document() for error in self.errors]
        if self.left_out:
            document["errors_left_out"] = self.left_out
        return document

    def __reduce__(self) -> tuple[type[Problem], tuple[Any, ...]]:
        return type(self), (self.kind, self.detail, self.errors, self.headers, self.left_out)

    @staticmethod
    def of_input(error: InputError, kind: str = "bad-input") -> Problem:
        """The problem that tells the caller of `error`, and of the further faults that it knows."""
        every = (error, *error.more) if isinstance(error, DocumentError) else (error,)
        errors = [
            FieldError(
                printable(each.field),
                shown(each.value),
                printable(each.allowed, LONGEST_ALLOWED),
                getattr(each, "line", None),
            )
            for each in every
        ]
        return Problem(kind, str(errors[0]), errors, left_out=getattr(error, "left_out", 0))


def printable(text: str, longest: int = 200) -> str:
    """`text` without control characters, lone surrogates and what is beyond `longest` characters."""
    cut = text if len(text) <= longest else text[: longest - 3] + "..."
    return "".join(c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in cut)


def shown(value: object) -> Any:
    """`value` as a problem may repeat it: a short scalar or a few numbers as they are, anything else in words."""
    match value:
        case None | bool():
            return value
        case _ if value is NOTHING:
            return NOTHING
        case int():
            return value if abs(value) < 1 << 53 else "a whole number beyond 2^53"
        case float():
            return value if math.isfinite(value) else "a number that is not finite"
        case str():
            return printable(value, SHOWN_CHARACTERS)
        case bytes() | bytearray():
            return f"{len(value)} bytes"
        case dict():
            return f"an object with {len(value)} field{'' if len(value) == 1 else 's'}"
        case list() if len(value) <= SHOWN_NUMBERS and all(type(x) in (int, float) for x in value):
            return [shown(x) for x in value]
        case list() | tuple() | set() | frozenset():
            return f"a list of {len(value)}"
        case _:
            return f"a {type(value).__name__}"

"""What a client raises when the service gives no answer to a request."""

from __future__ import annotations

from typing import Any

from assur.planner.errors import AssurError, InputError

KIND = "urn:assur:problem:"
"""What the `type` of the service's problems begins with."""


class ServiceError(AssurError):
    """The service at `url` did not answer, or what answered there is not this service."""

    def __init__(self, url: str, why: str) -> None:
        Exception.__init__(self, f"{url}: {why}")  # not the next class's own, which may be that of an InputError
        self.url = url
        self.why = why

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.url, self.why)


class ProblemError(ServiceError):
    """The service answered with a problem document (RFC 9457) in place of an answer.

    `document`: the problem; `status`: of HTTP; `kind`: the end of the problem's type, such as ``busy`` (docs/service.md
    lists them); `retry_after_s`: when to ask again, if the service says so.
    """

    def __init__(self, url: str, document: dict[str, Any], retry_after_s: float | None = None) -> None:
        ServiceError.__init__(self, url, f"{document['title']} ({document['status']}). {document['detail']}")
        self.document = document
        self.status = int(document["status"])
        self.kind = str(document["type"]).removeprefix(KIND)
        self.retry_after_s = retry_after_s

    @property
    def errors(self) -> list[dict[str, Any]]:
        """Each fault of the request: `field`, `value` (not there where the field is missing), `allowed`."""
        return list(self.document.get("errors", ()))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.url, self.document, self.retry_after_s)


class RemoteInputError(ProblemError, InputError):
    """A field of the request holds a value that is not allowed. As the `InputError` of a call without a service it has
    `field`, `value` (None where the field is missing) and `allowed`, of the first fault; all are in `errors`."""

    def __init__(self, url: str, document: dict[str, Any], retry_after_s: float | None = None) -> None:
        ProblemError.__init__(self, url, document, retry_after_s)
        first = self.errors[0]
        self.field = str(first["field"])
        self.value = first.get("value")
        self.allowed = str(first["allowed"])

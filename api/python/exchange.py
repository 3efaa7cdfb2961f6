"""What is sent to the service and what is made of its answers: the same for the client that waits and the one that is
awaited. Knows no library of HTTP."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Literal, TypedDict, TypeVar, cast

from assur.api.python.answer import Answer
from assur.api.python.calls import A_CELL, document_of, known, plain_answer, plain_parts, plain_request
from assur.api.python.service_errors import KIND, ProblemError, RemoteInputError, ServiceError
from assur.planner.errors import InputError
from assur.scenes.faults import dotted
from assur.scenes.schema.normal import plain

if TYPE_CHECKING:
    from assur.scenes.schema.answer import Verdict
    from assur.scenes.schema.ik import IkAnswer

T = TypeVar("T")
Parts = tuple[str | int, ...]

PROBLEM = "application/problem+json"
OK, CREATED, ACCEPTED, NOT_READY = 200, 201, 202, 503
DIGEST = "request_digest"
"""The field of an answer that says to which request it is one."""
DIGEST_OF_CELL = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True)
class Health:
    """Whether the service runs and takes requests: `ready` when each of its `workers` has planned once; `detail` says
    what it waits for until then."""

    ready: bool
    workers: int | None
    detail: str


@dataclass(frozen=True)
class Exchange(Generic[T]):
    """A request of HTTP, and what is made of the document that answers it. `accepted`: further kinds of problem that
    are answers, too. `streamed`: the answer is no document, but a stream of events that ends with a job; its content is
    not needed."""

    method: Literal["GET", "POST", "PUT", "DELETE"]
    path: str
    made: Callable[[Any], T]
    body: bytes | None = None
    parameters: tuple[tuple[str, str], ...] = ()
    accepted: frozenset[str] = frozenset()
    media_type: str = "application/json"
    streamed: bool = False

    @property
    def headers(self) -> dict[str, str]:
        return {} if self.body is None else {"Content-Type": self.media_type}

    def result(self, url: str, status: int, headers: Mapping[str, str], content: bytes) -> T:
        """What the response means. Raises `ProblemError` for a problem, `ServiceError` for what is none of ours."""
        if self.streamed and status == OK:
            return self.made(None)
        try:
            document = json.loads(content)
        except ValueError as error:
            raise ServiceError(url, _stranger(status, headers)) from error
        if status in (OK, CREATED, ACCEPTED):
            return self.made(document)
        kind = document.get("type") if isinstance(document, dict) else None
        if not (isinstance(kind, str) and kind.startswith(KIND)):
            raise ServiceError(url, _stranger(status, headers))
        if kind.removeprefix(KIND) in self.accepted:
            return self.made(document)
        later = headers.get("Retry-After")
        raised = RemoteInputError if document.get("errors") else ProblemError
        raise raised(url, document, float(later) if later is not None else None)


def planning(request: object, certificate: str) -> Exchange[Answer]:
    document = plain_request(request)
    return Exchange(
        "POST",
        "v1/plans",
        lambda answer: Answer(answer, known(document)),
        _json(document),
        (("certificate", certificate),),
    )


def checking(request: object, answer: object) -> Exchange[Verdict]:
    body = {"request": plain_request(request), "plan": plain_answer(answer)}
    return Exchange("POST", "v1/plans/check", _same, _json(body))


def kinematics(request: object | None, question: dict[str, object]) -> Exchange[IkAnswer]:
    of = {} if request is None else {"request": plain_request(request)}
    return Exchange("POST", "v1/ik", _same, _json({**of, **plain_parts(question)}))


def robots() -> Exchange[list[dict[str, Any]]]:
    return Exchange("GET", "v1/robots", lambda document: cast("list[dict[str, Any]]", document["robots"]))


def scenarios() -> Exchange[dict[str, str]]:
    return Exchange("GET", "v1/scenes", lambda document: {each["name"]: each["about"] for each in document["scenes"]})


def loading(name: str) -> Exchange[dict[str, Any]]:
    from urllib.parse import quote

    return Exchange("GET", f"v1/scenes/{quote(name, safe='')}", _same)


def uploading(content: bytes, form: str, unit: str) -> Exchange[dict[str, Any]]:
    """A mesh is sent, and covered at once; what comes of it is the mesh as a request names it."""
    digest = hashlib.sha256(content).hexdigest()
    mesh = {"sha256": digest, "format": form, "unit": unit}
    how = (("format", form), ("unit", unit))
    return Exchange("PUT", f"v1/meshes/{digest}", lambda _: mesh, content, how, media_type="application/octet-stream")


def keeping(cell: object) -> Exchange[str]:
    """A cell is sent; what comes of it is the digest that names it."""
    body = _json(plain_request(cell))
    digest = _digest(body)
    return Exchange("PUT", f"v1/cells/{digest}", lambda _: digest, body)


def planning_task(
    digest: str,
    task: dict[str, object],
    certificate: str,
    fields: Sequence[str] | None,
    digits: int | None,
    cell: object,
) -> Exchange[Answer]:
    """A task is planned; the answer knows its request where the document of the `cell` is known. Raises `InputError`
    for a cell that is not the one with this digest: another text of it has the same requests."""
    body = _json({key: value for key, value in plain_parts(task).items() if value is not None})
    how = [("certificate", certificate)]
    if fields is not None:
        if isinstance(fields, str) or not fields or not all(isinstance(each, str) for each in fields):
            raise InputError("fields", fields, "a list of names of fields, as in ['status', 'trajectory.position']")
        how.append(("fields", ",".join(fields)))
    if digits is not None:
        how.append(("digits", str(digits)))

    document = None if cell is None else plain(document_of(cell))
    own = None if document is None else _digest(_json(document))
    another = InputError("cell", f"the digest {own}", f"the cell of this task, with the digest {digest}")
    if own not in (None, digest) and fields is not None and DIGEST not in fields:
        raise InputError("fields", fields, f"{DIGEST} among them, which shows that `cell` is the cell of this task")

    def made(answer: Any) -> Answer:
        if document is None:
            return Answer(answer)
        from assur.scenes.schema.cell_file import TASK
        from assur.scenes.tasks.joining import joined

        stated = {"schema": TASK, **json.loads(body)}
        if own != digest and not _is_answer_in(answer, document, stated):
            raise another
        return Answer.made(answer, joined(document, stated).request, (document, stated))

    return Exchange("POST", f"v1/cells/{digest}/plans", made, body, tuple(how))


class Question(TypedDict, total=False):
    """What a simulation is to do with its cell; the service has the values of what is left out."""

    minutes: float
    seed: int
    seeds: int
    planning_ms: float
    set: Mapping[str, object] | None
    helps: bool


def simulating(cell: object, question: Question) -> Exchange[str]:
    """A simulation of a cell, which is its digest or its document, is started; what comes of it is the id of its
    job. Raises `InputError` for another cell."""
    given = {key: value for key, value in plain_parts({**question}).items() if value is not None}
    if isinstance(cell, str) and not DIGEST_OF_CELL.fullmatch(cell):
        raise InputError("cell", cell, f"the digest of a cell that was sent (put_cell), or {A_CELL}")
    path = f"v1/cells/{cell}/simulations" if isinstance(cell, str) else "v1/simulations"
    body = _json(given if isinstance(cell, str) else {**given, "cell": plain(document_of(cell))})
    return Exchange("POST", path, lambda job: str(job["id"]), body)


def end_of(job: str) -> Exchange[None]:
    """A job is waited for."""
    return Exchange("GET", f"v1/jobs/{job}/events", lambda _: None, streamed=True)


def answer_of(job: str) -> Exchange[dict[str, Any]]:
    """The answer of a job that has ended, or its problem."""
    return Exchange("GET", f"v1/jobs/{job}/answer", _same)


def cancelling(job: str) -> Exchange[None]:
    """A job is cancelled."""
    return Exchange("DELETE", f"v1/jobs/{job}", lambda _: None)


def _is_answer_in(answer: Any, cell: dict[str, Any], task: dict[str, Any]) -> bool:
    """Whether an answer is one to the request that this cell and the task make."""
    from assur.scenes.requests import request_digest
    from assur.scenes.tasks.joining import joined

    try:
        return bool(request_digest(joined(cell, task).request) == answer[DIGEST])
    except InputError:
        return False


def _digest(body: bytes) -> str:
    return hashlib.sha256(body).hexdigest()


def health() -> Exchange[Health]:
    return Exchange("GET", "readyz", _health, accepted=frozenset({"not-ready"}))


def _same(document: Any) -> Any:
    return document


def _health(document: dict[str, Any]) -> Health:
    ready = document.get("ready") is True
    return Health(ready, int(document["workers"]) if ready else None, str(document.get("detail", "")))


def _stranger(status: int, headers: Mapping[str, str]) -> str:
    kind = headers.get("Content-Type", "nothing of a stated kind")
    return f"answered {status} with {kind}, as no service of assur does; see whether this is its address"


def _json(document: object) -> bytes:
    """A document as the body of a request. Raises `InputError` at what JSON has no form for."""
    body = plain(document)
    try:
        return json.dumps(body, allow_nan=False).encode("ascii")
    except (TypeError, ValueError) as error:
        path, value = _not_json(body, ())
        allowed = "a finite number" if isinstance(value, float) else "text, a number, true, false, a list or a mapping"
        raise InputError(dotted(path), value, allowed) from error


def _not_json(value: object, path: Parts) -> tuple[Parts, object]:
    """The first place in a document for which JSON has no form, and what is there."""
    items: list[tuple[str | int, object]] = []
    if isinstance(value, dict):
        items = [(key if isinstance(key, str) else repr(key), item) for key, item in value.items()]
    elif isinstance(value, list):
        items = list(enumerate(value))
    found = (_not_json(item, (*path, key)) for key, item in items)
    return next((there for there in found if not _is_json(there[1])), (path, value))


def _is_json(value: object) -> bool:
    return (
        value is None
        or isinstance(value, str | bool | int | dict | list)
        or (isinstance(value, float) and math.isfinite(value))
    )

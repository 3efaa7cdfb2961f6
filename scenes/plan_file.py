"""A request and the answer to it in one document: the file that `assur plan --out` writes.

`POST /v1/plans/check`, `/view` and `/report` take it. Nothing in it names another file: the request contains the
content of the cell's files (meshes, robots, plans of neighbours).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final

from assur.scenes.bounds import MAX_TEXT
from assur.scenes.faults import NOTHING, WHOLE, DocumentError

FORM: Final = "assur-plan/1"
"""Its `schema`."""
FORMS: Final = "assur-plan/"
"""How the `schema` of every version begins."""
TEXTS: Final = ("title", "about")
"""What a plan file may say of its cell: its name, and why it exists."""
FIELDS: Final = ("schema", *TEXTS, "request", "plan")
LONGEST_BEGINNING: Final = 256
"""Number of first bytes that show whether a file is a plan file, whatever its name."""
MEANT: Final = "a plan file, as `assur plan --out` writes it"

OTHERS: Final = (("status", "an answer without its request"), ("task", "a request without an answer"))
"""A field of other documents, and what they are."""


@dataclass(frozen=True, eq=False)
class PlanFile:
    """A request, the answer to it, the name of the cell and why it exists (empty: not stated)."""

    request: dict[str, Any]
    plan: dict[str, Any]
    title: str = ""
    about: str = ""

    @property
    def document(self) -> dict[str, Any]:
        """The document; its schema comes first."""
        labels = {key: text for key, text in (("title", self.title), ("about", self.about)) if text}
        return {"schema": FORM, **labels, "request": self.request, "plan": self.plan}

    def held_together(self, digest: str) -> None:
        """Accepts an answer to the request. `digest`: that of the request. Raises `DocumentError` for an answer to
        another one."""
        stated = self.plan.get("request_digest", NOTHING)
        if stated != digest:
            allowed = f"{digest}, the digest of the request in this file; its plan is an answer to another request"
            raise DocumentError("plan.request_digest", stated, allowed)


def is_plan_file(document: object) -> bool:
    """Whether a document calls itself a plan file, of whichever version."""
    form = document.get("schema") if isinstance(document, dict) else None
    return isinstance(form, str) and form.startswith(FORMS)


def begins_a_plan_file(data: bytes) -> bool:
    """Whether text begins as a plan file does that we wrote, up to `LONGEST_BEGINNING` bytes of it."""
    return b"".join(data[:LONGEST_BEGINNING].split()).startswith(f'{{"schema":"{FORMS}'.encode())


def plan_file_in(document: object) -> PlanFile:
    """The request and the answer in a document. Raises `DocumentError` at the first field that is not as a plan file
    has it; whether they are right, and belong together, is seen when they are read."""
    if not isinstance(document, dict):
        raise DocumentError(WHOLE, document, MEANT)
    if document.get("schema") != FORM:
        this = next((f"; this is {what}" for key, what in OTHERS if key in document), "")
        raise DocumentError("schema", document.get("schema", NOTHING), f"{FORM}: {MEANT}{this}")
    for key in document:
        if key not in FIELDS:
            raise DocumentError(key, document[key], f"one of {', '.join(FIELDS)}")
    for key, what in (("request", "the request"), ("plan", "the answer to the request")):
        if not isinstance(document.get(key), dict):
            raise DocumentError(key, document.get(key, NOTHING), f"{what}, an object, which must be given")
    for key in TEXTS:
        if not (isinstance(document.get(key, ""), str) and len(document.get(key, "")) <= MAX_TEXT):
            raise DocumentError(key, document[key], f"a text of up to {MAX_TEXT} characters")
    return PlanFile(**{key: value for key, value in document.items() if key != "schema"})


@contextmanager
def in_request() -> Iterator[None]:
    """A fault of the request of a plan file, raised inside, gets the field that it has in the file."""
    try:
        yield
    except DocumentError as error:
        if error.field.split(".")[0] in ("plan", WHOLE):
            raise  # of the plan, or of the document as a whole
        raise error.relocated(lambda field: f"{WHOLE}.{field}") from error

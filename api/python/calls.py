"""The calls of `import assur`. Each takes a request as a plain document or as built of `assur.request`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

from assur.api.python.answer import Answer
from assur.planner.errors import InputError

if TYPE_CHECKING:
    from assur.request import Request
    from assur.scenes.schema.answer import Verdict
    from assur.scenes.schema.ik import IkAnswer

A_CELL = "an assur.Cell, or the document of a cell; assur.load reads the one in a file"


def load(name: str | Path) -> dict[str, Any]:
    """The request in a scenario file (YAML), a request file (``.json``) or a plan file, or in the shipped scenario of
    that name. Of a plan file `load_answer` reads the answer, too. Of a cell file it is the cell, which `Cell` takes.

    A plain document of its own each time: change it, plan it, post it. What the files hold that a scenario names (of
    robots, plans and meshes), which must lie below its folder, is in it already. A file that is there comes before a
    scenario's name. Raises `InputError` naming the field (in YAML with its line), or where neither a file nor a
    scenario has the name; `OSError` for a file that cannot be read.
    """
    from assur.scenes import load as read

    return read(name)


def plan(
    request: Mapping[str, Any] | Request,
    *,
    set: Mapping[str, object] | None = None,  # noqa: A002 as on the command line
    certificate: Literal["full", "digest"] = "full",
) -> Answer:
    """The answer to a request: ``answer.planned``, or not, and then ``answer.sentence`` says why.

    `set`: values of the request by their paths, as `assur.Cell` takes them; ``answer["relaxation"]["set"]`` is such.
    `certificate`: the whole table of the proof, which `check` needs, or its digest and size.
    Raises `InputError` naming the field that is not right; its `errors` are all fields that are not.
    """
    from assur.scenes.requests import plan_document
    from assur.scenes.schema.normal import plain
    from assur.scenes.set_values import with_values

    document = plain_request(request)
    if set is not None and isinstance(document, dict):
        document = with_values(document, plain(plain_request(set)))
    return Answer.made(plan_document(document, certificate=certificate), known(document))


def check(request: Mapping[str, Any] | Request, answer: Mapping[str, Any]) -> Verdict:
    """What the checker, which trusts no planner, says of an answer: ``{"ok": ..., "findings": [...]}``.

    Of a refusal it says whether what is called proved is proved. Raises `InputError` for a plan whose certificate is
    not in full.
    """
    from assur.scenes.requests import check_document

    return cast("Verdict", check_document(plain_request(request), plain_answer(answer)))


def bundle(request: Mapping[str, Any] | Request, answer: Mapping[str, Any]) -> dict[str, Any]:
    """The proof bundle of a planned answer: all that `assur prove`, a second checker, needs (docs/bundle.md).

    Raises `InputError` for what is no plan with a certificate in full, and for what a bundle cannot state.
    """
    from assur.scenes.bundle import bundle_document

    return bundle_document(plain_request(request), plain_answer(answer))


def ik(request: Mapping[str, Any] | Request | None = None, **question: object) -> IkAnswer:
    """All joint positions of a request's robot at ``pose={"at_mm": ..., "yaw_deg": ..., "frame": ...}``, with their
    margins; or the pose of its tool at ``joints={"j1_deg": ..., ...}``. At the time ``at_s``, or that of the start.

    Without a request ``robot={"model": ..., "tool": ...}`` says which robot. Objects of `assur.request` may be given in
    place of the mappings. Raises `InputError` naming the field that is not right.
    """
    from assur.scenes.requests import ik_document

    return cast("IkAnswer", ik_document(None if request is None else plain_request(request), plain_parts(question)))


def robots() -> list[dict[str, Any]]:
    """The shipped robots as plain data: ``model``, ``family``, and each number with unit, status and source."""
    from assur.scenes.requests import robots as listed

    return listed()


def scenarios() -> dict[str, str]:
    """Name and purpose of each shipped scenario; `load` takes the names."""
    from assur.scenes.requests import shipped_scenarios

    return shipped_scenarios()


def plain_request(request: object) -> object:
    """A request as its document; what is no request stays, for its reader to refuse."""
    document = getattr(request, "document", None)
    if callable(document):
        return document()
    return dict(request) if isinstance(request, Mapping) and not isinstance(request, dict) else request


def document_of(cell: object) -> dict[str, Any]:
    """The document of a cell, which is an `assur.Cell` or that document. Raises `InputError`."""
    found = cell if isinstance(cell, Mapping) else getattr(cell, "document", None)
    if not isinstance(found, Mapping):
        raise InputError("cell", cell, A_CELL)
    return dict(found)


def known(document: object) -> dict[str, Any] | None:
    """A request that an answer was made to, as plain data; None for one that only names a shipped scenario."""
    from assur.scenes.schema.normal import plain

    return plain(document) if isinstance(document, dict) and "scenario" not in document else None


def plain_answer(answer: object) -> object:
    """An answer as its document; what is none stays, for its reader to refuse."""
    if isinstance(answer, Answer):
        return answer.document
    return dict(answer) if isinstance(answer, Mapping) and not isinstance(answer, dict) else answer


def plain_parts(question: dict[str, object]) -> dict[str, object]:
    """The parts of a question as documents."""
    return {key: plain_request(value) for key, value in question.items()}

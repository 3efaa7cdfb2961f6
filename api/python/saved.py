"""Answers with their requests in plan files (`docs/api.md`)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from assur.api.python.answer import Answer


def write(answer: Answer, request: Mapping[str, Any], path: Path, title: str, about: str) -> Path:
    """Writes the plan file of an answer. Raises `InputError`, or `OSError`."""
    from assur.api.documents import plan_file_bytes
    from assur.scenes.plan_file import PlanFile, plan_file_in

    held = PlanFile(dict(request), answer.document, title, about)
    plan_file_in(held.document)  # what would not be read is not written
    path.write_bytes(plan_file_bytes(held, "path"))
    return path


def load_answer(path: str | Path) -> Answer:
    """The answer in a plan file, as ``assur plan --out`` and `Answer.save` write it, with its request.

    Refused is an answer to another request than that in the file. Whether the plan is right is what `check` says:
    ``assur.check(answer.request, answer)``. Raises `InputError` naming the field, or `OSError` for a file that cannot
    be read.
    """
    from assur.planner.errors import InputError
    from assur.scenes.files import is_file, json_in
    from assur.scenes.plan_file import in_request, plan_file_in
    from assur.scenes.requests import request_digest

    if not is_file(Path(path)):
        raise InputError("path", str(path), "a plan file that is there, as assur plan --out and Answer.save write it")
    held = plan_file_in(json_in(Path(path), "a plan file, as JSON"))
    with in_request():
        digest = request_digest(held.request)
    held.held_together(digest)
    return Answer(held.plan, held.request)

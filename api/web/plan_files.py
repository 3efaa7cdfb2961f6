"""One call that plans and returns the file: what its address may say, and what its response says of the plan."""

from __future__ import annotations

import math
from typing import Any, get_args

from starlette.requests import Request

from assur.api.problems import Problem
from assur.api.web.openapi import parameter, ref
from assur.api.workers.file_jobs import HEADERS, MEDIA_TYPES, REPORT
from assur.planner.errors import InputError
from assur.scenes.faults import raised_as
from assur.scenes.schema.export import ExportDocument, JerkRule
from assur.scenes.schema.read import read

OF_FILES = ("tick_s", "tick_ms", "jerk")
"""Parameters of the address that say how a file is to be written, besides its `format`."""
NAMES = ("format", *OF_FILES)

PARAMETERS = (
    parameter(
        "format",
        "the response is the plan as this file, and not the answer",
        {"type": "string", "enum": list(MEDIA_TYPES)},
    ),
    *(
        parameter(name, f"with `format`: the step of the controller, {name.removeprefix('tick_')}", {"type": "number"})
        for name in OF_FILES[:2]
    ),
    parameter(
        "jerk",
        "with `format`: the file keeps the limit of jerk (`limit`, the default), or may exceed it and states by how "
        "much (`report`)",
        {"type": "string", "enum": list(get_args(JerkRule))},
    ),
)

BINARY = {"schema": {"type": "string", "format": "binary"}}
NO_FILE = "With `format`, where there is no plan: the answer, which is `not_planned`"


def responses(problems: dict[int | str, dict[str, Any]]) -> dict[int | str, dict[str, Any]]:
    """The responses of the call, described, its `problems` among them."""
    headers = {
        name: {"description": f"with `format`: {about}", "schema": {"type": "string"}}
        for name, about in HEADERS.items()
    }
    answer = {"application/json": {"schema": ref("NotPlannedAnswer")}}
    both = {**problems[409], "description": f"{NO_FILE}; {problems[409]['description']}"}
    files: dict[str, Any] = {kind: BINARY for kind in MEDIA_TYPES.values() if kind != "application/json"}
    return {
        **problems,
        200: {"description": "The answer; with `format` the file", "content": files, "headers": headers},
        409: {**both, "content": {**answer, **problems[409]["content"]}},
    }


def file_wanted(request: Request) -> dict[str, Any] | None:
    """How the plan is to be written into a file, as an export has it; None: the answer is wanted. Raises `Problem`
    naming the parameter."""
    given = dict(request.query_params.items())
    own = {name: given[name] for name in OF_FILES if name in given}
    form = given.get("format")
    if form is not None and form not in MEDIA_TYPES:
        raise Problem.of_input(InputError("format", form, f"one of {', '.join(MEDIA_TYPES)}"))
    if form in (None, REPORT):
        for name, text in own.items():
            raise Problem.of_input(InputError(name, text, f"{name} with the format of a controller's file only"))
        return None if form is None else {"format": REPORT}
    how = {"format": form} | {name: text if name == "jerk" else _number(name, text) for name, text in own.items()}
    with raised_as(Problem.of_input):
        read(ExportDocument, how)
    return how


def _number(name: str, text: str) -> float:
    try:
        found = float(text) if text.isascii() and "_" not in text else math.nan
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise Problem.of_input(InputError(name, text, "a finite number"))
    return found

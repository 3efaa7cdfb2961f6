"""Scenario files: the purpose of a cell, the request, and the expected answer."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import Field

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_TEXT, MAX_YAML_BYTES
from assur.scenes.faults import NOTHING, DocumentError, fault, likeliest, together
from assur.scenes.files import empty
from assur.scenes.not_requests import refuse_document, refuse_text
from assur.scenes.scenario import OF_REQUEST, Scenario
from assur.scenes.schema.cell_file import CELL, TASK
from assur.scenes.schema.expect import ExpectDocument
from assur.scenes.schema.model import Document
from assur.scenes.schema.read import read
from assur.scenes.schema.request import RequestDocument
from assur.scenes.tasks.next_task import EndState
from assur.scenes.tasks.task_file import cell_document, is_cell, is_task, task_scenario
from assur.scenes.text.yaml_text import Lines, parse_yaml, with_line

CELLS = Path(__file__).parent / "cells"
"""The shipped scenarios."""


class ScenarioDocument(Document):
    """A scenario file; without `expect` nothing is held against its answer."""

    about: Annotated[str, Field(min_length=1, max_length=MAX_TEXT)]
    request: RequestDocument
    expect: ExpectDocument | None = None


def load_scenario(
    path: Path, after: EndState | None = None, given: Mapping[str, object] = MappingProxyType({})
) -> Scenario:
    """The scenario in a YAML file. `after`: the end of the plan where it begins; it is a task then, in which values are
    `given` by their paths. Raises `DocumentError` with the line, or `OSError` for a file that is not there."""
    return _scenario(*parse_yaml(yaml_in(path)), path, after, given)


def load_yaml(path: Path) -> Scenario | dict[str, Any]:
    """The scenario in a YAML file, or the cell, with what the files hold that it names. Raises as `load_scenario`."""
    document, lines = parse_yaml(yaml_in(path))
    return cell_document(document, lines, path.parent) if is_cell(document) else _scenario(document, lines, path)


def yaml_in(path: Path) -> bytes:
    """The text of a YAML file. Raises `DocumentError` where it is known to be something else, or `OSError`."""
    with path.open("rb") as file:
        data = file.read(MAX_YAML_BYTES + 1)
    refuse_text(data, path)
    return data


def scenario_in(text: bytes, path: Path) -> Scenario:
    """The scenario in the YAML text of a file, which is not opened. Raises `DocumentError` with the line."""
    return _scenario(*parse_yaml(text), path)


def _scenario(
    document: Any,
    lines: Lines,
    path: Path,
    after: EndState | None = None,
    given: Mapping[str, object] = MappingProxyType({}),
) -> Scenario:
    if is_task(document):
        return task_scenario(document, lines, path, after, given)
    if after is not None:
        allowed = f"{TASK}: a task file begins where a plan ends; of a request, answer.next_task does so in Python"
        raise with_line(fault(document, ("schema",), allowed), lines)
    if is_cell(document):
        raise with_line(
            fault(document, ("schema",), f"{TASK}: this is a cell; a task file that names it is planned"), lines
        )
    schema = document.get("schema") if isinstance(document, dict) else None
    if isinstance(schema, str) and schema.startswith("assur-"):
        raise with_line(fault(document, ("schema",), f"{TASK} or {CELL}; a scenario has none"), lines)
    refuse_document(document, path)
    if document is None:
        raise empty(path, "a scenario: YAML with about, request and, if something is expected of the answer, expect")
    if isinstance(document, dict) and "request" not in document and {"robot", "task"} & document.keys():
        raise DocumentError("request", NOTHING, "a request; this file is one without it: put it under request:", 1)
    try:
        read(ScenarioDocument, document)
    except DocumentError as error:
        from assur.scenes.reading.partly import other_faults

        request = document.get("request") if isinstance(document, dict) else None
        others = [
            each if each.line is not None else each.relocated(OF_REQUEST.__add__)
            for each in other_faults(request, path.parent)
        ]
        raise with_line(together([error, *others]), lines) from error
    about = " ".join(document["about"].split())
    return Scenario(path.stem, about, document["request"], document.get("expect", {}), path.parent, lines)


@lru_cache(maxsize=1)
def shipped_scenarios() -> dict[str, str]:
    """Name and purpose of each shipped scenario, by name."""
    return {path.stem: load_scenario(path).about for path in sorted(CELLS.glob("*.yaml"))}


def shipped(name: str) -> Scenario:
    """A shipped scenario. Raises `InputError` for a name that is none; no other file is ever opened."""
    names = sorted(path.stem for path in CELLS.glob("*.yaml"))
    if name not in names:
        raise InputError("scenario", name, f"one of {likeliest(name, names)}")
    return load_scenario(CELLS / f"{name}.yaml")


def scenario_text(name: str) -> str:
    """The YAML of a shipped scenario. Raises `InputError` for a name that is none."""
    return (CELLS / f"{shipped(name).name}.yaml").read_text(encoding="utf-8")


def unmet(expect: dict[str, Any], answer: dict[str, Any]) -> list[str]:
    """The parts of a scenario's `expect` that the answer does not meet, in words; [] if it meets all of them."""
    if not expect:
        return []
    wanted = read(ExpectDocument, expect)
    found = []
    if answer["status"] != wanted.status:
        return [f"status is {answer['status']}, not {wanted.status}"]  # the rest follows from it
    for key in ("reason", "proved"):
        want = getattr(wanted, key)
        if want is not None and answer.get(key) != want:
            found.append(f"{key} is {answer.get(key)}, not {want}")
    if wanted.duration_s is not None:
        duration = answer.get("duration_s")
        low, high = wanted.duration_s.min, wanted.duration_s.max
        if duration is None:
            found.append("there is no duration_s")
        elif not ((low is None or duration >= low) and (high is None or duration <= high)):
            found.append(f"duration_s is {duration}, not from {low} to {high}")
    answered = str(
        [answer.get(key) for key in ("sentence", "refusal", "census", "relaxation", "margins", "legs", "load")]
    )
    found += [f"{words!r} is not mentioned" for words in wanted.mentions if words not in answered]
    met = {arrival["control_point"] for arrival in answer.get("arrivals", ()) if arrival["matched"]}
    found += [f"{name} is not met with its velocity" for name in wanted.matched if name not in met]
    if wanted.relaxation is not None and wanted.relaxation not in str(answer.get("relaxation")):
        found.append(f"relaxation is {answer.get('relaxation')}, not {wanted.relaxation}")
    return found

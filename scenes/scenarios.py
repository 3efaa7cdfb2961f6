"""Scenario files: the purpose of a cell, the request, and the expected answer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_TEXT, MAX_YAML_BYTES
from assur.scenes.catalogue import with_robots
from assur.scenes.faults import NOTHING, DocumentError, likeliest
from assur.scenes.files import empty, with_meshes, with_plans
from assur.scenes.schema.model import Document, Instant
from assur.scenes.schema.read import read
from assur.scenes.schema.request import RequestDocument
from assur.scenes.text.yaml_text import Lines, parse_yaml, with_line

CELLS = Path(__file__).parent / "cells"
"""The shipped scenarios."""
OF_PLAN = "plan"
"""First part of the fields of a plan that is checked against a scenario; no key of a request."""


class RangeDocument(Document):
    """A range; either end may be left out."""

    min: Instant | None = None
    max: Instant | None = None


class ExpectDocument(Document):
    """What a scenario's answer must be."""

    status: Literal["planned", "not_planned"]
    duration_s: RangeDocument | None = None
    reason: str | None = None
    proved: bool | None = None
    mentions: Annotated[list[str], Field(max_length=32)] = Field(default_factory=list)
    matched: Annotated[list[str], Field(max_length=64)] = Field(default_factory=list)
    relaxation: str | None = None


class ScenarioDocument(Document):
    """A scenario file; without `expect` nothing is held against its answer."""

    about: Annotated[str, Field(min_length=1, max_length=MAX_TEXT)]
    request: RequestDocument
    expect: ExpectDocument | None = None


@dataclass(frozen=True, eq=False)
class Scenario:
    """A scenario: its name is its file's, `folder` its file's folder, `lines` has the line of each value."""

    name: str
    about: str
    request: dict[str, Any]
    expect: dict[str, Any]
    folder: Path
    lines: Lines

    @contextmanager
    def located(self) -> Iterator[None]:
        """An `InputError` about the request, raised inside, gets the line of the file."""
        try:
            yield
        except InputError as error:
            if error.field.split(".")[0] == OF_PLAN:
                raise  # about the plan that is checked: another file, whose lines are not known
            raise with_line(error, self.lines, "request.") from error


def load_scenario(path: Path) -> Scenario:
    """The scenario in a YAML file. Raises `DocumentError` with the line, or `OSError` for a file that is not there."""
    with path.open("rb") as file:
        text = file.read(MAX_YAML_BYTES + 1)
    return scenario_in(text, path)


def scenario_in(text: bytes, path: Path) -> Scenario:
    """The scenario in the YAML text of a file, which is not opened. Raises `DocumentError` with the line."""
    document, lines = parse_yaml(text)
    if document is None:
        raise empty(path, "a scenario: YAML with about, request and, if something is expected of the answer, expect")
    if isinstance(document, dict) and "request" not in document and {"robot", "task"} & document.keys():
        raise DocumentError("request", NOTHING, "a request; this file is one without it: put it under request:", 1)
    try:
        read(ScenarioDocument, document)
    except InputError as error:
        raise with_line(error, lines) from error
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


def with_files(request: Any, folder: Path) -> Any:
    """The request with the content of each file (of a robot, a plan, a mesh) in place of its name; the files must be
    below `folder`."""
    return with_meshes(with_plans(with_robots(request, folder), folder), folder)


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

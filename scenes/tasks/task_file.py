"""Task files: the scenario that a task in a YAML file and the cell in the file that it names make together."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_YAML_BYTES
from assur.scenes.faults import NOTHING, DocumentError, fault
from assur.scenes.files import below, empty
from assur.scenes.scenario import OF_PLAN, Scenario, with_files
from assur.scenes.schema.cell_file import TASK
from assur.scenes.tasks.cell_alone import cell_alone
from assur.scenes.tasks.joining import OF_CELL, OF_TASK, Joined, documented, joined, within_document
from assur.scenes.text.yaml_text import Lines, line_of, parse_yaml, with_line

ENDINGS = (".yaml", ".yml")


@dataclass(frozen=True, eq=False)
class _Files:
    """Lines of a task's file (`task`) and of the file of its cell, with the name of that."""

    task: Lines
    name: str
    cell: Lines

    def placed(self, error: InputError) -> DocumentError:
        """A fault of the cell or the task, with the file and the line: fields of the task alone, those of the cell
        behind the name of its file."""
        return documented(error).relocated(self._field, self._line)

    def _field(self, field: str) -> str:
        inside = field.removeprefix(OF_TASK).removeprefix(".")
        if not field.startswith(OF_CELL):
            return inside or OF_TASK
        return f"{self.name}: {field.removeprefix(OF_CELL).removeprefix('.') or OF_CELL}"

    def _line(self, field: str) -> int | None:
        name, mark, inside = field.partition(": ")
        return line_of(inside, self.cell) if mark and name == self.name else line_of(field, self.task)


@dataclass(frozen=True, eq=False)
class TaskScenario(Scenario):
    """A scenario whose request is a task in a cell."""

    joined: Joined
    files: _Files

    @contextmanager
    def located(self) -> Iterator[None]:
        """An `InputError` about the request, raised inside, gets the place in the file of the cell or the task."""
        try:
            yield
        except InputError as error:
            if error.field.split(".")[0] == OF_PLAN:
                raise  # about the plan that is checked
            raise self.files.placed(self.joined.relocated(error)) from error


def is_task(document: object) -> bool:
    """Whether the document of a file is a task."""
    return isinstance(document, dict) and document.get("schema") == TASK


def task_scenario(document: dict[str, Any], lines: Lines, path: Path) -> TaskScenario:
    """The scenario of a task, which was read from the file at `path`. The file of its cell must be below the folder of
    that file. Raises `DocumentError` with file and line, or `OSError`."""
    cell = document.get("cell", NOTHING)
    name = cell.get("file") if isinstance(cell, dict) else None
    if not isinstance(name, str):
        raise with_line(fault(document, ("cell",), "the file of a cell, as in {file: cell.yaml}"), lines)
    try:
        found = below(path.parent, name, "cell.file", ENDINGS, MAX_YAML_BYTES)
    except InputError as error:
        raise with_line(error, lines) from error
    try:
        given, cell_lines = parse_yaml(found.read_bytes())
        if given is None:
            raise empty(found, "a cell: YAML with schema: assur-cell/1")
    except DocumentError as error:
        raise error.relocated(lambda field: field if field == found.name else f"{found.name}: {field}") from error
    return _made(document, given, _Files(lines, found.name, cell_lines), path, found.parent)


def scenario_of_texts(task: bytes | None, cell: bytes, path: Path) -> TaskScenario:
    """The scenario of the text of a task and the text of its cell, or of a cell alone (None). Faults of the cell are
    those of `cell: `; the name of a file in the task does not count. Files that the cell names must be below the folder
    of `path`. Raises `DocumentError` with the line."""
    document, lines = (None, Lines()) if task is None else parse_yaml(task)
    if task is not None and not is_task(document):
        schema = document.get("schema", NOTHING) if isinstance(document, dict) else NOTHING
        allowed = f"{TASK}: the text beside a cell is one of its tasks"
        raise DocumentError("schema", schema, allowed, line_of("schema", lines))
    try:
        given, cell_lines = parse_yaml(cell)
    except DocumentError as error:
        raise error.relocated(lambda field: f"{OF_CELL}: {field}") from error
    return _made(document, given, _Files(lines, OF_CELL, cell_lines), path, path.parent)


def _made(document: dict[str, Any] | None, given: Any, files: _Files, path: Path, folder: Path) -> TaskScenario:
    """The scenario of a task (None: there is none yet) in the cell `given`, whose files are below `folder`. Raises
    `DocumentError` with the line."""
    try:
        with within_document(OF_CELL):
            given = with_files(given, folder)
        made = cell_alone(given) if document is None else joined(given, document)
    except InputError as error:
        raise files.placed(error) from error
    stated = document or {}
    about, expect = stated.get("about") or given.get("about") or "", stated.get("expect", {})
    return TaskScenario(path.stem, " ".join(about.split()), made.request, expect, path.parent, files.task, made, files)

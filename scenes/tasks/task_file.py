"""Task files: the scenario that a task in a YAML file and the cell in the file that it names make together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_YAML_BYTES
from assur.scenes.faults import NOTHING, DocumentError, documented, fault, raised_as
from assur.scenes.files import below, empty
from assur.scenes.proposals.files import answer_to_task
from assur.scenes.scenario import Scenario, with_files
from assur.scenes.schema.cell_file import CELL, TASK
from assur.scenes.set_values import GIVEN
from assur.scenes.tasks.cell_alone import cell_alone
from assur.scenes.tasks.joining import joined, valid_cell
from assur.scenes.tasks.next_task import EndState, joined_after, next_task
from assur.scenes.tasks.origins import CARRIED, OF_CELL, OF_TASK, Joined, within_document
from assur.scenes.text.yaml_text import Lines, line_of, parse_yaml, with_line

ENDINGS = (".yaml", ".yml")


@dataclass(frozen=True, eq=False)
class _Files:
    """Lines of a task's file (`task`) and of the file of its cell, with the name of that. `after`: the end of the plan
    where the task begins. `documents`: of the cell, and of the task (None: there is none yet)."""

    task: Lines
    name: str
    cell: Lines
    after: EndState | None
    documents: tuple[Any, Any] = (None, None)

    def placed(self, error: InputError) -> DocumentError:
        """A fault of the cell or the task, with the file and the line: fields of the task alone, those of the cell
        behind the name of its file."""
        return documented(error).relocated(self._field, self._line)

    def joined(self, given: Mapping[str, object] | None = None) -> Joined:
        """The request of the task, with values that are set last. Raises `DocumentError` with file and line."""
        cell, task = self.documents
        with raised_as(self.placed):
            if task is None:
                return cell_alone(cell)
            if self.after is None:
                return joined(cell, task, given)
            for path in given or {}:
                if (key := path.partition(".")[0].partition("[")[0]) == "start" or path == "parts":
                    raise DocumentError(f"{GIVEN}{path}", given[path], f"no {key}: it is that of the plan")  # type: ignore[index]
            follows = next_task(cell, task, self.after, given=given or {})
            return joined_after(cell, follows, self.after, task, given or {})

    def _field(self, field: str) -> str:
        inside = field.removeprefix(OF_TASK).removeprefix(".")
        if not field.startswith(OF_CELL):
            return inside or OF_TASK
        return f"{self.name}: {field.removeprefix(OF_CELL).removeprefix('.') or OF_CELL}"

    def _line(self, field: str) -> int | None:
        if field.startswith((GIVEN, CARRIED)):
            return None
        name, mark, inside = field.partition(": ")
        return line_of(inside, self.cell) if mark and name == self.name else line_of(field, self.task)


@dataclass(frozen=True, eq=False)
class TaskScenario(Scenario):
    """A scenario whose request is a task in a cell."""

    joined: Joined
    files: _Files
    given: Mapping[str, object] = field(default_factory=dict)
    """Values that were set in it, by their paths."""

    def placed(self, error: InputError) -> DocumentError:
        return self.files.placed(self.joined.relocated(error))

    def with_values(self, given: Mapping[str, object]) -> TaskScenario:
        made = self.files.joined(given)
        return replace(self, request=made.request, joined=made, given=given)

    def answered(self, answer: dict[str, Any]) -> dict[str, Any]:
        return answer_to_task(answer, self.joined, lambda values: self.files.joined({**self.given, **values}))


def is_task(document: object) -> bool:
    """Whether the document of a file is a task."""
    return isinstance(document, dict) and document.get("schema") == TASK


def is_cell(document: object) -> bool:
    """Whether a document is a cell."""
    return isinstance(document, dict) and document.get("schema") == CELL


def cell_document(document: dict[str, Any], lines: Lines, folder: Path) -> dict[str, Any]:
    """The cell in a file, with what the files hold that it names, which are below `folder`. Raises `DocumentError`
    with the line."""
    with raised_as(lambda error: with_line(error, lines)):
        found: dict[str, Any] = with_files(document, folder)
        valid_cell(found)
    return found


def task_scenario(
    document: dict[str, Any],
    lines: Lines,
    path: Path,
    after: EndState | None = None,
    given: Mapping[str, object] = MappingProxyType({}),
) -> TaskScenario:
    """The scenario of a task, which was read from the file at `path`. The file of its cell must be below the folder of
    that file. `after`: the end of the plan where the task begins; `given`: values that are set last, by their paths.
    Raises `DocumentError` with file and line, or `OSError`."""
    cell = document.get("cell", NOTHING)
    name = cell.get("file") if isinstance(cell, dict) else None
    if not isinstance(name, str):
        raise with_line(fault(document, ("cell",), "the file of a cell, as in {file: cell.yaml}"), lines)
    with raised_as(lambda error: with_line(error, lines)):
        found = below(path.parent, name, "cell.file", ENDINGS, MAX_YAML_BYTES)
    try:
        stated, cell_lines = parse_yaml(found.read_bytes())
        if stated is None:
            raise empty(found, "a cell: YAML with schema: assur-cell/1")
    except DocumentError as error:
        raise error.relocated(lambda field: field if field == found.name else f"{found.name}: {field}") from error
    return _made(document, stated, _Files(lines, found.name, cell_lines, after), path, found.parent, given)


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
        stated, cell_lines = parse_yaml(cell)
    except DocumentError as error:
        raise error.relocated(lambda field: f"{OF_CELL}: {field}") from error
    return _made(document, stated, _Files(lines, OF_CELL, cell_lines, None), path, path.parent)


def _made(
    document: dict[str, Any] | None,
    cell: Any,
    files: _Files,
    path: Path,
    folder: Path,
    given: Mapping[str, object] = MappingProxyType({}),
) -> TaskScenario:
    """The scenario of a task (None: there is none yet) in a cell, whose files are below `folder`, with values that are
    `given` by their paths. Raises `DocumentError` with the line."""
    with raised_as(files.placed), within_document(OF_CELL):
        cell = with_files(cell, folder)
    files = replace(files, documents=(cell, document))
    made, stated = files.joined(given), document or {}
    about, expect = stated.get("about") or cell.get("about") or "", stated.get("expect", {})
    return TaskScenario(
        path.stem, " ".join(about.split()), made.request, expect, path.parent, files.task, made, files, given
    )

"""The cell that the command `simulate` is given: a file, or a shipped cell, with values that are set in it."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.faults import choices, documented, fault, raised_as, together
from assur.scenes.files import is_file, is_json, json_in
from assur.scenes.scenario import with_files
from assur.scenes.scenarios import CELLS, yaml_in
from assur.scenes.schema.cell_file import CELL
from assur.scenes.set_values import GIVEN, Changed, unknown_paths
from assur.scenes.tasks.joining import FIELDS
from assur.scenes.tasks.task_file import is_cell
from assur.scenes.text.yaml_text import Lines, line_of, parse_yaml

Document = dict[str, Any]


@dataclass(frozen=True, eq=False)
class CellText:
    """A cell by its `name`: its `document`, with the values that were set in it, and the lines of its file."""

    name: str
    document: Document
    changed: Changed
    lines: Lines

    def located(self) -> AbstractContextManager[None]:
        """A fault of the cell inside is at its place in the file, or at the value that was set."""
        return raised_as(lambda error: documented(error).relocated(self.changed.field, self._line))

    def _line(self, field: str) -> int | None:
        known = not field.startswith(GIVEN) and field.partition(".")[0].partition("[")[0] in self.document
        return line_of(field, self.lines) if known else None


def shipped_cells() -> tuple[str, ...]:
    """The names of the shipped cells that have streams."""
    paths = sorted((CELLS / "shared").glob("*.yaml"))
    return tuple(path.stem for path in paths if "streams" in parse_yaml(path.read_bytes())[0])


def cell_named(text: str, given: Mapping[str, object]) -> CellText:
    """The cell in a file, YAML or JSON, or the shipped one of that name, with values that are `given` by their paths.
    Raises `InputError`, with the line, or `OSError`."""
    path = Path(text)
    if not is_file(path):
        if text not in shipped_cells():
            known = choices(shipped_cells(), text)
            raise InputError("CELL", text, f"a cell file that exists, or a shipped cell with streams: {known}")
        path = CELLS / "shared" / f"{text}.yaml"
    lines = Lines()
    if is_json(path):
        document = json_in(path, "a cell, as JSON")
    else:
        document, lines = parse_yaml(yaml_in(path))
    if not is_cell(document):
        where = document if isinstance(document, dict) else {}
        raise fault(where, ("schema",), f"{CELL}: a cell with streams is simulated, and no task or request")
    if unknown := unknown_paths(given, GIVEN, FIELDS):
        raise together(list(unknown.values()))
    changed = Changed(document, given, GIVEN)
    made = CellText(path.stem, changed.document, changed, lines)
    with made.located():
        return CellText(path.stem, with_files(changed.document, path.parent), changed, lines)

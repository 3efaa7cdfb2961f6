"""A scenario: a request with a name, where it was written, and what its answer must be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.catalogue import with_robots
from assur.scenes.faults import DocumentError, documented, together
from assur.scenes.files import with_meshes, with_plans
from assur.scenes.schema.request import RequestDocument
from assur.scenes.set_values import GIVEN, Changed, unknown_paths
from assur.scenes.streams.table import with_arrivals
from assur.scenes.text.yaml_text import Lines, line_of, with_line

OF_PLAN = "plan"
"""First part of the fields of a plan that is checked against a scenario; no key of a request."""
OF_REQUEST = "request."
"""What the fields of a request begin with in the file."""


@dataclass(frozen=True, eq=False)
class Scenario:
    """A scenario: its name is its file's, `folder` its file's folder, `lines` has the line of each value."""

    name: str
    about: str
    request: dict[str, Any]
    expect: dict[str, Any]
    folder: Path
    lines: Lines
    changed: Changed | None = field(default=None, kw_only=True)
    """The request with the values that were set in it, if some were."""

    @contextmanager
    def located(self) -> Iterator[None]:
        """An `InputError` about the request, raised inside, gets the line of the file."""
        try:
            yield
        except InputError as error:
            if error.field.split(".")[0] == OF_PLAN:
                raise  # about the plan that is checked: another file, whose lines are not known
            raise self.placed(error) from error

    def placed(self, error: InputError) -> DocumentError:
        """A fault of the request with its place in the file."""
        if self.changed is None:
            return with_line(error, self.lines, OF_REQUEST)
        return documented(error).relocated(self.changed.field, self._line)

    def _line(self, field: str) -> int | None:
        return None if field.startswith(GIVEN) else line_of(OF_REQUEST + field, self.lines)

    def with_values(self, given: Mapping[str, object]) -> Scenario:
        """The scenario with values that are set in its request by their paths; their faults are at `GIVEN`. Raises
        `InputError`."""
        changed = set_in_request(self.request, given)
        return replace(self, request=changed.document, changed=changed)

    def answered(self, answer: dict[str, Any]) -> dict[str, Any]:
        """The answer to the request, as one to the file: the paths of the change that it proposes are those that
        `with_values` takes."""
        return answer


def set_in_request(request: dict[str, Any], given: Mapping[str, object]) -> Changed:
    """A request in which values are set by their paths; their faults are at `GIVEN`. Raises `DocumentError`."""
    unknown = unknown_paths(given, GIVEN, [each.alias or name for name, each in RequestDocument.model_fields.items()])
    if unknown:
        raise together(list(unknown.values()))
    return Changed(request, given, GIVEN)


def with_files(request: Any, folder: Path) -> Any:
    """The request, or the cell, with the content of each file (of a robot, a plan, a mesh, arrivals) in place of its
    name; the files must be below `folder`."""
    return with_arrivals(with_meshes(with_plans(with_robots(request, folder), folder), folder), folder)

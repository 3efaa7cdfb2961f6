"""Where the values of a request were written: in the cell, in the task, or where they are set in one of these."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.faults import WHOLE, DocumentError, documented, dotted, raised_as
from assur.scenes.set_values import Changed

Document = dict[str, Any]
Path = tuple[str | int, ...]
OF_CELL, OF_TASK = "cell", "task"
"""First part of the fields of a fault: the document that it is in."""


CARRIED = "part of the plan that is continued, "
"""What is before the name, in faults, of a part that a task does not list, because it has it of a plan."""
PART = re.compile(rf"{OF_TASK}\.parts\[(\d+)\]\.?")


@dataclass(frozen=True)
class Carried:
    """What a task has of the plan that it continues: the names of `parts` that it does not list, by their numbers among
    all its parts; and when, s, a part is taken away."""

    parts: Mapping[int, str] = field(default_factory=dict)
    gone_at_s: Mapping[str, float] = field(default_factory=dict)


class Origins:
    """Where values of cell and task were set, and which parts are `carried` over from a plan: faults name these."""

    def __init__(self, carried: Carried | None = None) -> None:
        self.carried = carried or Carried()
        self._changed: list[tuple[str, Changed]] = []

    def changed(self, name: str, document: Document, values: Document, mark: str) -> Document:
        """The document of that name with these values."""
        made = Changed(document, values, mark)
        self._changed.insert(0, (f"{name}.", made))
        return made.document

    def located(self) -> AbstractContextManager[None]:
        """A fault inside is at the place where its value was set."""
        return raised_as(lambda error: documented(error).relocated(self.field))

    def field(self, field: str) -> str:
        """The place of a field of the cell or the task."""
        for name, changed in self._changed:
            if field.startswith(name) and (origin := changed.origin(field.removeprefix(name))) is not None:
                return origin
        part = PART.match(field)
        if part is not None and int(part[1]) in self.carried.parts:
            inside = field[part.end() :]
            return f"{OF_TASK}.{CARRIED}{self.carried.parts[int(part[1])]}{inside and f': {inside}'}"
        return field


def within_document(name: str) -> AbstractContextManager[None]:
    """A fault inside is one of the document of that name."""
    return raised_as(
        lambda error: documented(error).relocated(lambda field: name if field == WHOLE else f"{name}.{field}")
    )


class Joined:
    """A `request`, and where its parts were written: `origins`, from the path of a part to its path in the cell or the
    task, which begins with `cell` or `task`."""

    def __init__(
        self, request: Document, origins: dict[Path, Path], values: Origins, cell: Document, task: Document
    ) -> None:
        """`cell`, `task`: both documents, with the values that were set in them."""
        self.request, self.cell, self.task, self._values, self._paths = request, cell, task, values, origins

    @cached_property
    def _origins(self) -> dict[str, str]:
        return {dotted(path): dotted(origin) for path, origin in self._paths.items()}

    def relocated(self, error: InputError) -> DocumentError:
        """A fault of the request as one of the cell or the task."""
        return documented(error).relocated(self.origin)

    def origin(self, field: str) -> str:
        """The field of the cell or the task from which a field of the request came."""
        head = field
        while head not in self._origins and head:
            head = head[: max(head.rfind("."), head.rfind("["), 0)]
        return self._values.field(self._origins[head] + field[len(head) :]) if head else field

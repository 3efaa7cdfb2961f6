"""A cell that is read once and planned many times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from assur.api.python.answer import Answer
from assur.api.python.calls import plain_request
from assur.planner.errors import InputError

if TYPE_CHECKING:
    from assur.request import Request
    from assur.scenes.reading.cell import Kept
    from assur.scenes.tasks.kept_cell import KeptCellFile


class Cell:
    """Robot and surroundings of a cell file or of a request, kept for many plans.

    ``cell = assur.Cell(assur.load("cell.yaml"))``, then ``cell.plan(start=..., parts=[...], steps=[...])``: a task in a
    cell. ``cell = assur.Cell(request)``, then ``cell.plan(start=..., task=...)``: what a plan does not state it has of
    the request. The answer is the same as that of `assur.plan` for `cell.request` with the same arguments.

    Several threads may plan with one cell. It keeps what is made of robot and surroundings as long as it is there.
    """

    def __init__(self, cell: Mapping[str, Any] | Request) -> None:
        """`cell`: the document of a cell (``schema: assur-cell/1``), or a request. Checks its form; names are looked up
        and meshes read with the first plan. Raises `InputError` naming the field that is not right; its `errors` are
        all fields that are not."""
        from assur.scenes.requests import validate
        from assur.scenes.schema.normal import plain
        from assur.scenes.tasks.kept_cell import KeptCellFile
        from assur.scenes.tasks.task_file import is_cell

        document = plain(plain_request(cell))
        self._file: KeptCellFile | None = None
        self._own: Kept = {}
        if is_cell(document):
            self._file = KeptCellFile(document)
        else:
            self._valid = validate(document)
        self._document: dict[str, Any] = document

    @property
    def document(self) -> dict[str, Any]:
        """The document of the cell, or the request, as it is planned. Change a copy, not this."""
        return self._document

    @property
    def file(self) -> KeptCellFile | None:
        """The cell file that is kept; None: this is a request."""
        return self._file

    def plan(
        self,
        *,
        start: object = None,
        parts: Sequence[object] | None = None,
        steps: Sequence[object] | None = None,
        task: object = None,
        options: object = None,
        set: Mapping[str, object] | None = None,  # noqa: A002 as on the command line
        certificate: Literal["full", "digest"] = "full",
    ) -> Answer:
        """The answer to `request` with the same arguments; `certificate`: as `assur.plan`.

        Raises `InputError` naming the field that is not right; its `errors` are all fields that are not. Of a cell file
        the fields are those of the task, and those of the cell begin with ``cell``.
        """
        from assur.scenes.requests import changed_cell, plan_cell

        given = {"start": start, "parts": parts, "steps": steps, "task": task, "options": options, "set": set}
        if self._file is not None:
            stated = self._task(given)
            made, answer = self._file.plan(stated, certificate=certificate)
            return Answer.made(answer, made.request, (self._document, stated))
        document, own = self._changed(given), self._document
        changes = {key: value for key, value in document.items() if key not in own or value is not own[key]}
        cell = changed_cell(own, self._valid, changes, self._own)
        return Answer.made(plan_cell(cell, certificate=certificate), document)

    def request(
        self,
        *,
        start: object = None,
        parts: Sequence[object] | None = None,
        steps: Sequence[object] | None = None,
        task: object = None,
        options: object = None,
        set: Mapping[str, object] | None = None,  # noqa: A002 as on the command line
    ) -> dict[str, Any]:
        """The document of a request. What is built of `assur.request` may stand in place of plain values.

        Of a cell file: that of the task with this `start`, these `parts`, `steps` and `options`, where values of the
        cell are `set` by their paths. Of a request: the same request with this `start` and this `task`, and values of
        it that are `set`. ``set={"options.seed": 3, "bodies.table.pose.at_mm": [350, -200, 25]}``: the parts of a path
        are fields, and an entry of a list by its name or its number. Later paths count over earlier ones, and all over
        `start` and `task`. Raises `InputError` for a path that leads nowhere, and of a cell file for all that is wrong
        in the form of the task.
        """
        given = {"start": start, "parts": parts, "steps": steps, "task": task, "options": options, "set": set}
        return self._changed(given) if self._file is None else self._file.joined(self._task(given)).request

    def _task(self, given: Mapping[str, object]) -> dict[str, Any]:
        """The document of the task with these fields."""
        from assur.scenes.schema.cell_file import TASK

        stated = {key: _plain(value, key) for key, value in given.items() if value is not None}
        if "task" in stated:
            raise InputError("task", given["task"], "no task: this is a cell file, whose plans have parts and steps")
        return {"schema": TASK, **stated}

    def _changed(self, given: Mapping[str, object]) -> dict[str, Any]:
        """The request with these fields."""
        from assur.scenes.set_values import with_values

        for key in ("parts", "steps", "options"):
            if given[key] is not None:
                allowed = f"no {key}: this is a request, whose plans have a start, a task and values that are set"
                raise InputError(key, given[key], allowed)
        parts = {key: _plain(given[key], key) for key in ("start", "task") if given[key] is not None}
        document = {**self._document, **parts}
        return document if given["set"] is None else with_values(document, _plain(given["set"], "set"))


def _plain(value: object, name: str) -> Any:
    """The argument of that name, or a list of values, that may be built of `assur.request`, as plain data."""
    from assur.scenes.schema.normal import plain

    each = [plain_request(item) for item in value] if isinstance(value, list | tuple) else plain_request(value)
    return plain({name: each})[name]

"""A cell that is read once and planned many times."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

from assur.api.python.answer import Answer
from assur.api.python.calls import plain_request

if TYPE_CHECKING:
    from assur.request import Request
    from assur.scenes.reading.cell import Kept


class Cell:
    """Robot and surroundings of a request, kept for plans with other starts, tasks and options.

    ``cell = assur.Cell(request)``, then ``cell.plan(start=..., task=...)``. What a plan does not state it has of the
    request. The answer is the same as that of `assur.plan` for `cell.request` with the same arguments.

    Several threads may plan with one cell. It keeps what is made of robot and surroundings as long as it is there.
    """

    def __init__(self, request: Mapping[str, Any] | Request) -> None:
        """Checks the form of the request; names are looked up and meshes read with the first plan. Raises `InputError`
        naming the field that is not right; its `errors` are all fields that are not."""
        from assur.scenes.requests import validate
        from assur.scenes.schema.normal import plain

        document = plain(plain_request(request))
        self._valid = validate(document)
        self._document: dict[str, Any] = document
        self._own: Kept = {}

    def plan(
        self,
        *,
        start: object = None,
        task: object = None,
        set: Mapping[str, object] | None = None,  # noqa: A002 as on the command line
        certificate: Literal["full", "digest"] = "full",
    ) -> Answer:
        """The answer to `request(start=start, task=task, set=set)`; `certificate`: as `assur.plan`.

        Raises `InputError` naming the field that is not right; its `errors` are all fields that are not.
        """
        from assur.scenes.requests import changed_cell, plan_cell

        document, own = self.request(start=start, task=task, set=set), self._document
        changes = {key: value for key, value in document.items() if key not in own or value is not own[key]}
        cell = changed_cell(own, self._valid, changes, self._own)
        return Answer.made(plan_cell(cell, certificate=certificate), document)

    def request(
        self,
        *,
        start: object = None,
        task: object = None,
        set: Mapping[str, object] | None = None,  # noqa: A002 as on the command line
    ) -> dict[str, Any]:
        """The document of the request with this start, this task, and values that are set by their paths.

        ``set={"options.seed": 3, "bodies.table.pose.at_mm": [350, -200, 25]}``: the parts of a path are fields, and an
        entry of a list by its name or its number. Later paths count over earlier ones, and all over `start` and `task`.
        What is built of `assur.request` may stand in place of plain values. Raises `InputError` for a path that leads
        nowhere.
        """
        from assur.scenes.set_values import with_values

        given = {"start": start, "task": task}
        parts = {key: _plain(value) for key, value in given.items() if value is not None}
        if set is None:
            return {**self._document, **parts}
        return with_values({**self._document, **parts}, _plain(set))


def _plain(value: object) -> Any:
    """A value, or a list of values, that may be built of `assur.request`, as plain data."""
    from assur.scenes.schema.normal import plain

    return plain([plain_request(each) for each in value] if isinstance(value, list | tuple) else plain_request(value))

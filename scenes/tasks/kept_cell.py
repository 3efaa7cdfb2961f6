"""A cell file that is read and built once, and planned with many tasks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from assur.planner.errors import FaultError, InputError
from assur.scenes.bounds import MAX_BODIES
from assur.scenes.faults import DocumentError, Gathered, Refused, documented, located
from assur.scenes.proposals.files import answer_to_task
from assur.scenes.requests import cell_of, plan_document
from assur.scenes.schema.read import read_fields
from assur.scenes.schema.request import RequestDocument
from assur.scenes.schema.shapes import BodyDocument
from assur.scenes.tasks.joining import CellFile, joined
from assur.scenes.tasks.origins import OF_TASK, Joined

if TYPE_CHECKING:
    from assur.planner.geometry.shapes import Body
    from assur.scenes.reading.cell import Depends, Kept, Surroundings

STATED_BY_CELL = ("robot", "frames", "bodies", "neighbours", "execution", "carry")
"""Fields of a request that the cell states, but for the parts among the bodies."""
STATED_BY_TASK = ("start", "task", "options")
"""Fields of a request that are of the task."""


class KeptCellFile:
    """A cell file, with what is made of its robot and surroundings, for many tasks.

    Of a task that sets no values of the cell only start, parts, steps and options are read and built. Several threads
    may use one at the same time: at worst, both make the same.
    """

    def __init__(self, document: object) -> None:
        """Raises `DocumentError` for a cell whose form has a fault. Otherwise names are looked up, and meshes read,
        with the first task."""
        self.file = CellFile(document)
        written = self.file.written
        stated = {key: written[key] for key in STATED_BY_CELL if key in written}
        self.alone = RequestDocument.of_cell(read_fields(RequestDocument, stated))
        self._around: Kept = {}
        self._last: tuple[str, Depends, Surroundings] | None = None

    def check(self) -> None:
        """Reads and builds all that the cell has: names, meshes, kinds, positions and slots. Raises `DocumentError` at
        the fields of the cell."""
        from assur.scenes.reading import bodies
        from assur.scenes.reading.cell import around, start_of_drift
        from assur.scenes.streams.carriers import check_on_kind

        cell, faults = self.file.valid, Gathered()
        with located(self.file.written):
            made = around(self.alone, (None, start_of_drift(self.alone, 0.0)), faults)
            solids: dict[str, Body] = {}
            for name, kind in cell.kinds.items():
                with faults.part("kinds", name):
                    solids[name] = bodies.solid(name, kind.shape)
            for name, grid in cell.slots.items():
                if grid.kind is not None:
                    with faults.part("slots", name):
                        check_on_kind(grid, cell, solids)
            for key, poses in (("positions", cell.positions), ("slots", cell.slots)):
                for name, pose in poses.items():
                    with faults.part(key, name):
                        bodies.named(pose, made.frames, made.places)
            try:
                read_fields(RequestDocument, {"options": self.file.written.get("options", {})})
            except InputError as error:
                faults.add(error)
            faults.settle()

    def joined(self, task: object) -> Joined:
        """The request of a task. Raises `DocumentError`; fields of the cell begin with `cell`."""
        try:
            return joined(self.file, task)
        except InputError as error:
            raise of_task(error) from error

    def plan(self, task: object, **how: Any) -> tuple[Joined, dict[str, Any]]:
        """The request of a task, and its answer, the same as that of `plan_document` for that request; `how`: as there.

        Raises `DocumentError` at the fields of the task; those of the cell begin with `cell`.
        """
        made = self.joined(task)
        try:
            answer = plan_document(made.request, task=TaskOfCell(self, made), **how)
        except InputError as error:
            raise of_task(made.relocated(error)) from error
        return made, answer_to_task(answer, made, lambda values: joined(self.file, task, values))

    def surroundings(self, task: object) -> Surroundings:
        """The robot and what is around it at the start of a task, with its parts. Raises `DocumentError`, as `plan`."""
        from assur.scenes.reading.cell import depends_of

        made = self.joined(task)
        of_cell = TaskOfCell(self, made)
        request = of_cell.read(("start",))
        around = None if request is None else of_cell.around(request)
        if request is None or around is None:
            try:
                cell_of(made.request)
            except InputError as error:
                raise of_task(made.relocated(error)) from error
            raise FaultError("a task that could not be read in a cell has no fault")
        return around[depends_of(request)]

    def around(self, request: RequestDocument, parts: Sequence[BodyDocument], depends: Depends) -> Surroundings | None:
        """Robot and surroundings of the request of a task with these parts; None where something of them has a
        fault."""
        last, (held, drifts_from_s) = self._last, depends
        if last is not None and last[1] == depends and last[0] == request.surroundings:
            return last[2]
        from assur.scenes.reading.cell import around, start_of_drift

        own = held if held is not None and any(body.name == held for body in self.alone.bodies) else None
        of_cell = own, None if drifts_from_s is None else start_of_drift(self.alone, drifts_from_s)
        cell = self._around.get(of_cell)
        if cell is None:
            faults = Gathered()
            cell = around(self.alone, of_cell, faults)
            if faults.faults:
                return None
            self._around = {of_cell: cell}
        try:
            made = cell.with_parts(parts, depends)
        except (Refused, InputError):
            return None
        self._last = request.surroundings, depends, made
        return made


def of_task(error: InputError) -> DocumentError:
    """A fault as one of the task, where a fault of the task has no first part."""
    return documented(error).relocated(lambda field: field.removeprefix(f"{OF_TASK}."))


class TaskOfCell:
    """A task in a cell that is kept: what has to be read and built of it.

    Where something has a fault, nothing is: the request is then read and built as a whole, which reports all faults at
    their fields.
    """

    def __init__(self, kept: KeptCellFile, made: Joined) -> None:
        self._kept, self._request = kept, made.request
        self._is_kept = made.cell is kept.file.written
        """Whether the task sets no values of the cell."""
        self._parts: Sequence[BodyDocument] | None = None

    def read(self, fields: Sequence[str] = STATED_BY_TASK) -> RequestDocument | None:
        """The request in SI, with its bodies and of what the task states these `fields`; None where it has to be read
        as a whole."""
        request, alone = self._request, self._kept.alone
        if not self._is_kept or len(request["bodies"]) > MAX_BODIES:
            return None
        stated = {key: request[key] for key in fields}
        try:
            found = read_fields(RequestDocument, {**stated, "bodies": request["bodies"][len(alone.bodies) :]})
        except InputError:
            return None
        self._parts = found.pop("bodies")
        return alone.with_task(found, self._parts)

    def around(self, request: RequestDocument) -> Kept | None:
        """Robot and surroundings of the request that was read; None where they have to be built as a whole."""
        if self._parts is None:
            return None
        from assur.scenes.reading.cell import depends_of

        depends = depends_of(request)
        found = self._kept.around(request, self._parts, depends)
        return None if found is None else {depends: found}

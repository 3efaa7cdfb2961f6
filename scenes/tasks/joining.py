"""A cell file and a task file are read, and make a request together.

The cell and the task stay as they were written, in their units; the request is made of their own values. So a fault of
the request is a fault at the place in the cell or the task from which the value came (`Joined.relocated`).
"""

from __future__ import annotations

from collections.abc import Mapping

from assur.planner.errors import InputError
from assur.scenes.faults import DocumentError, Gathered, together, written_key
from assur.scenes.schema.cell_file import TASK, CellDocument, TaskDocument
from assur.scenes.schema.in_parts import Unread, in_parts
from assur.scenes.schema.normal import plain
from assur.scenes.schema.read import read
from assur.scenes.schema.sizes import check_sizes
from assur.scenes.set_values import GIVEN, unknown_paths
from assur.scenes.tasks.origins import OF_CELL, OF_TASK, Carried, Document, Joined, Origins, within_document
from assur.scenes.tasks.request_of_task import RequestOfTask
from assur.scenes.units import si_key

OWN = ("start", "parts", "steps", "options")
"""Fields of a task whose values can be set there."""
FIELDS = tuple(field.alias or name for name, field in CellDocument.model_fields.items())
"""Fields of a cell."""

ANY_TASK = {"schema": TASK, "start": {"joints": {}}, "steps": [{"move": {"to": {}}}]}
"""A task for a cell whose faults alone are wanted."""


class CellFile:
    """The document of a cell, read once for many tasks: valid by its model, and as it was `written`."""

    def __init__(self, document: object) -> None:
        """Raises `DocumentError`, with all faults of a cell whose form has one."""
        self.written: Document = plain(document)
        self.valid: CellDocument = valid_cell(self.written)


def valid_cell(document: object) -> CellDocument:
    """A cell by its model. Raises `DocumentError`, with all faults of a cell whose form has one."""
    try:
        valid: CellDocument = read(CellDocument, document)
    except DocumentError as form:
        try:
            joined(document, ANY_TASK)
        except DocumentError as error:
            every = [each for each in (error, *error.more) if each.field.startswith(f"{OF_CELL}.")]
            found = [DocumentError(each.field, each.value, each.allowed) for each in every]
            others = [each.relocated(lambda field: field.removeprefix(f"{OF_CELL}.")) for each in found]
            raise together([form, *others]) from form
        raise
    return valid


def joined(
    cell: object, task: object, given: Mapping[str, object] | None = None, carried: Carried | None = None
) -> Joined:
    """The request of a task in a cell, a document or a `CellFile`. Raises `DocumentError` whose fields begin with
    `cell`, `task`, or `GIVEN`.

    `given`: values that are set last, by their paths. A path that begins with a field of `OWN` is one of the task, but
    for an option that the cell states; all others are paths of the cell.
    """
    origins = Origins(carried)
    with origins.located():
        with within_document(OF_TASK):
            asked = plain(task)
        with within_document(OF_CELL):
            written = cell.written if isinstance(cell, CellFile) else plain(cell)
        of_cell, of_task = shared(given or {}, written)
        if of_task and isinstance(asked, dict):
            asked = origins.changed(OF_TASK, asked, of_task, GIVEN)
        faults = Gathered()
        asked = _right(OF_TASK, TaskDocument, asked, faults)
        changed = written
        for values, mark, more in ((asked.get("set", {}), f"{OF_TASK}.set.", ()), (of_cell, GIVEN, OWN)):
            if values and isinstance(changed, dict) and not isinstance(values, Unread):
                unknown = unknown_paths(values, mark, (*FIELDS, *more))
                for fault in unknown.values():
                    faults.add(fault)
                values = {path: value for path, value in values.items() if path not in unknown}
                try:
                    changed = origins.changed(OF_CELL, changed, values, mark)
                except InputError as error:
                    faults.add(error)
                    faults.settle()
        if changed is not written or not isinstance(cell, CellFile):
            changed = _right(OF_CELL, CellDocument, changed, faults)
        return RequestOfTask(changed, asked, origins, faults).made()


def _right(name: str, model: type[CellDocument | TaskDocument], document: object, faults: Gathered) -> Document:
    """The document of that name, with `Unread` in place of its parts that have a fault, which `faults` get. Raises
    `DocumentError` where no part can be read."""
    try:
        with within_document(name):
            read(model, document)
    except DocumentError as error:
        faults.add(error)
        try:
            check_sizes(model, document)
        except DocumentError:  # what is too long is not looked through
            faults.settle()
        right = in_parts(model, document, as_written=True) if isinstance(document, dict) else None
        if right is None or error.field == f"{name}.schema":
            faults.settle()
        return right or {}
    return document  # type: ignore[return-value] # its model has read it


def shared(given: Mapping[str, object], cell: object) -> tuple[Document, Document]:
    """The values that are set in the cell, and those that are set in the task."""
    own = cell.get("options") if isinstance(cell, dict) else None
    stated = own if isinstance(own, dict) else {}
    of_cell: Document = {}
    of_task: Document = {}
    for path, value in given.items():
        first, _, rest = path.partition(".")
        key = rest.partition(".")[0]
        in_cell = first == "options" and written_key(stated, (si_key(key) or (key,))[0]) is not None
        (of_task if first.partition("[")[0] in OWN and not in_cell else of_cell)[path] = value
    return of_cell, of_task

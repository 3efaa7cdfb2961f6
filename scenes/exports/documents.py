"""The public functions of this folder, for the service, the command line and Python: documents in, documents out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.faults import fault
from assur.scenes.requests import cell_of, read_plan
from assur.scenes.scenario import with_files
from assur.scenes.schema.export import ExportDocument, ForeignTrajectoryDocument
from assur.scenes.schema.read import read

if TYPE_CHECKING:
    from assur.scenes.reading.cell import Cell

TOLERANCE = ("start_tolerance_s", "start_tolerance_ms")


def export_document(request: object, plan: object, options: object, *, folder: Path | None = None) -> dict[str, Any]:
    """The export of a planned answer, whose certificate may be a digest, with the `options` of docs/export.md.

    `folder`: below which the request may name files. Raises `InputError` naming the field: for what is wrong with a
    document, for what the answer repeats of request and motion and is not so, and for a motion that cannot be proved on
    the required grid. Other claims of the answer (margins, contacts, loads) and its certificate are not judged: the
    motion is proved anew, and the export has none of them. `check_document` judges them.
    """
    document: Any = request if folder is None else with_files(request, folder)
    return export_cell(cell_of(document), document, plan, options)


def export_cell(cell: Cell, request: Any, plan: object, options: object) -> dict[str, Any]:
    """The same for a cell that has been read; `request`: that of the cell, with what files hold in it."""
    from assur.scenes.exports.export import exported, in_words
    from assur.scenes.exports.handover import AFTER, handed_over

    running = options.get(AFTER) if isinstance(options, dict) else None
    # a plan file is read by its own rules, and keeps its units
    how: ExportDocument = read(ExportDocument, options if running is None else {**options, AFTER: {}})  # type: ignore[dict-item]
    made, untrue, _ = read_plan(cell, plan, proved_anew=True)
    if untrue:
        raise InputError("plan", "this answer", f"one that is right: {in_words(untrue)}")
    try:
        made, handover = handed_over(cell, made, how, running)
        return dict(exported(cell, request, made, how, handover))
    except InputError as error:
        if error.field not in ExportDocument.model_fields:
            raise
        raise fault(options, (error.field,), error.allowed) from error  # by the key that is written: tick_ms for tick_s


def check_trajectory_document(
    request: object, given: object, plan: object | None = None, *, folder: Path | None = None
) -> dict[str, Any]:
    """The verdict on a trajectory in a file: `given` is {"file": TEXT, "format": "csv" or "ros2", ...}
    (docs/export.md). `plan`: a planned answer whose legs it has; None: it is one motion in travel.

    `folder`: below which the request may name files. Raises `InputError` naming the field, in files with the line.
    """
    document: Any = request if folder is None else with_files(request, folder)
    return check_trajectory_cell(cell_of(document), document, given, plan)


def check_trajectory_cell(cell: Cell, request: Any, given: object, plan: object | None = None) -> dict[str, Any]:
    """The same for a cell that has been read; `request`: that of the cell, with what files hold in it."""
    from assur.scenes.exports.foreign import verdict

    how: ForeignTrajectoryDocument = read(ForeignTrajectoryDocument, given)
    if how.start_tolerance_s is not None:
        execution = {key: value for key, value in (request.get("execution") or {}).items() if key not in TOLERANCE}
        request = {**request, "execution": {**execution, TOLERANCE[0]: how.start_tolerance_s}}
        cell = cell_of(request)
    made = None if plan is None else read_plan(cell, plan, proved_anew=True)[0]
    return dict(verdict(cell, request, how, made))


def export_schemas() -> tuple[dict[str, Any], dict[str, Any]]:
    """JSON Schemas of the options of an export, and of a trajectory to be checked."""
    return ExportDocument.model_json_schema(), ForeignTrajectoryDocument.model_json_schema()

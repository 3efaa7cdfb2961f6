"""Values that are changed in the texts of a scenario, or of a task and its cell: by a proposed change of the request,
or because a thing in the drawing was moved."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal

from pydantic import Field

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.scene import Move, Pick, Place, Trace
from assur.scenes import bounds
from assur.scenes.faults import choices, written_key
from assur.scenes.proposals.edits import Text, value_at
from assur.scenes.proposals.files import origins_of, part_of_transfer
from assur.scenes.proposals.values import ENDS, si_number, written_number
from assur.scenes.reading.cell import Cell
from assur.scenes.requests import cell_of
from assur.scenes.scenario import Scenario
from assur.scenes.schema.model import Coordinate, Document
from assur.scenes.schema.normal import normal
from assur.scenes.schema.read import read
from assur.scenes.set_values import Changed
from assur.scenes.tasks.origins import OF_CELL, OF_TASK, within_document
from assur.scenes.tasks.task_file import TaskScenario

Texts = dict[str, str]
"""The `text` of a scenario or a task, and the text of its `cell`."""
Again = Callable[[Texts], Scenario]
"""Reads texts. Raises `InputError`."""
NAMES = {OF_TASK: "text", OF_CELL: "cell"}
SMALL_M = 1e-9
"""Places that differ by no more are the same, m."""


def with_request_values(scenario: Scenario, texts: Texts, values: Mapping[str, object], again: Again) -> Texts:
    """The texts with `values` of their request, by their paths. They mean the request with these values, and no other.
    Raises `InputError` where no change of the texts does that."""
    if isinstance(values, dict) and len(values) > bounds.MAX_STEPS:
        raise InputError("set", f"{len(values)} values", f"at most {bounds.MAX_STEPS} values")
    changed = Changed(scenario.request, values, "set.")
    with changed.located():
        wanted = normal(changed.document)
    part = ""
    if isinstance(scenario, TaskScenario):
        part = part_of_transfer(scenario.joined, changed)
        ways = [[(NAMES.get(head), *rest) for head, *rest in each] for each in origins_of(scenario.joined, changed)]
    else:
        ways = [[("text", f"request.{field}", value_at(changed.document, field)) for field in changed.fields]]
    for way in ways:
        try:
            made = dict(texts)
            for name, field, value in way:
                made[str(name)] = Text(made[str(name)]).with_value(str(field), value).content
            if normal(again(made).request) == wanted:
                return made
        except (InputError, KeyError):
            continue
    allowed = "values that can be written in the text without a change of anything else"
    raise InputError("set", dict(values), f"{allowed}: these are for {part}" if part else allowed)


class ShiftDocument(Document):
    """A thing of the drawing, a body by its name or a step by its number, that is moved in the plane by so much, along
    the axes of the frame in which it is. Its place is then a multiple of `grid_m`."""

    kind: Literal["body", "step"]
    name: Annotated[str, Field(max_length=255)]
    by_m: Annotated[list[Coordinate], Field(min_length=2, max_length=2)]
    grid_m: Annotated[float, Field(ge=bounds.LEAST, le=bounds.FAR_M)] = 1e-3


def with_shift(scenario: Scenario, texts: Texts, cell: Cell, shift: object, again: Again) -> Texts:
    """The texts in which a thing of a cell, which is that of the scenario, was moved: the place that is written for it
    is another one. Raises `InputError` where its place is not written, or where it would not go there."""
    with within_document("move"):
        stated: ShiftDocument = read(ShiftDocument, shift)
    field, own, (frame, pose) = _place(scenario.request, cell, stated)
    base = pose.yaw - _yaw(own)
    key = written_key(own, "at_m") or "at_mm"
    name, at = _origin(scenario, f"{field}.{key}")
    if name not in texts:
        raise _not_moved(stated, "a thing of this text: this one is written in the file of the cell, which is not here")
    text = Text(texts[name])
    found, rest = text.known(at)
    point = [0, 0, 0] if rest in (".at_m", ".at_mm") else None if rest else value_at(text.document, found)
    if not (isinstance(point, list) and len(point) == 3):
        raise _not_moved(stated, "a thing whose place is written as three numbers")
    unit = at if rest else found
    turned = _turned(stated.by_m, -base)
    there = [_on_grid(si_number(value, unit), by, stated.grid_m) for value, by in zip(point, turned, strict=False)]
    for i, value in enumerate(there):
        if value is not None and not rest:
            text = text.with_value(f"{found}[{i}]", written_number(value, unit))
    if rest and any(value is not None for value in there):
        whole = [0 if value is None else written_number(value, unit) for value in (*there, None)]
        text = text.with_value(at, whole)
    made = {**texts, name: text.content}
    by = [0.0 if new is None else new - si_number(old, unit) for new, old in zip(there, point, strict=False)]
    x, y = _turned(by, base)
    changed = again(made)
    with changed.located():
        after = cell_of(changed.request, folder=changed.folder)
    if not _is_at(_place(changed.request, after, stated)[2], (frame, replace(pose, x=pose.x + x, y=pose.y + y))):
        raise _not_moved(stated, "a thing whose place is that which is written: this one depends on others")
    return made


def _place(request: dict[str, Any], cell: Cell, shift: ShiftDocument) -> tuple[str, dict[str, Any], tuple[str, Pose]]:
    """The field of the place of a thing, the place as the request has it, and frame and pose that it is."""
    if shift.kind == "body":
        bodies = request.get("bodies", [])
        number = next((i for i, body in enumerate(bodies) if body["name"] == shift.name), None)
        if number is None:
            raise _not_moved(
                shift, f"a body of the cell, or a part: {choices([b['name'] for b in bodies], shift.name)}"
            )
        if "pose" not in bodies[number]:
            raise _not_moved(shift, "a body with a pose: this one is in the gripper")
        body = cell.scene.index[shift.name]
        return f"bodies[{number}].pose", bodies[number]["pose"], (body.frame, body.pose)
    steps = cell.scene.task
    if not (shift.name.isdecimal() and int(shift.name) < len(steps)):
        raise _not_moved(shift, f"the number of a step, 0 to {len(steps) - 1}")
    step, stated = steps[int(shift.name)], request["task"][int(shift.name)]
    if isinstance(step, Pick):
        raise _not_moved(shift, f"a step with a place of its own: move {step.part}, which it picks")
    if isinstance(step, Trace) or (isinstance(step, Move) and step.path):
        raise _not_moved(shift, "a step without a path, whose points are written one by one")
    to = step.to if isinstance(step, Place) else step.target
    kind = next(each for each in ENDS if each in stated)
    return f"task[{int(shift.name)}].{kind}.{ENDS[kind]}", stated[kind][ENDS[kind]], (to.frame, to.pose)


def _not_moved(shift: ShiftDocument, allowed: str) -> InputError:
    return InputError("move.name", shift.name, allowed)


def _origin(scenario: Scenario, field: str) -> tuple[str, str]:
    """The text in which a field of the request is written, and its field there."""
    if not isinstance(scenario, TaskScenario):
        return "text", f"request.{field}"
    head, _, inside = scenario.joined.origin(field).partition(".")
    return NAMES[head], inside


def _yaw(place: dict[str, Any]) -> float:
    key = written_key(place, "yaw_rad")
    return 0.0 if key is None else si_number(place[key], key)


def _turned(by: list[float], yaw: float) -> tuple[float, float]:
    x, y = by
    return math.cos(yaw) * x - math.sin(yaw) * y, math.sin(yaw) * x + math.cos(yaw) * y


def _on_grid(value: float, by: float, grid: float) -> float | None:
    """The multiple of the grid to which a coordinate is moved, m; None: it stays."""
    return None if abs(by) < grid / 2 else round(round((value + by) / grid) * grid, 12)


def _is_at(place: tuple[str, Pose], wanted: tuple[str, Pose]) -> bool:
    (frame, pose), (other, there) = place, wanted
    return frame == other and all(abs(getattr(pose, k) - getattr(there, k)) <= SMALL_M for k in ("x", "y", "z", "yaw"))

"""Faults of names in a request whose form has faults: every part without one is read, and its names are looked up."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from assur.planner.errors import InputError
from assur.planner.model.deadline import Deadline, OutOfTimeError
from assur.scenes.faults import DocumentError, documented
from assur.scenes.not_requests import refuse_other
from assur.scenes.schema.frames import FrameDocument
from assur.scenes.schema.in_parts import Unread, in_parts, right_options
from assur.scenes.schema.read import read
from assur.scenes.schema.request import SCHEMA, ExecutionDocument, OptionsDocument, RequestDocument
from assur.scenes.schema.robots import NeighbourDocument, RobotDocument, StartDocument
from assur.scenes.schema.shapes import BodyDocument
from assur.scenes.schema.sizes import check_sizes
from assur.scenes.schema.task import StepDocument

LONGEST_S = 1.0
"""Longest time for which more faults are searched in a request that is refused anyway, s."""


@dataclass(frozen=True, eq=False)
class PartlyRead:
    """What could be read of a request; `options`: those that could."""

    robot: RobotDocument | Unread
    start: StartDocument | Unread
    frames: Mapping[str, FrameDocument | Unread]
    bodies: Sequence[BodyDocument | Unread]
    neighbours: Sequence[NeighbourDocument | Unread]
    task: Sequence[StepDocument | Unread]
    options: OptionsDocument
    execution: ExecutionDocument | Unread

    @property
    def depends(self) -> tuple[str | None, float]:
        """The part that the gripper holds at the start, and the time of the start, s (0 where it is not known)."""
        if isinstance(self.start, Unread):
            return self.start.text("holding", "part") or None, 0.0
        return None if self.start.holding is None else self.start.holding.part, self.start.at_s


def _partly_read(document: dict[str, Any]) -> PartlyRead | None:
    """What can be read of a request; None where nothing can."""
    found = in_parts(RequestDocument, document)
    if found is None:
        return None
    if isinstance(found["options"], Unread):
        found["options"] = right_options(found["options"].written)
    start, robot = found["start"], found["robot"]
    holds = isinstance(start, Unread) and not start.text("holding", "part")

    def looked_up(body: BodyDocument | Unread) -> BodyDocument | Unread:
        """A body whose place, and whose files, are in the request."""
        if isinstance(body, Unread):
            return body
        in_file = body.shape.mesh is not None and body.shape.mesh.file is not None
        return Unread({"name": body.name}) if in_file or (holds and body.pose is None) else body

    found["bodies"] = [looked_up(body) for body in found["bodies"]]
    found["robot"] = Unread() if isinstance(robot, RobotDocument) and robot.file is not None else robot
    return PartlyRead(**{name: found[name] for name in PartlyRead.__dataclass_fields__})


def other_faults(document: object, folder: Path | None = None) -> list[DocumentError]:
    """What has no meaning (names, places, joints) in those parts of a request whose form has no fault, for one that has
    faults of form. `folder`: below which it may name files; where a file has a fault, that is the only one. None where
    reading takes more than `LONGEST_S`, as some meshes do."""
    from assur.scenes.reading.cell import look_up
    from assur.scenes.scenario import with_files

    schema = document.get("schema", SCHEMA) if isinstance(document, dict) else None
    if not isinstance(document, dict) or not isinstance(schema, str) or schema != SCHEMA:
        return []
    try:
        refuse_other(document)
        whole = document if folder is None else with_files(document, folder)
        check_sizes(RequestDocument, whole)
        request = _partly_read(whole)
        if request is not None:
            with Deadline(time.perf_counter(), LONGEST_S):
                look_up(document, request)
    except InputError as error:
        return [documented(error)]
    except OutOfTimeError:  # the faults of form are reported without the others
        return []
    return []


def faults_of(document: dict[str, Any]) -> list[DocumentError]:
    """All faults of a request in which `Unread` is in place of parts that have a fault: none of these is one again."""
    found = other_faults(document)
    try:
        read(RequestDocument, document)
    except DocumentError as error:
        found.insert(0, error)
    every = [each for error in found for each in (error, *error.more) if not _is_unread(each.value)]
    return [DocumentError(each.field, each.value, each.allowed) for each in every]


def _is_unread(value: object) -> bool:
    """Whether a value is `Unread`, or something in it is."""
    if isinstance(value, dict | list):
        return any(map(_is_unread, value.values() if isinstance(value, dict) else value))
    return isinstance(value, Unread)

"""Steps and start of a task file for its schema: those of a request, but for what a cell states in their place. Values
are read with the request that a cell and a task make."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, Field, GetJsonSchemaHandler, TypeAdapter, create_model
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from assur.scenes import bounds
from assur.scenes.schema.model import WHOLE, Document, Duration, Group, Interval, Name, Point, Reference, Stretch
from assur.scenes.schema.robots import StartDocument, ToolPoseDocument
from assur.scenes.schema.task import (
    FollowDocument,
    LiftDocument,
    MoveDocument,
    PickDocument,
    PlaceDocument,
    StepDocument,
    TargetDocument,
    TraceDocument,
)

Count = Annotated[int, Field(ge=1, le=bounds.MAX_SLOTS), WHOLE]
Slot = Annotated[dict[Name, Count], Field(min_length=1, max_length=1)]
"""The name of a grid, and the number of a slot in it, from 1."""


class TransferDocument(Document):
    """A pick and a place for each part, in this order, to the next free slots."""

    stated_elsewhere: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("approach", "dwell", "depart"), "the cell: kinds.KIND.{key} or slots.SLOTS.{key}"),
        **dict.fromkeys(("grasp", "grasp_yaw"), "the kind of the part: kinds.KIND.{key}"),
        "contact_with": "the slots: slots.SLOTS.{key}",
    }

    parts: Annotated[list[Reference], Field(min_length=1, max_length=bounds.MAX_STEPS)]
    to: Name
    window_s: Interval | None = None
    window_m: Stretch | None = None
    gone_after_s: Duration | None = None


class SlotTargetDocument(Document):
    """A slot in place of the pose of a place."""

    slot: Slot


class _Step(StepDocument):
    """One step of a task."""

    exactly_one: ClassVar[tuple[Group, ...]] = ((*StepDocument.exactly_one[0], "transfer"),)

    transfer: TransferDocument | None = None


def _in_task(model: type[Document], **fields: Any) -> type[Document]:
    """The model of a task's part whose `fields`, type and default each, differ from those of a request's."""
    name = f"{model.__name__.strip('_').removesuffix('Document')}InTask"
    return create_model(name, __base__=model, __doc__=model.__doc__, **fields)


POSE = TargetDocument | Name
HANDLING: dict[str, Any] = {
    "approach": (LiftDocument | None, None),
    "dwell_s": (Duration | None, None),
    "depart": (LiftDocument | None, None),
}
STEPS = {
    "move": _in_task(MoveDocument, to=(POSE, ...)),
    "follow": _in_task(FollowDocument, to=(POSE, ...)),
    "trace": _in_task(TraceDocument, start=(POSE, ...)),
    "pick": _in_task(PickDocument, grasp_m=(Point | None, None), **HANDLING),
    "place": _in_task(PlaceDocument, to=(POSE | SlotTargetDocument, ...), **HANDLING),
}
StepInTask = _in_task(_Step, **{key: (model | None, None) for key, model in STEPS.items()})
StartInTask = _in_task(StartDocument, tool=(ToolPoseDocument | Name | None, None))


class SchemaOf:
    """The schema of a field is that of a model; its value is read later."""

    def __init__(self, model: type[BaseModel]) -> None:
        self._model = model

    def __get_pydantic_json_schema__(self, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        listed: JsonSchemaValue = handler(TypeAdapter(list[self._model]).core_schema)["items"]  # type: ignore[name-defined]
        return listed

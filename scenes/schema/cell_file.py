"""Cell files and task files: what a cell has for all of its tasks, and what a task adds."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from assur.planner.selection.names import Rule
from assur.scenes import bounds
from assur.scenes.schema.expect import ExpectDocument
from assur.scenes.schema.frames import FrameDocument
from assur.scenes.schema.model import (
    KNOWN,
    ORIGIN,
    WHOLE,
    Angle,
    Document,
    Duration,
    Group,
    Mass,
    Name,
    Point,
    PoseUncertaintyDocument,
    Reference,
)
from assur.scenes.schema.request import CarryDocument, ExecutionDocument, OptionsDocument
from assur.scenes.schema.robots import NeighbourDocument, RobotDocument
from assur.scenes.schema.shapes import BodyDocument, PlaceInCell, ShapeDocument
from assur.scenes.schema.streams import StreamDocument
from assur.scenes.schema.task import LiftDocument, TargetDocument
from assur.scenes.schema.task_steps import Count, SchemaOf, Slot, StartInTask, StepInTask

CELL, TASK = "assur-cell/1", "assur-task/1"
"""Versions of both files."""


class HandlingDefaults(Document):
    """What picks and places do that do not state it."""

    approach: LiftDocument | None = None
    dwell_s: Duration | None = None
    depart: LiftDocument | None = None


class KindDocument(HandlingDefaults):
    """What all parts of a kind have in common."""

    shape: ShapeDocument
    mass_kg: Mass | None = None
    yaw_symmetry: Annotated[int, Field(ge=0, le=360), WHOLE] = 1
    uncertainty: PoseUncertaintyDocument = KNOWN
    grasp_m: Point | None = None
    grasp_yaw_rad: Angle | None = None


class SlotsDocument(HandlingDefaults):
    """A grid of places for parts, in a frame, relative to a body, or on each part of a kind."""

    at_most_one: ClassVar[tuple[Group, ...]] = (
        ("frame", "body", "kind"),
        *[("kind", key) for key in ("contact_with", "exchange_s")],
    )

    frame: Reference | None = None
    body: Reference | None = None
    kind: Name | None = None
    at_m: Point = ORIGIN
    step_m: Point | None = None
    count: Annotated[list[Count], Field(min_length=3, max_length=3)] | None = None
    yaw_rad: Angle = 0.0
    contact_with: Annotated[list[Reference], Field(max_length=bounds.MAX_CONTACTS)] | None = None
    exchange_s: Duration | None = None


class CellDocument(Document):
    """What a cell has for all of its tasks."""

    schema_: Literal["assur-cell/1"] = Field(alias="schema")
    about: Annotated[str, Field(min_length=1, max_length=bounds.MAX_TEXT)] | None = None
    robot: RobotDocument
    frames: Annotated[dict[Name, FrameDocument], Field(max_length=bounds.MAX_FRAMES)] = Field(default_factory=dict)
    bodies: Annotated[list[BodyDocument], Field(max_length=bounds.MAX_BODIES)] = Field(default_factory=list)
    neighbours: Annotated[list[NeighbourDocument], Field(max_length=bounds.MAX_NEIGHBOURS)] = Field(
        default_factory=list
    )
    kinds: Annotated[dict[Name, KindDocument], Field(max_length=bounds.MAX_BODIES)] = Field(default_factory=dict)
    positions: Annotated[dict[Name, TargetDocument], Field(max_length=bounds.MAX_BODIES)] = Field(default_factory=dict)
    slots: Annotated[dict[Name, SlotsDocument], Field(max_length=bounds.MAX_BODIES)] = Field(default_factory=dict)
    streams: Annotated[dict[Name, StreamDocument], Field(max_length=bounds.MAX_STREAMS)] = Field(default_factory=dict)
    selection: Rule = "look-ahead"
    refuge: Name | None = None
    options: Annotated[dict[str, Any], SchemaOf(OptionsDocument)] = Field(default_factory=dict)
    execution: ExecutionDocument = ExecutionDocument()
    carry: CarryDocument | None = None


class PartDocument(Document):
    """A part of a kind, or with a solid of its own: at a pose, in a slot, or in the gripper at the start."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("kind", "shape"),)
    at_most_one: ClassVar[tuple[Group, ...]] = (("pose", "slot"),)

    name: Name
    kind: Name | None = None
    shape: ShapeDocument | None = None
    pose: PlaceInCell | None = None
    slot: Slot | None = None
    mass_kg: Mass | None = None
    yaw_symmetry: Annotated[int, Field(ge=0, le=360), WHOLE] = 1
    uncertainty: PoseUncertaintyDocument = KNOWN


Step = Annotated[dict[str, Any], SchemaOf(StepInTask)]


class CellReference(Document):
    """Names the cell of a task."""

    file: Annotated[str, Field(min_length=1, max_length=255)]


class TaskDocument(Document):
    """What a task adds to a cell. Its steps are read with the request that both make together. Only a task that begins
    where a plan ends has no start of its own."""

    schema_: Literal["assur-task/1"] = Field(alias="schema")
    about: Annotated[str, Field(min_length=1, max_length=bounds.MAX_TEXT)] | None = None
    cell: CellReference | None = None
    set: Annotated[dict[str, Any], Field(max_length=bounds.MAX_SET)] = Field(default_factory=dict)
    start: Annotated[dict[str, Any], SchemaOf(StartInTask)] | None = None
    parts: Annotated[list[PartDocument], Field(max_length=bounds.MAX_BODIES)] = Field(default_factory=list)
    steps: Annotated[list[Step], Field(min_length=1, max_length=bounds.MAX_STEPS)]
    options: Annotated[dict[str, Any], SchemaOf(OptionsDocument)] = Field(default_factory=dict)
    expect: ExpectDocument | None = None

"""The request: all data on which a plan depends."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, Field, SerializerFunctionWrapHandler, field_serializer

from assur.scenes import bounds
from assur.scenes.schema.frames import FrameDocument
from assur.scenes.schema.model import (
    WHOLE,
    ByName,
    Distance,
    Document,
    Duration,
    Instant,
    Mode,
    Name,
    Positive,
    Reference,
)
from assur.scenes.schema.robots import NeighbourDocument, RobotDocument, StartDocument
from assur.scenes.schema.shapes import BodyDocument
from assur.scenes.schema.task import StepDocument

SCHEMA = "assur/1"
"""Version of the documents."""


class ClearanceDocument(Document):
    """Distances to keep. Both, or none."""

    travel: Distance
    near: Distance


Bodies = Annotated[list[Reference], Field(min_length=1, max_length=bounds.MAX_CONTACTS)]


class ClearanceExceptionDocument(Document):
    """Other distances for some bodies."""

    between: Bodies
    and_: Bodies | None = Field(default=None, alias="and")
    clearance_m: ClearanceDocument


class OptionsDocument(Document):
    """How to search, and what is safe enough."""

    seed: Annotated[int, Field(ge=0, le=bounds.MAX_INTEGER), WHOLE] = 0
    budget_s: Annotated[float, Field(ge=bounds.MIN_BUDGET_S, le=bounds.MAX_BUDGET_S)] = 1.0
    max_candidates: Annotated[int, Field(ge=1, le=bounds.MAX_CANDIDATES), WHOLE] | None = None
    stop: Literal["first", "budget"] = "budget"
    explain_budget_s: Annotated[float, Field(ge=0.0, le=bounds.MAX_BUDGET_S)] = 0.0
    report: Literal["none", "short", "full"] = "short"
    clearance_m: ClearanceDocument = ClearanceDocument(travel=0.0, near=0.0)
    clearance_exceptions: Annotated[list[ClearanceExceptionDocument], Field(max_length=bounds.MAX_CONTACTS)] = Field(
        default_factory=list
    )
    singularity_margin: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.05
    elbow: Mode = "keep"
    end: Literal["rest", "moving"] = "rest"
    stay_safe_s: Duration = 0.0
    latest_end_s: Instant | None = None
    timing: Literal["jerk_limited", "parabolic_blend"] = "jerk_limited"
    acceleration_time_s: Annotated[float, Field(ge=bounds.SHORTEST_RAMP_S, le=bounds.LONGEST_RAMP_S)] | None = None


class LagDocument(ByName):
    """How far each joint may be from the trajectory, by the maker's joint names (`j1_rad`, `j3_m`); 0 if left out."""

    __pydantic_extra__: dict[str, Distance]

    if TYPE_CHECKING:  # keywords of any name, which a type checker does not see otherwise

        def __init__(self, **values: float) -> None: ...


class ExecutionDocument(Document):
    """How the plan will be run: servo lag, late dispatch, belt correction by the live encoder."""

    lag: LagDocument | None = None
    start_tolerance_s: Duration = 0.0
    belt_correction: bool = False


class CarryDocument(Document):
    """Limit of the tool point's acceleration while a part is held."""

    acceleration_m_s2: Positive


class RequestDocument(Document):
    """Robot, cell, task and options. The service refuses any other field."""

    schema_: Literal["assur/1"] = Field(alias="schema")
    robot: RobotDocument
    start: StartDocument
    frames: Annotated[dict[Name, FrameDocument], Field(max_length=bounds.MAX_FRAMES)] = Field(
        default_factory=dict, json_schema_extra={"additionalProperties": False}
    )
    bodies: Annotated[list[BodyDocument], Field(max_length=bounds.MAX_BODIES)] = Field(default_factory=list)
    neighbours: Annotated[list[NeighbourDocument], Field(max_length=bounds.MAX_NEIGHBOURS)] = Field(
        default_factory=list
    )
    task: Annotated[list[StepDocument], Field(min_length=1, max_length=bounds.MAX_STEPS)]
    options: OptionsDocument = OptionsDocument()
    execution: ExecutionDocument = ExecutionDocument()
    carry: CarryDocument | None = None

    @field_serializer("frames", mode="wrap")
    def _sorted(self, frames: dict[str, FrameDocument], written: SerializerFunctionWrapHandler) -> Any:
        return written(dict(sorted(frames.items())))

    def changed(self, stated: dict[str, Any]) -> RequestDocument:
        """The request with these values of its fields, which are valid, in place of its own."""
        own = {"digest"} if AROUND.isdisjoint(stated) else {"digest", "surroundings", "cell"}
        self.surroundings  # noqa: B018 - a copy with the same has the text, too: it is made once
        made = BaseModel.model_copy(self, update=stated)
        for name in own:
            made.__dict__.pop(name, None)
        return made

    @staticmethod
    def of_cell(stated: dict[str, Any]) -> RequestDocument:
        """What a cell states of the requests of its tasks, valid values by their fields: no request yet."""
        return RequestDocument.model_construct(schema_=SCHEMA, **stated)

    def with_task(self, stated: dict[str, Any], parts: Sequence[BodyDocument]) -> RequestDocument:
        """The request of a task in this cell: the valid values that the task states, and its parts behind the bodies of
        the cell."""
        own = {name: self.__dict__[name] for name in RequestDocument.model_fields if name in self.__dict__}
        made = RequestDocument.model_construct(**{**own, **stated, "bodies": [*self.bodies, *parts]})
        if parts:
            texts = [part.model_dump_json(by_alias=True, exclude_none=True) for part in parts]
            before, behind = self._around_parts
            made.__dict__["surroundings"] = f"{before}{',' if self.bodies else ''}{','.join(texts)}{behind}"
        else:
            made.__dict__["surroundings"] = self.surroundings
        return made

    @cached_property
    def _around_parts(self) -> tuple[str, str]:
        """The text of the surroundings before and behind the place of further bodies."""
        behind = self.model_dump_json(by_alias=True, exclude_none=True, include={"neighbours"})
        return self.surroundings[: -len(behind) - 1], f"],{behind[1:]}"

    def canonical(self) -> dict[str, Any]:
        """The request in SI with every default written out: what two requests that mean the same have in common.

        Fields have the order of the schema, and names that the document gives (of frames, of joints) their own.
        """
        return self.model_dump(mode="python", by_alias=True, exclude_none=True)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the canonical request as JSON without spaces, ``sha256:<64 hex digits>``."""
        return self._digest({})

    @property
    def meaning(self) -> str:
        """The same of the request without its seed: of all requests that ask for the same with other random numbers."""
        return self._digest({"options": {"seed"}})

    @cached_property
    def surroundings(self) -> str:
        """Frames, bodies and neighbours as JSON: two that mean the same have the same."""
        return self.model_dump_json(by_alias=True, exclude_none=True, include=SURROUNDINGS)

    @cached_property
    def cell(self) -> str:
        """SHA-256 of the robot and its surroundings."""
        return hashlib.sha256(f"{self.robot.text}{self.surroundings}".encode()).hexdigest()

    def _digest(self, without: dict[str, Any]) -> str:
        left_out = {**dict.fromkeys(AROUND, True), **without}
        own = self.model_dump_json(by_alias=True, exclude_none=True, exclude=left_out)
        # in the order of the fields; most requests repeat a robot and what is around it
        schema, start, behind = own.partition(',"start":')
        state, task, rest = behind.partition(',"task":[')
        text = f'{schema},"robot":{self.robot.text}{start}{state},{self.surroundings[1:-1]}{task}{rest}'
        return "sha256:" + hashlib.sha256(text.encode()).hexdigest()


SURROUNDINGS = {"frames", "bodies", "neighbours"}
AROUND = SURROUNDINGS | {"robot"}
"""Fields of what is kept of a cell."""

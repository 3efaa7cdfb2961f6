"""Inverse kinematics as documents: a pose of the tool or joints, and all joint positions there with their margins."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, NotRequired

from pydantic import Field, with_config
from typing_extensions import TypedDict

from assur.planner.model.refusal import Facts, Reason
from assur.scenes.schema.answer import CLOSED, Number, Pair, Schema, Text, Vector
from assur.scenes.schema.model import Document, Group, Instant
from assur.scenes.schema.robots import JointValues, RobotDocument, ToolPoseDocument


class IkDocument(Document):
    """A pose of the tool point, or joints, at a time (silent: the start of the request, or 0).

    The robot is that of a request, which is given beside this, or `robot`, without a cell.
    """

    exactly_one: ClassVar[tuple[Group, ...]] = (("pose", "joints"),)

    robot: RobotDocument | None = None
    pose: ToolPoseDocument | None = None
    joints: JointValues | None = None
    at_s: Instant | None = None


@with_config(CLOSED)
class ToolPose(TypedDict):
    """Where the tool point is. It has a yaw only if a yaw is required or follows from joints; pitch and roll only with
    five axes."""

    at_m: Vector
    yaw_rad: NotRequired[Number]
    pitch_rad: NotRequired[Number]
    roll_rad: NotRequired[Number]


@with_config(CLOSED)
class Collision(TypedDict):
    """Two bodies that are nearer to each other than travel allows."""

    bodies: Pair
    facts: Annotated[Facts, Field(discriminator="kind")]
    detail: Text


@with_config(CLOSED)
class Solution(TypedDict):
    """A joint position, and how near it is to what the arm cannot do."""

    mode: Text
    turn: int | None
    joints: dict[Text, Number]
    to_limits: dict[Text, Annotated[list[Number], Field(min_length=2, max_length=2)]]
    singularity_margin: Number
    parallel_margin: Number | None
    reach_m: Number
    collisions: NotRequired[list[Collision]]


@with_config(CLOSED)
class Unreached(TypedDict):
    """A working mode without a solution, and what it lacks."""

    mode: Text
    reason: Reason
    short_m: Number | None
    beyond: dict[Text, Number]
    detail: Text


@with_config(CLOSED)
class IkAnswer(TypedDict):
    """The pose of the tool in every frame that is known at the time, all joint positions, and what other modes lack."""

    schema: Schema
    status: Literal["reached", "not_reached"]
    robot: Text
    at_s: Instant
    tool: dict[Text, ToolPose]
    solutions: list[Solution]
    unreached: list[Unreached]
    notice: Text

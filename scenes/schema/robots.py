"""Robots in documents: an arm, as a robot's file or a request writes it out; and the robot of a request, which is such
an arm or the name of a shipped one, with tool, narrower limits, base and start.

A fact about an arm may be stated with its status and source (`assur.scenes.schema.stated`).
"""

from __future__ import annotations

import marshal
import math
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, get_args

from pydantic import Field, ModelWrapValidatorHandler, model_validator

from assur.planner.geometry.shapes import LARGEST_M
from assur.planner.robots.turns import MOST_TURNS
from assur.scenes import bounds
from assur.scenes.schema.model import (
    ORIGIN,
    WHOLE,
    Angle,
    ByName,
    Coordinate,
    Document,
    Duration,
    Group,
    Inertia,
    Instant,
    Load,
    Mass,
    Mode,
    Name,
    Point,
    PoseDocument,
    PoseUncertaintyDocument,
    Positive,
    Reference,
    Scale,
    Size,
    Strength,
    Stretch,
)
from assur.scenes.schema.shapes import AttachedBody, LinkBody, LinkName
from assur.scenes.schema.stated import BOTH_FORMS, Stated

Family = Literal["scara", "elbow_arm", "polar_arm", "five_axis_arm", "five_bar"]
FAMILIES: tuple[Family, ...] = get_args(Family)

Pair = Annotated[list[Strength], Field(min_length=2, max_length=2)]
Row = Annotated[list[Strength], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
Rows = Annotated[list[Row], Field(min_length=2, max_length=bounds.MAX_KNOTS)]
Text = Annotated[str, Field(min_length=1, max_length=bounds.MAX_TEXT)]
ModelName = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")]

Heading = Annotated[float, Field(ge=-math.tau, le=math.tau)]
Separation = Annotated[float, Field(ge=0.0, le=LARGEST_M)]
BothSides = Annotated[list[Size], Field(min_length=2, max_length=2)]
MOST_JERK = 1e9
"""rad/s³ or m/s³; beyond it only rounding happens."""
Jerk = Annotated[float, Field(ge=bounds.LEAST, le=MOST_JERK)]
LinkBodies = Annotated[list[LinkBody], Field(max_length=bounds.MAX_TOOL_BODIES)]

LengthFact = Annotated[Size | Stated[Size], BOTH_FORMS]
HeightFact = Annotated[Coordinate | Stated[Coordinate], BOTH_FORMS]
AngleFact = Annotated[Heading | Stated[Heading], BOTH_FORMS]
OffsetFact = Annotated[Stretch | Stated[Stretch], BOTH_FORMS]
RangeFact = Annotated[Pair | Stated[Pair], BOTH_FORMS]
LimitFact = Annotated[Positive | Stated[Positive], BOTH_FORMS]
LoadFact = Annotated[Load | Stated[Load], BOTH_FORMS]
JerkFact = Annotated[Jerk | Stated[Jerk], BOTH_FORMS]


class ToolDocument(Document):
    """What is bolted to the flange. The tool point must be given."""

    tcp_m: Point
    tcp_yaw_rad: Angle = 0.0
    mass_kg: Mass | None = None
    inertia_kgm2: Inertia | None = None
    bodies: Annotated[list[AttachedBody], Field(max_length=bounds.MAX_TOOL_BODIES)] = Field(default_factory=list)


class LoadShare(Document):
    """With this load, tool and part together, the joints have this share of their acceleration and jerk."""

    mass_kg: Mass
    share: Scale


YawRangeDocument = Annotated[list[Heading], Field(min_length=2, max_length=2)]
YawRanges = Annotated[list[YawRangeDocument], Field(min_length=1, max_length=bounds.MAX_YAW_RANGES)]

LoadShares = Annotated[list[LoadShare], Field(min_length=1, max_length=bounds.MAX_LOAD_ROWS)]


class LimitsDocument(ByName):
    """Limits that are narrower than the robot's own, among them ranges by the maker's joint names (`j4_rad`)."""

    __pydantic_extra__: dict[str, Pair]

    velocity: Scale = 1.0
    acceleration: Scale = 1.0
    jerk: Scale = 1.0
    acceleration_by_load: LoadShares | None = None
    forbidden_yaw_rad: YawRanges | None = None

    if TYPE_CHECKING:  # the fields, and keywords of any name, which a type checker does not see otherwise

        def __init__(
            self,
            *,
            velocity: Scale = ...,
            acceleration: Scale = ...,
            jerk: Scale = ...,
            acceleration_by_load: LoadShares | None = ...,
            forbidden_yaw_rad: YawRanges | None = ...,
            **ranges: Pair,
        ) -> None: ...


class JointDocument(Document):
    """A joint of an arm in its maker's convention."""

    exactly_one: ClassVar[tuple[Group, ...]] = (
        ("range_rad", "range_m"),
        ("velocity_rad_s", "velocity_m_s"),
        ("acceleration_rad_s2", "acceleration_m_s2"),
        ("jerk_rad_s3", "jerk_m_s3"),
    )

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9]{0,15}$")]
    range_rad: RangeFact | None = None
    range_m: RangeFact | None = None
    velocity_rad_s: LimitFact | None = None
    velocity_m_s: LimitFact | None = None
    acceleration_rad_s2: LimitFact | None = None
    acceleration_m_s2: LimitFact | None = None
    jerk_rad_s3: JerkFact | None = None
    jerk_m_s3: JerkFact | None = None
    sign: Annotated[Literal[1, -1], WHOLE] = 1
    zero_m: HeightFact | None = None
    zero_rad: AngleFact | None = None


class AnyArm(Document):
    """What arms of all families have in common: what they are called and who made them, what they may carry (tool and
    part together; the inertia is about the last joint's axis), where the axis of the base is in the frame in which a
    request places the arm, the solids of their links, and which links can meet (not those that are joined, which
    overlap by construction)."""

    name: ModelName | None = None
    title: Text | None = None
    maker: Text | None = None
    about: Text | None = None
    rated_load_kg: LoadFact | None = None
    max_load_kg: LoadFact | None = None
    max_inertia_kgm2: Annotated[Inertia | Stated[Inertia], BOTH_FORMS] | None = None
    acceleration_by_load: Annotated[LoadShares | Stated[LoadShares], BOTH_FORMS] | None = None
    base_offset_m: OffsetFact | None = None
    bodies: Annotated[LinkBodies | Stated[LinkBodies], BOTH_FORMS]
    self_pairs: Annotated[
        list[Annotated[list[LinkName], Field(min_length=2, max_length=2)]], Field(max_length=bounds.MAX_TOOL_BODIES)
    ]


class ScaraDocument(AnyArm):
    """A SCARA with three or four axes: turn, turn, lift, turn; or with the lift elsewhere, as `axis_order` says: r for
    a joint that turns, p for the lift. With three axes its last letter does not count."""

    l1_m: LengthFact
    l2_m: LengthFact
    joints: Annotated[list[JointDocument], Field(min_length=3, max_length=4)]
    axis_order: Literal["rrpr", "rprr", "prrr", "rrrp"] = "rrpr"
    tool_frame: Literal["z_up", "z_down"] = "z_up"


class ElbowArmDocument(AnyArm):
    """An elbow arm: base turn, shoulder, elbow."""

    height_m: HeightFact
    l1_m: LengthFact
    l2_m: LengthFact
    joints: Annotated[list[JointDocument], Field(min_length=3, max_length=3)]


class PolarArmDocument(AnyArm):
    """A polar arm: base turn, tilt, ram."""

    height_m: HeightFact
    joints: Annotated[list[JointDocument], Field(min_length=3, max_length=3)]


class FiveBarDocument(AnyArm):
    """A five-bar: two cranks, and if they are given a lift and a wrist."""

    separation_m: Annotated[Separation | Stated[Separation], BOTH_FORMS]
    proximal_m: Annotated[BothSides | Stated[BothSides], BOTH_FORMS]
    distal_m: Annotated[BothSides | Stated[BothSides], BOTH_FORMS]
    assembly: Literal["front", "back"] = "front"
    parallel_margin: Annotated[float, Field(ge=bounds.LEAST, lt=1.0)] = 0.1
    height_m: HeightFact = 0.0
    joints: Annotated[list[JointDocument], Field(min_length=2, max_length=4)]


class FiveAxisArmDocument(AnyArm):
    """A five-axis arm: base turn, shoulder, elbow, pitch, roll."""

    height_m: HeightFact
    l1_m: LengthFact
    l2_m: LengthFact
    l3_m: LengthFact
    joints: Annotated[list[JointDocument], Field(min_length=5, max_length=5)]


Arm = ScaraDocument | ElbowArmDocument | PolarArmDocument | FiveAxisArmDocument | FiveBarDocument


class ArmDocument(Document):
    """An arm under the key of its family: what a robot's file holds."""

    exactly_one: ClassVar[tuple[Group, ...]] = (FAMILIES,)

    scara: ScaraDocument | None = None
    elbow_arm: ElbowArmDocument | None = None
    polar_arm: PolarArmDocument | None = None
    five_axis_arm: FiveAxisArmDocument | None = None
    five_bar: FiveBarDocument | None = None

    def written_out(self) -> tuple[Family, Arm] | None:
        """The family that is given and its arm; None where a robot is named instead."""
        return next(((name, arm) for name in FAMILIES if (arm := getattr(self, name)) is not None), None)


class RobotDocument(ArmDocument):
    """A robot in the cell. The loader of scenario files puts what a `file` holds in its place."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("model", "file", *FAMILIES),)

    model: ModelName | None = None
    file: Annotated[str, Field(min_length=1, max_length=255)] | None = None
    tool: ToolDocument
    base: PoseDocument = PoseDocument()
    limits: LimitsDocument = Field(default_factory=lambda: LimitsDocument.model_validate({}))

    @model_validator(mode="wrap")
    @classmethod
    def _once(cls, data: Any, validated: ModelWrapValidatorHandler[Self]) -> Self:
        """A robot that documents repeat is validated once. The same bytes of `marshal` are the same plain data."""
        try:
            key = marshal.dumps(data, 2)
        except ValueError:  # no plain data
            return validated(data)
        found = _kept.get(key)
        if type(found) is cls:
            return found
        made = validated(data)
        if len(key) <= LONGEST_KEPT:
            if len(_kept) >= MOST_KEPT:
                _kept.clear()
            _kept[key] = made
        return made

    @cached_property
    def states_sources(self) -> bool:
        """Whether the source of one of its facts is stated."""
        return '"status":' in self.text

    @cached_property
    def text(self) -> str:
        """The robot in SI with every default written out, as JSON: two that mean the same have the same."""
        return self.model_dump_json(by_alias=True, exclude_none=True)


MOST_KEPT = 64
"""So many robots are kept for further documents."""
LONGEST_KEPT = 1 << 16
"""Longest robot that is kept, bytes: one with meshes in it is not."""
_kept: dict[bytes, RobotDocument] = {}


class JointValues(ByName):
    """A number for each joint, by the maker's joint name and unit: `j1_rad`, `j3_m`, `j1_rad_s`."""

    __pydantic_extra__: dict[str, Strength]

    if TYPE_CHECKING:  # keywords of any name, which a type checker does not see otherwise

        def __init__(self, **values: float) -> None: ...


class HoldingDocument(Document):
    """A part in the gripper at the start."""

    part: Reference
    grasp_m: Point
    grasp_yaw_rad: Angle = 0.0
    within: PoseUncertaintyDocument = PoseUncertaintyDocument()


class ToolPoseDocument(Document):
    """A pose of the tool point in a frame (the world if none is named), or relative to a body and in that body's frame.

    All angles that the arm can give its tool are given: the yaw, or pitch and roll.
    """

    at_most_one: ClassVar[tuple[Group, ...]] = (("frame", "body"),)

    frame: Reference | None = None
    body: Reference | None = None
    at_m: Point = ORIGIN
    yaw_rad: Angle | None = None
    pitch_rad: Angle | None = None
    roll_rad: Angle | None = None


Turn = Annotated[int, Field(ge=-MOST_TURNS, le=MOST_TURNS), WHOLE]


class StartDocument(Document):
    """The state from which the plan begins: joints, at rest unless velocity (and acceleration) are given; or a pose of
    the tool, at rest, with the working mode `elbow` and the full turn of the wrist in which it is taken. The gripper is
    empty unless the request states what it holds."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("joints", "tool"),)
    at_most_one: ClassVar[tuple[Group, ...]] = tuple(
        [("tool", key) for key in ("velocity", "acceleration")] + [("joints", key) for key in ("elbow", "turn")]
    )

    at_s: Instant = 0.0
    joints: JointValues | None = None
    tool: ToolPoseDocument | None = None
    elbow: Mode | None = None
    turn: Turn | None = None
    velocity: JointValues | None = None
    acceleration: JointValues | None = None
    holding: HoldingDocument | None = None


class TrajectoryDocument(Document):
    """Knots in the maker's convention, rad and m, as an answer gives them: quintic Hermite between knots."""

    joint_names: Annotated[list[str], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
    joint_units: Annotated[list[Literal["rad", "m"]], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
    time_s: Annotated[list[Instant], Field(min_length=2, max_length=bounds.MAX_KNOTS)]
    position: Rows
    velocity: Rows
    acceleration: Rows
    acceleration_jumps: bool = False


class PlanFileDocument(Document):
    """A file with a planned answer; its loader puts the answer's trajectory in its place."""

    file: Annotated[str, Field(min_length=1, max_length=255)]


class NeighbourDocument(Document):
    """Another robot in the cell, doing what its own plan says, and standing still before and after."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("trajectory", "plan"),)

    name: Name
    robot: RobotDocument
    trajectory: TrajectoryDocument | None = None
    plan: PlanFileDocument | None = None
    starts_at_s: Instant | None = None
    start_uncertainty_s: Duration = 0.0

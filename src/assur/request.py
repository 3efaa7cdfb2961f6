"""Requests as typed objects: one class for each part of the document, with the document's own names, in SI.

    from assur.request import Conveyor, Frame, mm
    Frame(conveyor=Conveyor(at_m=mm(-500, 350, 50), speed_m_s=mm(250)))

These are the very models that read a request, so that there is one description of it: an editor completes the names, a
type checker holds them to their types, and a value that is not allowed raises `pydantic.ValidationError` where it is
written. Objects are frozen. ``.document()`` of any of them is the plain document, and `Request.of` makes a request of
one. ``docs/request.md`` says what each name means.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, cast, overload

from pydantic import Field

from assur.scenes.schema.frames import ConveyorDocument as Conveyor
from assur.scenes.schema.frames import FixedDocument as Fixed
from assur.scenes.schema.frames import FrameDocument as Frame
from assur.scenes.schema.frames import IndexerDocument as Indexer
from assur.scenes.schema.frames import Keyframe, RateChange, SpeedChange
from assur.scenes.schema.frames import KeyframesDocument as Keyframes
from assur.scenes.schema.frames import LinearDocument as Linear
from assur.scenes.schema.frames import OscillationDocument as Oscillation
from assur.scenes.schema.frames import SwingDocument as Swing
from assur.scenes.schema.frames import TurntableDocument as Turntable
from assur.scenes.schema.frames import UncertaintyDocument as Uncertainty
from assur.scenes.schema.model import PoseDocument as Pose
from assur.scenes.schema.model import PoseUncertaintyDocument as PoseUncertainty
from assur.scenes.schema.read import read
from assur.scenes.schema.request import CarryDocument as Carry
from assur.scenes.schema.request import ClearanceDocument as Clearance
from assur.scenes.schema.request import ClearanceExceptionDocument as ClearanceException
from assur.scenes.schema.request import ExecutionDocument as Execution
from assur.scenes.schema.request import LagDocument as Lag
from assur.scenes.schema.request import OptionsDocument as Options
from assur.scenes.schema.request import RequestDocument
from assur.scenes.schema.robots import ElbowArmDocument as ElbowArm
from assur.scenes.schema.robots import FiveAxisArmDocument as FiveAxisArm
from assur.scenes.schema.robots import FiveBarDocument as FiveBar
from assur.scenes.schema.robots import HoldingDocument as Holding
from assur.scenes.schema.robots import JointDocument as Joint
from assur.scenes.schema.robots import JointValues as Joints
from assur.scenes.schema.robots import LimitsDocument as Limits
from assur.scenes.schema.robots import LoadShare
from assur.scenes.schema.robots import NeighbourDocument as Neighbour
from assur.scenes.schema.robots import PlanFileDocument as PlanFile
from assur.scenes.schema.robots import PolarArmDocument as PolarArm
from assur.scenes.schema.robots import RobotDocument as Robot
from assur.scenes.schema.robots import ScaraDocument as Scara
from assur.scenes.schema.robots import StartDocument as Start
from assur.scenes.schema.robots import ToolDocument as Tool
from assur.scenes.schema.robots import ToolPoseDocument as ToolPose
from assur.scenes.schema.robots import TrajectoryDocument as Trajectory
from assur.scenes.schema.shapes import AttachedBody, LinkBody, PlaceInCell
from assur.scenes.schema.shapes import BodyDocument as Body
from assur.scenes.schema.shapes import BoxDocument as Box
from assur.scenes.schema.shapes import CapsuleDocument as Capsule
from assur.scenes.schema.shapes import CylinderDocument as Cylinder
from assur.scenes.schema.shapes import MeshDocument as Mesh
from assur.scenes.schema.shapes import ShapeDocument as Shape
from assur.scenes.schema.shapes import SphereDocument as Sphere
from assur.scenes.schema.stated import Stated
from assur.scenes.schema.task import ArcDocument as Arc
from assur.scenes.schema.task import ArchDocument as Arch
from assur.scenes.schema.task import FollowDocument as Follow
from assur.scenes.schema.task import LiftDocument as Lift
from assur.scenes.schema.task import LineDocument as Line
from assur.scenes.schema.task import MoveDocument as Move
from assur.scenes.schema.task import PathPartDocument as PathPart
from assur.scenes.schema.task import PickDocument as Pick
from assur.scenes.schema.task import PlaceDocument as Place
from assur.scenes.schema.task import SplineDocument as Spline
from assur.scenes.schema.task import StepDocument as Step
from assur.scenes.schema.task import TargetDocument as Target
from assur.scenes.schema.task import TraceDocument as Trace
from assur.scenes.units import to_si

__all__ = [
    "Arc",
    "Arch",
    "AttachedBody",
    "Body",
    "Box",
    "Capsule",
    "Carry",
    "Clearance",
    "ClearanceException",
    "Conveyor",
    "Cylinder",
    "ElbowArm",
    "Execution",
    "FiveAxisArm",
    "FiveBar",
    "Fixed",
    "Follow",
    "Frame",
    "Holding",
    "Indexer",
    "Joint",
    "Joints",
    "Keyframe",
    "Keyframes",
    "Lag",
    "Lift",
    "Limits",
    "Line",
    "Linear",
    "LinkBody",
    "LoadShare",
    "Mesh",
    "Move",
    "Neighbour",
    "Options",
    "Oscillation",
    "PathPart",
    "Pick",
    "Place",
    "PlaceInCell",
    "PlanFile",
    "PolarArm",
    "Pose",
    "PoseUncertainty",
    "RateChange",
    "Request",
    "Robot",
    "Scara",
    "Shape",
    "SpeedChange",
    "Sphere",
    "Spline",
    "Start",
    "Stated",
    "Step",
    "Swing",
    "Target",
    "Tool",
    "ToolPose",
    "Trace",
    "Trajectory",
    "Turntable",
    "Uncertainty",
    "deg",
    "mm",
]


class Request(RequestDocument):
    """Robot, cell, task and options: what `assur.plan` takes. `schema` need not be given."""

    schema_: Literal["assur/1"] = Field(default="assur/1", alias="schema")

    @classmethod
    def of(cls, document: object) -> Request:
        """The request in a plain document, in whichever units. Raises `InputError` naming the field."""
        return cast(Request, read(cls, dict(document) if isinstance(document, Mapping) else document))

    def document(self) -> dict[str, Any]:
        return {"schema": self.schema_, **super().document()}


@overload
def mm(value: float, /) -> float: ...
@overload
def mm(value: float, second: float, /, *more: float) -> list[float]: ...
def mm(value: float, /, *more: float) -> float | list[float]:
    """Millimetres in metres, and anything per second or a higher power of it: ``mm(250)``, ``mm(-500, 350, 50)``.

    The same numbers to the bit as those of a document with `_mm`.
    """
    return _in_si("mm", value, *more)


@overload
def deg(value: float, /) -> float: ...
@overload
def deg(value: float, second: float, /, *more: float) -> list[float]: ...
def deg(value: float, /, *more: float) -> float | list[float]:
    """Degrees in radians, and anything per second or a higher power of it: ``deg(90)``, ``deg(-270, 270)``.

    The same numbers to the bit as those of a document with `_deg`.
    """
    return _in_si("deg", value, *more)


def _in_si(unit: str, *values: float) -> float | list[float]:
    found = cast("list[float]", to_si([float(value) for value in values], unit))
    return found if len(found) > 1 else found[0]

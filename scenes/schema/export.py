"""Exports as documents: a plan as a controller's file, with what it is proved against."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, with_config
from typing_extensions import TypedDict

from assur.scenes import bounds
from assur.scenes.schema.answer import CLOSED, CheckedPlan, Finding, Nearest, Number, Pair, Schema, Text
from assur.scenes.schema.model import Document, Duration, Instant

Form = Literal["csv", "ros2", "ros2-json", "glb", "spel", "melfa"]
Encoding = Literal["text", "base64"]
JerkRule = Literal["limit", "report"]


class ExportDocument(Document):
    """How a plan is to be exported. `tick_s`: the controller's step; silent: the points are the plan's knots. `jerk`:
    whether it must keep the robot's limit, or may be proved against a higher one, which is stated."""

    format: Form
    tick_s: Annotated[float, Field(ge=bounds.LEAST, le=bounds.LONG_S)] | None = None
    jerk: JerkRule = "limit"


@with_config(CLOSED)
class JerkProved(TypedDict):
    """The highest jerk of a joint (null: parabolic blends have no bound), the limit against which it is proved, and the
    limit of the request; in `unit`."""

    joint: Text
    unit: Literal["rad/s³", "m/s³"]
    highest: Number | None
    limit: Number
    of_request: Number


@with_config(CLOSED)
class Deviation(TypedDict):
    """By how much a joint is off the plan at most, rad or m."""

    joint: Text
    at_most: Number


@with_config(CLOSED)
class ExportAnswer(TypedDict):
    """A plan as a `file` in `format`, and what it is: a `statement` for people and the same as numbers.

    `encoding`: whether `file` is the text itself, or bytes in base64 (glb).

    `plan` is the motion in the file with its own certificate, `request` that against which it was checked: both
    together are what a check takes. `jerk_raised`: by what the limits of jerk in it are higher than in the request that
    was given, 1 where they are not. `ends_moving`: joint_trajectory_controller must be told to allow it. `ending`: how
    the name of such a file ends, without the dot.
    """

    schema: Schema
    format: Form
    encoding: Encoding
    file: str
    statement: list[Text]
    knots: int
    start_s: Number
    duration_s: Number
    tick_s: Number | None
    shortest_step_s: Number
    deviation: list[Deviation]
    jerk: list[JerkProved]
    jerk_raised: Number
    ends_moving: bool
    request: dict[str, object]
    plan: CheckedPlan
    request_digest: Text
    certificate_digest: Text
    ending: Text
    notice: Text


class ForeignTrajectoryDocument(Document):
    """A trajectory of another, and how it is to be judged: `file` is its text, in `format`.

    `start_s`: the cell's clock when a ROS trajectory, or CSV with times of the calendar, starts; silent: when the
    request begins. `start_tolerance_s`: in place of that of the request. `jerk`: whether it must keep the robot's
    limit, or is reported only.
    """

    file: str
    format: Literal["csv", "ros2"]
    jerk: JerkRule = "limit"
    start_s: Instant | None = None
    start_tolerance_s: Duration | None = None


StateName = Literal["position", "velocity", "acceleration"]


@with_config(CLOSED)
class BeginsOff(TypedDict):
    """By how much a state of a joint at the first point is off that of the request's start, in `unit`."""

    joint: Text
    state: StateName
    by: Number
    unit: Text


@with_config(CLOSED)
class FirstViolation(TypedDict):
    """What is violated first, at `time_s` of the cell's clock, by `amount` (null: it is only not shown to be
    right); the `bodies` that come too near."""

    what: Text
    time_s: Number
    amount: Number | None
    unit: Text
    bodies: Pair | None


@with_config(CLOSED)
class TrajectoryVerdict(TypedDict):
    """Whether a trajectory is proved: `ok` if and only if there are no findings.

    `judged_as`: one motion in `travel`, or with the legs of a `plan`. `first`: of limits and distances that are
    violated; null where none is. `begins_off`: where the motion begins elsewhere than the request, which is no finding.
    `notes`: what was read otherwise than as the file has it, or not read. `clearance`: where it comes nearest to
    anything. `ends_moving`: the last point is not at rest, and nothing after its time is proved.
    """

    schema: Schema
    ok: bool
    judged_as: Literal["travel", "plan"]
    findings: list[Finding]
    begins_off: list[BeginsOff]
    notes: list[Text]
    first: FirstViolation | None
    clearance: Nearest | None
    jerk: list[JerkProved]
    points: int
    start_s: Number
    duration_s: Number
    ends_moving: bool
    start_tolerance_s: Number
    request_digest: Text
    notice: Text

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
    """How a plan is to be exported."""

    format: Form
    tick_s: Annotated[float, Field(ge=bounds.LEAST, le=bounds.LONG_S)] | None = None
    jerk: JerkRule = "limit"
    lead_s: Annotated[float, Field(ge=0.0, le=bounds.LONGEST_LEAD_S)] | None = None
    after: dict[str, object] | None = None


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
    """A plan as a file, and what it is, for people and as numbers. `request` and `plan` together are what a check
    takes."""

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
    warnings: list[Text]
    ends_moving: bool
    request: dict[str, object]
    plan: CheckedPlan
    request_digest: Text
    certificate_digest: Text
    ending: Text
    notice: Text


class ForeignTrajectoryDocument(Document):
    """A trajectory of another, and how it is to be judged."""

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
    """What is violated first."""

    what: Text
    time_s: Number
    amount: Number | None
    unit: Text
    bodies: Pair | None


@with_config(CLOSED)
class TrajectoryVerdict(TypedDict):
    """Whether a trajectory is proved. Nothing after the end of one that ends in motion is."""

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

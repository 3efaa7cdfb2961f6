"""What the checker answers: right, or what is wrong, each with its number."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Code(StrEnum):
    """What a finding is about."""

    FORM = "FORM"
    """Not the shape of a plan: missing, not finite, out of order."""
    ERROR = "ERROR"
    DIGEST = "DIGEST"
    START = "START"
    END = "END"
    LEGS = "LEGS"
    LIMIT = "LIMIT"
    LOAD = "LOAD"
    """More is carried than the robot may carry."""
    ASSEMBLY = "ASSEMBLY"
    """A closed chain is not proved to keep its assembly mode."""
    ARRIVAL = "ARRIVAL"
    MATCH = "MATCH"
    TRACKING = "TRACKING"
    WINDOW = "WINDOW"
    ARCH = "ARCH"
    CARRY = "CARRY"
    YAW = "YAW"
    """The yaw of the tool is in a forbidden range, or not shown to stay outside it."""
    BLEND = "BLEND"
    """Of a plan with parabolic blends: no parabola, not the asked acceleration time, not missed as it says."""
    ELBOW = "ELBOW"
    """A control point is met in another working mode than the request asks for."""
    SINGULARITY = "SINGULARITY"
    """Nearer to a singular position than `singularity_margin` allows, where it counts."""
    VIA = "VIA"
    """The arm stops, or waits, at a via that is to be flown by."""
    LAW_ENDS = "LAW_ENDS"
    ROW = "ROW"
    """A row of the certificate that means nothing: unknown body, no such piece, outside or across phases."""
    NORMAL = "NORMAL"
    SEPARATION = "SEPARATION"
    """Rows that do not amount to the required distance."""
    COVER = "COVER"
    CONTAINMENT = "CONTAINMENT"
    NEAREST = "NEAREST"
    """The smallest clearance is not what the answer says."""
    CLAIM = "CLAIM"
    """Something else that the answer says beside its plan is not so: contacts, peaks, or what it repeats of the
    request."""


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong: `what` in words, by how much (`amount` in `unit`, NaN: no number), and `where`."""

    code: Code
    what: str
    amount: float = float("nan")
    unit: str = ""
    where: str = ""


@dataclass(frozen=True, slots=True)
class Verdict:
    """`ok` if and only if there are no findings."""

    ok: bool
    findings: tuple[Finding, ...]

    @staticmethod
    def of(findings: list[Finding]) -> Verdict:
        return Verdict(not findings, tuple(findings))

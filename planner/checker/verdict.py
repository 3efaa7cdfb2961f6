"""What the checker answers: right, or what is wrong, each with its number."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Code(StrEnum):
    """What a finding is about."""

    FORM = "FORM"
    """Not the shape of a plan or of a claim: missing, not finite, out of order."""
    DIGEST = "DIGEST"
    """Request, plan and certificate do not belong together."""
    START = "START"
    """The plan does not begin in the state of the request."""
    END = "END"
    """The plan does not end as the request asks."""
    LEGS = "LEGS"
    """The legs are not those of the task, or not in its order."""
    ARRIVAL = "ARRIVAL"
    """An arrival is not that of its step."""
    WINDOW = "WINDOW"
    """A control point is met outside of its window."""
    MOTION = "MOTION"
    """The knots of an arm are others, go back in time, or jump."""
    PHASE = "PHASE"
    """The phases are not the legs and what comes behind them."""
    LAW = "LAW"
    """The motion of a frame is another, or is not known for long enough."""
    UNCERTAINTY = "UNCERTAINTY"
    """More is uncertain than is claimed, of frames, bodies, joints or the start."""
    LINK = "LINK"
    """The links of an arm are others, or its loop is not shown to stay closed."""
    SOLID = "SOLID"
    """The shape of a body is another."""
    SURFACE = "SURFACE"
    """The surface of a body is not closed."""
    SEAT = "SEAT"
    """A body is fixed to another link or frame, or at another pose."""
    CONTACT = "CONTACT"
    """Bodies touch that may not touch, or more deeply."""
    LIMIT = "LIMIT"
    """A joint does not keep a limit."""
    LOAD = "LOAD"
    """More is carried than the robot may carry."""
    POINT = "POINT"
    """The tool is not at its control point, or does not move with it."""
    GUIDE = "GUIDE"
    """The tool leaves the line or the path that it has to follow."""
    ARCH = "ARCH"
    """An arch is lower than the request asks."""
    RATE = "RATE"
    """The tool point is faster or slower, or accelerates harder, than is allowed or stated."""
    DIRECTION = "DIRECTION"
    """An axis of the tool is not within its directions."""
    JOINTS = "JOINTS"
    """A sum of joints, or a derivative of it, is not within its bounds: rest, pitch, roll."""
    CORRECTION = "CORRECTION"
    """A joint does not keep its range, or the arm its reach, while a correction shifts the tool."""
    YAW = "YAW"
    """The yaw of the tool is in a forbidden range, or not shown to stay outside it."""
    BLEND = "BLEND"
    """Of a plan with parabolic blends: no parabola, another acceleration time, or other misses than it states."""
    ELBOW = "ELBOW"
    """A control point is met in another working mode than is required or stated."""
    SINGULARITY = "SINGULARITY"
    """Nearer to a singular position than `singularity_margin` allows, or than is stated."""
    SEPARATION = "SEPARATION"
    """Two bodies are not shown to keep the required distance."""
    DISTANCE = "DISTANCE"
    """A smaller distance is required of a pair, or for a shorter time."""
    ROW = "ROW"
    """A row that means nothing, or does not hold."""
    COVER = "COVER"
    """No row for a part of a phase."""
    CONTAINMENT = "CONTAINMENT"
    """Nothing shows that one body is not within the other."""
    NEAREST = "NEAREST"
    """A smallest clearance, or how far apart a pair is, is not what the answer says."""
    ERROR = "ERROR"
    """The tool may be farther from its control point than the answer says."""
    PEAK = "PEAK"
    """A peak of a joint or of the tool is not what the answer says."""
    WORK = "WORK"
    """The claim needs more work than the checker does."""
    CLAIM = "CLAIM"
    """Something else that the answer says beside its plan is not so: contacts, or what it repeats of the request."""
    REFUSAL = "REFUSAL"
    """A refusal claims to be proved and is not, or what it states is wrong."""


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

"""The steps of a task: control points, and how each is to be met. Facts only, SI.

Every kind of step answers the same questions; what a kind does not have is stated once, in its class: `tracks` (whether
the tool is guided along the point's frame for a time), `part`, `target`, `approach_m`, `depart_m`, `dwell_s`, `match`,
`via`, `arch`, `leg`, `window`, `tolerance`, `contact_tolerance_m`, `approach_stop`, `depart_stop`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeGuard

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.path import Path, PathPart, Point, end_of


@dataclass(frozen=True, slots=True)
class Window:
    """When a control point may be met: `time` in seconds, `along` in metres along its conveyor (either or both)."""

    time: tuple[float, float] | None = None
    along: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Target:
    """A pose of the tool point (or, for a place, of the part) that is constant in a frame. `yaw_free`: with any yaw;
    `yaw_keep`: with the yaw, in the world, that the tool has when the step begins; then `yaw_free` holds, too.

    `pitch`, `roll`: of the tool, rad, for arms that have these coordinates (`assur.planner.frames.motion`); None: free.
    """

    frame: str
    pose: Pose
    yaw_free: bool = False
    pitch: float | None = None
    roll: float | None = None
    yaw_keep: bool = False


Match = Literal["velocity", "position"]


@dataclass(frozen=True, slots=True)
class Tolerance:
    """The largest error of the tool against the part or the control point: a distance, m, and a yaw, rad."""

    position_m: float = math.inf
    yaw_rad: float = math.inf


ANY_ERROR = Tolerance()


@dataclass(frozen=True, slots=True)
class Arch:
    """Up, over, down: `top_m` is the least height (world z of the tool point) of the highest point."""

    top_m: float


class _Bare:
    """What a step without a part has none of."""

    __slots__ = ()
    part: ClassVar[None] = None
    approach_m: ClassVar[float] = 0.0
    depart_m: ClassVar[float] = 0.0
    approach_stop: ClassVar[bool] = False
    depart_stop: ClassVar[bool] = False
    contact_tolerance_m: ClassVar[float] = 0.0


class _Guided(_Bare):
    """... and which guides the tool along the frame of its target."""

    __slots__ = ()
    tracks: ClassVar[bool] = True
    match: ClassVar[Match] = "velocity"
    via: ClassVar[bool] = False
    arch: ClassVar[None] = None
    leg: ClassVar[Literal["joint"]] = "joint"


@dataclass(frozen=True, slots=True)
class Move(_Bare):
    """Bring the tool point to `target`. `via`: flown by, never stopped at. `leg`: joint or cartesian: straight or, if
    there is one, along a `path` in the target's frame that ends there, corners rounded within `blend_m`."""

    name: str
    target: Target
    match: Match = "velocity"
    via: bool = False
    arch: Arch | None = None
    window: Window = Window()
    leg: Literal["joint", "cartesian"] = "joint"
    path: tuple[PathPart, ...] = ()
    blend_m: float = 0.0

    tracks: ClassVar[bool] = False
    dwell_s: ClassVar[float] = 0.0
    tolerance: ClassVar[Tolerance] = ANY_ERROR

    def __post_init__(self) -> None:
        if not self.path:
            return
        if self.leg != "cartesian" or self.via or self.arch is not None:
            raise InputError("path", self.path, "none: only a cartesian leg that is no via has one")
        pose = self.target.pose
        if end_of(self.path[-1]) != (pose.x, pose.y, pose.z):
            raise InputError("path", end_of(self.path[-1]), "a path that ends at the target")

    def path_from(self, begin: Point) -> Path:
        """The path from a point in the target's frame. Raises `PathError` where there is none."""
        return Path(begin, self.path, self.blend_m)


@dataclass(frozen=True, slots=True)
class Follow(_Guided):
    """Meet `target` with its velocity and track it for `duration_s`."""

    name: str
    target: Target
    duration_s: float
    window: Window = Window()
    tolerance: Tolerance = ANY_ERROR

    @property
    def dwell_s(self) -> float:
        return self.duration_s


@dataclass(frozen=True, slots=True)
class Trace(_Guided):
    """Take the tool point along `path` in the target's frame, at `speed_m_s` relative to that frame.

    `target`: frame, first point and yaw of the tool, which it keeps in the frame. The speed is reached on a straight
    lead-in of `lead_in_m` along the first tangent before the path, and given up on a lead-out behind it.
    """

    name: str
    target: Target
    path: Path
    speed_m_s: float
    lead_in_m: float
    lead_out_m: float
    window: Window = Window()

    tolerance: ClassVar[Tolerance] = ANY_ERROR

    def __post_init__(self) -> None:
        for name in ("speed_m_s", "lead_in_m", "lead_out_m"):
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise InputError(name.removesuffix("_m").removesuffix("_m_s"), value, "a finite number above 0")
        pose = self.target.pose
        if self.path.begin != (pose.x, pose.y, pose.z):
            raise InputError("start", self.path.begin, "the first point of the path")

    @property
    def dwell_s(self) -> float:
        """How long the path takes, without lead-in and lead-out, s."""
        return self.path.length / self.speed_m_s

    @property
    def end(self) -> Pose:
        """The pose in the frame that the tool has at the end of the path."""
        return Pose(*self.path.end, self.target.pose.yaw)


LEAD_ACCELERATION, LEAD_S = 3.0, 0.04
"""m/s², s: a lead-in that is not stated is as long as this peak of the acceleration makes it, and takes so much."""


def lead_length(speed: float) -> float:
    """How long, m, a lead-in or a lead-out is that is not stated, for a speed in m/s (Q6)."""
    return speed / 2.0 * max(1.5 * speed / LEAD_ACCELERATION, LEAD_S)


@dataclass(frozen=True, slots=True)
class Pick:
    """Approach `part` along the vertical of its frame, track it, attach it at the end of `dwell_s`, depart.

    `grasp` is the tool point in the part's frame; `contact_with` names what the part rests on (None: derived).
    `contact_tolerance_m`: how deep allowed contacts may become where things are not where they are planned.
    `held_within`: how well the part is known in the gripper once it is held (None: as well as when it was gripped).
    `approach_stop`, `depart_stop`: whether the tool stops at the outer end of that straight part; else it moves on
    along the vertical where it can. `grip_within_m`: how far, m, the tool's bodies may be from the part when it is
    attached.
    """

    name: str
    part: str
    grasp: Pose
    approach_m: float
    dwell_s: float
    depart_m: float
    match: Match = "velocity"
    window: Window = Window()
    contact_with: tuple[str, ...] | None = None
    tolerance: Tolerance = ANY_ERROR
    contact_tolerance_m: float = 0.0
    held_within: PoseUncertainty | None = None
    approach_stop: bool = False
    depart_stop: bool = False
    arch: Arch | None = None
    grip_within_m: float = math.inf

    tracks: ClassVar[bool] = True
    via: ClassVar[bool] = False
    leg: ClassVar[Literal["joint"]] = "joint"
    target: ClassVar[None] = None


@dataclass(frozen=True, slots=True)
class Place:
    """Bring the held part's frame to `to`, track it, detach at the end of `dwell_s`, depart; the part then sits in
    `to.frame`. `support_within_m`: how far, m, the part may be from the nearest body of `contact_with` when it is
    detached. `gone_after_s`: so long after that, s, somebody has taken the part away (None: nobody does)."""

    name: str
    part: str
    to: Target
    approach_m: float
    dwell_s: float
    depart_m: float
    match: Match = "velocity"
    window: Window = Window()
    contact_with: tuple[str, ...] | None = None
    tolerance: Tolerance = ANY_ERROR
    contact_tolerance_m: float = 0.0
    approach_stop: bool = False
    depart_stop: bool = False
    arch: Arch | None = None
    support_within_m: float = math.inf
    gone_after_s: float | None = None

    tracks: ClassVar[bool] = True
    via: ClassVar[bool] = False
    leg: ClassVar[Literal["joint"]] = "joint"

    def __post_init__(self) -> None:
        if math.isfinite(self.support_within_m) and not self.contact_with:
            allowed = "none without contact_with, which names what the part rests on"
            raise InputError("support_within_m", self.support_within_m, allowed)
        if self.gone_after_s is not None and not 0.0 <= self.gone_after_s < math.inf:
            raise InputError("gone_after_s", self.gone_after_s, "a finite time of at least 0")

    @property
    def target(self) -> Target:
        """Where the part is put: its own pose, not that of the tool."""
        return self.to


def key_of(step: Step) -> str:
    """The kind of a step, as a task names it: ``pick``, ``place``, ``move``, ``follow`` or ``trace``."""
    return type(step).__name__.lower()


def is_taken_away(step: Step) -> TypeGuard[Place]:
    """Whether a step is a place whose part is taken away."""
    return isinstance(step, Place) and step.gone_after_s is not None


Step = Move | Follow | Trace | Pick | Place

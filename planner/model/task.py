"""The steps of a task: control points with manners. Facts only, SI."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from assur.planner.frames.motion import Pose


@dataclass(frozen=True, slots=True)
class Window:
    """When a control point may be met: `time` in seconds, `along` in metres along its conveyor (either or both)."""

    time: tuple[float, float] | None = None
    along: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Target:
    """A pose of the tool point (or, for a place, of the part) that is constant in a frame. `yaw` free: any yaw.

    `pitch`, `roll`: of the tool, rad, for arms that have these coordinates (`assur.planner.frames.tilted`); None: free.
    """

    frame: str
    pose: Pose
    yaw_free: bool = False
    pitch: float | None = None
    roll: float | None = None


Match = Literal["velocity", "position"]


@dataclass(frozen=True, slots=True)
class Arch:
    """Up, over, down: `top_m` is the least height (world z of the tool point) of the highest point."""

    top_m: float


@dataclass(frozen=True, slots=True)
class Move:
    """Bring the tool point to `target`. `via`: flown by, never stopped at. `leg`: joint or cartesian (straight)."""

    name: str
    target: Target
    match: Match = "velocity"
    via: bool = False
    arch: Arch | None = None
    window: Window = Window()
    leg: Literal["joint", "cartesian"] = "joint"


@dataclass(frozen=True, slots=True)
class Follow:
    """Meet `target` with its velocity and stay glued to it for `duration_s`."""

    name: str
    target: Target
    duration_s: float
    window: Window = Window()


@dataclass(frozen=True, slots=True)
class Pick:
    """Approach `part` along the vertical of its frame, glue, attach at the end of `dwell_s`, depart.

    `grasp` is the tool point in the part's frame; `contact_with` names what the part rests on (None: derived).
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


@dataclass(frozen=True, slots=True)
class Place:
    """Bring the held part's frame to `to`, glue for `dwell_s`, detach, depart; the part then rides on to.frame."""

    name: str
    part: str
    to: Target
    approach_m: float
    dwell_s: float
    depart_m: float
    match: Match = "velocity"
    window: Window = Window()
    contact_with: tuple[str, ...] | None = None


Step = Move | Follow | Pick | Place

"""A control point as the arm meets it: the motion of the flange there, and when it may be met."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose, Tilt
from assur.planner.laws.belt_window import outside_for_good, times_inside, travelled
from assur.planner.model.attachments import Attachments
from assur.planner.model.scene import Scene, Step, Trace, Window
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory

WINDOW_S = 1e-12
"""A window, and the latest end, are kept up to this, s: rounding of times."""
ROUNDED_S, ROUNDED = 1e-12, 8
"""By so many seconds, and units in the last place of a clock that counts far, a window may seem too short for its
dwell: its ends were read, converted from milliseconds, or found along a belt. In 1 ps a fast arm goes 10 pm."""


@dataclass(frozen=True, eq=False)
class MovingEnd:
    """The end of a straight part at which the tool does not stop: motion along the vertical of the point at the outer
    end of an approach or depart.

    `height` above the point, m; its `rate`, m/s, upwards positive, and `acceleration`, m/s²; `far`: the height, m, at
    which the motion that was cut there stops; `profile`: the heights from there to rest at the point, or back.
    """

    height: float
    rate: float
    acceleration: float
    far: float
    profile: Trajectory


@dataclass(frozen=True, eq=False)
class ControlPoint:
    """The control point of step number `step`: the flange's `pose` in `frame`, `tilt` (pitch and roll of the tool at
    the point, which it keeps while it is there; None: the arm has none), and the turn of the tool that it is for.

    `target`: the pose in the frame whose way along a conveyor is measured: the part's, or the target's.
    """

    scene: Scene
    step: int
    facts: Step
    """The step that it belongs to."""
    frame: str
    pose: Pose
    target: Pose
    yaw_offset: float
    tilt: Tilt | None
    approach: float
    """Metres above the point, along the vertical that every frame shares, where tracking begins."""
    dwell: float
    """Seconds for which the point itself is tracked."""
    depart: float
    """Metres above the point where tracking ends."""
    held: str | None = None
    """The part in the gripper on the way to the point and there."""
    entry: MovingEnd | None = None
    """How the tool comes into the approach; None: from rest above the point."""

    @property
    def limits(self) -> Limits:
        """The joints' limits until the tool leaves the point: with what the gripper holds there."""
        return self.scene.limits_with(self.held)

    @property
    def limits_after(self) -> Limits:
        """... and from then on: with what was picked, or without what was placed."""
        step = self.facts
        return self.limits if step.part is None else self.scene.limits_with(step.part if step.target is None else None)

    def carries(self, *, up: bool) -> bool:
        """Whether a part is in the gripper on the way down to the point, to be placed, or `up` from it, as picked."""
        return self.facts.part is not None and (self.facts.target is None) == up

    @property
    def name(self) -> str:
        return self.facts.name

    @property
    def tracks(self) -> bool:
        """Whether the tool is guided along the frame for a time."""
        return self.facts.tracks

    @property
    def via(self) -> bool:
        return self.facts.via

    @property
    def matched(self) -> bool:
        """Whether velocity and yaw rate at the point are those of the frame."""
        return self.facts.match == "velocity"

    @property
    def window(self) -> Window:
        return self.facts.window

    @property
    def still(self) -> bool:
        """Whether the control point never moves."""
        return self.scene.frames[self.frame].law.is_fixed

    def flange(self, t: FloatArray, above: float = 0.0) -> Motion:
        """Motion of the flange (world) that tracks the point, `above` metres over it, at times t (...)."""
        motion = self.scene.frames[self.frame].law.motion(t).at(self.pose, above)
        return motion if self.tilt is None else motion.with_tilt(np.array(self.tilt))

    def entered(self, t: FloatArray) -> Motion:
        """Motion of the flange (world) with which the point is met at times t (...), `approach` above it."""
        motion = self.flange(t, self.approach)
        if self.facts.match != "velocity" or self.facts.via:
            motion = motion.at_rest()
        if self.entry is None:
            return motion
        table = motion.table.copy()
        table[..., 1, 2] += self.entry.rate
        table[..., 2, 2] += self.entry.acceleration
        return Motion(table)

    @property
    def span(self) -> tuple[float, float]:
        """From when until when the point may be tracked (`span_of`)."""
        return span_of(self.scene, self.frame, self.window)

    @cached_property
    def intervals(self) -> list[tuple[float, float]]:
        """Times at which tracking may begin, as closed intervals in order; empty: the dwell does not fit."""
        window, found = self.facts.window, list[tuple[float, float]]()
        low, high = span_of(self.scene, self.frame, window)
        for first, last in ((low, high),) if window.along is None else self.inside(window.along):
            a, b = max(low, first), min(high, last)
            if b - self.dwell >= a or self._fits(a, b):
                found.append((a, max(a, b - self.dwell)))
        return found

    def _fits(self, a: float, b: float) -> bool:
        """Whether the dwell fits between a and b, s, but for rounding. A window may be exactly as long as it: 1.4 − 0.3
        rounds to less than 1.1, and does not make the window shorter. A law that ends is kept to the bit."""
        known = a + self.dwell <= self.scene.frames[self.frame].law.valid[1]
        return known and a - (b - self.dwell) <= ROUNDED_S + ROUNDED * max(math.ulp(a), math.ulp(b))

    @property
    def outside_for_good(self) -> bool:
        """Whether it stays outside its window along a conveyor after the time that is searched."""
        law, window = self.scene.frames[self.frame].law, self.window.along
        if window is None or law.way is None:
            return True
        return outside_for_good(law, self.target, window, self.scene.start.time)

    def along(self, t: FloatArray) -> FloatArray | None:
        """Metres (...) of the control point along its conveyor from the conveyor's given pose; None: no conveyor."""
        law = self.scene.frames[self.frame].law
        if law.way is None:
            return None
        return travelled(law, self.target, t)

    def inside(self, window: tuple[float, float]) -> tuple[tuple[float, float], ...]:
        """When the point is in `window`, m along its conveyor, in the next `HORIZON_S`; closed intervals in order."""
        law = self.scene.frames[self.frame].law
        if law.way is None:
            raise InputError(f"task[{self.step}].window_mm", window, "a window in millimetres only on a conveyor")
        return times_inside(law, self.target, window, self.scene.start.time)


def span_of(scene: Scene, frame: str, window: Window) -> tuple[float, float]:
    """From when until when a point on a frame may be tracked, s, its window along a conveyor left aside; empty if
    reversed."""
    valid, latest = scene.frames[frame].law.valid, scene.options.latest_end_s
    opens, closes = window.time or (-math.inf, math.inf)
    return max(scene.start.time, valid[0], opens), min(valid[1], math.inf if latest is None else latest, closes)


def control_point(
    scene: Scene, step: int, attached: Attachments, yaw_offset: float, tilt: Tilt | None = None
) -> ControlPoint:
    """The control point of a step that begins with `attached`; an arm with pitch and roll meets it with those of
    `tilt`. Of a trace it is where the lead-in begins, and the dwell is that of the path."""
    what = scene.task[step]
    frame, pose = attached.flange(scene, what, yaw_offset)
    if isinstance(what, Trace):
        pose = _before(what, pose)
    target, (approach, depart) = attached.point(scene, what)[1], scene.straight(what)
    held = None if attached.held is None else attached.held.part
    return ControlPoint(scene, step, what, frame, pose, target, yaw_offset, tilt, approach, what.dwell_s, depart, held)


def _before(step: Trace, pose: Pose) -> Pose:
    """The pose, in the frame, of what has `pose` there at the beginning of a path, where the lead-in begins."""
    _, tangent, _ = step.path.curve.at(np.zeros(1))
    x, y, z = (step.lead_in_m * tangent[0]).tolist()
    return Pose(pose.x - x, pose.y - y, pose.z - z, pose.yaw)

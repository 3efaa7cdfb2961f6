"""The course along a path in a frame, and how far the pieces over jumps of its curvature may reach (equation Q7)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose, Tilt
from assur.planner.model.path import Path
from assur.planner.model.refusal import PathPart, Spot
from assur.planner.model.scene import Scene

BEND_M = 6e-6
"""m. How far the joints' spline may leave the path where its curvature jumps."""
BEND_SHARE = 2.684e-3
"""The quintic over a jump of the second derivative in its middle leaves it by this, times the jump and the square of
its length (Q7)."""
REACH = 0.45
"""Of the shorter part at a jump, how much the piece over it takes at most."""
FLAT = 1e-9
"""1/m. A smaller jump of the curvature is none."""


@dataclass(frozen=True, eq=False)
class PathCourse:
    """The course of the flange along a path in `frame`: the phase is the arc length, m from the path's first point, in
    parts of `unit`, m, and runs between `edges`, m. The flange is where its point `tcp` is on the path, or `beside` it,
    m in the frame. `turn`: yaw in the frame at the phase 0, and by how much it has turned at the phase 1; `tilts`:
    pitch and roll there, of a hand that has them. `stands`: the time, s, at which the frame is taken to stand; None: it
    moves."""

    scene: Scene
    frame: str
    path: Path
    edges: tuple[float, float]
    unit: float
    tcp: Pose
    beside: FloatArray
    turn: tuple[float, float]
    tilts: tuple[Tilt, Tilt] | None
    stands: float | None = None

    def motion(self, t: FloatArray, s: FloatArray, sd: FloatArray, sdd: FloatArray) -> Motion:
        """Motion (T,) of the flange in the world at times t (T,) in these phases (T,); without jerk."""
        r, tangent, bend = self.path.curve.at(self.unit * s)
        rate = (self.unit * sd)[:, None] * tangent
        pull = (self.unit * sdd)[:, None] * tangent + ((self.unit * sd) ** 2)[:, None] * bend
        law, (yaw, turn) = self.scene.frames[self.frame].law, self.turn
        frame = law.motion(t) if self.stands is None else law.motion(np.full(len(t), self.stands)).at_rest()
        motion = frame.carrying(self.beside + r, rate, pull, yaw + s * turn, sd * turn, sdd * turn)
        motion = motion.at(self.tcp.inverse())
        if self.tilts is None:
            return motion
        one = np.array(self.tilts[0])
        gone = np.array(self.tilts[1]) - one
        gone -= 2 * np.pi * np.round(gone / (2 * np.pi))
        return motion.with_tilt(one + s[:, None] * gone, sd[:, None] * gone, sdd[:, None] * gone)

    def spot(self, s: float) -> Spot:
        """Where on the path the tool is in a phase."""
        return spot(self.path, self.unit * s)

    @cached_property
    def widths(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Arc lengths, m, of junctions without a jump of the curvature; of those with one, (J,), and half of how far
        the piece over each reaches, (J,), m."""
        junctions = self.path.curve.junctions
        lengths = np.diff([self.edges[0], *(each.at for each in junctions), self.edges[1]])
        rows = [k for k, each in enumerate(junctions) if each.jump > FLAT]
        widest = [np.sqrt(BEND_M / (BEND_SHARE * junctions[k].jump)) / 2 for k in rows]
        room = [REACH * min(lengths[k], lengths[k + 1]) for k in rows]
        smooth = np.array([each.at for each in junctions if each.jump <= FLAT])
        half = np.array([min(one, other) for one, other in zip(widest, room, strict=True)])
        return smooth, np.array([junctions[k].at for k in rows]), half


def spot(path: Path, s: float) -> Spot:
    """The place at arc length `s` from the path's first point, m: less than 0 on the lead-in of a trace."""
    x, y, z = path.curve.at(np.array([s]))[0][0].tolist()
    part: PathPart = "lead-in" if s < 0.0 else "lead-out" if s > path.length else "path"
    return {"path_m": s, "path_part": part, "path_at_m": (x, y, z)}

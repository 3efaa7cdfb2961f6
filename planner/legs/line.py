"""The way of the tool point between two frames that move, p(s, t) = A(t) + s (B(t) - A(t)), timed by a phase law s(t).

With Δ = B - A (equation L1):

    ṗ = Ȧ + s Δ̇ + ṡ Δ        p̈ = Ä + s Δ̈ + 2 ṡ Δ̇ + s̈ Δ

and likewise yaw, pitch and roll, the short way round. The flange is where it then has to be: beside a line, where the
tool point is beside the flange's axis and the yaw changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import TiltedMotion

Along = Callable[[FloatArray], Motion]
"""The motion of a frame at times (T,)."""


@dataclass(frozen=True, slots=True)
class Line:
    """The course between two frames of the flange; `tcp`: the tool point in the flange, which is what goes along the
    line."""

    left: Along
    met: Along
    tcp: Pose = Pose()

    def motion(self, t: FloatArray, s: FloatArray, sd: FloatArray, sdd: FloatArray) -> Motion:
        """Motion (T,) of the flange, equation L1, at times t (T,) in these phases (T,)."""
        beside = Pose(self.tcp.x, self.tcp.y)
        a, b = self.left(t).at(beside), self.met(t).at(beside)
        turn = np.round((b.yaw[0] - a.yaw[0]) / (2 * np.pi)) * 2 * np.pi
        p, v, acceleration = _between(a.p, a.v, a.a, b.p, b.v, b.a, s[:, None], sd[:, None], sdd[:, None])
        yaw, yaw_d, yaw_dd = _between(a.yaw, a.yaw_d, a.yaw_dd, b.yaw - turn, b.yaw_d, b.yaw_dd, s, sd, sdd)
        motion = Motion(p, v, acceleration, np.zeros_like(p), yaw, yaw_d, yaw_dd, np.zeros_like(yaw))
        if not (isinstance(a, TiltedMotion) and isinstance(b, TiltedMotion)):
            return motion.at(beside.inverse())
        turns = np.round((b.tilt[0] - a.tilt[0]) / (2 * np.pi)) * 2 * np.pi
        rates = a.tilt_d, a.tilt_dd, b.tilt - turns, b.tilt_d, b.tilt_dd
        tilt = _between(a.tilt, *rates, s[:, None], sd[:, None], sdd[:, None])
        return TiltedMotion.of(motion, *tilt, np.zeros_like(tilt[0]))


def _between(
    a: FloatArray,
    ad: FloatArray,
    add: FloatArray,
    b: FloatArray,
    bd: FloatArray,
    bdd: FloatArray,
    s: FloatArray,
    sd: FloatArray,
    sdd: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    gap, gap_d, gap_dd = b - a, bd - ad, bdd - add
    return a + s * gap, ad + s * gap_d + sd * gap, add + s * gap_dd + 2 * sd * gap_d + sdd * gap

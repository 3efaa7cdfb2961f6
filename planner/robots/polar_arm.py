"""The polar arm with three axes (RRP): a base that turns, and an RPR dyad in the vertical plane.

q = [θ1, ψ, d]: base angle, angle of the arm above the horizontal (up is positive), length from shoulder to flange. The
flange is, in the plane, at ζ = d e^{iψ} (K25). Source: 002, whose θ2 is ψ − 90° and whose l1 is the shoulder's height;
000, figures 2 and 3, for the dyad.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen
from assur.planner.assur.codes import Code
from assur.planner.assur.rpr import FORWARD, RPR
from assur.planner.assur.rrr import ROUNDING, Planar
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import SMALLEST_M
from assur.planner.robots.planar import principal
from assur.planner.robots.protocol import Sweep
from assur.planner.robots.tilting import TiltingArm
from assur.planner.robots.vertical_plane import LINK2, LINK3, InPlane, Orders

MODES = ("front", "back")
"""`back`: the base is turned away and the arm reaches over the vertical."""
BEYOND = 1.0 + 1e-6
"""Share of the longest stroke up to which bounds of speed hold: a trajectory may exceed its limits by rounding."""
_RATES = frozen(np.eye(3), (3, 3), "rate_matrix")


@dataclass(frozen=True, eq=False, kw_only=True)
class PolarArm(TiltingArm):
    """A polar arm; implements `assur.planner.robots.protocol.Robot`.

    `link2` is the guide that tilts, its frame at the shoulder; `link3` the ram that slides in it, its frame at the
    flange; `flange` likewise. Raises `InputError` unless the ram's shortest length is at least 10 µm: at zero the arm
    has no direction. The rest: `TiltingArm`.
    """

    dyad: RPR = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if len(self.limits.lower) == 3 and not self.limits.lower[2] >= SMALLEST_M:
            raise InputError("robot.limits.lower", float(self.limits.lower[2]), f"a length from {SMALLEST_M} m")
        super().__post_init__()
        object.__setattr__(self, "dyad", RPR(ROUNDING * self.longest))

    @property
    def modes(self) -> tuple[str, ...]:
        return MODES

    @property
    def longest(self) -> float:
        return float(self.limits.upper[-1])

    @property
    def rate_matrix(self) -> FloatArray:
        """(3, 3): φ̇1, ψ̇, ḋ."""
        return _RATES

    def _names(self) -> tuple[str, str, str]:
        return ("theta1", "theta2", "d3")

    def _kinds(self) -> tuple[str, str, str]:
        return ("revolute", "revolute", "prismatic")

    def _side(self, mode: int) -> tuple[int, int]:
        return (1, -1)[mode], FORWARD

    def _assembled(self, assembly: int, path: list[Planar]) -> InPlane:
        solved = self.dyad.solve(assembly, path[0], *path[1:])
        joints = np.empty((len(path), *solved.code.shape, 2))
        joints[0, ..., 0], joints[0, ..., 1] = principal(solved.angle), solved.length
        for k, (turns, grows) in enumerate(solved.rates, start=1):
            joints[k, ..., 0], joints[k, ..., 1] = turns, grows
        return InPlane(joints, solved.code, np.minimum(solved.length / self.longest, 1.0))

    def _arms(self, link: int, joints: Orders) -> list[tuple[list[FloatArray], list[FloatArray]]]:
        return [([x[..., 2] for x in joints], [x[..., 1] for x in joints])] if link >= LINK3 else []

    def _tilt(self, _link: int, q: FloatArray, /) -> FloatArray:
        return q[..., 1]

    def _plane_jacobian(self, q: FloatArray) -> FloatArray:
        c, s, d = np.cos(q[..., 1]), np.sin(q[..., 1]), q[..., 2]
        return np.stack([np.stack([-d * s, c], -1), np.stack([d * c, s], -1)], -2)

    @np.errstate(all="ignore")
    def mode_of(self, q: FloatArray) -> IntArray:
        """Working mode number (...) of q: 0 (front) where d cos ψ >= 0, else 1 (back); −1 where it is not finite."""
        rho = q[..., 2] * np.cos(q[..., 1])
        return np.where(rho >= 0.0, 0, np.where(rho < 0.0, 1, -1))

    def _dyad_margin(self, q: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
        """d over the longest stroke: the arm is singular with nothing of the ram out, its workspace's inner edge."""
        d = np.abs(q[..., 2])
        return np.minimum(d / self.longest, 1.0), np.full(d.shape, int(Code.FOLDED)), d

    def _plane_bounds(
        self, link: IntArray, distance: FloatArray, sweep: Sweep
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """A point of the guide turns; one of the ram is at most d + its own distance away, and slides: K20, K21."""
        slides = link != LINK2
        far = distance + np.where(slides, BEYOND * self.longest, 0.0)
        w, dw = sweep.rate[:, 1], sweep.rate_d[:, 1]
        v, dv = slides * sweep.rate[:, 2], slides * sweep.rate_d[:, 2]
        return far * w + v, far * np.hypot(dw, w * w) + dv + 2.0 * v * w, far

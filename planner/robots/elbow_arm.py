"""The elbow arm with three axes (RRR): a base that turns, and an RRR dyad in the vertical plane.

q = [θ1, θ2, θ3]: base angle, angle of the upper arm above the horizontal, angle of the forearm from the upper arm (up
is positive). With ψ2 = θ2 and ψ3 = θ2 + θ3 the flange is, in the plane, at ζ = l1 e^{iψ2} + l2 e^{iψ3} (K24); the tool
is a part of the forearm. Sources: 002 (geometric method), 003 (by oblique triangles).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen
from assur.planner.assur.rrr import LEFT, RIGHT, RRR, Planar
from assur.planner.robots.planar import elbow_singularity
from assur.planner.robots.protocol import Sweep
from assur.planner.robots.tilting import TiltingArm
from assur.planner.robots.vertical_plane import FLANGE, LINK2, LINK3, InPlane, Orders

MODES = ("up", "down", "back-up", "back-down")
"""Elbow above or below the line from shoulder to flange; `back`: the base is turned away, the arm reaches over it."""
_SIDES = ((1, LEFT), (1, RIGHT), (-1, RIGHT), (-1, LEFT))
_RATES = frozen([[1, 0, 0], [0, 1, 0], [0, 1, 1]], (3, 3), "rate_matrix")


@dataclass(frozen=True, eq=False, kw_only=True)
class ElbowArm(TiltingArm):
    """An elbow arm; implements `assur.planner.robots.protocol.Robot`.

    `link2` is the upper arm, its frame at the shoulder; `link3` the forearm, its frame at the elbow; `flange` is at the
    forearm's end and tilts with it. `l1`, `l2`: lengths of upper arm and forearm, m. The rest: `TiltingArm`.
    """

    l1: float
    l2: float
    dyad: RRR = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "dyad", RRR(self.l1, self.l2))
        super().__post_init__()

    @property
    def modes(self) -> tuple[str, ...]:
        return MODES

    @property
    def longest(self) -> float:
        return self.l1 + self.l2

    @property
    def rate_matrix(self) -> FloatArray:
        """(3, 3): φ̇1, ψ̇2, ψ̇3 per joint rate."""
        return _RATES

    def _names(self) -> tuple[str, ...]:
        return ("theta1", "theta2", "theta3")

    def _kinds(self) -> tuple[str, ...]:
        return ("revolute", "revolute", "revolute")

    def _side(self, mode: int) -> tuple[int, int]:
        return _SIDES[mode]

    def _assembled(self, assembly: int, path: list[Planar]) -> InPlane:
        solved = self.dyad.solve(assembly, path[0], *path[1:])
        (ux, uy), (wx, wy) = solved.u, solved.w
        joints = np.empty((len(path), *solved.code.shape, 2))
        joints[0, ..., 0] = np.arctan2(uy + 0.0, ux)  # + 0.0: an arm that points straight back is at π, not −π
        joints[0, ..., 1] = np.arctan2(solved.cross, ux * wx + uy * wy)
        for k, (first, second) in enumerate(solved.rates, start=1):
            joints[k, ..., 0], joints[k, ..., 1] = first, second - first
        return InPlane(joints, solved.code, solved.margin)

    def _arms(self, link: int, joints: Orders) -> list[tuple[list[FloatArray], list[FloatArray]]]:
        upper = [x[..., 1] for x in joints]
        fore = [x[..., 1] + x[..., 2] for x in joints]
        none = [np.zeros(upper[0].shape) for _ in joints[1:]]
        arms = []
        if link >= LINK3:
            arms.append(([np.full(upper[0].shape, self.l1), *none], upper))
        if link >= FLANGE:
            arms.append(([np.full(upper[0].shape, self.l2), *none], fore))
        return arms

    def _tilt(self, link: int, q: FloatArray, /) -> FloatArray:
        return q[..., 1] if link == LINK2 else q[..., 1] + q[..., 2]

    def _plane_jacobian(self, q: FloatArray) -> FloatArray:
        psi2, psi3 = q[..., 1], q[..., 1] + q[..., 2]
        found = np.empty((*q.shape[:-1], 2, 2))
        found[..., 0, 1], found[..., 1, 1] = -self.l2 * np.sin(psi3), self.l2 * np.cos(psi3)
        found[..., 0, 0] = found[..., 0, 1] - self.l1 * np.sin(psi2)
        found[..., 1, 0] = found[..., 1, 1] + self.l1 * np.cos(psi2)
        return found

    @np.errstate(all="ignore")
    def mode_of(self, q: FloatArray) -> IntArray:
        """Working mode number (...) of q: by the signs of ρ and of sin θ3; −1 where they are not finite."""
        rho, sine = self._zeta(self.tip, (q,))[0][0], np.sin(q[..., 2])
        found = np.where(rho >= 0.0, np.where(sine > 0.0, 1, 0), np.where(sine > 0.0, 2, 3))
        return np.where(np.isfinite(rho + sine), found, -1)

    def _dyad_margin(self, q: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
        """|sin θ3|, and the distances of K16."""
        return elbow_singularity(self.l1, self.l2, q[..., 2])

    def _plane_bounds(
        self, link: IntArray, distance: FloatArray, sweep: Sweep
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Arms l1 and l2 as far as the link is beyond them, and the point's own distance, on the link's own angle."""
        upper = np.where(link == LINK2, distance, self.l1)
        fore = np.where(link == LINK2, 0.0, np.where(link == FLANGE, self.l2 + distance, distance))
        w, dw = sweep.rate[:, 1:3], sweep.rate_d[:, 1:3]
        size = np.hypot(dw, w * w)
        return upper * w[:, 0] + fore * w[:, 1], upper * size[:, 0] + fore * size[:, 1], upper + fore

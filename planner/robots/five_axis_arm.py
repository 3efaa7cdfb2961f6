"""The arm with five axes (RRRRR): an elbow arm that carries a wrist, which pitches and rolls. Mitsubishi RV-M1.

q = [θ1, θ2, θ3, θ4, θ5]: those of the elbow arm, angle of the hand from the forearm (up is positive), roll of the
flange about the hand. With ψ4 = θ2 + θ3 + θ4 the tool point is, in the plane, at ζ = l1 e^{iψ2} + l2 e^{iψ3} +
l3 e^{iψ4} (H2). Equations H of docs/kinematics.md. Source: 003, section 5.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen
from assur.planner.assur.codes import Code
from assur.planner.assur.rrr import Planar
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.planar import principal
from assur.planner.robots.protocol import Inverse, Sweep
from assur.planner.robots.tilting import TiltingArm
from assur.planner.robots.vertical_plane import LINK2, LINK3, Orders, turned

LINKS = ("base", "link1", "link2", "link3", "link4", "flange")
LINK4, FLANGE = 4, 5
_RATES = frozen(
    [[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], [0, 1, 1, 0, 0], [0, 1, 1, 1, 0], [0, 0, 0, 0, 1]], (5, 5), "rate_matrix"
)


@dataclass(frozen=True, eq=False, kw_only=True)
class FiveAxisArm(ElbowArm):
    """A five-axis arm; implements `assur.planner.robots.protocol.Robot` and `assur.planner.robots.protocol.Pitching`.

    `link2` to `link3` as in an elbow arm; `link4` is the hand, its frame at the pitch axis; `flange` is at the tool
    point, `l3` (m) from there along the hand, and rolls about it. Modes are named by the elbow and by the side on which
    the tool point is: in `back` modes the heading φ1 points away from it, and the pitch is still counted from φ1.
    Raises `InputError` unless l3 is positive and finite. The rest: `ElbowArm`.
    """

    l3: float
    links: tuple[str, ...] = field(default=LINKS, init=False, repr=False)
    tilting: frozenset[int] = field(default=frozenset((LINK2, LINK3, LINK4, FLANGE)), init=False, repr=False)
    coordinates: tuple[str, ...] = field(default=("x", "y", "z", "pitch", "roll"), init=False, repr=False)

    def __post_init__(self) -> None:
        if not 0.0 < self.l3 < np.inf:
            raise InputError("robot.l3", self.l3, "a positive length in m")
        super().__post_init__()

    @property
    def longest(self) -> float:
        return self.l1 + self.l2 + self.l3

    @property
    def rate_matrix(self) -> FloatArray:
        """(5, 5): φ̇1, ψ̇2, ψ̇3, ψ̇4, θ̇5 per joint rate."""
        return _RATES

    def _names(self) -> tuple[str, ...]:
        return ("theta1", "theta2", "theta3", "theta4", "theta5")

    def _kinds(self) -> tuple[str, ...]:
        return ("revolute",) * 5

    @np.errstate(all="ignore")
    def inverse(self, flange: Motion, mode: int, order: int = 3) -> Inverse:
        """Joint motion that gives the tool point this motion, with its pitch and roll, in working mode `mode`, H2, H3.

        Derivatives above `order` are NaN; the yaw is not looked at. Codes: those of `TiltingArm.inverse`, ALIGNED where
        the tool point is over the base axis. All joints are in (−π, π]. Raises `FaultError` for a motion without pitch
        and roll. Not checked: joint limits (`within`).
        """
        if not isinstance(flange, TiltedMotion):
            raise FaultError(f"{type(self).__name__}.inverse: a motion without pitch and roll")
        inner = TiltingArm.inverse(self, flange, mode, order)
        tilts = (flange.tilt, flange.tilt_d, flange.tilt_dd, flange.tilt_ddd)
        given = sum((0.0 * tilt.sum(-1) for tilt in tilts[: order + 1]), np.zeros(inner.code.shape))
        known = np.isfinite(given)
        code = np.where(known, inner.code, Code.OUT_OF_REACH).astype(np.int64)
        found = []
        for k, (q, tilt) in enumerate(zip((inner.q, inner.qd, inner.qdd, inner.qddd), tilts, strict=True)):
            hand = np.stack([tilt[..., 0] - q[..., 1] - q[..., 2], tilt[..., 1] + 0.0 * q[..., 1]], -1)
            joints = np.concatenate([q, hand if k else principal(hand)], -1)
            found.append(np.where(known[..., None], joints, np.nan))
        q, qd, qdd, qddd = found
        return replace(inner, q=q, qd=qd, qdd=qdd, qddd=qddd, code=code, margin=np.where(known, inner.margin, np.nan))

    def _inward(self, flange: Motion, path: list[Planar]) -> list[Planar]:
        """ζ of the wrist: that of the tool point less the hand, ζ − l3 e^{iP} (H2)."""
        if not isinstance(flange, TiltedMotion):
            raise FaultError(f"{type(self).__name__}: a motion without pitch and roll")
        pitch = [tilt[..., 0] for tilt in (flange.tilt, flange.tilt_d, flange.tilt_dd, flange.tilt_ddd)][: len(path)]
        length = [np.full(pitch[0].shape, self.l3), *(np.zeros(pitch[0].shape) for _ in path[1:])]
        return [(rho - x, h - z) for (rho, h), (x, z) in zip(path, turned(length, pitch), strict=True)]

    def _arms(self, link: int, joints: Orders) -> list[tuple[list[FloatArray], list[FloatArray]]]:
        arms = super()._arms(link, joints)
        if link >= FLANGE:
            hand = [x[..., 1] + x[..., 2] + x[..., 3] for x in joints]
            none = [np.zeros(hand[0].shape) for _ in joints[1:]]
            arms.append(([np.full(hand[0].shape, self.l3), *none], hand))
        return arms

    def _tilt(self, link: int, q: FloatArray, /) -> FloatArray:
        return q[..., 1] + q[..., 2] + q[..., 3] if link >= LINK4 else super()._tilt(link, q)

    @np.errstate(all="ignore")
    def placements(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Link frames in the world for q (..., 5): positions (..., 6, 3), rotations (..., 6, 3, 3), K31, H1, H4."""
        p, rotation = super().placements(q)
        c, s = np.cos(q[..., 4])[..., None], np.sin(q[..., 4])[..., None]
        across, up = rotation[..., FLANGE, :, 1].copy(), rotation[..., FLANGE, :, 2].copy()
        rotation[..., FLANGE, :, 1], rotation[..., FLANGE, :, 2] = c * across + s * up, c * up - s * across
        return p, rotation

    @np.errstate(all="ignore")
    def link_motion(self, link: int, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray) -> Motion:
        """Motion of a link's origin in the world for joint motion (..., 5), its yaw being the heading φ1; of the flange
        a `TiltedMotion`. Raises `FaultError` for a link that does not exist. NaN where the joint motion is not finite.
        """
        motion = super().link_motion(link, q, qd, qdd, qddd)
        if link != FLANGE:
            return motion
        tilts = [np.stack([x[..., 1] + x[..., 2] + x[..., 3], x[..., 4]], -1) for x in (q, qd, qdd, qddd)]
        return TiltedMotion.of(motion, *tilts)

    @np.errstate(all="ignore")
    def jacobian(self, q: FloatArray) -> FloatArray:
        """(..., 5, 5): rates of x, y, z in the world, pitch and roll per joint rate, H5."""
        phi, psi = q[..., 0] + self.base.yaw, np.cumsum(q[..., 1:4], -1)
        c, s = np.cos(phi), np.sin(phi)
        terms = np.array([self.l1, self.l2, self.l3]) * np.stack([np.cos(psi), np.sin(psi)])
        # link k moves all that hangs on it: sums from the tool point inwards
        rho, h = np.cumsum(terms[..., ::-1], -1)[..., ::-1]
        found = np.zeros((*q.shape[:-1], 5, 5))
        found[..., 0, 0], found[..., 1, 0] = -rho[..., 0] * s, rho[..., 0] * c
        found[..., 0, 1:4], found[..., 1, 1:4] = -h * c[..., None], -h * s[..., None]
        found[..., 2, 1:4] = rho
        found[..., 3, 1:4] = found[..., 4, 4] = 1.0
        return found

    def out_of_reach(self, p: FloatArray) -> FloatArray:
        """Metres (...) by which tool points p (..., 3) in the world are out of reach at every pitch, H8; 0: in reach.

        The wrist may be anywhere on the circle of radius l3 about the tool point, so at any distance from |d − l3| to
        d + l3 of the shoulder; the dyad reaches from |l1 − l2| to l1 + l2. NaN where p is not finite.
        """
        away = p - self.base.position
        d = np.hypot(np.hypot(away[..., 0], away[..., 1]), away[..., 2] - self.height)
        outer, inner = self.l1 + self.l2, abs(self.l1 - self.l2)
        short: FloatArray = np.maximum(np.maximum(np.abs(d - self.l3) - outer, inner - d - self.l3), 0.0)
        return short

    def _plane_bounds(
        self, link: IntArray, distance: FloatArray, sweep: Sweep
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Arms as far as the link is beyond them, and the point's own distance on the link's own angle; on the flange
        that distance rolls, too (H6, H7)."""
        upper = np.where(link == LINK2, distance, self.l1)
        fore = np.where(link == LINK2, 0.0, np.where(link == LINK3, distance, self.l2))
        hand = np.where(link == LINK4, distance, np.where(link == FLANGE, self.l3, 0.0))
        rolls = np.where(link == FLANGE, distance, 0.0)
        w, dw = sweep.rate[:, 1:5], sweep.rate_d[:, 1:5]
        size = np.hypot(dw, w * w)
        pitch, roll = w[:, 2], w[:, 3]
        v = upper * w[:, 0] + fore * w[:, 1] + hand * pitch + rolls * np.hypot(pitch, roll)
        a = upper * size[:, 0] + fore * size[:, 1] + hand * size[:, 2]
        return v, a + rolls * (size[:, 2] + size[:, 3] + 2.0 * pitch * roll), upper + fore + hand + rolls

"""The links of a five-bar: where their frames are, and bounds of the motion of their points."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.assur.rrr import Planar
from assur.planner.frames.motion import Pose
from assur.planner.robots.loop import Loop
from assur.planner.robots.planar import arm_bounds
from assur.planner.robots.protocol import Sweep

LINKS = ("base", "proximal-left", "distal-left", "proximal-right", "distal-right", "quill", "flange")
BASE, PROXIMAL_LEFT, DISTAL_LEFT, PROXIMAL_RIGHT, DISTAL_RIGHT, QUILL, FLANGE = range(7)


def placements(base: Pose, loop: Loop, axes: int, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Link frames in the world for q (..., n): positions (..., 7, 3) and rotations (..., 7, 3, 3), K34."""
    shape, found = q.shape[:-1], loop.assembled((q[..., 0],), (q[..., 1],))
    c, s = np.cos(base.yaw), np.sin(base.yaw)
    u, w = joined(found.u), -joined(found.w)
    left, right = (np.stack([np.cos(q[..., k]), np.sin(q[..., k])], -1) for k in (0, 1))
    p, rotation = np.zeros((*shape, 7, 3)), np.empty((*shape, 7, 3, 3))
    rotation[...] = np.eye(3)
    side = np.array([0.0, loop.separation / 2])
    p[..., PROXIMAL_LEFT, :2], p[..., PROXIMAL_RIGHT, :2] = side, -side
    p[..., DISTAL_LEFT, :2] = side + loop.cranks[0] * left
    p[..., DISTAL_RIGHT, :2] = -side + loop.cranks[1] * right
    p[..., QUILL, :2] = p[..., FLANGE, :2] = p[..., DISTAL_LEFT, :2] + u
    if axes > 2:
        p[..., QUILL, 2] = p[..., FLANGE, 2] = q[..., 2]
    u, w = u / loop.couplers[0], w / loop.couplers[1]
    wrist = u
    if axes == 4:
        cosine, sine = np.cos(q[..., 3]), np.sin(q[..., 3])
        wrist = np.stack([cosine * u[..., 0] - sine * u[..., 1], sine * u[..., 0] + cosine * u[..., 1]], -1)
    turned = {PROXIMAL_LEFT: left, PROXIMAL_RIGHT: right, DISTAL_LEFT: u, DISTAL_RIGHT: w, FLANGE: wrist}
    turned[BASE] = np.broadcast_to(np.array([1.0, 0.0]), (*shape, 2))
    for link, e in turned.items():
        rotation[..., link, 0, 0] = rotation[..., link, 1, 1] = c * e[..., 0] - s * e[..., 1]
        rotation[..., link, 1, 0] = s * e[..., 0] + c * e[..., 1]
        rotation[..., link, 0, 1] = -rotation[..., link, 1, 0]
    x, y = p[..., 0].copy(), p[..., 1].copy()
    p[..., 0], p[..., 1] = c * x - s * y + base.x, s * x + c * y + base.y
    p[..., 2] += base.z
    return p, rotation


def joined(vector: Planar) -> FloatArray:
    """Vectors (..., 2) of their coordinates."""
    return np.stack(vector, -1)


_SPIN = np.zeros((7, 5))
"""Which of φ̇1, φ̇5, φ̇2, φ̇3, φ̇4 turns each link frame; base and quill do not turn."""
_SPIN[[PROXIMAL_LEFT, PROXIMAL_RIGHT, DISTAL_LEFT, DISTAL_RIGHT, FLANGE], range(5)] = 1.0
_CRANKS = np.array([[0, 0], [0, 0], [1, 0], [0, 0], [0, 1], [1, 0], [1, 0]])
"""Beyond which crank a link is; flange and quill are told over the left side here."""
_TIP = np.array([0, 0, 0, 0, 0, 1, 1], dtype=np.bool_)
"""Links at the tool axis."""


@np.errstate(all="ignore")
def point_bounds(
    loop: Loop, link: IntArray, reach: FloatArray, n: FloatArray, sweep: Sweep
) -> tuple[FloatArray, FloatArray]:
    """Bounds (N,) of a five-bar's points: see `FiveBar.point_bounds`.

    Arms of a point (K42): r (φ1) or r (φ5) on a crank; a_L (φ1), r (φ2) or a_R (φ5), r (φ3) on a coupler; at the tool
    axis a_L (φ1), b_L (φ2) or a_R (φ5), b_R (φ3), whichever moves less, and r (φ4) on the flange.
    """
    flat = (n[:, 0] == 0.0) & (n[:, 1] == 0.0)
    passive = loop.passive(sweep.lower[:, :2], sweep.upper[:, :2], sweep.rate[:, :2], sweep.rate_d[:, :2])
    wrist = passive.left + sweep.rate[:, 3], passive.left_d + sweep.rate_d[:, 3]
    turn = np.stack([sweep.rate[:, 0], sweep.rate[:, 1], passive.left, passive.right, wrist[0]], -1)
    turn_d = np.stack([sweep.rate_d[:, 0], sweep.rate_d[:, 1], passive.left_d, passive.right_d, wrist[1]], -1)
    arms = reach[:, None] * _SPIN[link]
    arms[:, :2] += np.array(loop.cranks) * _CRANKS[link]
    tip = _TIP[link]
    lift, lift_d = tip * sweep.rate[:, 2], tip * sweep.rate_d[:, 2]
    over_left, over_right = arms.copy(), arms
    over_left[:, 2] += tip * loop.couplers[0]
    over_right[:, 0] = np.where(tip, 0.0, over_right[:, 0])
    over_right[:, 1] = np.where(tip, loop.cranks[1], over_right[:, 1])
    over_right[:, 3] += tip * loop.couplers[1]
    found = [_bounds(n, each, turn, turn_d, lift, lift_d, flat) for each in (over_left, over_right)]
    known = (reach >= 0) & np.isfinite(reach) & np.isfinite(sweep.rate).all(1) & np.isfinite(sweep.rate_d).all(1)
    speed, acceleration = (np.minimum(*pair) for pair in zip(*found, strict=True))
    return np.where(known, speed, np.inf), np.where(known, acceleration, np.inf)


def _bounds(
    n: FloatArray,
    arms: FloatArray,
    turn: FloatArray,
    turn_d: FloatArray,
    lift: FloatArray,
    lift_d: FloatArray,
    flat: BoolArray,
) -> tuple[FloatArray, FloatArray]:
    """`arm_bounds`, where arms of no length, and all arms along the vertical, move by nothing even if ∞ is known."""
    counts = (arms != 0.0) & ~flat[:, None]
    turn, turn_d, arms = (np.where(counts, x, 0.0) for x in (turn, turn_d, arms))
    return arm_bounds(n, arms, turn, turn_d, lift, lift_d)

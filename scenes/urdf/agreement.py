"""Compares an arm of ours with the chain of a file: the flanges at random states, and the links.

Both sides come from one reading of the file, so an error of the reader is not seen here. `unread` refuses all that the
reader ignores, and the tests compare poses with a second reader.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.robots.robot import Robot
from assur.scenes.conventions import converted
from assur.scenes.reading.arms import OVER, BuiltArm
from assur.scenes.urdf.chain import Chain
from assur.scenes.urdf.families import Kinematics
from assur.scenes.urdf.refusals import Unsuitable

STATES, SEED = 1_000, 0
"""Random states at which flanges are compared, within the ranges of the joints."""
WITHIN_M, WITHIN_RAD = 1e-6, 1e-6
"""How far the flanges may be apart."""
RIGID_M = 1e-7
"""How far a link's place in the frame that carries it may wander from state to state."""


def states(chain: Chain, ranges: list[list[float]], count: int = STATES) -> FloatArray:
    """Random states (count, n) of the joints in the file's count, within ranges."""
    low, high = np.array(ranges).T
    found: FloatArray = np.random.default_rng(SEED).uniform(low, high, (count, len(chain.joints)))
    return found


def frames(arm: BuiltArm, q: FloatArray) -> dict[str, FloatArray]:
    """Poses (..., 4, 4) of our links in the frame of the file's base for states (..., n) in the file's count."""
    robot: Robot = arm.robot(Pose(), arm.limits)
    positions, rotations = robot.placements(converted(q, arm.conventions))
    found = {}
    for i, name in enumerate(robot.links):
        pose = np.zeros((*q.shape[:-1], 4, 4))
        pose[..., :3, :3], pose[..., :3, 3], pose[..., 3, 3] = rotations[..., i, :, :], positions[..., i, :], 1.0
        found[name] = pose
    return found


def between(one: FloatArray, other: FloatArray) -> tuple[float, float]:
    """How far poses (N, 4, 4) are apart at most: m, rad."""
    distance = np.linalg.norm(one[..., :3, 3] - other[..., :3, 3], axis=-1)
    # |R - R'| in the Frobenius norm is √8 sin(angle / 2)
    off = np.linalg.norm(one[..., :3, :3] - other[..., :3, :3], axis=(-2, -1)) / np.sqrt(8.0)
    return float(distance.max()), float(2.0 * np.arcsin(np.minimum(off, 1.0)).max())


def hold_together(
    chain: Chain, arm: BuiltArm, kinematics: Kinematics, ranges: list[list[float]]
) -> tuple[float, float]:
    """How far the flanges are apart at random states, m and rad. Raises `Unsuitable` beyond 1 µm or 1 µrad."""
    q = states(chain, ranges)
    ours = frames(arm, q)["flange"]
    ours[..., :3, :3] @= kinematics.turn @ OVER if kinematics.z_down else kinematics.turn
    metres, radians = between(chain.places(q)[chain.tip], ours)
    if not (metres <= WITHIN_M and radians <= WITHIN_RAD):
        what = f"our arm's flange is up to {1e6 * metres:.3g} um and {1e6 * radians:.3g} urad from the file's"
        supply = "up to 1 um and 1 urad are accepted: write positions and angles of the joints with more digits"
        raise Unsuitable(f"link {chain.tip}", what, supply)
    return metres, radians


def place_in(carrier: FloatArray, link: FloatArray, *, turning: bool) -> FloatArray:
    """The pose (4, 4) of a link in its carrier, from the poses (N, 4, 4) of both at several states. `turning`: it may
    turn about a vertical axis there. Raises `Unsuitable` where it does not stay."""
    inverse = np.linalg.inv(carrier)
    local: FloatArray = inverse @ link
    wander = local - local[0]
    if turning:
        wander = wander[..., 2, :]
    if not float(np.abs(wander).max()) <= RIGID_M:
        raise Unsuitable("the solids", "a link does not move with the one of ours that should carry it", "report it")
    found: FloatArray = local[0]
    return found

"""Inputs of kernels, singular and degenerate ones among them, and what the kernels make of them.

Run as a module it writes the outputs to the file that is named: plain Python does so under `NUMBA_DISABLE_JIT=1`.
"""

from __future__ import annotations

import math
import sys

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.carriers import derivative, place_carriers, sweep_carriers
from assur.planner.kernels.inverse import POSTURE_COLUMNS, joint_motions, postures
from assur.planner.kernels.jets import JET_COLUMNS, JETS
from assur.planner.kernels.links import ANGLE_COUNT, ranges_assembled
from assur.planner.kernels.motion import link_motions
from assur.planner.kernels.solids import CARRIER, CENTRE, COLUMNS, HALF, ROTATION
from assur.planner.kernels.spline import piece_motion, spline_state, sweep_joints
from assur.planner.laws import (
    Change,
    Law,
    Pose,
    conveyor,
    fixed,
    indexer,
    keyframes,
    law_tables,
    linear,
    swing,
    turntable,
)
from assur.planner.model.link_frames import link_law
from assur.planner.trajectory import Trajectory
from tests.planner.kernels.arms import ARMS, states
from tests.planner.robots.point_bounds import joint_jets
from tests.planner.trajectory.splines import REGIMES, spline

SIZE = 24


def laws() -> list[Law]:
    """One of every kind, and one whose time is over."""
    time = np.array([0.0, 0.4, 1.0])
    q, still = np.array([[0.1, 0.5, 0.0, 0.0], [0.4, 0.9, 0.1, 1.0], [0.2, 1.2, 0.0, 2.0]]), np.zeros((3, 4))
    ramp = (Change(0.2, 0.4, 2.0, 20.0), Change(0.8, 0.0, 2.0, math.inf))
    return [
        fixed(Pose(1.0, 0.2, 0.0, 0.3)),
        linear(Pose(), (0.1, -0.2, 0.05), 0.1, (-1.0, 0.5)),
        conveyor(Pose(0.1, 0.2, 0.3, 0.7), 0.25, ramp),
        turntable(Pose(0.5), -0.5, 0.01, ramp),
        indexer(Pose(), 0.8, 0.3, 0.2),
        indexer(Pose(0.0, 0.0, 0.0, 0.4), 0.2, 0.3, 0.0, "travel", 0.1),
        swing(Pose(), 0.9, 0.7, 0.3),
        keyframes([0.0, 0.3, 0.9], (Pose(), Pose(0.1, 0.2, 0.0, 0.4), Pose(0.3))),
        link_law(ARMS["scara whose arms rise"], Trajectory(time, q, still, still), 2),
    ]


def of_arm(name: str, rows: FloatArray, pieces: FloatArray) -> dict[str, FloatArray]:
    """Places, bounds, joint states, motions of links and postures of an arm and the frames about it."""
    robot, rng = ARMS[name], np.random.default_rng(1)
    q, n = states(robot, 7, SIZE), len(robot.joints)
    q[-1] = np.nan
    carriers = len(robot.links) + len(rows)
    placed, jets = np.empty((SIZE, carriers, 12)), np.zeros((SIZE, carriers, JETS, JET_COLUMNS))
    half, rates = 10.0 ** rng.uniform(-5, 0, (SIZE, n)), rng.normal(size=(2, SIZE, n))
    half[::4] = rates[:, ::6] = 0.0
    rates[0, 5, 0] = np.inf
    turns, unit = np.empty((int(robot.row[ANGLE_COUNT]), 2, JET_COLUMNS)), np.zeros((1, COLUMNS))
    unit[0, CENTRE : CENTRE + 3], unit[0, HALF : HALF + 3], unit[0, ROTATION : ROTATION + 9 : 4] = 0.1, 0.05, 1.0
    lower, upper, t = q - half, q + half, rng.uniform(-0.2, 1.2, (2, SIZE))
    points, proved = np.empty((SIZE, 2)), np.empty(SIZE, dtype=np.bool_)
    for i in range(SIZE):
        place_carriers((robot.row, rows, pieces), q[i], t[0, i], placed[i])
        ends = (min(t[:, i]), max(t[:, i]))
        joints = joint_jets(lower[i], upper[i], rates[0, i], rates[1, i])
        sweep_carriers((robot.row, rows, pieces), *ends, joints, turns, jets[i])
        unit[0, CARRIER] = i % carriers
        points[i] = derivative(unit, jets[i], 0, 1 + i % 2, (0.6, 0.0, 0.8))
    ranges_assembled(robot.row, lower, upper, proved)
    joints = np.stack([q, *rng.normal(size=(3, *q.shape))], 1)
    moved = np.empty((len(robot.links), SIZE, 4, 6))
    for link in range(len(robot.links)):
        link_motions(robot.row, link, joints, moved[link])
    found = {"placed": placed, "jets": jets, "points": points, "proved": proved.astype(float), "moved": moved}
    targets = moved[-1].copy()
    targets[::7, 0, :2] *= 4.0
    for mode in range(len(robot.modes)):
        for order in (0, 3):
            solved, margins = np.empty((SIZE, 4, n)), np.empty((SIZE, 2))
            codes = np.empty(SIZE, dtype=np.int64)
            joint_motions(robot.row, mode, order, targets, solved, margins, codes)
            # rates beside a singularity amplify the last bit
            solved[margins[:, 0] < 0.01, 1:] = np.nan
            found |= {f"joints {mode} {order}": solved, f"codes {mode} {order}": codes.astype(float)}
    found["posture"] = np.empty((SIZE, POSTURE_COLUMNS))
    postures(robot.row, q, found["posture"])
    return {f"{name}: {key}": value for key, value in found.items()}


def of_splines() -> dict[str, FloatArray]:
    """States and bounds of a trajectory of every regime."""
    found: dict[str, FloatArray] = {}
    for regime in REGIMES:
        path = spline(3, regime)
        table = path.spline
        out, motion, q = np.zeros((SIZE, 3, JET_COLUMNS)), np.empty((SIZE, 4, 3)), np.empty((SIZE, 3))
        times = np.linspace(path.start - 0.1, path.end + 0.1, SIZE + 1)
        for i in range(SIZE):
            sweep_joints(table, times[i], times[i + 1], out[i])
            spline_state(table, times[i], q[i])
            piece_motion(*table[:2], times[i], motion[i])
        found |= {f"{regime}: swept": out, f"{regime}: state": q, f"{regime}: motion": motion, f"{regime}": table[2]}
    return found


def outputs() -> dict[str, FloatArray]:
    """Output by name."""
    rows, pieces = law_tables(laws())
    found = of_splines()
    for name in ARMS:
        found |= of_arm(name, rows, pieces)
    return found


if __name__ == "__main__":
    np.savez(sys.argv[1], allow_pickle=False, **outputs())

"""Kernels: where links and frames are, and how the flange moves, as `Scara` and the laws have it (K9, K12)."""

from __future__ import annotations

import numpy as np

from benchmarks.compiled.door import kernel
from planner.arrays import FloatArray

LINKS = 5


@kernel
def turned(rotation: FloatArray, c: float, s: float, one: float) -> None:
    """A rotation (3, 3) about the vertical."""
    rotation[0, 0], rotation[0, 1], rotation[0, 2] = c, -s, 0.0
    rotation[1, 0], rotation[1, 1], rotation[1, 2] = s, c, 0.0
    rotation[2, 0], rotation[2, 1], rotation[2, 2] = 0.0, 0.0, one


@kernel
def links(arm: FloatArray, q: FloatArray, position: FloatArray, rotation: FloatArray) -> None:
    """Link frames of a SCARA at q (n,) into position (5.., 3) and rotation (5.., 3, 3)."""
    phi1 = q[0] + arm[5]
    phi2 = phi1 + q[1]
    phi4 = phi2 + q[3] if arm[6] == 4.0 else phi2
    c1, s1, c2, s2 = np.cos(phi1), np.sin(phi1), np.cos(phi2), np.sin(phi2)
    turned(rotation[0], np.cos(arm[5]), np.sin(arm[5]), 1.0)
    turned(rotation[1], c1, s1, 1.0)
    turned(rotation[2], c2, s2, 1.0)
    turned(rotation[3], 1.0, 0.0, 1.0)
    turned(rotation[4], np.cos(phi4), np.sin(phi4), 1.0)
    x, y = arm[2] + arm[0] * c1, arm[3] + arm[0] * s1
    for k in range(LINKS):
        position[k, 0] = arm[2] if k < 2 else x if k == 2 else x + arm[1] * c2
        position[k, 1] = arm[3] if k < 2 else y if k == 2 else y + arm[1] * s2
        position[k, 2] = arm[4] + q[2] if k >= arm[7] else arm[4]


@kernel
def frame(law: FloatArray, t: float, position: FloatArray, rotation: FloatArray, upright: bool) -> None:
    """A frame at time t; NaN where it is not known, `upright`: except for the vertical axis."""
    if not (law[9] <= t <= law[10]):
        position[0] = position[1] = position[2] = np.nan
        turned(rotation, np.nan, np.nan, 1.0 if upright else np.nan)
        return
    past = t - law[8]
    for i in range(3):
        position[i] = law[i] + past * law[4 + i] if law[4 + i] != 0.0 else law[i]
    yaw = law[3] + law[7] * past if law[7] != 0.0 else law[3]
    turned(rotation, np.cos(yaw), np.sin(yaw), 1.0)


@kernel
def everything(
    arm: FloatArray, laws: FloatArray, q: FloatArray, t: float, position: FloatArray, rotation: FloatArray
) -> None:
    """All carriers at one time."""
    links(arm, q, position, rotation)
    for k in range(len(laws)):
        frame(laws[k], t, position[LINKS + k], rotation[LINKS + k], True)


@kernel
def everywhere(arm: FloatArray, laws: FloatArray, q: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """`carriers`: all of them at times t (T,); what stands still is turned once."""
    count = LINKS + len(laws)
    position, rotation = np.empty((len(t), count, 3)), np.empty((len(t), count, 3, 3))
    for i in range(len(t)):
        links(arm, q[i], position[i], rotation[i])
        for k in range(len(laws)):
            still = laws[k, 7] == 0.0 and laws[k, 4] == 0.0 and laws[k, 5] == 0.0 and laws[k, 6] == 0.0
            known = i > 0 and laws[k, 9] <= t[i] <= laws[k, 10] and laws[k, 9] <= t[i - 1] <= laws[k, 10]
            if still and known:
                position[i, LINKS + k] = position[i - 1, LINKS + k]
                rotation[i, LINKS + k] = rotation[i - 1, LINKS + k]
            else:
                frame(laws[k], t[i], position[i, LINKS + k], rotation[i, LINKS + k], True)
    return position, rotation


@kernel
def placements(arm: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Link frames at q (T, n)."""
    position, rotation = np.empty((len(q), LINKS, 3)), np.empty((len(q), LINKS, 3, 3))
    for i in range(len(q)):
        links(arm, q[i], position[i], rotation[i])
    return position, rotation


@kernel
def swing(out: FloatArray, length: float, phi: float, w: float, dw: float, ddw: float) -> None:
    """K12: one arm's part of p, v, a, j in out (4, 3)."""
    x, y = length * np.cos(phi), length * np.sin(phi)
    square, jerk, mixed = w * w, ddw - w * w * w, 3.0 * w * dw
    out[0, 0] += x
    out[0, 1] += y
    out[1, 0] -= w * y
    out[1, 1] += w * x
    out[2, 0] -= dw * y + square * x
    out[2, 1] += dw * x - square * y
    out[3, 0] -= jerk * y + mixed * x
    out[3, 1] += jerk * x - mixed * y


@kernel
def flange(arm: FloatArray, x: FloatArray, out: FloatArray, yaw: FloatArray) -> None:
    """Motion of the flange for joints and derivatives x (4, n): out (4, 3), yaw (4,)."""
    out[:] = 0.0
    for i in range(3):
        out[0, i] = arm[2 + i]
    swing(out, arm[0], x[0, 0] + arm[5], x[1, 0], x[2, 0], x[3, 0])
    swing(out, arm[1], x[0, 0] + arm[5] + x[0, 1], x[1, 0] + x[1, 1], x[2, 0] + x[2, 1], x[3, 0] + x[3, 1])
    for i in range(4):
        out[i, 2] += x[i, 2]
        yaw[i] = (x[i, 0] + arm[5] if i == 0 else x[i, 0]) + x[i, 1]
        if arm[6] == 4.0:
            yaw[i] += x[i, 3]


@kernel
def flanges(
    arm: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray, qddd: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Motion of the flange at T times: (4, T, 3) and (4, T)."""
    out, yaw = np.empty((4, len(q), 3)), np.empty((4, len(q)))
    x, row, turn = np.empty((4, q.shape[1])), np.empty((4, 3)), np.empty(4)
    for t in range(len(q)):
        x[0], x[1], x[2], x[3] = q[t], qd[t], qdd[t], qddd[t]
        flange(arm, x, row, turn)
        for i in range(4):
            out[i, t] = row[i]
            yaw[i, t] = turn[i]
    return out, yaw

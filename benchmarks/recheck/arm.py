"""The robot of the problems: forward kinematics and the three bodies that may collide.

    elbow = a1 (cos q1, sin q1)      tool = elbow + a2 (cos(q1+q2), sin(q1+q2))      yaw = q1 + q2 + q4       (R3)

q[2] is the height of the tool tip above the floor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.recheck.spline import Floats
from benchmarks.recheck.surroundings import PlacedBody
from benchmarks.soak.solids import solid_of

A1_M = 0.325
"""Shoulder axis to elbow axis."""
A2_M = 0.275
"""Elbow axis to tool axis."""
LINK_1_Z_M = 0.30
"""Height of the middle of link 1."""
LINK_2_Z_M = 0.36
"""Height of the middle of link 2."""

QUILL_LENGTH_M = 0.31
LINK_1, LINK_2, QUILL = (
    solid_of({"box": {"size_m": [0.405, 0.08, 0.06]}}),
    solid_of({"box": {"size_m": [0.355, 0.08, 0.06]}}),
    solid_of({"cylinder": {"radius_m": 0.012, "height_m": QUILL_LENGTH_M}}),
)


@dataclass(frozen=True, eq=False)
class Tool:
    """Tool point in the world: `position` (N, 3) m, `yaw` (N,) rad, and their rates."""

    position: Floats
    yaw: Floats
    velocity: Floats
    yaw_rate: Floats


def tool(q: Floats, qd: Floats) -> Tool:
    """The tool point and its velocity for joint states (N, 4)."""
    first, second = q[:, 0], q[:, 0] + q[:, 1]
    first_d, second_d = qd[:, 0], qd[:, 0] + qd[:, 1]
    position = np.stack(
        [A1_M * np.cos(first) + A2_M * np.cos(second), A1_M * np.sin(first) + A2_M * np.sin(second), q[:, 2]], axis=-1
    )
    velocity = np.stack(
        [
            -A1_M * np.sin(first) * first_d - A2_M * np.sin(second) * second_d,
            A1_M * np.cos(first) * first_d + A2_M * np.cos(second) * second_d,
            qd[:, 2],
        ],
        axis=-1,
    )
    return Tool(position, second + q[:, 3], velocity, second_d + qd[:, 3])


def placed_bodies(q: Floats) -> tuple[PlacedBody, ...]:
    """The three bodies at joint positions (N, 4)."""
    first, second = q[:, 0], q[:, 0] + q[:, 1]
    elbow = A1_M * np.stack([np.cos(first), np.sin(first)], axis=-1)
    forearm = A2_M * np.stack([np.cos(second), np.sin(second)], axis=-1)
    level = np.ones(len(q))
    return (
        PlacedBody("link 1", LINK_1, _with_height(elbow / 2, LINK_1_Z_M * level), first),
        PlacedBody("link 2", LINK_2, _with_height(elbow + forearm / 2, LINK_2_Z_M * level), second),
        PlacedBody("quill", QUILL, _with_height(elbow + forearm, q[:, 2] + QUILL_LENGTH_M / 2), 0.0 * level),
    )


def _with_height(plane: Floats, z: Floats) -> Floats:
    return np.concatenate([plane, z[:, None]], axis=-1)

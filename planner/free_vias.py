"""Random joint positions between two: ways around what is in the direct way."""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray
from planner.legs.joint import Via
from planner.robots.protocol import Robot

VIAS = (0.3, 0.4, 0.3)
"""Shares of vias near the way, anywhere, and with a folded arm."""
SPREAD = 0.2
"""Spread of vias near the way, in ranges of the joints."""


def free_vias(
    rng: np.random.Generator, robot: Robot, start: FloatArray, goal: FloatArray, count: int
) -> tuple[Via, ...]:
    """`count` vias, within limits, on the way from `start` to `goal` (n,)."""
    limits = robot.limits
    shares = np.sort(rng.uniform(0.1, 0.9, count))
    found = []
    for share in shares:
        q = start + share * (goal - start)
        # the lift has a rule of its own, below
        free = np.array([number != robot.lift for number in range(len(robot.joints))])
        free[3:] = False  # the wrist only turns with the way; it clears nothing
        kind = rng.choice(len(VIAS), p=VIAS)
        spread = SPREAD * (limits.upper - limits.lower)
        if kind == 0:
            q = np.where(free, q + rng.normal(0.0, 1.0, len(q)) * spread, q)
        elif kind == 1:
            q = np.where(free, rng.uniform(limits.lower, limits.upper), q)
        else:
            # one joint near an end of its range: a folded arm passes where a stretched one does not
            joint = int(rng.choice(np.flatnonzero(free)[1:]))
            q = np.where(free, q + rng.normal(0.0, 0.5, len(q)) * spread, q)
            edge = limits.upper if rng.random() < 0.5 else limits.lower
            q[joint] = edge[joint] * (1 - 0.3 * rng.random())
        if robot.lift is not None:
            z = robot.lift
            low = max(float(start[z]), float(goal[z])) if rng.random() < 0.7 else float(limits.lower[z])
            q[z] = rng.uniform(min(low, limits.upper[z]), limits.upper[z]) if rng.random() < 0.6 else limits.upper[z]
        pace = float(rng.choice([0.0, 0.4, 0.8, 1.2]))
        found.append(Via(np.clip(q, limits.lower, limits.upper), pace))
    return tuple(found)

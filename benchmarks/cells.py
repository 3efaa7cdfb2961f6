"""Cells of any size, seeded: many bodies round one path, near and far, or within reach and away from the path.

Written as problems of the benchmark, so that the independent recheck knows them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.problem_set import Problem
from benchmarks.recheck.arm import A1_M, A2_M

Document = dict[str, Any]

DENSITY_M2 = 8.0
"""Bodies in a square metre of floor: ten of them within the arm's reach of 0.6 m, as crowded as a static problem."""
INNER_M = 0.12
"""No body stands nearer to the shoulder's axis."""
CLEAR_M = 0.07
"""No body stands nearer to start or goal, from above."""
ASIDE_M, ASIDE_RAD = (0.2, 0.58), 2.4
"""Where bodies stand that the arm could reach and does not come near: radii, and least angle from the front."""
SMALL_M = 0.004
"""Edge of a body of which a thousand stand there and apart."""


def state(r: float, angle: float, z: float) -> list[float]:
    """q that puts the tool at r, angle, z with yaw 0, the elbow on the right."""
    q2 = float(np.arccos((r * r - A1_M**2 - A2_M**2) / (2 * A1_M * A2_M)))
    q1 = angle - float(np.arctan2(A2_M * np.sin(q2), A1_M + A2_M * np.cos(q2)))
    return [q1, q2, z, -q1 - q2]


def crowd(seed: int, bodies: int) -> Problem:
    """A static problem with this many bodies. Those of a smaller crowd are in every larger one: they fill the floor
    from the middle outwards, evenly, so what the arm can reach is the same whatever their number."""
    random = np.random.default_rng([11, seed])
    start = state(0.42, random.uniform(-1.2, -0.6), 0.12)
    goal_at = (random.uniform(0.3, 0.5), random.uniform(0.6, 1.2), 0.12)
    goal = [goal_at[0] * np.cos(goal_at[1]), goal_at[0] * np.sin(goal_at[1]), goal_at[2]]
    begin = A1_M * np.array([np.cos(start[0]), np.sin(start[0])])
    begin = begin + A2_M * np.array([np.cos(start[0] + start[1]), np.sin(start[0] + start[1])])
    obstacles: list[Document] = []
    area = np.pi * INNER_M**2
    while len(obstacles) < bodies:
        area += random.exponential(1 / DENSITY_M2)
        r, angle = np.sqrt(area / np.pi), random.uniform(-np.pi, np.pi)
        edge, height, yaw = random.uniform(0.04, 0.1), random.uniform(0.05, 0.24), random.uniform(-1.0, 1.0)
        upright_box = bool(random.integers(2))
        at = np.array([r * np.cos(angle), r * np.sin(angle)])
        if min(np.linalg.norm(at - begin), np.linalg.norm(at - np.array(goal[:2]))) < CLEAR_M + edge:
            continue
        pos = [float(at[0]), float(at[1]), height / 2]
        if upright_box:
            obstacles.append({"type": "box", "size": [edge, edge, height], "pos": pos, "yaw": yaw})
        else:
            obstacles.append({"type": "cylinder", "radius": edge / 2, "height": height, "pos": pos, "yaw": 0.0})
    return {
        "id": f"crowd-{seed}-{bodies}",
        "start": start,
        "goal": {"pos": [float(x) for x in goal], "yaw": 0.0},
        "obstacles": obstacles,
    }


def aside(seed: int, bodies: int) -> Problem:
    """The start and goal of a crowd, before which the arm stays; all bodies stand behind it, within its reach."""
    random = np.random.default_rng([14, seed])
    obstacles: list[Document] = []
    for _ in range(bodies):
        r, angle = random.uniform(*ASIDE_M), np.pi + random.uniform(ASIDE_RAD - np.pi, np.pi - ASIDE_RAD)
        pos = [float(r * np.cos(angle)), float(r * np.sin(angle)), random.uniform(0.05, 0.25)]
        obstacles.append({"type": "box", "size": [SMALL_M] * 3, "pos": pos, "yaw": random.uniform(-1.0, 1.0)})
    return crowd(seed, 0) | {"id": f"aside-{seed}-{bodies}", "obstacles": obstacles}

"""Cells of any size for the scaling curves, seeded: many bodies round one path, and many control points in one cell.

Written as problems of the benchmark, so that the independent recheck knows them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from benchmarks.problem_set import Problem
from benchmarks.recheck.arm import A1_M, A2_M
from benchmarks.translation import Manners, request

Document = dict[str, Any]
Kind = Literal["via", "move", "pick"]
KINDS: tuple[Kind, ...] = ("via", "move", "pick")

DENSITY_M2 = 8.0
"""Bodies in a square metre of floor: ten of them within the arm's reach of 0.6 m, as crowded as a static problem."""
INNER_M = 0.12
"""No body stands nearer to the shoulder's axis."""
CLEAR_M = 0.07
"""No body stands nearer to a control point, from above."""
PARTS_Z_M = 0.09
"""Height at which the middles of parts lie; they are 20 mm high."""
APART_M = 0.05
"""Between control points, from above: parts lie there, and do not touch."""
GRASP_M, LIFT_M = 0.011, 0.03
"""Tool point above the middle of a part that is held, and height of approach and depart."""
TABLE = "obstacle-0"
TABLE_M, TABLE_AT_M = [0.6, 1.2, 0.04], [0.42, 0.0, 0.06]
POSTS = 6
LATEST_S, BUDGET_S = 30.0, 5.0


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


def points(seed: int, count: int) -> list[list[float]]:
    """Tool points in turn, on either side of the arm."""
    random = np.random.default_rng([12, seed])
    found: list[list[float]] = []
    while len(found) < count:
        side = 1.0 if len(found) % 2 else -1.0
        r, angle, z = random.uniform(0.3, 0.5), side * random.uniform(0.3, 1.2), random.uniform(0.14, 0.2)
        at = [float(r * np.cos(angle)), float(r * np.sin(angle)), float(z)]
        if all(math.dist(at[:2], other[:2]) >= APART_M for other in found):
            found.append(at)
    return found


def tour(
    kind: Kind, seed: int, count: int, most: int, limits: Mapping[str, tuple[float, ...]]
) -> tuple[Problem, Document, list[list[float]]]:
    """A task of `count` control points; as a problem for the recheck (start, obstacles); and where the tool must be.

    The cell is that of `most` points, whatever their number. Posts 0.1 m high stand between the points; with `pick`,
    parts lie on a table, and every second point is a place beside where its part lay.
    """
    every = points(seed, most)
    random = np.random.default_rng([13, seed])
    obstacles: list[Document] = []
    while len(obstacles) < POSTS:
        at = np.array([random.uniform(0.15, 0.5), random.uniform(-0.45, 0.45)])
        if all(np.linalg.norm(at - np.array(p[:2])) > CLEAR_M for p in every):
            pos = [float(at[0]), float(at[1]), 0.05]
            obstacles.append({"type": "cylinder", "radius": 0.02, "height": 0.1, "pos": pos, "yaw": 0.0})
    picks = kind == "pick"
    met = [[x, y, PARTS_Z_M + GRASP_M if picks else z] for x, y, z in every[:count]]
    # what is picked is lifted at the end, away from its last point
    goal = [met[-1][0], met[-1][1], met[-1][2] + (LIFT_M if picks else 0.0)]
    problem = {
        "id": f"{kind}-{seed}-{count}",
        "start": state(0.4, 0.0, 0.2),
        "goal": {"pos": goal, "yaw": 0.0},
        "obstacles": [{"type": "box", "size": TABLE_M, "pos": TABLE_AT_M, "yaw": 0.0}] if picks else obstacles,
    }
    made = request(problem, limits, Manners())
    made["options"] |= {"elbow": "keep", "latest_end_s": LATEST_S, "budget_s": BUDGET_S}
    if picks:
        made["bodies"] += [_part(i, at) for i, at in enumerate(every[::2])]
        made["task"] = [_pick(i // 2) if i % 2 == 0 else _place(i // 2, every[i]) for i in range(count)]
        return problem, made, met
    steps = []
    for i, point in enumerate(every[:count]):
        step: Document = {"to": {"at_m": point, "yaw_rad": 0.0}, "match": "position", "name": f"point-{i}"}
        if kind == "via" and i < count - 1:
            step["via"] = True
            del step["match"]
        steps.append({"move": step})
    made["task"] = steps
    return problem, made, met


def _part(i: int, at: list[float]) -> Document:
    pose = {"at_m": [at[0], at[1], PARTS_Z_M], "yaw_rad": 0.0}
    return {"name": f"part-{i}", "shape": {"box": {"size_m": [0.02, 0.02, 0.02]}}, "pose": pose}


def _pick(i: int) -> Document:
    return {"pick": {"part": f"part-{i}", "grasp_m": [0.0, 0.0, GRASP_M], **_manner()}}


def _place(i: int, at: list[float]) -> Document:
    to = {"at_m": [at[0], at[1], PARTS_Z_M], "yaw_rad": 0.0}
    return {"place": {"part": f"part-{i}", "to": to, **_manner()}}


def _manner() -> Document:
    return {"approach": {"m": LIFT_M}, "dwell_s": 0.02, "depart": {"m": LIFT_M}, "contact_with": [TABLE]}

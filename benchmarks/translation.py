"""A problem of the benchmark as a request document (`schema: assur/1`), and a made-up problem to warm up with.

The planner and the judge both read this document. Tests hold it to the formulas of `benchmarks/problems/README.md`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from benchmarks.problem_set import Problem

Document = dict[str, Any]
Match = Literal["position", "velocity"]

LATEST_END_S = 5.0
"""Nothing in the problems holds beyond."""

A1_M, A2_M = 0.325, 0.275
"""Shoulder axis to elbow axis, and elbow axis to tool axis."""
ROBOT_BODIES: list[Document] = [
    {"name": "link-1", "link": "link1", "shape": {"box": {"size_m": [0.405, 0.08, 0.06]}}, "at_m": [0.1625, 0.0, 0.30]},
    {"name": "link-2", "link": "link2", "shape": {"box": {"size_m": [0.355, 0.08, 0.06]}}, "at_m": [0.1375, 0.0, 0.36]},
    {
        "name": "quill-body",
        "link": "quill",
        "shape": {"cylinder": {"radius_m": 0.012, "height_m": 0.31}},
        "at_m": [0.0, 0.0, 0.155],
    },
]
"""Bodies that may collide: without the column, which is no part of the problems (one body drives through it), and
without the arm against itself, which cannot happen within these limits."""


@dataclass(frozen=True, slots=True)
class Terms:
    """How a problem is to be solved."""

    budget_s: float = 1.0
    stop: Literal["first", "budget"] = "first"
    match: Match = "position"
    seed: int = 0


def request(problem: Problem, limits: Mapping[str, tuple[float, ...]], terms: Terms) -> Document:
    """The request that asks for a motion from the problem's start to its goal among its obstacles."""
    q1, q2, z, q4 = problem["start"]
    frames: dict[str, Document] = {}
    bodies = []
    for i, obstacle in enumerate(problem["obstacles"]):
        name = f"obstacle-{i}"
        frame, body = _obstacle(name, obstacle)
        if frame is not None:
            frames[name] = frame
        bodies.append(body)
    goal = problem["goal"]
    to: Document = {"at_m": goal["pos"], "yaw_rad": goal["yaw"]}
    if "v" in goal:
        frames["goal"] = {"linear": {"at_m": goal["pos"], "velocity_m_s": [*goal["v"], 0.0]}}
        to = {"frame": "goal", "at_m": [0.0, 0.0, 0.0], "yaw_rad": goal["yaw"]}
    return {
        "schema": "assur/1",
        "robot": {"scara": robot(limits), "tool": {"tcp_m": [0.0, 0.0, 0.0]}},
        "start": {"joints": {"q1_rad": q1, "q2_rad": q2, "z_m": z, "q4_rad": q4}},
        "frames": frames,
        "bodies": bodies,
        "task": [{"move": {"to": to, "match": terms.match}}],
        "options": {
            "seed": terms.seed,
            "budget_s": terms.budget_s,
            "stop": terms.stop,
            "clearance_m": {"travel": 0.0, "near": 0.0},
            "singularity_margin": 0.0,
            "elbow": "auto",
            "end": "moving" if terms.match == "velocity" and "v" in goal else "rest",
            "stay_safe_s": 0.0,
            "latest_end_s": LATEST_END_S,
        },
    }


def robot(limits: Mapping[str, tuple[float, ...]]) -> Document:
    """The robot of the problems with the limits of a file; its flange is the tool tip, z above the floor."""
    joints = []
    for j, (name, unit) in enumerate((("q1", "rad"), ("q2", "rad"), ("z", "m"), ("q4", "rad"))):
        joint: Document = {
            "name": name,
            f"range_{unit}": [limits["qmin"][j], limits["qmax"][j]],
            f"velocity_{unit}_s": limits["vmax"][j],
            f"acceleration_{unit}_s2": limits["amax"][j],
            f"jerk_{unit}_s3": limits["jmax"][j],
        }
        if unit == "m":
            joint["zero_m"] = 0.0
        joints.append(joint)
    return {"l1_m": A1_M, "l2_m": A2_M, "joints": joints, "bodies": ROBOT_BODIES, "self_pairs": []}


def _obstacle(name: str, obstacle: Document) -> tuple[Document | None, Document]:
    """The frame of an obstacle, if it moves, and its body in it."""
    kind, motion = obstacle["type"], obstacle.get("motion")
    if kind == "capsule" and motion is not None and motion["kind"] == "swing":
        length = obstacle["length"]
        frame = {"at_m": motion["pivot"], "yaw_rad": motion["phase"], "rate_rad_s": motion["omega"]}
        shape = {"capsule": {"radius_m": obstacle["radius"], "length_m": length, "axis": "x"}}
        pose = {"frame": name, "at_m": [length / 2, 0.0, 0.0]}
        return {"turntable": frame}, {"name": name, "shape": shape, "pose": pose}
    if kind == "box":
        shape = {"box": {"size_m": obstacle["size"]}}
    elif kind == "cylinder":
        shape = {"cylinder": {"radius_m": obstacle["radius"], "height_m": obstacle["height"]}}
    else:
        raise ValueError(f"{name}: unknown type {kind!r}")
    if motion is None:
        pose = {"at_m": obstacle["pos"], "yaw_rad": obstacle["yaw"]}
        return None, {"name": name, "shape": shape, "pose": pose}
    if motion["kind"] != "linear":
        raise ValueError(f"{name}: unknown motion {motion['kind']!r}")
    frame = {"at_m": obstacle["pos"], "velocity_m_s": motion["v"]}
    pose = {"frame": name, "at_m": [0.0, 0.0, 0.0], "yaw_rad": obstacle["yaw"]}
    return {"linear": frame}, {"name": name, "shape": shape, "pose": pose}


def unrelated_problem(seed: int, moving_goal: bool) -> Problem:
    """A problem that is in no set, with every kind of obstacle in it, out of the way of an easy motion.

    A run is warmed up with it: libraries are loaded and code paths are taken once, and nothing that a cache might hold
    of it occurs in a real problem.
    """
    rng = np.random.default_rng(seed)
    near = rng.uniform(0.0, 0.02, 12)
    goal: Document = {"pos": [0.35 + near[0], 0.2 + near[1], 0.12 + near[2]], "yaw": 0.5 + near[3]}
    if moving_goal:
        goal["v"] = [-0.1 - near[4], 0.05 + near[5]]
    return {
        "id": "warm-up",
        "start": [-0.5 + near[6], 0.9 + near[7], 0.15, near[8]],
        "goal": goal,
        "obstacles": [
            {"type": "box", "size": [0.08, 0.06, 0.2], "pos": [-0.4 + near[9], 0.3, 0.1], "yaw": 0.3},
            {
                "type": "cylinder",
                "radius": 0.04,
                "height": 0.5,
                "pos": [0.5 + near[10], 0.35, 0.25],
                "yaw": 0.0,
                "motion": {"kind": "linear", "v": [0.05, 0.1, 0.0]},
            },
            {
                "type": "capsule",
                "radius": 0.03,
                "length": 0.2,
                "motion": {"kind": "swing", "pivot": [-0.5, -0.4 - near[11], 0.3], "phase": 3.0, "omega": 0.8},
            },
        ],
    }

"""The line of `line-through-singularity` as requests to the planner, and what it answers."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.model.outcome import Outcome, Planned
from assur.planner.model.refusal import Reason
from assur.planner.pipeline import plan
from assur.scenes.requests import scene_of

LINK = 0.2
"""l1 = l2 of the arm of 004, m."""
SPEED, HALF = 0.25, 0.2
"""Of the tool, m/s, and half of the line's length, m."""
FASTEST_DEG_S = 300
"""Limit of θ1 and θ2 in the catalogue's entry of this arm."""


def request(h_mm: float, kind: str) -> dict[str, Any]:
    """The line as a request: at `constant speed` a point on a belt, to be followed; at `any speed` a straight leg."""

    def joint(name: str, turn_deg: float) -> dict[str, Any]:
        rates = {"velocity_deg_s": FASTEST_DEG_S, "acceleration_deg_s2": 3000, "jerk_deg_s3": 150_000}
        return {"name": name, "range_deg": [-turn_deg, turn_deg], **rates}

    lift = {"velocity_mm_s": 1000, "acceleration_mm_s2": 10_000, "jerk_mm_s3": 500_000}
    shaft = {"cylinder": {"radius_mm": 8, "height_mm": 100}}
    scara = {
        "l1_mm": 1e3 * LINK,
        "l2_mm": 1e3 * LINK,
        # No stops before the singular position: it is the margin that must refuse.
        "joints": [joint("theta1", 720), joint("theta2", 180), {"name": "d3", "range_mm": [-250, -20], **lift}],
        "bodies": [{"name": "shaft", "link": "quill", "shape": shaft, "at_mm": [0, 0, 50]}],
        "self_pairs": [],
    }
    # A body far below: the request is about the arm alone.
    floor = {"name": "floor", "shape": {"box": {"size_mm": [1000, 1000, 20]}}, "pose": {"at_mm": [0, 0, -800]}}
    document: dict[str, Any] = {
        "schema": "assur/1",
        "robot": {"scara": scara, "tool": {"tcp_mm": [0, 0, 0]}},
        "start": {"joints": {"theta1_deg": 150, "theta2_deg": 80, "d3_mm": -100}},
        "bodies": [floor],
        "options": {"max_candidates": 30, "budget_s": 60, "stop": "first", "elbow": "right", "seed": 1},
    }
    begin, end = [-1e3 * HALF, h_mm, -100], [1e3 * HALF, h_mm, -100]
    if kind == "any speed":
        document["task"] = [{"move": {"to": {"at_mm": begin}}}, {"move": {"to": {"at_mm": end}, "leg": "cartesian"}}]
        return document
    took = 2 * HALF / SPEED
    document["frames"] = {"belt": {"conveyor": {"at_mm": begin, "speed_mm_s": 1e3 * SPEED, "at_s": 2}}}
    tracking = {"to": {"frame": "belt", "at_mm": [0, 0, 0]}, "duration_s": took}
    document["task"] = [{"follow": {**tracking, "window_s": [2, 2 + took + 1e-3]}}]
    return document


def decision(h_mm: float, kind: str) -> dict[str, Any]:
    """What the planner answers to the line at this distance."""
    scene = scene_of(request(h_mm, kind))
    outcome: Outcome = plan(scene)
    if isinstance(outcome, Planned):
        leg = outcome.plan.legs[1]
        rates = outcome.plan.trajectory.evaluate(np.linspace(leg.t0, leg.t1, 4001), 1)[:, :2]
        return {
            "answer": "planned",
            "leg_s": leg.t1 - leg.t0,
            "margin": outcome.margins.singularity,
            "peak_deg_s": float(np.degrees(np.abs(rates).max())),
        }
    refused: dict[str, Any] = {"answer": str(outcome.reason), "sentence": outcome.sentence}
    if outcome.reason == Reason.NEAR_SINGULARITY and outcome.refusal is not None and outcome.refusal.amount:
        refused["margin"] = scene.options.singularity_margin - outcome.refusal.amount.value
        refused["margin_asked"] = scene.options.singularity_margin
    return refused

"""Robots of every family as requests name them or write them out, joint positions of them, and where their tool is."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.scenes.catalogue import models
from assur.scenes.conventions import as_maker
from assur.scenes.reading.robots import RobotWithTool, equipped
from assur.scenes.schema.read import read
from assur.scenes.schema.robots import RobotDocument

TURN = {"range_deg": [-200, 200], "velocity_deg_s": 180, "acceleration_deg_s2": 1500, "jerk_deg_s3": 75000}
LIFT = {"range_mm": [60, 160], "velocity_mm_s": 900, "acceleration_m_s2": 12, "jerk_m_s3": 600}
BARE: dict[str, Any] = {"bodies": [], "self_pairs": []}
BARS: dict[str, Any] = {"separation_mm": 85, "proximal_mm": [200, 200], "distal_mm": [260, 260], **BARE}
LINKS: dict[str, Any] = {"l1_mm": 250, "l2_mm": 160, **BARE}


def _joints(*kinds: dict[str, Any]) -> list[dict[str, Any]]:
    return [{"name": f"j{i + 1}", **kind} for i, kind in enumerate(kinds)]


_DOWN = _joints(TURN, TURN, {**LIFT, "sign": -1, "zero_mm": 300}, {**TURN, "sign": -1})
_ZEROS = _joints(
    {**TURN, "zero_deg": 90},
    {**TURN, "sign": -1, "zero_deg": -35},
    {**TURN, "zero_deg": 10},
    LIFT,
    {**TURN, "zero_deg": 20},
)
_RAM = _joints(TURN, TURN, {**LIFT, "range_mm": [200, 500]})
ROBOTS: dict[str, dict[str, Any]] = {
    **{model: {"model": model} for model in models()},
    "scara, tool frame down": {"scara": {**LINKS, "tool_frame": "z_down", "joints": _DOWN}},
    "scara of three axes": {"scara": {**LINKS, "joints": _joints(TURN, TURN, LIFT)}},
    "scara whose arms rise": {"scara": {**LINKS, "axis_order": "rprr", "joints": _joints(TURN, LIFT, TURN, TURN)}},
    "scara of three axes whose arms rise": {
        "scara": {**LINKS, "axis_order": "rprr", "joints": _joints(TURN, LIFT, TURN)}
    },
    "scara whose lift is first": {"scara": {**LINKS, "axis_order": "prrr", "joints": _joints(LIFT, TURN, TURN, TURN)}},
    "scara whose lift is last, with zeros": {
        "scara": {**LINKS, "axis_order": "rrrp", "base_offset_mm": [40, -25], "joints": _ZEROS[:4]}
    },
    "elbow arm with zeros": {"elbow_arm": {**LINKS, "height_mm": 300, "joints": [_ZEROS[i] for i in (0, 1, 4)]}},
    "five-bar of two axes": {"five_bar": {**BARS, "height_mm": 250, "joints": _joints(TURN, TURN)}},
    "five-bar of three axes": {"five_bar": {**BARS, "assembly": "back", "joints": _joints(TURN, TURN, LIFT)}},
    "five-bar of four axes": {"five_bar": {**BARS, "joints": _joints(TURN, TURN, LIFT, TURN)}},
    "elbow arm": {"elbow_arm": {**LINKS, "height_mm": 300, "joints": _joints(TURN, TURN, TURN)}},
    "polar arm": {"polar_arm": {**BARE, "height_mm": 300, "joints": _RAM}},
    "five-axis arm": {"five_axis_arm": {**LINKS, "height_mm": 300, "l3_mm": 72, "joints": _joints(*5 * [TURN])}},
}
"""Those of the catalogue, and others whose joints turn more than once, by name."""
TILTING = ("elbow", "polar", "rv-m1", "five-axis")


def robot_document(name: str) -> dict[str, Any]:
    """The robot with a tool, standing somewhere."""
    tool: dict[str, Any] = {"tcp_mm": [0, 0, 0]} if any(word in name for word in TILTING) else {"tcp_mm": [0, 0, -30]}
    given = ROBOTS[name]
    if "yaw" in equipped(read(RobotDocument, {**given, "tool": tool})).robot.coordinates:
        tool = {"tcp_mm": [15, -5, -30], "tcp_yaw_deg": 25}
    return {**given, "tool": tool, "base": {"at_mm": [20, -30, 40], "yaw_deg": 130}}


def built(name: str) -> RobotWithTool:
    return equipped(read(RobotDocument, robot_document(name)))


def positions(given: RobotWithTool, size: int, seed: int) -> FloatArray:
    """Joint vectors (size, n) within the ranges, away from singular positions."""
    rng, limits = np.random.default_rng(seed), given.robot.limits
    q = rng.uniform(limits.lower, limits.upper, (200 * size, len(limits.lower)))
    good = q[given.robot.within(q) & (given.robot.margin(q) > 0.05)]
    assert len(good) >= size
    return good[:size]


def in_words_of_the_maker(q: FloatArray, given: RobotWithTool) -> dict[str, float]:
    """A joint vector (n,) as a request has it."""
    values = as_maker(q, given.conventions).tolist()
    return {f"{joint.name}_{joint.unit}": value for joint, value in zip(given.conventions, values, strict=True)}


def tool_at(q: FloatArray, given: RobotWithTool) -> Motion:
    """The tool point in the world."""
    none = np.zeros_like(q)
    flange = given.robot.link_motion(given.robot.links.index("flange"), q, none, none, none)
    return flange.at(given.tool.tcp)


def pose_document(motion: Motion, given: RobotWithTool) -> dict[str, Any]:
    """The pose of the tool as a request has it, in the world."""
    found: dict[str, Any] = {"at_m": motion.p.tolist()}
    if "yaw" in given.robot.coordinates:
        found["yaw_rad"] = float(motion.yaw)
    if motion.tilted:
        found["pitch_rad"], found["roll_rad"] = motion.tilt.tolist()
    return found

"""A joint_limits.yaml, as MoveIt and ros2_control read it: its joints, and what of it is not taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from assur.scenes.faults import DocumentError, dotted
from assur.scenes.text.yaml_text import Lines, line_of, parse_yaml
from assur.scenes.urdf.refusals import ImportRefused, Lack

KINDS = ("position", "velocity", "acceleration", "deceleration", "jerk")
"""What a joint may have limits of; those of a kind count if has_KIND_limits is not there or true."""
ENDS = ("min_position", "max_position")
SOFT = ("soft_lower_limit", "soft_upper_limit")
"""Ends of a range as in a URDF's safety_controller; they count if has_soft_limits is not there or true."""
KNOWN = (*(f"has_{kind}_limits" for kind in (*KINDS, "soft")), *ENDS, *(f"max_{kind}" for kind in KINDS[1:]), *SOFT)
"""Keys of a joint that are taken."""
NO_LIMITS = ("has_effort_limits", "max_effort", "angle_wraparound", "k_position", "k_velocity")
"""Keys of a joint that no plan depends on."""
NOT_OF_THE_ARM = ("default_velocity_scaling_factor", "default_acceleration_scaling_factor", "cartesian_limits")
"""Keys beside joint_limits whose meaning is known: shares of a motion, and limits of a tool."""
LIMITING = {"limit", "limits", "min", "max", *KINDS, "joint", "joints"}
"""Words of a key that may be of limits of joints."""


@dataclass(frozen=True)
class LimitsFile:
    """What is below `joint_limits` in a file, by joint and key; `remarks`: what else is in it, with its line."""

    name: str
    joints: dict[str, dict[str, Any]]
    remarks: tuple[str, ...]
    path: tuple[str, ...]
    lines: Lines

    def line(self, joint: str, key: str) -> int:
        """The line of a key of a joint."""
        return line_of(dotted((*self.path, joint, key)), self.lines)


def read_limits(content: bytes, name: str) -> LimitsFile:
    """The limits in a joint_limits.yaml: what is below `joint_limits`, at the root or below ROS parameters. Raises
    `ImportRefused`, which calls the file `name`."""
    try:
        document, lines = parse_yaml(content)
    except DocumentError as error:
        lack = Lack(f"line {error.line}", str(error.value), f"allowed is {error.allowed}")
        raise ImportRefused(name, [lack]) from error
    found: list[tuple[str, ...]] = []
    ahead: list[tuple[tuple[str, ...], Any]] = [((), document)]
    while ahead:
        path, here = ahead.pop(0)
        if isinstance(here, dict):
            for key, value in here.items():
                if (
                    key == "joint_limits"
                    and isinstance(value, dict)
                    and all(isinstance(j, dict) for j in value.values())
                ):
                    found.append((*path, key))
                else:
                    ahead.append(((*path, key), value))
    if not found:
        supply = "joint_limits: {JOINT: {has_acceleration_limits: true, max_acceleration: NUMBER}}"
        raise ImportRefused(name, [Lack("the file", "no mapping joint_limits with a mapping for each joint", supply)])
    if len(found) > 1:
        where = ", ".join(f"line {line_of(dotted(path), lines)}" for path in found)
        what = f"{len(found)} mappings joint_limits ({where})"
        raise ImportRefused(name, [Lack("the file", what, "leave the one of this arm")])
    (path,) = found
    lacks, remarks = _beside(document, path, lines)
    if lacks:
        raise ImportRefused(name, lacks)
    joints = document
    for key in path:
        joints = joints[key]
    return LimitsFile(name, joints, tuple(f"{name}, {remark}" for remark in remarks), path, lines)


def _beside(document: Any, path: tuple[str, ...], lines: Lines) -> tuple[list[Lack], list[str]]:
    """What is beside the way to joint_limits: refused if it may be limits of joints, else reported."""
    lacks: list[Lack] = []
    remarks: list[str] = []
    for depth, step in enumerate(path):
        for key in document:
            if key == step:
                continue
            line = line_of(dotted((*path[:depth], key)), lines)
            if key in NOT_OF_THE_ARM:
                remarks.append(f"line {line}: {key} is not taken: it is no limit of the arm's joints")
            elif LIMITING & set(key.lower().split("_")):
                what = f"{key!r} is not known, and may be limits of joints"
                lacks.append(Lack(f"line {line}", what, "put it below joint_limits, or remove it"))
            else:
                remarks.append(f"line {line}: {key!r} is not read")
        document = document[step]
    return lacks, remarks

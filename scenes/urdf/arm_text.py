"""A robot's file in our form, as text: every number with its status and its source, one body a line; and the parts of
an arm as bodies of it, with the files of their hulls."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.scenes.reading.arms import AT_FLANGE, OVER, BuiltArm
from assur.scenes.schema.robots import Family
from assur.scenes.urdf.families import Kinematics
from assur.scenes.urdf.limits import Limits, Number
from assur.scenes.urdf.solids import Part


@dataclass(frozen=True, eq=False)
class ArmText:
    """What a robot's file says. `stated`: status and source of lengths and zeros; `solids`: those of bodies."""

    name: str
    title: str
    about: str
    kinematics: Kinematics
    joints: tuple[tuple[str, bool, Limits], ...]
    """Name of ours, whether it turns, limits."""
    stated: tuple[str, str]
    solids: tuple[str, str]
    bodies: tuple[dict[str, Any], ...] = ()
    pairs: tuple[tuple[str, str], ...] = ()

    def text(self) -> str:
        """The file."""
        kinematics = self.kinematics
        lines = [f"{kinematics.family}:"]
        lines += [f"  {key}: {_flow(value)}" for key, value in (("name", self.name), ("title", self.title))]
        lines.append(f"  about: {_flow(self.about)}")
        lines += [f"  {key}: {self._fact(round_off(value))}" for key, value in kinematics.lengths.items()]
        if any(abs(value) > 0.0 for value in kinematics.offset):
            lines.append(f"  base_offset_m: {self._fact([round_off(value) for value in kinematics.offset])}")
        if kinematics.family == "scara":
            lines.append(f"  axis_order: {kinematics.order}")
            lines.append(f"  tool_frame: {'z_down' if kinematics.z_down else 'z_up'}")
        lines.append("  joints:")
        for i, (name, turns, limits) in enumerate(self.joints):
            unit = "rad" if turns else "m"
            lines.append(f"    - name: {_flow(name)}")
            if kinematics.signs[i] < 0:
                lines.append("      sign: -1")
            zero = round_off(kinematics.zeros[i])
            if zero != 0.0:
                lines.append(f"      zero_{unit}: {self._fact(zero)}")
            lines.append(f"      range_{unit}: {_number(limits.range)}")
            lines.append(f"      velocity_{unit}_s: {_number(limits.velocity)}")
            lines.append(f"      acceleration_{unit}_s2: {_number(limits.acceleration)}")
            lines.append(f"      jerk_{unit}_s3: {_number(limits.jerk)}")
        status, source = self.solids
        lines += ["  bodies:", f"    status: {status}", f"    source: {_flow(source)}"]
        lines.append("    value:" if self.bodies else "    value: []")
        lines += [f"      - {_flow(body)}" for body in self.bodies]
        lines.append(f"  self_pairs: {_flow([list(pair) for pair in self.pairs])}")
        return "\n".join(lines) + "\n"

    def _fact(self, value: float | list[float]) -> str:
        return _number(Number(value, *self.stated))


def round_off(value: float) -> float:
    """A length or an angle without the rounding of its computation: a picometre, a picoradian."""
    return round(value, 12) + 0.0


def _number(number: Number) -> str:
    return f"{{value: {_flow(number.value)}, status: {number.status}, source: {_flow(number.source)}}}"


def _flow(value: Any) -> str:
    """Plain data as YAML in one line. Every text is in quotes: some are words of YAML (null, true, on)."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    if isinstance(value, str):
        return "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in json.dumps(value, ensure_ascii=False))
    return repr(float(value)) if isinstance(value, float) else str(value)


def body_of(part: Part, family: Family, arm: BuiltArm, folder: str) -> tuple[dict[str, Any], bytes | None]:
    """A body of the document, in the frame in which bodies of its link are given, and the file of its hull, which the
    body names in `folder`."""
    to_given = np.eye(4)
    if family == "scara":
        if part.link not in AT_FLANGE:
            to_given[2, 3] = arm.zero_m
        elif part.link == "flange" and arm.z_down:
            to_given[:3, :3] = OVER
    pose = to_given @ part.pose
    body: dict[str, Any] = {"name": part.name, "link": part.link}
    if part.hull is not None:
        points = part.hull.vertices @ pose[:3, :3].T + pose[:3, 3]
        shape = {"mesh": {"file": f"{folder}/{part.name}.obj", "unit": "m"}}
        return {**body, "shape": shape, "at_m": [0.0, 0.0, 0.0]}, _obj(points, part.hull.faces, part.source)
    body |= {"shape": part.shape, "at_m": [float(x) + 0.0 for x in pose[:3, 3]]}
    turned = zip(("roll_rad", "pitch_rad", "yaw_rad"), angles(pose[:3, :3]), strict=True)
    return body | {key: angle for key, angle in turned if angle != 0.0}, None


def _obj(points: FloatArray, faces: IntArray, source: str) -> bytes:
    """A hull as OBJ, its numbers exactly."""
    lines = [f"# convex hull, m, of a part of {re.sub(r'[^ -~]', '?', source)}"]
    lines += ["v " + " ".join(repr(float(x)) for x in point) for point in points]
    lines += ["f " + " ".join(str(int(i) + 1) for i in face) for face in faces]
    return ("\n".join(lines) + "\n").encode("ascii")


def angles(turn: FloatArray) -> tuple[float, float, float]:
    """Roll, pitch and yaw of a rotation R_z(yaw) R_y(pitch) R_x(roll), rad; what is 0 to a picoradian is 0."""
    flat = float(np.hypot(turn[0, 0], turn[1, 0]))
    pitch = math.atan2(-turn[2, 0], flat)
    if flat > 1e-9:
        roll, yaw = math.atan2(turn[2, 1], turn[2, 2]), math.atan2(turn[1, 0], turn[0, 0])
    else:
        roll, yaw = math.atan2(-turn[1, 2], turn[1, 1]), 0.0
    roll, pitch, yaw = (0.0 if abs(angle) < 1e-12 else angle for angle in (roll, pitch, yaw))
    return roll, pitch, yaw


def shared_head(names: list[str]) -> str:
    """What all names begin with, up to the last mark between words."""
    head = names[0]
    for name in names[1:]:
        while not name.startswith(head):
            head = head[:-1]
    return head[: max(head.rfind("_"), head.rfind("-")) + 1]


def free_name(name: str, taken: set[str]) -> str:
    """The name, or the name with a number that is not taken; it is taken from now on."""
    found, i = name, 2
    while found in taken:
        found, i = f"{name}-{i}", i + 1
    taken.add(found)
    return found

"""Parts of an arm as bodies of its document, and the files of their hulls."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.scenes.reading.arms import AT_FLANGE, OVER, BuiltArm
from assur.scenes.schema.robots import Family
from assur.scenes.urdf.solids import Part


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

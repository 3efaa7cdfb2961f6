"""URDFs made for the tests: chains of joints with solids, limits beside them, and another library's kinematics."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yourdfpy
from scipy.spatial.transform import Rotation

from assur.planner.arrays import FloatArray
from assur.scenes.urdf.importing import ImportedRobot, ImportOptions, import_robot
from assur.scenes.urdf.refusals import ImportRefused

Three = tuple[float, float, float]
RIGHT = 1.5707963267948966


@dataclass(frozen=True)
class J:
    """A joint to the next link: `shape` is the XML of that link's collision geometry, with its origin."""

    kind: str
    xyz: Three = (0.0, 0.0, 0.0)
    rpy: Three = (0.0, 0.0, 0.0)
    axis: Three = (0.0, 0.0, 1.0)
    ends: tuple[float, float] = (-2.0, 2.5)
    velocity: float = 3.0
    shape: str = ""
    more: str = ""


def said(values: tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)


def box(x: float, y: float, z: float, at: Three = (0.0, 0.0, 0.0), rpy: Three = (0.0, 0.0, 0.0)) -> str:
    return f'<origin xyz="{said(at)}" rpy="{said(rpy)}"/><geometry><box size="{said((x, y, z))}"/></geometry>'


def urdf(*joints: J, base: str = "", head: str = "", tail: str = "") -> str:
    """The links are l0, l1 and so on, the joints a_joint_1 and so on."""
    parts = [head, _link(0, base)]
    for i, j in enumerate(joints, 1):
        parts.append(_link(i, j.shape))
        limit = f'<limit effort="1" velocity="{j.velocity!r}" lower="{j.ends[0]!r}" upper="{j.ends[1]!r}"/>'
        parts.append(
            f'<joint name="a_joint_{i}" type="{j.kind}"><parent link="l{i - 1}"/><child link="l{i}"/>'
            f'<origin xyz="{said(j.xyz)}" rpy="{said(j.rpy)}"/>'
            + ("" if j.kind == "fixed" else f'<axis xyz="{said(j.axis)}"/>{limit}')
            + f"{j.more}</joint>"
        )
    return '<robot name="made">' + "".join([*parts, tail]) + "</robot>"


def _link(i: int, shape: str) -> str:
    return f'<link name="l{i}">' + (f"<collision>{shape}</collision>" if shape else "") + "</link>"


def limits(count: int, acceleration: float = 20.0, more: str = "") -> str:
    """A joint_limits.yaml for joints a_joint_1 to a_joint_count."""
    rows = "".join(
        f"  a_joint_{i}: {{has_acceleration_limits: true, max_acceleration: {acceleration}{more}}}\n"
        for i in range(1, count + 1)
    )
    return "joint_limits:\n" + rows


@dataclass(frozen=True)
class Files:
    """A folder with a URDF and its limits."""

    folder: Path
    urdf: Path = field(init=False)
    limits: Path = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "urdf", self.folder / "made.urdf")
        object.__setattr__(self, "limits", self.folder / "joint_limits.yaml")

    def write(self, text: str, count: int = 8) -> Files:
        self.urdf.write_text(text)
        self.limits.write_text(limits(count))
        return self

    def imported(self, **more: object) -> ImportedRobot:
        """The robot; `more`: other options than the file of limits."""
        given: dict[str, Any] = {"joint_limits": self.limits, **more}
        return import_robot(ImportOptions(self.urdf, **given))

    @property
    def remarks(self) -> list[str]:
        """What the report on the import says besides."""
        found: list[str] = self.imported().report["remarks"]
        return found


def told(files: Files, **more: object) -> list[str]:
    """All that is told of a description that is refused."""
    with pytest.raises(ImportRefused) as caught:
        files.imported(**more)
    return [str(lack) for lack in caught.value.lacks]


def flange_by_library(file: Path, base: str, tip: str, names: list[str], q: FloatArray) -> FloatArray:
    """Poses (N, 4, 4) of a link in another for positions (N, n) of joints, by yourdfpy."""
    robot = yourdfpy.URDF.load(str(file), load_meshes=False, build_collision_scene_graph=False)
    found = []
    for row in q:
        robot.update_cfg(dict(zip(names, row.tolist(), strict=True)))
        found.append(np.array(robot.get_transform(tip, base)))
    return np.array(found)


def mesh(file: str, scale: str = "1 1 1", at: Three = (0.0, 0.0, 0.0), rpy: Three = (0.0, 0.0, 0.0)) -> str:
    origin = f'<origin xyz="{said(at)}" rpy="{said(rpy)}"/>'
    return f'{origin}<geometry><mesh filename="{file}" scale="{scale}"/></geometry>'


def with_quaternions(text: str) -> str:
    """The same robot in version 1.1, each turn as a quaternion."""

    def turn(match: re.Match[str]) -> str:
        rpy = [float(part) for part in match[1].split()]
        return f'quat_xyzw="{said(tuple(Rotation.from_euler("xyz", rpy).as_quat()))}"'

    return re.sub(r'rpy="([^"]*)"', turn, text).replace("<robot ", '<robot version="1.1" ')


FORE_AT, LIFT_AT = 'xyz="0.1 0 0.1"', 'xyz="0.2 0 0"'
CELLARM = f"""<?xml version="1.0"?>
<robot name="cellarm">
  <link name="base"><collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.06" length="0.2"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0.15 0 0.03"/><geometry><box size="0.36 0.1 0.06"/></geometry></collision></link>
  <link name="fore"><collision><origin {FORE_AT}/><geometry><box size="0.3 0.1 0.06"/></geometry></collision></link>
  <link name="carriage"/>
  <link name="flange"><collision><origin xyz="0 0 0.12"/><geometry><cylinder radius="0.01" length="0.24"/></geometry></collision></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.2"/><axis xyz="0 0 1"/>
    <limit lower="-2.2" upper="2.2" velocity="6" effort="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0.3 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2.5" upper="2.5" velocity="9" effort="1"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="fore"/><child link="carriage"/><origin {LIFT_AT}/><axis xyz="0 0 -1"/>
    <limit lower="0" upper="0.15" velocity="1" effort="1"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="carriage"/><child link="flange"/><axis xyz="0 0 1"/>
    <limit lower="-6.28" upper="6.28" velocity="20" effort="1"/>
  </joint>
</robot>
"""  # noqa: E501 - a link a line
"""A SCARA of the size of a small one that is sold."""
CELLARM_LIMITS = """joint_limits:
  shoulder: {has_acceleration_limits: true, max_acceleration: 60}
  elbow: {has_acceleration_limits: true, max_acceleration: 90}
  lift: {has_acceleration_limits: true, max_acceleration: 12}
  wrist: {has_acceleration_limits: true, max_acceleration: 300}
"""


def cellarm(folder: Path, *changes: tuple[str, str], version: str = "", limits: str = CELLARM_LIMITS) -> Files:
    """The files of `CELLARM` with some of its text replaced; each change must be of text that is there once."""
    text = CELLARM
    for old, new in changes:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    if version:
        text = text.replace("<robot ", f'<robot version="{version}" ')
    files = Files(folder)
    files.urdf.write_text(text)
    files.limits.write_text(limits)
    return files


LIFT = (0.01, 0.2)
FAMILIES: dict[str, tuple[str, str, str]] = {
    "scara, lift third": (
        "scara",
        "rrpr",
        urdf(
            J("revolute", (0, 0, 0.2)),
            J("revolute", (0.3, 0, 0)),
            J("prismatic", (0.25, 0, 0), ends=LIFT),
            J("revolute"),
        ),
    ),
    "scara, axes that count the other way round, a base beside the origin, zeros everywhere": (
        "scara",
        "rrpr",
        urdf(
            J("fixed", (0.1, -0.2, 0.3), (0, 0, 0.7)),
            J("revolute", (0.02, 0.03, 0.1), (0, 0, 0.4), (0, 0, -1)),
            J("fixed", (0.1, 0.05, 0.01), (0, 0, 0.3)),
            J("revolute", (0.2, 0.1, 0.02), (0, 0, -0.9), (0, 0, -1)),
            J("prismatic", (0.15, -0.2, 0.1), (0, 0, 1.1), (0, 0, -1), LIFT),
            J("revolute", (0, 0, -0.1), (0, 0, 0.25), (0, 0, -1)),
            J("fixed", (0, 0, -0.05), (0, 0, 0.6)),
        ),
    ),
    "scara, tool frame down": (
        "scara",
        "rrpr",
        urdf(
            J("revolute", (0, 0, 0.2)),
            J("revolute", (0.3, 0, 0), (2 * RIGHT, 0, 0)),
            J("prismatic", (0.25, 0, 0), ends=LIFT),
            J("revolute", (0, 0, 0.1), (0, 0, 0.5)),
        ),
    ),
    "scara, lift first": (
        "scara",
        "prrr",
        urdf(
            J("prismatic", ends=LIFT),
            J("revolute", (0.1, 0, 0.2)),
            J("revolute", (0, 0.3, 0)),
            J("revolute", (0.25, 0, 0)),
        ),
    ),
    "scara, lift second": (
        "scara",
        "rprr",
        urdf(
            J("revolute"),
            J("prismatic", (0.1, 0, 0), ends=LIFT),
            J("revolute", (0.2, 0, 0.1)),
            J("revolute", (0.2, 0, 0)),
        ),
    ),
    "scara, lift last": (
        "scara",
        "rrrp",
        urdf(
            J("revolute"),
            J("revolute", (0.2, 0, 0.1)),
            J("revolute", (0.2, 0, 0), (0, 0, 1)),
            J("prismatic", axis=(0, 0, -1), ends=LIFT),
        ),
    ),
    "scara of three axes": (
        "scara",
        "rrpr",
        urdf(J("revolute", (0, 0, 0.2)), J("revolute", (0.3, 0, 0)), J("prismatic", (0.25, 0.1, 0), ends=LIFT)),
    ),
    "elbow arm, straight up at its zeros": (
        "elbow_arm",
        "",
        urdf(
            J("revolute", (0.02, 0.01, 0.1), (0, 0, 0.3)),
            J("revolute", (0, 0.06, 0.2), axis=(0, 1, 0)),
            J("revolute", (0, -0.03, 0.25), axis=(0, -1, 0)),
            J("fixed", (0.01, -0.03, 0.2), (0.1, 0.2, 0.3)),
        ),
    ),
    "elbow arm, level axes by turned frames": (
        "elbow_arm",
        "",
        urdf(
            J("revolute", (0, 0, 0.1), axis=(0, 0, -1)),
            J("revolute", (0, 0, 0.2), (RIGHT, 0, 0)),
            J("revolute", (0.3, 0, 0)),
            J("fixed", (0.2, 0.02, 0)),
        ),
    ),
    "five-axis arm": (
        "five_axis_arm",
        "",
        urdf(
            J("revolute", (0, 0, 0.1)),
            J("revolute", (0, 0.05, 0.2), axis=(0, 1, 0)),
            J("revolute", (0, 0, 0.25), axis=(0, 1, 0)),
            J("revolute", (0.16, -0.05, 0), axis=(0, -1, 0)),
            J("revolute", (0.03, 0, 0), axis=(-1, 0, 0)),
            J("fixed", (0.05, 0, 0), (0, RIGHT, 0)),
        ),
    ),
}
"""Family, axis order and URDF of arms of every family."""

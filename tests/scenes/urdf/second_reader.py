"""A second reader of URDFs, written from the specification of versions 1.0 to 1.2 and not from ours: where links and
collision shapes are. It reads right files only, and uses other rotations than the product does.

yourdfpy, the other library of these tests, knows version 1.0 only and leaves quaternions out without a word.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from assur.planner.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Shape:
    """A collision shape: its link, its element, its attributes, and its pose (4, 4) in the frame of the link."""

    link: str
    shape: str
    attributes: dict[str, str]
    pose: FloatArray


def _floats(text: str) -> list[float]:
    return [float(part) for part in text.split()]


def _pose(holder: ET.Element) -> FloatArray:
    found, origin = np.eye(4), holder.find("origin")
    if origin is not None:
        found[:3, 3] = _floats(origin.get("xyz", "0 0 0"))
        quaternion = origin.get("quat_xyzw")
        turn = (
            Rotation.from_euler("xyz", _floats(origin.get("rpy", "0 0 0")))
            if quaternion is None
            else Rotation.from_quat(_floats(quaternion))
        )
        found[:3, :3] = turn.as_matrix()
    return found


def shapes(file: Path) -> list[Shape]:
    """The collision shapes of all links."""
    found = []
    for link in ET.parse(file).getroot().findall("link"):
        for collision in link.findall("collision"):
            (shape,) = collision.iterfind("geometry/*")
            found.append(Shape(link.attrib["name"], shape.tag, dict(shape.attrib), _pose(collision)))
    return found


def link_in(file: Path, base: str, tip: str, names: list[str], q: FloatArray) -> FloatArray:
    """Poses (N, 4, 4) of the link `tip` in the link `base` for positions (N, n) of joints; others are at 0."""
    above = {}
    for joint in ET.parse(file).getroot().findall("joint"):
        (child,) = joint.findall("child")
        above[child.attrib["link"]] = joint
    found = []
    for row in q:
        at = dict(zip(names, row.tolist(), strict=True))
        found.append(np.linalg.inv(_in_root(above, base, at)) @ _in_root(above, tip, at))
    return np.array(found)


def _in_root(above: dict[str, ET.Element], link: str, at: dict[str, float]) -> FloatArray:
    found = np.eye(4)
    while (joint := above.get(link)) is not None:
        axis = joint.find("axis")
        way = np.array([1.0, 0.0, 0.0] if axis is None else _floats(axis.attrib["xyz"]))
        way = at.get(joint.attrib["name"], 0.0) * way / np.linalg.norm(way)
        moved = np.eye(4)
        if joint.attrib["type"] == "prismatic":
            moved[:3, 3] = way
        elif joint.attrib["type"] in ("revolute", "continuous"):
            moved[:3, :3] = Rotation.from_rotvec(way).as_matrix()
        found = _pose(joint) @ moved @ found
        (parent,) = joint.findall("parent")
        link = parent.attrib["link"]
    return found

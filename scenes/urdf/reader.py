"""A URDF file of version 1.0, 1.1 or 1.2 as a tree of links and joints. `unread.py` refuses or reports the parts that
this reader ignores.

Source: the ROS wiki's pages urdf/XML for version 1.0, and the README of ros/urdfdom 6 for versions 1.1 (turns as
quaternions, capsules) and 1.2 (limits of acceleration, deceleration and jerk; both ends of a range are required).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import get_args

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.urdf.refusals import Defect, ImportRefused, Unsuitable
from assur.scenes.urdf.tree import Bound, Joint, JointType, Limit, Solid, Tree, of_quaternion, of_rpy
from assur.scenes.urdf.unread import not_expanded, unread
from assur.scenes.urdf.xml_text import FARTHEST, NUMBER, Node, number, numbers, parse_xml

VERSIONS = ("1.0", "1.1", "1.2")
"""Versions of the format that are known; a file that states none is of version 1.0."""
SIZES: dict[str, tuple[str, ...]] = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
}
"""Primitives of a URDF, and the attributes that have their sizes."""
OF_1_2: tuple[Bound, ...] = ("acceleration", "deceleration", "jerk")
MOST_LINKS = 1_000
LONGEST_NAME = 200
ROUND_RAD = 1e-4
"""An angle that is this near to a multiple of a right angle may be one that was written with few digits."""
UNIT_LENGTH = 1e-3
"""How far the length of a quaternion may be from 1: three digits are the fewest that tools write."""


def read_tree(content: bytes, name: str, *, rounding: bool = False) -> Tree:
    """The tree in a URDF file. `rounding`: angles that are near to a multiple of a right angle are read as such.

    Raises `ImportRefused` with all that makes it no tree (names that are given twice or lead nowhere, a loop, several
    roots, numbers that are none), or that is not known and may change joints, limits or shapes.
    """
    root = parse_xml(content, name, "robot")
    if lacks := not_expanded(root):
        raise ImportRefused(name, lacks)
    version = root.get("version")
    if version is not None and version not in VERSIONS:
        what = f"version {version[:40]!r}, which may mean other than what is read here"
        supply = f"versions {', '.join(VERSIONS)} are known; write the description in one of them"
        raise ImportRefused(name, [Defect(f"line {root.line}, robot, version", what, supply)])
    return _Reader(root, name, version or VERSIONS[0], rounding=rounding).tree()


class _Reader:
    """One reading of a file."""

    def __init__(self, root: Node, name: str, version: str, *, rounding: bool) -> None:
        self.root, self.name, self.version, self.rounding = root, name, version, rounding
        self.lacks: list[Defect] = []
        self.remarks: list[str] = []
        self.warnings: list[str] = []
        self.rounded: list[str] = []
        self.links: dict[str, tuple[Solid, ...]] = {}
        self.joints: dict[str, Joint] = {}

    @contextmanager
    def _collected(self, node: Node) -> Iterator[None]:
        """What is unsuitable inside is one of the lacks, and settles the node."""
        try:
            yield
        except Unsuitable as error:
            self.lacks.append(error.lack)
            node.settled = True

    def tree(self) -> Tree:
        elements = self.root.every("link")
        for i, element in enumerate(elements):
            with self._collected(element):
                link = element.get("name") or ""
                if not link or link in self.links:
                    raise Unsuitable(f"<link> {i + 1}", f"name {link[:40]!r}", "give each link a name of its own")
                _short_enough("link", link)
                self.links[link] = ()  # a link with a wrong shape is there all the same: no joint lacks it
                self.links[link] = tuple(self._solids(element, link))
        controlled, lacks, remarks = controller_bounds(self.root)
        self.lacks += lacks
        self.remarks += remarks
        for i, element in enumerate(self.root.every("joint")):
            with self._collected(element):
                joint = self._joint(element, i, controlled)
                if joint.name in self.joints:
                    raise Unsuitable(f"joint {joint.name}", "a second one", "give each joint a name of its own")
                self.joints[joint.name] = joint
        robot = (self.root.get("name") or "robot")[:LONGEST_NAME]
        lacks, remarks, unused = unread(self.root)
        self.lacks += lacks
        self.remarks += remarks
        if not self.lacks:
            self.lacks += _no_tree(self.links, self.joints)
        if self.lacks:
            raise ImportRefused(self.name, self.lacks)
        seen = [link.attributes["name"] for link in elements if any(c.tag == "visual" for c in link.children)]
        only_seen = tuple(link for link in seen if not self.links[link])
        rounded = tuple(dict.fromkeys(self.rounded))
        more = tuple(self.remarks), tuple(unused), tuple(self.warnings)
        return Tree(robot, self.links, self.joints, rounded, only_seen, *more)

    def _joint(self, element: Node, i: int, controlled: dict[str, list[tuple[Bound, Limit]]]) -> Joint:
        name = element.get("name") or ""
        where = f"joint {name}" if name else f"<joint> {i + 1}"
        kind = element.get("type") or ""
        if not name:
            raise Unsuitable(where, "no name", "give each joint a name of its own")
        _short_enough("joint", name)
        if kind not in get_args(JointType):
            raise Unsuitable(where, f"type {kind!r}", f"one of {', '.join(get_args(JointType))}")
        known: JointType = kind  # type: ignore[assignment]
        parent, child = (self._end(element, tag, where) for tag in ("parent", "child"))
        axis, stretch = self._axis(element, where, known)
        bounds = self._bounds(element, where, known, controlled.get(name, []))
        mimic = element.one("mimic", where)
        mimics = None if mimic is None else mimic.get("joint") or "?"
        silent = (("multiplier", 1.0), ("offset", 0.0))
        slope, offset = (
            v if mimic is None else number(mimic.get(key), f"{where}, mimic.{key}", v) for key, v in silent
        )
        origin, rpy = self._origin(element, where)
        return Joint(name, known, parent, child, origin, axis, bounds, mimics, (slope, offset), rpy, stretch)

    def _end(self, element: Node, tag: str, where: str) -> str:
        found = element.one(tag, where)
        link = "" if found is None else found.get("link") or ""
        if link not in self.links:
            raise Unsuitable(where, f"its {tag} {link!r} is no link of the file", "name a link that is there")
        return link

    def _axis(self, element: Node, where: str, kind: JointType) -> tuple[FloatArray, float]:
        """The direction (3,) of a joint's axis, and the length with which it is written."""
        along = element.one("axis", where)
        text = None if along is None else along.get("xyz")
        if kind in ("fixed", "floating"):
            return np.array([1.0, 0.0, 0.0]), 1.0
        if along is None:
            self.remarks.append(f"line {element.line}, {where}: no <axis>: it is 1 0 0 by the format")
            return np.array([1.0, 0.0, 0.0]), 1.0
        axis = np.array(numbers(text, 3, f"{where}, axis"))
        stretch = float(np.linalg.norm(axis))
        if not stretch > 1e-9:
            raise Unsuitable(f"{where}, axis", "no direction", "write a direction that is not 0 0 0")
        return axis / stretch, stretch

    def _bounds(
        self, element: Node, where: str, kind: JointType, more: list[tuple[Bound, Limit]]
    ) -> dict[Bound, Limit]:
        """The limits that are stated of a joint: in `limit`, in `safety_controller` and (`more`) for its controller; of
        several the narrowest."""
        limit, found = element.one("limit", where), dict[Bound, Limit]()
        for key in get_args(Bound):
            text = None if limit is None else limit.get(key)
            if text is not None:
                found[key] = Limit(number(text, f"{where}, limit.{key}"), f"limit.{key}")
        late = [key for key in OF_1_2 if key in found]
        if limit is not None and late and self.version != "1.2":
            what = f"limit.{', limit.'.join(late)}: version {self.version} has none; read as in version 1.2"
            self.remarks.append(f"line {limit.line}, {where}: {what}")
        ends: tuple[Bound, Bound] = ("lower", "upper")
        for end in ends:
            if limit is None or end in found or kind not in ("revolute", "prismatic"):
                continue
            if self.version == "1.2":
                supply = f"write {end}; version 1.2 requires both ends of the range"
                raise Unsuitable(f"{where}, limit.{end}", "nothing", supply)
            found[end] = Limit(0.0, f"limit (no {end}: it is 0 by the format)")
        safety = element.one("safety_controller", where)
        for end in ends:
            key = f"soft_{end}_limit"
            text = None if safety is None else safety.get(key)
            if text is not None:
                more = [*more, (end, Limit(number(text, f"{where}, {key}"), f"safety_controller.{key}"))]
        if kind == "continuous":
            of_ends = [
                *(found[end].source for end in ends if end in found),
                *(s.source for end, s in more if end in ends),
            ]
            if of_ends:
                what = "it turns without end, so what the file states of its range is not taken"
                self.remarks.append(f"line {element.line}, {where}, {', '.join(of_ends)}: {what}")
            more = [(bound, stated) for bound, stated in more if bound not in ends]
        for bound, stated in more:
            own = found.get(bound)
            if own is None or (stated.value > own.value if bound == "lower" else stated.value < own.value):
                found[bound] = stated
        return found

    def _solids(self, element: Node, link: str) -> list[Solid]:
        found = []
        several = element.every("collision")
        for i, collision in enumerate(several):
            where = f"link {link}, collision" + (f" {i + 1}" if len(several) > 1 else "")
            geometry = collision.one("geometry", where)
            shapes = [] if geometry is None else geometry.children
            if len(shapes) != 1 or shapes[0].tag not in (*SIZES, "mesh"):
                tags = ", ".join(shape.tag for shape in shapes) or "nothing"
                raise Unsuitable(where, f"geometry {tags}", f"one of {', '.join((*SIZES, 'mesh'))}")
            (shape,) = (geometry or collision).every(shapes[0].tag)
            origin, _ = self._origin(collision, where)
            if shape.tag == "mesh":
                scale = numbers(shape.get("scale"), 3, f"{where}, mesh.scale", (1.0, 1.0, 1.0))
                if 0.0 in scale:
                    raise Unsuitable(f"{where}, mesh.scale", "a scale of 0", "three numbers that are not 0")
                found.append(Solid(where, "mesh", origin, (), shape.get("filename") or "", scale))
                continue
            if shape.tag == "capsule" and self.version == "1.0":
                what = "a capsule: version 1.0 has none; read as in version 1.1"
                self.remarks.append(f"line {shape.line}, {where}: {what}")
            sizes: list[float] = []
            for key in SIZES[shape.tag]:
                sizes += numbers(shape.get(key), 3 if key == "size" else 1, f"{where}, {shape.tag}.{key}")
            if not min(sizes) > 0.0:
                raise Unsuitable(where, f"{shape.tag} of size {sizes}", "sizes above 0")
            found.append(Solid(where, shape.tag, origin, tuple(sizes)))
        return found

    def _origin(self, element: Node, where: str) -> tuple[FloatArray, tuple[float, ...]]:
        """The pose (4, 4) of an element, turned first and then moved, and its roll, pitch and yaw as they are
        written."""
        given = element.one("origin", where)
        found, rest = np.eye(4), (0.0, 0.0, 0.0)
        if given is None:
            return found, rest
        found[:3, 3] = numbers(given.get("xyz"), 3, f"{where}, origin.xyz", (0.0, 0.0, 0.0))
        angles, quaternion = given.get("rpy"), given.get("quat_xyzw")
        if quaternion is not None:
            if angles is not None:
                raise Unsuitable(f"{where}, origin", "both rpy and quat_xyzw", "leave the one that counts")
            found[:3, :3] = self._quaternion(quaternion, f"{where}, origin.quat_xyzw", given.line)
            return found, rest
        rpy = numbers(angles, 3, f"{where}, origin.rpy", rest)
        if max(map(abs, rpy)) > math.tau:
            meant = " ".join(f"{math.radians(angle):.6g}" for angle in rpy)
            what = f"{(angles or '')[:80]} is more than a turn; if these are deg, it is {meant} rad"
            self.warnings.append(f"line {given.line}, {where}, origin.rpy: {what}")
        roll, pitch, yaw = map(self._angle, rpy)
        found[:3, :3] = of_rpy(roll, pitch, yaw)
        return found, rpy

    def _angle(self, value: float) -> float:
        near = round(value / (math.pi / 2)) * (math.pi / 2)
        if self.rounding and value != near and abs(value - near) <= ROUND_RAD:
            self.rounded.append(f"{value:.9g}")
            return near
        return value

    def _quaternion(self, text: str, where: str, line: int) -> FloatArray:
        """The rotation (3, 3) of a quaternion x, y, z, w. Raises `Unsuitable` for one that is not 1 long."""
        if self.version == "1.0":
            supply = 'write version="1.1" in <robot>, or the turn as rpy'
            raise Unsuitable(where, "a quaternion, which version 1.0 does not have: its readers ignore it", supply)
        x, y, z, w = numbers(text, 4, where)
        length = math.sqrt(x * x + y * y + z * z + w * w)
        if not abs(length - 1.0) <= UNIT_LENGTH:
            supply = f"write x y z w of a quaternion that is 1 long, to {UNIT_LENGTH:g}"
            raise Unsuitable(where, f"{text[:80]!r}, which is {length:.6g} long", supply)
        found = of_quaternion(x, y, z, w)
        near = np.round(found)
        if self.rounding and not np.array_equal(found, near) and np.abs(found - near).max() <= ROUND_RAD:
            self.rounded.append(text[:80])
            return near + 0.0
        if abs(length - 1.0) > 1e-6:
            what = f"it is {length:.6g} long; the quaternion of its direction is taken"
            self.remarks.append(f"line {line}, {where}: {what}")
        return found


def _short_enough(kind: str, name: str) -> None:
    """Raises `Unsuitable` for a name that is too long for the text of a source."""
    if len(name) > LONGEST_NAME:
        what = f"a name of {len(name)} characters"
        raise Unsuitable(f"{kind} {name[:40]}...", what, f"names of up to {LONGEST_NAME} characters are read")


def _no_tree(links: dict[str, tuple[Solid, ...]], joints: dict[str, Joint]) -> list[Defect]:
    if not 1 <= len(links) <= MOST_LINKS:
        none = "" if links else "; a xacro file that only defines macros has none: give the file that calls them"
        return [Defect("the file", f"{len(links)} links", f"1 to {MOST_LINKS} links are read{none}")]
    found = []
    parents = Counter(joint.child for joint in joints.values())
    for link, count in parents.items():
        if count > 1:
            by = ", ".join(joint.name for joint in joints.values() if joint.child == link)
            found.append(Defect(f"link {link}", f"it is the child of {count} joints ({by})", "give it one parent"))
    for joint in joints.values():
        if joint.mimics is not None and joint.mimics not in joints:
            what = f"it mimics joint {joint.mimics!r}, which is not in the file"
            found.append(Defect(f"joint {joint.name}", what, "name a joint that is there"))
    roots = [link for link in links if link not in parents]
    if not roots:
        found.append(Defect("the file", "a loop of joints: no link is the root", "open the loop; a URDF is a tree"))
    if len(roots) > 1:
        supply = "join them by fixed joints, or remove what is not of the robot"
        found.append(Defect("the file", f"{len(roots)} roots: {', '.join(roots[:8])}", supply))
    if not found:
        seen, ahead = set(roots), list(roots)
        while ahead:
            link = ahead.pop()
            for joint in joints.values():
                if joint.parent == link and joint.child not in seen:
                    seen.add(joint.child)
                    ahead.append(joint.child)
        if len(seen) < len(links):
            lost = next(link for link in links if link not in seen)
            found.append(Defect(f"link {lost}", "it is in a loop of joints", "open the loop; a URDF is a tree"))
    return found


# Limits that a URDF states for the controllers of its joints: `min` and `max` of command interfaces in ros2_control.
#
# A controller cuts off what is beyond them, so a plan must keep them, too.

KINDS: dict[str, tuple[Bound, Bound]] = {
    "position": ("lower", "upper"),
    "velocity": ("velocity", "velocity"),
    "acceleration": ("acceleration", "acceleration"),
    "jerk": ("jerk", "jerk"),
}
"""Names of interfaces, and what their `min` and `max` limit."""

ControllerBounds = dict[str, list[tuple[Bound, Limit]]]
"""The limits of each joint, by its name."""


def controller_bounds(root: Node) -> tuple[ControllerBounds, list[Defect], list[str]]:
    """The limits of controllers, those that are no numbers, and those that are not taken, with their lines."""
    found: ControllerBounds = {}
    lacks: list[Defect] = []
    remarks: list[str] = []
    for name, kind, off, param in _params(root):
        side = ("min", "max").index(param.attributes["name"])
        where = f"line {param.line}, ros2_control, joint {name}, {kind}.{param.attributes['name']}"
        text = param.text.strip()
        value = float(text) if NUMBER.fullmatch(text) else None
        if off:
            remarks.append(f"{where}: {text[:40]} is not taken, for <limits enable=...> switches it off")
        elif value is None or not abs(value) <= FARTHEST:
            lacks.append(Defect(where, f"{text[:40]!r} is no finite number", "write a number, or remove it"))
        elif kind != "position" and not (value if side else -value) > 0.0:
            remarks.append(f"{where}: {text} is not taken, for it limits one direction only")
        else:
            size = value if kind == "position" else abs(value)
            source = f"ros2_control {kind}.{param.attributes['name']}"
            found.setdefault(name, []).append((KINDS[kind][side], Limit(size, source)))
    return found, lacks, remarks


def _params(root: Node) -> Iterator[tuple[str, str, bool, Node]]:
    """Joint, name of the interface, whether its limits are switched off, and the element of each limit."""
    for joint in (each for child in root.children if child.tag == "ros2_control" for each in child.children):
        name, off = joint.attributes.get("name", ""), _off(joint)
        for interface in joint.children if joint.tag == "joint" else []:
            kind, own = interface.attributes.get("name", ""), off or _off(interface)
            for param in interface.children if interface.tag == "command_interface" and kind in KINDS else []:
                if param.tag == "param" and param.attributes.get("name") in ("min", "max"):
                    yield name, kind, own, param


def _off(node: Node) -> bool:
    return any(
        child.tag == "limits" and child.attributes.get("enable", "true").strip().lower() == "false"
        for child in node.children
    )

"""The tree of links and joints that a URDF says, with the solids of its links, as plain data in metres and radians."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from assur.planner.arrays import FloatArray
from assur.scenes.urdf.refusals import ImportRefused, Lack, Unsuitable
from assur.scenes.urdf.xml_text import number, numbers, parse_xml

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

JointType = Literal["revolute", "continuous", "prismatic", "fixed", "floating", "planar"]
MOVING = ("revolute", "continuous", "prismatic")
SIZES: dict[str, tuple[str, ...]] = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
}
"""Primitives of a URDF, and the attributes that have their sizes."""
MOST_LINKS = 1_000
LONGEST_NAME = 200
ROUND_RAD = 1e-4
"""An angle that is this near to a multiple of a right angle may be one that was written with few digits."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A collision shape of a link: `origin` (4, 4) in the link's frame. A primitive has its `sizes` in m; a mesh its
    `file` as it is written, and the scale (3,) of its coordinates."""

    where: str
    kind: str
    origin: FloatArray
    sizes: tuple[float, ...] = ()
    file: str = ""
    scale: tuple[float, ...] = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint. `origin` (4, 4): the child's frame in the parent's at position 0; `axis` (3,): a unit vector in the
    child's frame. `lower`, `upper`, `velocity` are None where the file is silent."""

    name: str
    kind: JointType
    parent: str
    child: str
    origin: FloatArray
    axis: FloatArray
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    mimics: str | None = None
    follows: tuple[float, float] = (1.0, 0.0)
    """Multiplier and offset of a joint that mimics another."""
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)
    """Roll, pitch and yaw of the origin as they are written."""
    ends: tuple[str, str] = ("limit.lower", "limit.upper")
    """Whence `lower` and `upper` are."""
    stretch: float = 1.0
    """Length of the axis as it is written."""

    @property
    def moves(self) -> bool:
        return self.kind in MOVING

    def motion(self, q: FloatArray) -> FloatArray:
        """Pose (..., 4, 4) of the child in the parent for positions (...), rad or m; what does not move stays."""
        found = np.broadcast_to(self.origin, (*q.shape, 4, 4)).copy()
        if self.kind == "prismatic":
            found[..., :3, 3] += q[..., None] * (self.origin[:3, :3] @ self.axis)
        elif self.moves:
            x, y, z = self.axis
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            s, c = np.sin(q)[..., None, None], np.cos(q)[..., None, None]
            found[..., :3, :3] = self.origin[:3, :3] @ (np.eye(3) + s * cross + (1 - c) * cross @ cross)
        return found


@dataclass(frozen=True, eq=False)
class Tree:
    """A robot: its links by name, each with its solids, and its joints by name. It has one root and no loop.

    `rounded`: angles that were read as multiples of a right angle, as they are written; `only_seen`: links with a
    visual shape and no collision shape.
    """

    name: str
    links: dict[str, tuple[Solid, ...]]
    joints: dict[str, Joint]
    rounded: tuple[str, ...] = ()
    only_seen: tuple[str, ...] = ()

    @property
    def root(self) -> str:
        children = {joint.child for joint in self.joints.values()}
        return next(link for link in self.links if link not in children)

    @cached_property
    def _below(self) -> dict[str, list[Joint]]:
        found: dict[str, list[Joint]] = {}
        for joint in self.joints.values():
            found.setdefault(joint.parent, []).append(joint)
        return found

    @cached_property
    def _above(self) -> dict[str, Joint]:
        return {joint.child: joint for joint in self.joints.values()}

    def below(self, link: str) -> list[Joint]:
        """The joints whose parent is a link, in the order of the file."""
        return self._below.get(link, [])

    def above(self, link: str) -> Joint | None:
        """The joint whose child is a link."""
        return self._above.get(link)

    def path(self, base: str, tip: str) -> list[Joint] | None:
        """The joints from `base` to `tip`; None if `tip` does not hang on `base`."""
        found: list[Joint] = []
        while tip != base:
            joint = self.above(tip)
            if joint is None:
                return None
            found.append(joint)
            tip = joint.parent
        return found[::-1]

    def with_held(self, held: dict[str, float]) -> Tree:
        """The tree with some joints held at a position, as if they were fixed there, and with them the joints that
        follow them."""
        joints, at = dict(self.joints), dict(held)
        while more := [joint for joint in joints.values() if joint.mimics in at and joint.name not in at]:
            for joint in more:
                multiplier, offset = joint.follows
                at[joint.name] = multiplier * at[joint.mimics or ""] + offset
        for name, value in at.items():
            joint = joints[name]
            joints[name] = replace(joint, kind="fixed", origin=joint.motion(np.array(value)), mimics=None)
        return replace(self, joints=joints)


def read_tree(content: bytes, name: str, *, rounding: bool = False) -> Tree:
    """The tree in a URDF file. `rounding`: angles that are near to a multiple of a right angle are read as such.

    Raises `ImportRefused` with all that makes it no tree: names that are given twice or lead nowhere, a loop, several
    roots, numbers that are none.
    """
    root = parse_xml(content, name, "robot")
    lacks: list[Lack] = []
    rounded: list[str] = []

    def angle(value: float) -> float:
        near = round(value / (math.pi / 2)) * (math.pi / 2)
        if rounding and value != near and abs(value - near) <= ROUND_RAD:
            rounded.append(f"{value:.9g}")
            return near
        return value

    links: dict[str, tuple[Solid, ...]] = {}
    for i, element in enumerate(root.findall("link")):
        link = element.get("name") or ""
        with _told(lacks):
            if not link or link in links:
                raise Unsuitable(f"<link> {i + 1}", f"name {link[:40]!r}", "give each link a name of its own")
            _short_enough("link", link)
            links[link] = ()  # a link with a wrong shape is there all the same: no joint lacks it
            links[link] = tuple(_solids(element, link, angle))
    joints: dict[str, Joint] = {}
    for i, element in enumerate(root.findall("joint")):
        with _told(lacks):
            joint = _joint(element, i, links, angle)
            if joint.name in joints:
                raise Unsuitable(f"joint {joint.name}", "a second one", "give each joint a name of its own")
            joints[joint.name] = joint
    if not lacks:
        lacks += _no_tree(links, joints)
    if lacks:
        raise ImportRefused(name, lacks)
    seen = [link.get("name") or "" for link in root.findall("link") if link.find("visual") is not None]
    only_seen = tuple(link for link in seen if not links[link])
    return Tree((root.get("name") or "robot")[:LONGEST_NAME], links, joints, tuple(dict.fromkeys(rounded)), only_seen)


class _told:
    """What is unsuitable inside is added to the list of lacks."""

    def __init__(self, lacks: list[Lack]) -> None:
        self._lacks = lacks

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if isinstance(error, Unsuitable):
            self._lacks.append(error.lack)
        return isinstance(error, Unsuitable)


def _short_enough(kind: str, name: str) -> None:
    """Raises `Unsuitable` for a name that is longer than any is, which no source could be told with."""
    if len(name) > LONGEST_NAME:
        what = f"a name of {len(name)} characters"
        raise Unsuitable(f"{kind} {name[:40]}...", what, f"names of up to {LONGEST_NAME} characters are read")


def _no_tree(links: dict[str, tuple[Solid, ...]], joints: dict[str, Joint]) -> list[Lack]:
    if not 1 <= len(links) <= MOST_LINKS:
        none = "" if links else "; a xacro file that only defines macros has none: give the file that calls them"
        return [Lack("the file", f"{len(links)} links", f"1 to {MOST_LINKS} links are read{none}")]
    found = []
    parents = Counter(joint.child for joint in joints.values())
    for link, count in parents.items():
        if count > 1:
            by = ", ".join(joint.name for joint in joints.values() if joint.child == link)
            found.append(Lack(f"link {link}", f"it is the child of {count} joints ({by})", "give it one parent"))
    for joint in joints.values():
        if joint.mimics is not None and joint.mimics not in joints:
            what = f"it mimics joint {joint.mimics!r}, which is not in the file"
            found.append(Lack(f"joint {joint.name}", what, "name a joint that is there"))
    roots = [link for link in links if link not in parents]
    if not roots:
        found.append(Lack("the file", "a loop of joints: no link is the root", "open the loop; a URDF is a tree"))
    if len(roots) > 1:
        supply = "join them by fixed joints, or remove what is not of the robot"
        found.append(Lack("the file", f"{len(roots)} roots: {', '.join(roots[:8])}", supply))
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
            found.append(Lack(f"link {lost}", "it is in a loop of joints", "open the loop; a URDF is a tree"))
    return found


ONCE = ("parent", "child", "origin", "axis", "limit", "mimic", "safety_controller")
"""What a joint has once; of two nobody knows which counts."""


def _joint(element: Element, i: int, links: dict[str, tuple[Solid, ...]], angle: Callable[[float], float]) -> Joint:
    name = element.get("name") or ""
    where = f"joint {name}" if name else f"<joint> {i + 1}"
    kind = element.get("type") or ""
    if not name:
        raise Unsuitable(where, "no name", "give each joint a name of its own")
    _short_enough("joint", name)
    if kind not in get_args(JointType):
        raise Unsuitable(where, f"type {kind!r}", f"one of {', '.join(get_args(JointType))}")
    for tag in ONCE:
        if len(element.findall(tag)) > 1:
            raise Unsuitable(f"{where}, {tag}", "more than one of them", "leave the one that counts")
    ends = []
    for end in ("parent", "child"):
        found = element.find(end)
        link = "" if found is None else found.get("link") or ""
        if link not in links:
            raise Unsuitable(where, f"its {end} {link!r} is no link of the file", "name a link that is there")
        ends.append(link)
    axis, stretch = np.array([1.0, 0.0, 0.0]), 1.0
    along = element.find("axis")
    if along is not None and kind != "fixed":
        axis = np.array(numbers(along.get("xyz"), 3, f"{where}, axis"))
        stretch = float(np.linalg.norm(axis))
        if not stretch > 1e-9:
            raise Unsuitable(f"{where}, axis", "no direction", "write a direction that is not 0 0 0")
        axis /= stretch
    limit, mimic = element.find("limit"), element.find("mimic")
    given = {} if limit is None else limit.attrib
    lower, upper, velocity = (
        number(given[key], f"{where}, limit.{key}") if key in given else None for key in ("lower", "upper", "velocity")
    )
    if limit is not None and kind in ("revolute", "prismatic"):
        lower, upper = lower or 0.0, upper or 0.0  # both are 0 where the file is silent, by the format
    lower, upper, whence = _narrower(element, where, lower, upper)
    mimics = None if mimic is None else mimic.get("joint") or "?"
    silent = (("multiplier", 1.0), ("offset", 0.0))
    slope, offset = (v if mimic is None else number(mimic.get(key), f"{where}, mimic.{key}", v) for key, v in silent)
    origin = _origin(element, where, angle)
    placed, rest = element.find("origin"), (0.0, 0.0, 0.0)
    rpy = rest if placed is None else numbers(placed.get("rpy"), 3, f"{where}, origin.rpy", rest)
    parent, child = ends
    known: JointType = kind  # type: ignore[assignment]
    limits = lower, upper, velocity
    return Joint(name, known, parent, child, origin, axis, *limits, mimics, (slope, offset), rpy, whence, stretch)


def _narrower(
    element: Element, where: str, lower: float | None, upper: float | None
) -> tuple[float | None, float | None, tuple[str, str]]:
    """The ends of a joint's range, with those of its safety controller where they are narrower, and whence each is."""
    safety = element.find("safety_controller")
    low, high = (
        None if safety is None or key not in safety.attrib else number(safety.get(key), f"{where}, {key}")
        for key in ("soft_lower_limit", "soft_upper_limit")
    )
    first, second = "limit.lower", "limit.upper"
    if low is not None and lower is not None and low > lower:
        lower, first = low, "safety_controller.soft_lower_limit"
    if high is not None and upper is not None and high < upper:
        upper, second = high, "safety_controller.soft_upper_limit"
    return lower, upper, (first, second)


def _solids(element: Element, link: str, angle: Callable[[float], float]) -> list[Solid]:
    found = []
    several = element.findall("collision")
    for i, collision in enumerate(several):
        where = f"link {link}, collision" + (f" {i + 1}" if len(several) > 1 else "")
        geometry = collision.find("geometry")
        shapes = [] if geometry is None else list(geometry)
        if len(shapes) != 1 or shapes[0].tag not in (*SIZES, "mesh"):
            tags = ", ".join(shape.tag for shape in shapes) or "nothing"
            raise Unsuitable(where, f"geometry {tags}", f"one of {', '.join((*SIZES, 'mesh'))}")
        (shape,) = shapes
        origin = _origin(collision, where, angle)
        if shape.tag == "mesh":
            scale = numbers(shape.get("scale"), 3, f"{where}, mesh.scale", (1.0, 1.0, 1.0))
            if 0.0 in scale:
                raise Unsuitable(f"{where}, mesh.scale", "a scale of 0", "three numbers that are not 0")
            found.append(Solid(where, "mesh", origin, (), shape.get("filename") or "", scale))
            continue
        sizes: list[float] = []
        for key in SIZES[shape.tag]:
            sizes += numbers(shape.get(key), 3 if key == "size" else 1, f"{where}, {shape.tag}.{key}")
        if not min(sizes) > 0.0:
            raise Unsuitable(where, f"{shape.tag} of size {sizes}", "sizes above 0")
        found.append(Solid(where, shape.tag, origin, tuple(sizes)))
    return found


def _origin(element: Element, where: str, angle: Callable[[float], float]) -> FloatArray:
    """The pose (4, 4) of an element: turned by roll, pitch and yaw about fixed x, y and z, then moved."""
    given = element.find("origin")
    found = np.eye(4)
    if given is None:
        return found
    found[:3, 3] = numbers(given.get("xyz"), 3, f"{where}, origin.xyz", (0.0, 0.0, 0.0))
    roll, pitch, yaw = map(angle, numbers(given.get("rpy"), 3, f"{where}, origin.rpy", (0.0, 0.0, 0.0)))
    found[:3, :3] = turned("z", yaw) @ turned("y", pitch) @ turned("x", roll)
    return found


def turned(axis: Literal["x", "y", "z"], angle: float) -> FloatArray:
    """A rotation (3, 3) about an axis; multiples of a right angle have no rounding."""
    c, s = math.cos(angle), math.sin(angle)
    quarter = angle / (math.pi / 2)
    if quarter == round(quarter):
        c, s = float(round(c)), float(round(s))
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    found = np.eye(3)
    found[j, j] = found[k, k] = c
    found[j, k], found[k, j] = -s, s
    return found

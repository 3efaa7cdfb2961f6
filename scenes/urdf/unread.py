"""What a URDF holds and its reader did not take: refused if it may change joints, limits or shapes, reported otherwise.

The reader marks what it takes, so nothing that a file holds can be left without a word: an attribute that is misspelt,
an element of a later version, a macro that nobody expanded.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator

from assur.scenes.urdf.refusals import Defect
from assur.scenes.urdf.xml_text import Node

XACRO = "xacro"
"""Namespaces of macros have this in their name; there are several."""
MACROS = ("include", "macro", "property", "arg", "if", "unless", "insert_block")
"""Elements of macros in files that are older than their namespace."""
WITHOUT_EFFECT: dict[str, frozenset[str]] = {
    "robot": frozenset({"material", "transmission", "gazebo", "ros2_control", "sensor", "mujoco"}),
    "link": frozenset(
        {"visual", "inertial", "contact", "sensor", "material", "gazebo", "@type"}
        | {"kinematic", "gravity", "selfCollide", "self_collide", "surface"}
    ),
    "joint": frozenset({"calibration", "dynamics", "joint_properties", "gazebo", "@dont_collapse"}),
    "limit": frozenset({"@effort"}),
    "safety_controller": frozenset({"@k_position", "@k_velocity"}),
    "collision": frozenset({"material", "verbose", "contact_coefficients", "@group", "@concave"}),
}
"""What each element may hold that no plan depends on; @ is before the name of an attribute."""
LISTED = {"ros2_control": "ros2_control but for the limits of its command interfaces"}
KINEMATIC = {
    *("link", "joint", "parent", "child", "origin", "pose", "axis", "limit", "limits", "mimic"),
    *("geometry", "collision", "constraint", "loop", "frame"),
}
"""Words of an element or attribute that may be of joints, limits or shapes."""
SIMULATED = ("joint", "link", "geometry")
"""What an element gazebo may add to the robot."""
OF_THE_SIMULATOR = ("plugin", "sensor", "visual")
"""Elements below gazebo that name joints and links, or show shapes, and add none to the robot."""


def not_expanded(root: Node) -> list[Defect]:
    """Macros and expressions in the place of values: without their values nothing else of the file has a meaning."""
    found = []
    ahead = deque([(root, "robot")])
    while ahead:
        node, where = ahead.popleft()
        found += [
            _unexpanded(node, where, f"{_plain(key)}={value[:60]!r} is an expression")
            for key, value in node.attributes.items()
            if "${" in value or "$(" in value
        ]
        harmless = WITHOUT_EFFECT.get(node.tag, frozenset())
        for child, inside in _children(node, where):
            space = child.tag[1:].partition("}")[0] if child.tag.startswith("{") else ""
            if XACRO in space or (node is root and child.tag in MACROS):
                found.append(_unexpanded(child, inside, f"<{_plain(child.tag)}> is a macro"))
            elif child.tag not in harmless:
                ahead.append((child, inside))
    return found


def _unexpanded(node: Node, where: str, what: str) -> Defect:
    supply = "give the file to import as .xacro, or expand it with xacro first"
    return Defect(f"line {node.line}, {where}", f"{what} that is not expanded", supply)


def unread(root: Node) -> tuple[list[Defect], list[str], list[str]]:
    """What was not taken of a file that was read: what is refused, what is reported, and what no plan depends on."""
    lacks: list[Defect] = []
    remarks: list[str] = []
    unused: dict[str, list[int]] = {}
    ahead = deque([(root, "robot")])
    while ahead:
        node, where = ahead.popleft()
        harmless = WITHOUT_EFFECT.get(node.tag, frozenset())
        for key in node.not_taken():
            if key == "name":
                continue  # of a shape: it is called by its link
            if "@" + key in harmless:
                unused.setdefault(f"{node.tag}.{key}", []).append(node.line)
            elif key.startswith("{") and node is root:
                remarks.append(
                    f"line {node.line}, {where}: attribute {_plain(key)} is of another format; it is not read"
                )
            else:
                lacks.append(_unknown(node, where, f"attribute {_plain(key)}={node.attributes[key][:40]!r}"))
        if text := " ".join(node.text.split())[:40]:
            if node.children:  # most likely a comment; what has no children may be meant to have a value
                remarks.append(f"line {node.line}, {where}: text {text!r} is not read")
            else:
                lacks.append(_unknown(node, where, f"text {text!r}"))
        for child, inside in _children(node, where):
            if child.settled:
                continue
            if node.took(child):
                ahead.append((child, inside))
            elif child.tag in harmless:
                unused.setdefault(child.tag, []).append(child.line)
                lacks += _simulated(child) if child.tag == "gazebo" else []
            elif node is root and not (word := _kinematic(child)):
                remarks.append(f"line {child.line}: element <{_plain(child.tag)}> is not of a URDF; it is not read")
            else:
                holds = f", which holds {word}" if node is root else ""
                lacks.append(_unknown(child, inside, f"element <{_plain(child.tag)}>{holds}"))
    listed = [f"{LISTED.get(what, what)} ({len(lines)}, first in line {min(lines)})" for what, lines in unused.items()]
    return lacks, remarks, listed


def _unknown(node: Node, where: str, what: str) -> Defect:
    unknown = "is not known, and may change joints, limits or shapes"
    return Defect(
        f"line {node.line}, {where}", f"{what} {unknown}", "correct its name, or remove it if it has no effect"
    )


def _simulated(gazebo: Node) -> Iterator[Defect]:
    """What a simulator adds to the robot: links, shapes, and joints that are not fixed, which may close a linkage."""
    ahead = [gazebo]
    while ahead:
        node = ahead.pop()
        if node.tag in SIMULATED and not (node.tag == "joint" and node.attributes.get("type") == "fixed"):
            what = f"<{node.tag}> adds to the robot what is no link or joint of the URDF"
            yield Defect(f"line {node.line}, gazebo", what, "remove it if the real robot has no such part")
        else:
            ahead += [child for child in node.children if child.tag not in OF_THE_SIMULATOR]


def _kinematic(node: Node) -> str | None:
    """A word in an element that may be of joints, limits or shapes; None if it has none."""
    for each in node.everything():
        tag = _plain(each.tag).rpartition(":")[2]
        if words := KINEMATIC & set(tag.lower().replace("-", "_").split("_")):
            return f"<{tag}>" if each is not node else min(words)
        for key in each.attributes:
            if key in ("xyz", "rpy", "quat_xyzw", "lower", "upper", *KINEMATIC):
                return f"the attribute {key}"
    return None


def _plain(name: str) -> str:
    """{namespace}name as the end of the namespace, a colon and the name."""
    space, _, plain = name.removeprefix("{").rpartition("}")
    return f"{space.rstrip('/').rpartition('/')[2]}:{plain}" if space else plain


def _children(parent: Node, above: str) -> Iterator[tuple[Node, str]]:
    """The children of a node, each in words: its tag, its name or which of several it is, after those of its
    parents."""
    several, seen = Counter(child.tag for child in parent.children), Counter[str]()
    for child in parent.children:
        seen[child.tag] += 1
        name = child.attributes.get("name", "")[:40]
        which = f" {name}" if name else f" {seen[child.tag]}" if several[child.tag] > 1 else ""
        own = _plain(child.tag) + which
        yield child, own if above == "robot" else f"{above}, {own}"

"""Limits that a URDF states for the controllers of its joints: `min` and `max` of command interfaces in ros2_control.

A controller cuts off what is beyond them, so a plan must keep them, too.
"""

from __future__ import annotations

from collections.abc import Iterator

from assur.scenes.urdf.refusals import Lack
from assur.scenes.urdf.tree import Bound, Limit
from assur.scenes.urdf.xml_text import FARTHEST, NUMBER, Node

KINDS: dict[str, tuple[Bound, Bound]] = {
    "position": ("lower", "upper"),
    "velocity": ("velocity", "velocity"),
    "acceleration": ("acceleration", "acceleration"),
    "jerk": ("jerk", "jerk"),
}
"""Names of interfaces, and what their `min` and `max` limit."""

ControllerBounds = dict[str, list[tuple[Bound, Limit]]]
"""The limits of each joint, by its name."""


def controller_bounds(root: Node) -> tuple[ControllerBounds, list[Lack], list[str]]:
    """The limits of controllers, those that are no numbers, and those that are not taken, with their lines."""
    found: ControllerBounds = {}
    lacks: list[Lack] = []
    remarks: list[str] = []
    for name, kind, off, param in _params(root):
        side = ("min", "max").index(param.attributes["name"])
        where = f"line {param.line}, ros2_control, joint {name}, {kind}.{param.attributes['name']}"
        text = param.text.strip()
        value = float(text) if NUMBER.fullmatch(text) else None
        if off:
            remarks.append(f"{where}: {text[:40]} is not taken, for <limits enable=...> switches it off")
        elif value is None or not abs(value) <= FARTHEST:
            lacks.append(Lack(where, f"{text[:40]!r} is no finite number", "write a number, or remove it"))
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

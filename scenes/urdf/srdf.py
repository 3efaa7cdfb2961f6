"""What an SRDF adds to a URDF: which pairs of links need no check, and where chains end."""

from __future__ import annotations

from dataclasses import dataclass

from assur.scenes.urdf.refusals import Defect, ImportRefused
from assur.scenes.urdf.tree import Tree
from assur.scenes.urdf.xml_text import parse_xml

KNOWN = (
    *("disable_collisions", "enable_collisions", "disable_default_collisions", "group", "group_state"),
    *("end_effector", "virtual_joint", "passive_joint", "joint_property", "link_sphere_approximation"),
)
"""Elements of an SRDF. Those of the second line say nothing of pairs of links."""


@dataclass(frozen=True, slots=True)
class Semantics:
    """`off`: pairs of links that are disabled; `tips`: ends of the chains of its groups."""

    off: frozenset[frozenset[str]]
    tips: tuple[str, ...]


def read_srdf(content: bytes, name: str, tree: Tree) -> Semantics:
    """The SRDF in a file. Raises `ImportRefused` for links that the robot has not: it belongs to another robot."""
    root = parse_xml(content, name, "robot")
    lacks: list[Defect] = []

    def links(tag: str, *keys: str) -> list[frozenset[str]]:
        found = []
        for element in root.every(tag):
            found.append(frozenset(element.get(key) or "" for key in keys))
            lacks.extend(
                Defect(
                    f"line {element.line}, {tag}", f"link {link!r} is not in the URDF", "give the SRDF of this robot"
                )
                for link in sorted(found[-1])
                if link not in tree.links
            )
        return found

    off, on = (set(links(tag, "link1", "link2")) for tag in ("disable_collisions", "enable_collisions"))
    every = [link for only in links("disable_default_collisions", "link") for link in only]
    lacks += [
        Defect(
            f"line {element.line}", f"element <{element.tag[:40]}> is not of an SRDF", "correct its name, or remove it"
        )
        for element in root.children
        if element.tag not in KNOWN
    ]
    if lacks:
        raise ImportRefused(name, lacks)
    off |= {frozenset((link, other)) for link in every for other in tree.links if link != other}
    tips = [chain.get("tip_link") or "" for group in root.every("group") for chain in group.every("chain")]
    return Semantics(frozenset(off - on), tuple(tip for tip in tips if tip in tree.links))

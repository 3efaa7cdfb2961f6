"""What an SRDF says beside a URDF: which pairs of links need not be looked at, and where chains end."""

from __future__ import annotations

from dataclasses import dataclass

from assur.scenes.urdf.refusals import ImportRefused, Lack
from assur.scenes.urdf.tree import Tree
from assur.scenes.urdf.xml_text import parse_xml


@dataclass(frozen=True, slots=True)
class Semantics:
    """`off`: pairs of links that are disabled; `tips`: ends of the chains of its groups."""

    off: frozenset[frozenset[str]]
    tips: tuple[str, ...]


def read_srdf(content: bytes, name: str, tree: Tree) -> Semantics:
    """The SRDF in a file. Raises `ImportRefused` for links that the robot has not: it belongs to another robot."""
    root = parse_xml(content, name, "robot")
    off, lacks = set(), []
    for element in root.every("disable_collisions"):
        pair = frozenset(element.get(key) or "" for key in ("link1", "link2"))
        lacks += [
            Lack("disable_collisions", f"link {link!r} is not in the URDF", "give the SRDF of this robot")
            for link in sorted(pair)
            if link not in tree.links
        ]
        off.add(pair)
    if lacks:
        raise ImportRefused(name, lacks)
    every = [element.get("link") for element in root.every("disable_default_collisions")]
    on = {
        frozenset(element.get(key) or "" for key in ("link1", "link2")) for element in root.every("enable_collisions")
    }
    off |= {frozenset((link, other)) for link in every if link in tree.links for other in tree.links if link != other}
    tips = [chain.get("tip_link") or "" for group in root.every("group") for chain in group.every("chain")]
    return Semantics(frozenset(off - on), tuple(tip for tip in tips if tip in tree.links))

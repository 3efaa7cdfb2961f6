"""XML of descriptions, read safely: no document type, no entities, bounded size and depth.

A document becomes a tree of `Node`. A node remembers what a reader took of it, so what no reader knows can be reported.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any
from xml.etree.ElementTree import ParseError

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import DefusedXMLParser

from assur.scenes.urdf.refusals import Defect, ImportRefused, Unsuitable

MAX_XML_BYTES = 8 * 2**20
"""A description; those of arms have some kilobytes."""
MAX_DEPTH = 64
"""Nesting of its elements; a URDF has five levels."""
MAX_ELEMENTS = 100_000
"""Elements of it."""
FARTHEST = 1e6
"""Largest number that is read, SI; above it a unit was mistaken."""

NUMBER = re.compile(r"\s*[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?\s*", re.ASCII)
"""A number as the readers of ROS take it. Python's own reading takes 6_0 for 60, and digits of every script."""


class Node:
    """An element: its tag ({namespace}name if it has a namespace), attributes, children, text, and the line where
    it begins. `settled`: what is wrong with it is reported already."""

    __slots__ = ("_taken", "attributes", "children", "line", "settled", "tag", "text")

    def __init__(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self.tag, self.attributes, self.line = tag, attributes, line
        self.children: list[Node] = []
        self.text = ""
        self.settled = False
        self._taken: set[str] = set()

    def get(self, key: str) -> str | None:
        """The value of an attribute, which is taken with it; None where there is none."""
        self._taken.add("@" + key)
        return self.attributes.get(key)

    def every(self, tag: str) -> list[Node]:
        """The children with a tag, which are taken with it."""
        self._taken.add(tag)
        return [child for child in self.children if child.tag == tag]

    def one(self, tag: str, where: str) -> Node | None:
        """The child with a tag, which is taken with it; None where there is none. Raises `Unsuitable`, which names the
        parent by `where`, if there are several: nothing says which one counts."""
        found = self.every(tag)
        if len(found) > 1:
            raise Unsuitable(f"{where}, {tag}", "more than one of them", "leave the one that counts")
        return found[0] if found else None

    def took(self, child: Node) -> bool:
        """Whether a child was taken."""
        return child.tag in self._taken

    def not_taken(self) -> list[str]:
        """Names of the attributes that were not taken."""
        return [key for key in self.attributes if "@" + key not in self._taken]

    def everything(self) -> Iterator[Node]:
        """The node and all below it."""
        ahead = [self]
        while ahead:
            node = ahead.pop()
            yield node
            ahead += reversed(node.children)


class _Builder:
    """What the parser calls: it makes nodes. `parser` is set before the document is fed."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.parser: Any = None
        self.root: Node | None = None
        self._open: list[Node] = []
        self._count = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        node = Node(tag, dict(attributes), self.parser.CurrentLineNumber)
        self._count += 1
        if self._count > MAX_ELEMENTS or len(self._open) >= MAX_DEPTH:
            most = f"up to {MAX_ELEMENTS} elements, nested up to {MAX_DEPTH} deep, are read"
            raise _refused(self.name, "the file", "too many elements", most)
        if self._open:
            self._open[-1].children.append(node)
        else:
            self.root = node
        self._open.append(node)

    def data(self, text: str) -> None:
        if self._open:
            self._open[-1].text += text

    def end(self, _tag: str) -> None:
        self._open.pop()


def parse_xml(content: bytes, name: str, root: str) -> Node:
    """The root element of an XML document, which must be called `root`. Raises `ImportRefused`, which calls the
    document `name`."""
    if len(content) > MAX_XML_BYTES:
        raise _refused(name, "the file", f"{len(content)} bytes", f"a file of up to {MAX_XML_BYTES} bytes is needed")
    builder = _Builder(name)
    reader = DefusedXMLParser(target=builder, forbid_dtd=True, forbid_entities=True, forbid_external=True)
    builder.parser = reader.parser
    try:
        reader.feed(content)
        reader.close()
    except ImportRefused:
        raise
    except DefusedXmlException:
        what = "a document type or an entity, which may grow without bound or read other files"
        raise _refused(name, "the file", what, "remove <!DOCTYPE ...> and write its entities out") from None
    except (ParseError, ValueError, LookupError) as error:
        raise _refused(name, "the file", f"no XML ({error})", "well-formed XML is needed") from None
    found = builder.root
    if found is None:
        raise _refused(name, "the file", "no element", "well-formed XML is needed")
    if found.tag != root:
        raise _refused(name, f"<{found.tag}>", "another kind of document", f"the outermost element must be <{root}>")
    return found


def _refused(name: str, where: str, what: str, supply: str) -> ImportRefused:
    return ImportRefused(name, [Defect(where, what, supply)])


def number(text: str | None, where: str, silent: float | None = None) -> float:
    """A finite number from an attribute; `silent` where the attribute is not there. Raises `Unsuitable`."""
    if text is None and silent is not None:
        return silent
    value = float(text) if text is not None and NUMBER.fullmatch(text) else math.nan
    if not abs(value) <= FARTHEST:
        shown = "nothing" if text is None else repr(text[:40])
        raise Unsuitable(where, f"{shown} is no finite number in metres or radians", "write a number")
    return value


def numbers(text: str | None, count: int, where: str, silent: tuple[float, ...] | None = None) -> tuple[float, ...]:
    """So many finite numbers, with spaces between, from an attribute. Raises `Unsuitable`."""
    if text is None and silent is not None:
        return silent
    parts = re.findall(r"[^ \t\r\n]+", text or "")
    if len(parts) != count:
        raise Unsuitable(where, f"{(text or 'nothing')[:40]!r}", f"write {count} numbers with spaces between")
    return tuple(number(part, where) for part in parts)

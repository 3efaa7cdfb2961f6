"""XML of descriptions, read safely: no document type, no entities, bounded size and depth. The door to defusedxml."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING
from xml.etree.ElementTree import ParseError

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from assur.scenes.urdf.refusals import ImportRefused, Lack, Unsuitable

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

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


def parse_xml(content: bytes, name: str, root: str) -> Element:
    """The root element of an XML document, which must be called `root`. Raises `ImportRefused`, which calls the
    document `name`."""
    if len(content) > MAX_XML_BYTES:
        raise _refused(name, "the file", f"{len(content)} bytes", f"a file of up to {MAX_XML_BYTES} bytes is needed")
    try:
        found: Element = fromstring(content, forbid_dtd=True, forbid_entities=True, forbid_external=True)
    except DefusedXmlException:
        what = "a document type or an entity, which may grow without bound or read other files"
        raise _refused(name, "the file", what, "remove <!DOCTYPE ...> and write its entities out") from None
    except (ParseError, ValueError, LookupError) as error:
        raise _refused(name, "the file", f"no XML ({error})", "well-formed XML is needed") from None
    level, count, depth = [found], 0, 0
    while level:
        count, depth = count + len(level), depth + 1
        if count > MAX_ELEMENTS or depth > MAX_DEPTH:
            most = f"up to {MAX_ELEMENTS} elements, nested up to {MAX_DEPTH} deep, are read"
            raise _refused(name, "the file", "too many elements", most)
        level = [child for element in level for child in element]
    if found.tag != root:
        raise _refused(name, f"<{found.tag}>", "another kind of document", f"the outermost element must be <{root}>")
    return found


def _refused(name: str, where: str, what: str, supply: str) -> ImportRefused:
    return ImportRefused(name, [Lack(where, what, supply)])


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

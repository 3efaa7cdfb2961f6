"""YAML 1.2 as scenario files need it: plain data with line numbers.

Built from the event stream of PyYAML's libyaml parser without recursion and without any of its constructors, so what a
scalar means is decided here by the core schema of YAML 1.2 (`on` is text, `1e3` is a number, `1:30` is text, `010` is
ten). Refused: anchors, aliases, merge keys, tags, keys that are not text or look like a boolean, keys given twice,
numbers that are not finite, more than one document, deep nesting, long files. Why so: docs/decisions/0003-documents.md.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, NoReturn

import yaml

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_DEPTH, MAX_YAML_BYTES
from assur.scenes.faults import WHOLE, DocumentError, Path, documented, dotted
from assur.scenes.text.json_text import not_utf8
from assur.scenes.text.scalars import Refused, real, whole

NULL = re.compile(r"(?:|~|null|Null|NULL)\Z")
TRUE = re.compile(r"(?:true|True|TRUE)\Z")
FALSE = re.compile(r"(?:false|False|FALSE)\Z")
INTEGER = re.compile(r"[-+]?[0-9]+\Z")
FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?\Z")
NOT_FINITE = re.compile(r"(?:[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))\Z")
BOOLEAN_KEY = re.compile(r"(?:on|off|yes|no|y|n|true|false)\Z", re.IGNORECASE)
"""Plain keys that some YAML reader takes for a boolean; the file would mean something else there."""

Lines = dict[str, int]
"""Dotted path of every value → the line where it begins (its key's line, in a mapping)."""

Spans = dict[str, tuple[int, int]]
"""Dotted path of every value → where it begins (its key, in a mapping) and ends, in characters of the text."""

LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""libyaml where PyYAML has it; the events are the same."""


def with_line(error: InputError, lines: Lines, prefix: str = "") -> DocumentError:
    """The error with the line of its field, or of the innermost mapping around it that the file has. `prefix`: where in
    the file the document is that the error speaks of; the field gets it."""
    known = documented(error)
    if known.line is not None:
        return known
    return known.relocated(
        lambda field: field if field == WHOLE else prefix + field, lambda field: line_of(field, lines)
    )


def line_of(field: str, lines: Lines) -> int:
    """The line of a field, or of the innermost mapping or list around it that the file has."""
    line = None
    while line is None and field:
        line = lines.get(field)
        field = field[: max(field.rfind("."), field.rfind("["), 0)]
    return line or 1


class _Open:
    """A mapping or list that is being read."""

    def __init__(self, path: Path, value: dict[str, Any] | list[Any]) -> None:
        self.path, self.value = path, value
        self.key: str | None = None
        self.last = 0
        """Where its last value ends, in characters."""


def parse_yaml(data: bytes, *, limit_bytes: int = MAX_YAML_BYTES) -> tuple[Any, Lines]:
    """The document and the line of each of its values. Raises `DocumentError` with field and line."""
    reader = _Reader()
    for event in _events(data, limit_bytes):
        reader.take(event)
    return reader.root, reader.lines


def spans_in(data: bytes) -> Spans:
    """Where each value of a document is written. Raises `DocumentError` with field and line."""
    reader = _Reader()
    for event in _events(data, MAX_YAML_BYTES):
        reader.take(event)
    return {path: (begin, reader.ends[path]) for path, begin in reader.begins.items()}


def parse_documents(data: bytes, *, limit_bytes: int = MAX_YAML_BYTES) -> list[tuple[Any, Lines]]:
    """All documents of a file that are not empty, each with the lines of its values: `ros2 topic echo` ends each
    message with the line that begins another document. Raises `DocumentError` with field and line."""
    readers: list[_Reader] = []
    for event in _events(data, limit_bytes):
        if isinstance(event, yaml.DocumentStartEvent):
            readers.append(_Reader())
        if readers:
            readers[-1].take(event)
    return [(reader.root, reader.lines) for reader in readers if reader.root is not None]


def _events(data: bytes, limit_bytes: int) -> Iterator[Any]:
    """What libyaml reads of a text. Raises `DocumentError`."""
    if len(data) > limit_bytes:
        raise DocumentError("scenario", f"{len(data)} bytes", f"up to {limit_bytes} bytes")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        found, allowed = not_utf8(error)
        raise DocumentError("scenario", found, f"YAML: {allowed}", line=line) from None
    try:
        yield from yaml.parse(text, Loader=LOADER)
    except yaml.YAMLError as error:
        raise _unreadable(error, text) from None


SENTENCES = {
    "found character that cannot start any token": (
        "a character in line {line} that no value begins with",
        "text that begins with one of @ ` % in quotes",
    ),
    "mapping values are not allowed in this context": (
        "a colon in line {line} where none can be: the line is indented further than the one above it, or has two",
        "keys of one mapping that begin in the same column, one in a line; text with a colon in quotes",
    ),
    "did not find expected key": (
        "line {line} begins in another column than the keys that it follows",
        "keys of one mapping that begin in the same column (the mapping begins in line {first})",
    ),
    "did not find expected '-' indicator": (
        "line {line} begins in another column than the list that it follows, or is no item of it",
        "items of one list that begin with - in the same column (the list begins in line {first})",
    ),
    "did not find expected <document start>": (
        "line {line} begins in another column than the lines above it",
        "keys of one mapping that begin in the same column",
    ),
    "did not find expected ',' or ']'": (
        "line {line} before the list in brackets is closed",
        "a comma between items and ] at the end (the list begins in line {first})",
    ),
    "did not find expected ',' or '}'": (
        "line {line} before the mapping in braces is closed",
        "a comma between fields and }} at the end (the mapping begins in line {first})",
    ),
    # libyaml has a bound of its own since 0.2.6, and reads ahead: it may speak before the reader counts its levels
    "exceeded maximum nesting depth": ("deeper nesting", f"nesting up to {MAX_DEPTH} levels"),
}
"""What libyaml says, in words that say what to mend: what was found, and what would be right."""


def _unreadable(error: yaml.YAMLError, text: str) -> DocumentError:
    """The error for text that is no YAML, with its line. A tab is named first: it is invisible, and often the cause."""
    mark, context = getattr(error, "problem_mark", None), getattr(error, "context_mark", None)
    problem = getattr(error, "problem", None) or "characters that YAML does not allow"
    if mark is None:
        return DocumentError("scenario", problem, "YAML")
    line = mark.line + 1
    rows = text.splitlines()
    row = rows[mark.line] if mark.line < len(rows) else ""
    if "\t" in row[: len(row) - len(row.lstrip())]:
        return DocumentError("scenario", f"line {line} begins with a tab", "YAML: indent with spaces", line=line)
    if problem not in SENTENCES:
        return DocumentError("scenario", problem, "YAML", line=line)
    first = line if context is None else context.line + 1
    shown, allowed = (part.format(line=line, first=first) for part in SENTENCES[problem])
    return DocumentError("scenario", shown, allowed, line=line)


class _Reader:
    """Takes the events of one document."""

    def __init__(self) -> None:
        self.root: Any = None
        self.lines: Lines = {}
        self.begins: dict[str, int] = {}
        self.ends: dict[str, int] = {}
        self.stack: list[_Open] = []
        self.documents = 0

    def take(self, event: Any) -> None:
        line, index, end = event.start_mark.line + 1, event.start_mark.index, event.end_mark.index
        if isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                self._refuse("a second document", "one document a file", line)
            return
        if isinstance(event, yaml.AliasEvent):
            self._refuse(f"*{event.anchor}", "data written out: no anchors, no aliases", line)
        if getattr(event, "anchor", None) is not None:
            self._refuse(f"&{event.anchor}", "data written out: no anchors, no aliases", line)
        if getattr(event, "tag", None) is not None:
            self._refuse(event.tag, "plain data: no tags", line)
        if isinstance(event, yaml.ScalarEvent):
            self._scalar(event, line)
        elif isinstance(event, yaml.MappingStartEvent | yaml.SequenceStartEvent):
            self._begin({} if isinstance(event, yaml.MappingStartEvent) else [], line, index)
        elif isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
            top = self.stack.pop()
            # what is in no brackets ends with its last value: its own end is behind the lines that follow
            self._ends(top.path, end if end > index else top.last)

    def _ends(self, path: Path, end: int) -> None:
        self.ends[dotted(path)] = end
        if self.stack:
            self.stack[-1].last = end

    def _scalar(self, event: Any, line: int) -> None:
        top = self.stack[-1] if self.stack else None
        if top is not None and isinstance(top.value, dict) and top.key is None:
            top.key = self._key(event, top, line)
            self.lines[dotted((*top.path, top.key))] = line
            self.begins[dotted((*top.path, top.key))] = event.start_mark.index
        else:
            path = self._path()
            self._put(_core(event.value) if event.implicit[0] else event.value, line, event.start_mark.index)
            self._ends(path, event.end_mark.index)

    def _key(self, event: Any, top: _Open, line: int) -> str:
        key: str = event.value
        if event.implicit[0]:
            if key == "<<":
                self._refuse("<<", "data written out: no merge keys", line)
            if BOOLEAN_KEY.match(key):
                allowed = f'another key, or "{key}" in quotes: some readers of YAML take {key} for a boolean'
                self._refuse(key, allowed, line)
            if not isinstance(_core(key), str):
                self._refuse(key, f'keys that are text: "{key}" in quotes if that is meant', line)
        if key in top.value:
            self._refuse(key, "each key once", line, (*top.path, key))
        return key

    def _begin(self, value: dict[str, Any] | list[Any], line: int, index: int) -> None:
        if self.stack and isinstance(self.stack[-1].value, dict) and self.stack[-1].key is None:
            self._refuse("a list or a mapping as a key", "keys that are text", line)
        path = self._path()
        if len(path) >= MAX_DEPTH:
            self._refuse("deeper nesting", f"nesting up to {MAX_DEPTH} levels", line, path[:4])
        self._put(value, line, index)
        self.stack.append(_Open(path, value))

    def _put(self, value: Any, line: int, index: int) -> None:
        path = self._path()
        if isinstance(value, Refused):
            self._refuse(value.shown, value.allowed, line, path)
        self.lines.setdefault(dotted(path), line)
        self.begins.setdefault(dotted(path), index)
        if not self.stack:
            self.root = value
            return
        top = self.stack[-1]
        if isinstance(top.value, list):
            top.value.append(value)
        else:
            top.value[str(top.key)] = value
            top.key = None

    def _path(self) -> Path:
        if not self.stack:
            return ()
        top = self.stack[-1]
        return (*top.path, len(top.value) if isinstance(top.value, list) else str(top.key))

    def _refuse(self, shown: object, allowed: str, line: int, path: Path | None = None) -> NoReturn:
        if path is None:
            path = self.stack[-1].path if self.stack else ()
        raise DocumentError(dotted(path) if path else "scenario", shown, allowed, line=line)


def _core(text: str) -> Any:
    """What a plain scalar means by the core schema of YAML 1.2 (less octal and hexadecimal, which nobody needs)."""
    if NULL.match(text):
        return None
    if TRUE.match(text):
        return True
    if FALSE.match(text):
        return False
    if INTEGER.match(text):
        return whole(text)
    if FLOAT.match(text):
        return real(text)
    return Refused(text, "a finite number") if NOT_FINITE.match(text) else text

"""A text in YAML or JSON in which values are changed, and nothing else: comments, order and layout stay."""

from __future__ import annotations

import json
import re
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.faults import WHOLE
from assur.scenes.proposals.values import si_number, written_number
from assur.scenes.text.yaml_text import BOOLEAN_KEY, parse_yaml, spans_in
from assur.scenes.units import si_key, twin_of

KEY = re.compile(r"""(?:"(?:[^"\\]|\\.)*"|'[^']*'|[^\s:"'][^:\n]*?)\s*:\s*""")
"""A key at the begin of what is written, and the colon."""
NEXT = re.compile(r"\[(\d+)\]|\.?((?:[^.\[\]])+)")
WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*\Z")
NULLS = ("null", "true", "false")


class Text:
    """A document as it is written, which is valid."""

    def __init__(self, content: str) -> None:
        self.content = content
        self.document, _ = parse_yaml(content.encode())
        self.spans = spans_in(content.encode())
        self.quoted = content.lstrip().startswith(("{", "["))
        """Whether it is JSON, whose keys are in quotes."""

    def known(self, field: str) -> tuple[str, str]:
        """The longest part of a field that the text has, and what is left; a key in the other unit is the same key."""
        found = max((path for path in self.spans if _begins(field, path)), key=len, default="")
        rest = field[len(found) :]
        key = NEXT.match(rest)
        twin = "" if key is None or key[2] is None else other_unit(key[2])
        if twin and f"{found}.{twin}" in self.spans:
            return self.known(f"{found}.{twin}{rest[key.end() :]}" if key is not None else "")
        return found, rest

    def with_value(self, field: str, value: object) -> Text:
        """The same with a value. Raises `InputError` where the text has no place for it."""
        found, rest = self.known(field)
        if not rest:
            return self._changed(found, in_unit(value, _key(field), _key(found)))
        keys = [match[2] for match in NEXT.finditer(rest)]
        if None in keys:
            raise InputError(field, value, "a field whose list is written out in the text")
        for key in reversed(keys[1:]):
            value = {key: value}
        return Text(self._with_key(found, keys[0], value))

    def _changed(self, field: str, value: Any) -> Text:
        """The same with another value at a field that the text has. Of a mapping its keys are changed. To a list its
        new entries are added, if that is all; of a list that stays as long, each plain value is changed where it is."""
        before = value_at(self.document, field)
        if isinstance(before, dict) and isinstance(value, dict) and before and value:
            text = self
            for key in [key for key in before if key not in value]:
                text = text._without(f"{field}.{key}")
            for key, each in value.items():
                text = text if key in before and before[key] == each else text.with_value(f"{field}.{key}", each)
            return text
        if isinstance(before, list) and isinstance(value, list) and before and value[: len(before)] == before:
            text = self
            for number in range(len(before), len(value)):
                text = text._with_entry(field, number, value[number])
            return text
        if _is_plain(before) and _is_plain(value) and len(before) == len(value):
            text = self
            for number, each in enumerate(value):
                text = text if before[number] == each else Text(text._replaced(f"{field}[{number}]", each))
            return text
        return Text(self._replaced(field, value))

    def _without(self, field: str) -> Text:
        """The same without a key, which is not the only one."""
        begin, end = self.spans[field]
        line, behind = self.content.rfind("\n", 0, begin) + 1, self.content[end:]
        if comma := re.match(r"\s*,\s*", behind):
            return Text(self.content[:begin] + behind[comma.end() :])
        if comma := re.search(r"\s*,\s*\Z", self.content[:begin]):
            return Text(self.content[: comma.start()] + behind)
        if self.content[line:begin].strip():  # the first of an entry of a list
            return Text(self.content[:begin] + behind.lstrip("\n").lstrip(" "))
        return Text(self.content[:line] + behind.partition("\n")[2])

    def _with_entry(self, field: str, number: int, value: object) -> Text:
        """The same with one entry more in a list that has some."""
        begin, end = self.spans[f"{field}[{number - 1}]"]
        line = self.content.rfind("\n", 0, begin) + 1
        mark = self.content[line:begin]
        if mark.strip() != "-":
            return Text(self._inserted(end, f", {self._flow(value)}"))
        at = self.content.find("\n", end - 1)
        return Text(self._inserted(len(self.content) if at < 0 else at, f"\n{mark}{self._flow(value)}"))

    def _replaced(self, field: str, value: object) -> str:
        begin, end = self.spans[field]
        end = max(begin, len(self.content[:end].rstrip()))  # a text in lines of its own ends behind its last line
        key = None if field.endswith("]") else KEY.match(self.content[begin:end])
        at = begin + (0 if key is None else key.end())
        null = at == end and self.content[at - 1 : at] in ("-", ":")  # that is left empty
        space = " " if null else ""
        return self.content[:at] + space + self._flow(value) + self.content[end:]

    def _with_key(self, field: str, key: str, value: object) -> str:
        """The text with a key that the mapping at `field` has not."""
        inside = [span for path, span in self.spans.items() if path not in (WHOLE, field) and _begins(path, field)]
        written = f"{self._key(key)}: {self._flow(value)}"
        if not inside:
            end = self.spans[field or WHOLE][1]
            if not self.content[:end].endswith("}"):
                raise InputError(field, value, "a field of a mapping")
            return self._inserted(end - 1, written)
        first, last = min(inside)[0], max(behind for _, behind in inside)
        if self.content[:first].rstrip().endswith("{"):
            return self._inserted(last, f", {written}")
        line = self.content.rfind("\n", 0, first) + 1
        at = self.content.find("\n", last - 1)
        return self._inserted(len(self.content) if at < 0 else at, f"\n{' ' * (first - line)}{written}")

    def _inserted(self, at: int, written: str) -> str:
        return self.content[:at] + written + self.content[at:]

    def _flow(self, value: object) -> str:
        """A value in one line."""
        if isinstance(value, dict):
            pairs = (f"{self._key(key)}: {self._flow(each)}" for key, each in value.items())
            return f"{{{', '.join(pairs)}}}"
        if isinstance(value, list):
            return f"[{', '.join(map(self._flow, value))}]"
        return self._key(value) if isinstance(value, str) else json.dumps(value)

    def _key(self, word: str) -> str:
        """A word, in quotes where it could be read as something else."""
        plain = WORD.match(word) and word not in NULLS and not BOOLEAN_KEY.match(word)
        return word if plain and not self.quoted else json.dumps(word)


def other_unit(key: str) -> str:
    """The key of the same quantity in the other unit; empty: it has none."""
    return twin_of(key) or (si_key(key) or ("",))[0]


def _is_plain(value: object) -> bool:
    """Whether a value is a list without lists and mappings in it."""
    return isinstance(value, list) and not any(isinstance(each, list | dict) for each in value)


def _begins(field: str, path: str) -> bool:
    """Whether a field is at a path or inside of it."""
    return field == path or not path or (field.startswith(path) and field[len(path)] in ".[")


def _key(field: str) -> str:
    """The key with a unit that counts for the values at a field."""
    return next((key for key in reversed(re.sub(r"\[\d+\]", "", field).split(".")) if other_unit(key)), "")


def in_unit(value: Any, given: str, key: str) -> Any:
    """A value under one key, under the key in the other unit."""
    if given == key:
        return value
    if isinstance(value, list):
        return [in_unit(each, given, key) for each in value]
    if isinstance(value, dict):
        return {name: in_unit(each, given, key) for name, each in value.items()}
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return written_number(si_number(value, given), key) if is_number else value


def value_at(document: Any, field: str) -> Any:
    """The value of a field of a document; keys may have dots in them."""
    if not field:
        return document
    if field.startswith("["):
        number, _, rest = field[1:].partition("]")
        return value_at(document[int(number)], rest.removeprefix("."))
    key = max((key for key in document if re.match(rf"{re.escape(key)}(?=[.\[]|$)", field)), key=len)
    return value_at(document[key], field[len(key) :].removeprefix("."))


def is_written(document: Any, field: str) -> bool:
    """Whether a document has a value at a field."""
    try:
        value_at(document, field)
    except (KeyError, IndexError, TypeError, ValueError):
        return False
    return True

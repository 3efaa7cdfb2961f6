"""JSON as our documents need it: text that two readers may understand differently is refused.

Refused are NaN, Infinity and numbers that overflow (1e999), lone surrogates, keys that are given twice, whole numbers
beyond 2**53, text that is not UTF-8, and nesting deeper than any document of ours. The message names the field, if
there is one.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from typing import Any, NoReturn

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_DEPTH, MAX_INTEGER, MAX_JSON_BYTES
from assur.scenes.faults import DocumentError, Path, dotted
from assur.scenes.text.scalars import LONGEST_NUMBER, Refused, real, whole

OF_NUMBERS = bytes(ord("0") if character in b"0123456789.eE+-" else ord(" ") for character in range(256))
"""Turns each character that a number may have into a zero, and any other into a space."""
BYTES_A_VALUE, BYTES_A_CONTAINER = 8, 48
"""A text has at most one value for so many bytes of its limit, and one object or list. Plans have some 11 and 70. A
value takes up to 80 bytes of memory, an object 240: this bounds what a text of a given limit takes."""
LONG_NUMBER = b"0" * (LONGEST_NUMBER + 1)
"""Is then in every text with a longer number."""
SURROGATES = (b"\\ud", b"\\uD")
"""One of these is in every text that escapes half of a surrogate pair."""


def parse_json(data: bytes, *, limit_bytes: int = MAX_JSON_BYTES) -> Any:
    """The value that `data` spells, of plain dicts, lists, strings, floats, ints, bools and None.

    Raises `DocumentError` with the field's path, or with the field "request" where the text as such is at fault.
    """
    if len(data) > limit_bytes:
        raise InputError("request", f"{len(data)} bytes", f"up to {limit_bytes} bytes")
    _check_counts(data, limit_bytes)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        found, allowed = not_utf8(error)
        raise InputError("request", found, f"JSON: {allowed}") from None
    try:
        # Functions of Python for each number and path take three times as long as all the rest: a document is read with
        # them only if it may hold something that is refused, to say what and where.
        if LONG_NUMBER not in data.translate(OF_NUMBERS) and not any(half in data for half in SURROGATES):
            document = json.loads(text, parse_constant=_constant, object_pairs_hook=_mapping)
            if type(document) is dict and _sound(document, 1):
                return document
        document = json.loads(
            text, parse_constant=_constant, parse_float=real, parse_int=whole, object_pairs_hook=_mapping
        )
    except json.JSONDecodeError as error:
        found, allowed = not_json(error)
        raise InputError("request", found, f"JSON: {allowed}") from None
    except RecursionError:
        raise InputError("request", "deeper nesting", f"nesting up to {MAX_DEPTH} levels") from None
    _inspect(document)
    return document


def _check_counts(data: bytes, limit_bytes: int) -> None:
    """Raises `InputError` for a text of more values, or objects and lists, than any document has. What stands in texts
    counts, too: no document has so many commas and brackets there."""
    containers = data.count(b"{") + data.count(b"[")
    for found, what, most in (
        (containers, "objects and lists", limit_bytes // BYTES_A_CONTAINER),
        (containers + data.count(b","), "values", limit_bytes // BYTES_A_VALUE),
    ):
        if found > most:
            raise InputError("request", f"{found} {what}", f"up to {most} {what}")


def _constant(name: str) -> Refused:
    return Refused(name, "a finite number")


def _mapping(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) < len(pairs):
        seen: set[str] = set()
        for key, _ in pairs:
            if key in seen:
                mapping[key] = Refused(key, "each key once")
            seen.add(key)
    return mapping


def _sound(value: dict[str, Any] | list[Any], depth: int) -> bool:
    """Whether nothing in a mapping or list, which has no longer number and no surrogate, is refused."""
    if depth > MAX_DEPTH:
        return False
    items: Iterable[Any] = value.values() if isinstance(value, dict) else value
    for item in items:
        kind = type(item)
        if kind is float:
            if not -math.inf < item < math.inf:
                return False
        elif kind is dict or kind is list:
            if not _sound(item, depth + 1):
                return False
        elif kind is int:
            if not -MAX_INTEGER <= item <= MAX_INTEGER:
                return False
        elif kind is Refused:
            return False
    return True


def _inspect(document: Any) -> None:
    """Reads the document without recursion; the first value that is refused is raised with its path."""
    waiting: list[tuple[Path, Any]] = [((), document)]
    while waiting:
        path, value = waiting.pop()
        kind = type(value)
        if kind is float or kind is int or value is None or kind is bool:
            continue
        if kind is str:
            _text(path, value)
        elif len(path) >= MAX_DEPTH:
            _refuse(path[:4], "deeper nesting", f"nesting up to {MAX_DEPTH} levels")
        elif kind is dict:
            for key, item in value.items():
                _text(path, key)
                waiting.append(((*path, key), item))
        elif kind is list:
            waiting.extend(((*path, i), item) for i, item in enumerate(value) if type(item) is not float)
        else:
            _refuse(path, value.shown, value.allowed)


def _text(path: Path, text: str) -> None:
    if not text.isascii():
        try:
            text.encode("utf-8")
        except UnicodeEncodeError:
            _refuse(path, ascii(text)[:40], "text without lone surrogates")


def _refuse(path: Path, shown: object, allowed: str) -> NoReturn:
    raise DocumentError(dotted(tuple(p if isinstance(p, int) else ascii(p)[1:-1] for p in path)), shown, allowed)


# What is wrong with text that is no JSON, in words that say what to mend: what was found, and what would be right.

CUT = re.compile(r"(?:|\.|[eE][-+]?|-)\Z")
"""What is left, from the place of the fault on, of a text that ends too early: nothing, or a part of a value."""
CUT_ESCAPE = re.compile(r"\\(?:u[0-9a-fA-F]{0,4})?\s*\Z")
"""The end of a text that ends within an escape."""
WORDS = ("true", "false", "null", "NaN", "Infinity", "-Infinity")
SENTENCES = {
    "Expecting property name enclosed in double quotes": ("no key", "a key in double quotes there"),
    "Illegal trailing comma before end of object": ("a comma behind the last field", "no comma there"),
    "Illegal trailing comma before end of array": ("a comma behind the last item", "no comma there"),
    "Expecting ':' delimiter": ("no colon behind a key", "a colon there"),
    "Expecting ',' delimiter": ("no comma between two values", "a comma, or a closing bracket, there"),
    "Expecting value": (
        "no value",
        "a value there: an object, a list, text in quotes, a number, true, false or null",
    ),
    "Invalid \\escape": ("a backslash that escapes nothing", 'one of \\" \\\\ \\/ \\b \\f \\n \\r \\t \\u there'),
    "Invalid \\uXXXX escape": ("\\u without four hexadecimal digits", "four hexadecimal digits there"),
    "Invalid control character at": ("a line break or another control character in a text", "an escape, as \\n, there"),
    "Extra data": ("more text behind the end of the value", "one value"),
}
"""What Python's reader says, up to its details, in our words."""


def not_utf8(error: UnicodeDecodeError) -> tuple[str, str]:
    """What was found, and what is allowed, where bytes are no text."""
    if error.reason == "unexpected end of data":
        return f"a text that ends within a character, at byte {error.start}", "the whole text, in UTF-8"
    return f"no text: byte {error.start} is not UTF-8", "text in UTF-8"


def not_json(error: json.JSONDecodeError) -> tuple[str, str]:
    """What was found, and what is allowed, where text is no JSON."""
    if error.doc.startswith("\ufeff"):
        return "a byte order mark", "UTF-8 without one"
    if not error.doc.strip():
        return "an empty text", "one value"
    at = f"at line {error.lineno}, column {error.colno}"
    rest = error.doc[error.pos :].strip()
    escape = error.msg.startswith("Invalid \\") and CUT_ESCAPE.search(error.doc) is not None
    within = error.msg.startswith("Unterminated string") or any(word.startswith(rest) for word in WORDS)
    if escape or within or CUT.match(rest):
        return f"a text that ends before its value is complete, {at}", "the whole text"
    ours = (texts for message, texts in SENTENCES.items() if error.msg.startswith(message))
    found, allowed = next(ours, ("no JSON", "JSON"))
    return f"{found}, {at}", allowed

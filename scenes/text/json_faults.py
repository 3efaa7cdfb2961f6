"""What is wrong with text that is no JSON, in words that say what to mend: what was found, and what would be right."""

from __future__ import annotations

import json
import re

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
    found, allowed = next((told for said, told in SENTENCES.items() if error.msg.startswith(said)), ("no JSON", "JSON"))
    return f"{found}, {at}", allowed

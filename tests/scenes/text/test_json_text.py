"""JSON that two readers could take differently is refused, and the field is named."""

from __future__ import annotations

import contextlib
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_DEPTH
from assur.scenes.text.json_text import parse_json

LEAVES = st.none() | st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
VALUES = st.recursive(
    LEAVES | TEXTS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXTS, inner, max_size=4), max_leaves=20
)


@given(VALUES, st.booleans())
def test_what_python_writes_is_read_back(value: Any, ascii_only: bool) -> None:
    assert parse_json(json.dumps(value, ensure_ascii=ascii_only).encode()) == value


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ('{"a": [1, {"b": NaN}]}', "a[1].b"),
        ('{"a": [1, 2, Infinity]}', "a[2]"),
        ("-Infinity", "request"),
        ('{"a": 1e400}', "a"),
        ('{"a": {"b": 1, "c": 2, "b": 3}}', "a.b"),
        ('{"a": [{"x": 1, "x": 1}]}', "a[0].x"),
        ('{"a": [{"x": 1, "\\u0078": 1}]}', "a[0].x"),
        ('{"a": -1e400}', "a"),
        ('{"a": 123456789012345678}', "a"),
        ('{"a": 1.' + "0" * 80 + "}", "a"),
        ('{"a": "\\udfff"}', "a"),
        ('{"\\ud83d": 1}', "request"),
    ],
)
def test_the_field_is_named(text: str, field: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_json(text.encode())
    assert caught.value.field == field
    str(caught.value).encode()  # and the message itself can be sent


def test_a_surrogate_pair_is_one_character_and_taken() -> None:
    assert parse_json(b'{"a": "\\ud83d\\ude00"}') == {"a": "\U0001f600"}


@pytest.mark.parametrize("opening", ["[", '{"a":'])
def test_nesting_is_taken_up_to_the_named_depth_and_no_further(opening: str) -> None:
    closing = "]" if opening == "[" else "}"
    parse_json((opening * MAX_DEPTH + "1" + closing * MAX_DEPTH).encode())
    for depth in (MAX_DEPTH + 1, 2_000, 100_000):
        with pytest.raises(InputError, match="nesting up to"):
            parse_json((opening * depth + "1" + closing * depth).encode())


def test_a_long_text_is_refused_before_it_is_read() -> None:
    with pytest.raises(InputError, match="up to 10 bytes"):
        parse_json(b"[1, 2, 3, 4]", limit_bytes=10)


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (b"[" + b"[]," * 99 + b"[[]]]", "objects and lists"),
        (b"[" + b'{"":0},' * 99 + b'{"":[]}]', "objects and lists"),
        (b"[" + b"0," * 600 + b"0]", "values"),
    ],
)
def test_a_text_of_more_values_than_any_document_has_is_refused_before_it_is_read(text: bytes, what: str) -> None:
    with pytest.raises(InputError, match=f"up to [0-9]+ {what}"):
        parse_json(text, limit_bytes=4800)
    assert parse_json(text, limit_bytes=9600)


@given(st.binary(max_size=60))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    with contextlib.suppress(InputError):
        parse_json(data)


WHOLE = '{"ab": [1, -2.5e+3, true, false, null, "t\\u00e9\\n"], "c": {"d": []}}'


@pytest.mark.parametrize("end", range(1, len(WHOLE)))
@pytest.mark.parametrize("behind", ["", "\n"])
def test_a_text_that_is_cut_anywhere_is_said_to_be_cut(end: int, behind: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_json((WHOLE[:end] + behind).encode())
    assert str(caught.value.value).startswith("a text that ends before its value is complete, at line "), caught.value


@pytest.mark.parametrize(
    ("data", "found", "allowed"),
    [
        (b"", "an empty text", "JSON: one value"),
        (b"\xb9\x00", "no text: byte 0 is not UTF-8", "JSON: text in UTF-8"),
        (b'"\xc3', "a text that ends within a character, at byte 1", "JSON: the whole text, in UTF-8"),
        (b"\xef\xbb\xbf{}", "a byte order mark", "JSON: UTF-8 without one"),
        (b"{} x", "more text behind the end of the value, at line 1, column 4", "JSON: one value"),
        (b" \n\t ", "an empty text", "JSON: one value"),
        ("{}".encode("utf-16"), "no text: byte 0 is not UTF-8", "JSON: text in UTF-8"),
        (b'"\xc0\xaf"', "no text: byte 1 is not UTF-8", "JSON: text in UTF-8"),
        (b"0x10", "more text behind the end", "JSON: one value"),
        (b"007", "more text behind the end", "JSON: one value"),
        (b"<a/>", "no value, at line 1, column 1", "JSON: a value there: "),
        (b"a: 1", "no value, at line 1, column 1", "JSON: a value there: "),
        (b"{'a': 1}", "no key, at line 1, column 2", "JSON: a key in double quotes there"),
        (b'{"a": 1,}', "no key, at line 1, column 9", "JSON: a key in double quotes there"),
        (b'{"a": 1 /* */}', "no comma between two values, at line 1, column 9", "JSON: a comma, or"),
        (b"{a: 1}", "no key, at line 1, column 2", "JSON: a key in double quotes there"),
        (b'{"a" 1}', "no colon behind a key, at line 1, column 6", "JSON: a colon there"),
        (b"[1 2]", "no comma between two values, at line 1, column 4", "JSON: a comma, or"),
        (b"[1,\nx]", "no value, at line 2, column 1", "JSON: a value there: "),
        (b'["\\x"]', "a backslash that escapes nothing, at line 1, column 3", "JSON: one of "),
        (b'["\\u12"]', "\\u without four hexadecimal digits, at line 1, column ", "JSON: four"),
        (b'["a\nb"]', "a line break or another control character in a text, at line 1, column 4", "JSON: an escape"),
        (b"\x00\x00", "no value, at line 1, column 1", "JSON: a value there: "),
    ],
)
def test_text_that_is_no_json_is_told_in_words(data: bytes, found: str, allowed: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_json(data)
    assert str(caught.value.value).startswith(found)
    assert caught.value.allowed.startswith(allowed)


@pytest.mark.parametrize("digits", [100, 5000])
def test_a_number_that_is_too_long_is_repeated_in_part(digits: int) -> None:
    with pytest.raises(InputError) as caught:
        parse_json(f'{{"a": 1{"0" * digits}}}'.encode())
    assert str(caught.value) == (
        f"a: got '1{'0' * 19}... ({digits + 1} characters)'; allowed: a whole number up to 2**53"
    )

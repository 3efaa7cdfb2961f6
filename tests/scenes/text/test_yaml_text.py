"""Scenario files mean one thing: YAML 1.2's core schema, no references, no tags, lines in every refusal."""

from __future__ import annotations

import contextlib
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_DEPTH, MAX_YAML_BYTES
from assur.scenes.faults import DocumentError
from assur.scenes.text.yaml_text import parse_yaml


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("on", "on"),
        ("yes", "yes"),
        ("no", "no"),
        ("true", True),
        ("False", False),
        ("~", None),
        ("", None),
        ("1e3", 1000.0),
        ("1:30", "1:30"),
        ("010", 10),
        ("0x10", "0x10"),
        ("-.5", -0.5),
        ("+7", 7),
        ("7.", 7.0),
        ("1_000", "1_000"),
        ("2020-01-01", "2020-01-01"),
        ("'1'", "1"),
        ('"true"', "true"),
    ],
)
def test_plain_scalars_mean_what_yaml_1_2_says(text: str, meaning: object) -> None:
    document, _ = parse_yaml(f"key: {text}\n".encode())
    assert document == {"key": meaning}
    assert type(document["key"]) is type(meaning)


@pytest.mark.parametrize(
    ("text", "line", "field"),
    [
        ("a: 1\nb: &x 2", 2, "scenario"),
        ("a: 1\nb: *a", 2, "scenario"),
        ("a:\n  <<: {b: 1}", 2, "a"),
        ("a: 1\nc: 2\na: 3", 3, "a"),
        ("a:\n- b: 1\n  b: 2", 3, "a[0].b"),
        ("a: 1\non: 2", 2, "scenario"),
        ("a: 1\nNo: 2", 2, "scenario"),
        ("x:\n  y: 2", 2, "x"),
        ("a: {true: 1}", 1, "a"),
        ("a: 1\n2: 3", 2, "scenario"),
        ("a:\n- 1\n- .nan", 3, "a[1]"),
        ("a: -.inf", 1, "a"),
        ("a: 1e999", 1, "a"),
        ("a: 99999999999999999999", 1, "a"),
        ("a: !!python/name:os.system x", 1, "scenario"),
        ("a: !!int '3'", 1, "scenario"),
        ("a: 1\n---\nb: 2", 2, "scenario"),
        ("a: [1,\nb: 2", 3, "scenario"),
        ("? [1, 2]\n: 3", 1, "scenario"),
        ("%YAML 1.1\n---\non: yes", 3, "scenario"),
    ],
)
def test_what_surprises_is_refused_with_its_line(text: str, line: int, field: str) -> None:
    with pytest.raises(DocumentError) as caught:
        parse_yaml(text.encode())
    assert (caught.value.line, caught.value.field) == (line, field)
    assert str(caught.value).startswith(f"line {line}: ")


@pytest.mark.parametrize(
    ("text", "line"),
    [("a:\n\tb: 1\n", 2), ("a:\n  b: 1\n\tc: 2\n", 3), ("a:\n  b: 1\n  \tc: 2\n", 3), ("a: x\n\ty: 2\n", 2)],
)
def test_a_tab_is_named_as_what_it_is(text: str, line: int) -> None:
    with pytest.raises(DocumentError, match=f"line {line} begins with a tab") as caught:
        parse_yaml(text.encode())
    assert caught.value.line == line
    assert caught.value.allowed == "YAML: indent with spaces"


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a:\n  b: 1\n   c: 2\n", 3, "indented further"),
        ("a: b: c\n", 1, "a colon in line 1"),
        ("a:\n  b: 1\n c: 2\n", 3, "the mapping begins in line 1"),
        ("a:\n  - b: 1\n   c: 2\n", 3, "the list begins in line 2"),
        ("  a: 1\nb: 2\n", 2, "in the same column"),
        ("a: [1,\nb: 2", 3, "] at the end"),
        ("a: {b: 1\nc: 2\n", 2, "} at the end"),
        ("a: @x\n", 1, "in quotes"),
    ],
)
def test_what_is_indented_or_closed_wrongly_is_said_in_a_sentence(text: str, line: int, words: str) -> None:
    with pytest.raises(DocumentError) as caught:
        parse_yaml(text.encode())
    assert caught.value.line == line
    assert words in str(caught.value)
    assert "did not find" not in str(caught.value)


def test_a_boolean_key_is_refused_by_its_name_unless_it_is_quoted() -> None:
    with pytest.raises(DocumentError, match='another key, or "off" in quotes'):
        parse_yaml(b"off: 1")
    assert parse_yaml(b'"off": 1')[0] == {"off": 1}


def test_a_bomb_of_references_is_refused_at_its_first_one() -> None:
    bomb = "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]"
    with pytest.raises(DocumentError, match="no anchors, no aliases") as caught:
        parse_yaml(bomb.encode())
    assert caught.value.line == 1


def test_deep_and_long_files_are_refused_without_recursion() -> None:
    for depth in (MAX_DEPTH + 1, 3_000):
        with pytest.raises(DocumentError, match="nesting up to"):
            parse_yaml(b"[" * depth + b"]" * depth)
    parse_yaml(b"[" * MAX_DEPTH + b"]" * MAX_DEPTH)
    with pytest.raises(DocumentError, match="bytes"):
        parse_yaml(b"#" * (MAX_YAML_BYTES + 1))


def test_each_value_knows_its_line() -> None:
    _, lines = parse_yaml(b"a: 1\nb:\n  c:\n  - 7\n  - {d: 8}\n")
    assert lines == {"request": 1, "a": 1, "b": 2, "b.c": 3, "b.c[0]": 4, "b.c[1]": 5, "b.c[1].d": 5}


JSON_VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(-1e9, 1e9)
    | st.from_regex(r"[a-z ]{0,6}", fullmatch=True),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.from_regex(r"[a-z]{3,6}", fullmatch=True), inner, max_size=3)
    ),
    max_leaves=12,
)


@given(JSON_VALUES)
def test_json_is_yaml_and_means_the_same(value: Any) -> None:
    text = json.dumps({"a": value})
    try:
        assert parse_yaml(text.encode())[0] == {"a": value}
    except InputError:
        raise AssertionError(text) from None


@given(st.binary(max_size=60))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    with contextlib.suppress(InputError):
        parse_yaml(data)

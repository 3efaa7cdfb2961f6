"""A proof bundle is read as it was written, and nothing else is read."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.claim import columns as c
from assur.planner.claim import document as forms
from assur.planner.claim.document import document_of
from assur.planner.errors import InputError
from tests.planner.claim.reading import read
from tests.prover.bundles import Document, bundle

NAMES = ("demo", "five-bar")
Path = tuple[str | int, ...]


@cache
def _short(name: str) -> Document:
    document = bundle(name)
    document["rows"] = document["rows"][:2]
    for arm in document["arms"]:
        for key in ("time", "q", "qd", "qdd"):
            arm[key] = arm[key][:2]
    for body in document["bodies"]:
        body["pieces"] = body["pieces"][:1]
        for piece in body["pieces"]:
            piece |= {"vertices": piece["vertices"][:4], "triangles": [[0, 1, 2]] if piece["triangles"] else []}
    document["required"]["exceptions"] = [{"first": [], "second": [0, 1], "travel": 0.01, "near": 0.0}]
    document["phases"][0]["put_down"] = [{"body": 0, "supports": [1]}]
    shares = [1.0] * len(document["arms"][0]["q"][0])
    document["sums"] = [{"t0": 0.0, "t1": 1.0, "order": 1, "joints": shares, "low": -1.0, "high": 2.0}]
    return document


def short(name: str) -> Document:
    """A bundle with a few knots and rows, to be changed at will."""
    return copy.deepcopy(_short(name))


def parts(value: Any, path: Path = (), kind: Path = ()) -> Iterator[tuple[Path, Path, Any]]:
    """All values of a document, each with its path, and with the path without numbers of items."""
    yield path, kind, value
    for key, each in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from parts(each, (*path, key), kind if isinstance(key, int) else (*kind, key))


def replaced(document: Document, path: Path, value: Any) -> Document:
    """The document with another value there."""
    *above, last = path
    at: Any = document
    for key in above:
        at = at[key]
    at[last] = value
    return document


def wrong_for(value: Any) -> tuple[Any, ...]:
    """Values of other kinds."""
    if isinstance(value, dict):
        return [], {**value, "note": 1}, dict(list(value.items())[1:])
    if isinstance(value, list):
        return {}, None, "none"
    if isinstance(value, bool):
        return 1, "true", None
    if isinstance(value, int | float):
        return math.nan, math.inf, 10**400, True, "1", [1.0], None
    if isinstance(value, str):
        return 1, None, ["a"]
    return (5,)


@pytest.mark.parametrize("name", NAMES)
def test_what_is_written_is_read_as_it_was(name: str) -> None:
    document = short(name)
    claim, labels = read(document)
    assert document_of(claim, labels) == document
    again, _ = read(document_of(claim, labels))
    for field, one, other in zip(claim._fields, claim, again, strict=True):
        assert np.array_equal(one, other), field
        assert one.dtype == np.float64, field
        assert one.flags.c_contiguous, field
    sides = claim.rules[0, c.RULE_SIDE :].reshape(2, -1)
    assert (sides[0].all(), np.flatnonzero(sides[1]).tolist()) == (True, [0, 1])


@pytest.mark.parametrize("name", NAMES)
def test_a_value_of_another_kind_is_refused_wherever_it_is(name: str) -> None:
    tried = set()
    for path, kind, value in parts(_short(name)):
        # values of the same kind and depth are read by the same code
        sort = (kind, type(value), len(path))
        if not path or sort in tried:
            continue
        tried.add(sort)
        for wrong in wrong_for(value):
            document = replaced(short(name), path, wrong)
            try:
                read(document)
            except InputError:
                continue
            pytest.fail(f"{wrong} is read at {path}")
    assert len(tried) > 100


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("schema",), "assur-bundle/1"),
        (("arms",), []),
        (("arms", 0, "q", 1), [0.0]),
        (("arms", 0, "time"), [0.0]),
        (("arms", 0, "q"), [[0.0] * 9] * 2),
        (("arms", 0, "links", 1, "offset"), [0.0, 0.0]),
        (("arms", 0, "links", 1, "parent"), 0.0),
        (("arms", 0, "links", 1, "parent"), -2),
        (("arms", 0, "links", 2, "yaw", "joints"), [1.0]),
        (("arms", 0, "links", 1, "pitch"), {"constant": 0.0, "joints": [0.0] * 4}),
        (("arms", 0, "loop"), [{"cranks": [1, 9], "lengths": [1, 1], "couplers": [1, 1], "side": 1, "least": 0.1}]),
        (("frames", 0, "arm"), 7),
        (("frames", 0, "edges"), [0.0]),
        (("frames", 0, "edges"), [0.0, 1.0]),
        (("frames", 0, "acceleration"), [[[], [], [], []]]),
        (("bodies", 0, "pieces", 0, "edges"), [[0.1, 0.0, 0.0]] * 7),
        (("bodies", 0, "pieces", 0, "triangles"), [[0, 1, 2]]),
        (("bodies", 0, "pieces", 0, "triangles"), [[0, 0, -1]]),
        (("phases", 0, "seats"), [0]),
        (("phases", 0, "seats", 0), 0.0),
        (("phases", 0, "unknown", 0), [0.0]),
        (("phases", 0, "shares"), []),
        (("phases", 0, "put_down", 0, "supports"), [1000]),
        (("required", "lag"), [0.0]),
        (("required", "self_pairs"), [[0, 50]]),
        (("required", "exceptions", 0, "first"), [-1]),
        (("limits", 0, "jerk"), [1.0]),
        (("limits", 0, "lower"), []),
        (("points", 0, "yaw"), [0.1, 0.1]),
        (("points", 0, "rates"), [-1.0]),
        (("rows", 0, "normal"), [0.0, 1.0]),
        (("rows", 0, "bodies"), [0, 1.5]),
    ],
)
def test_lists_of_another_length_and_numbers_of_what_does_not_exist_are_refused(path: Path, value: Any) -> None:
    with pytest.raises(InputError):
        read(replaced(short("demo"), path, value))
    with pytest.raises(InputError, match="an object with the keys"):
        read([short("demo")])


@pytest.mark.parametrize("name", [*NAMES, "rv-m1"])
@pytest.mark.parametrize("many", [0, 1, -1, 1000])
def test_a_sum_of_joints_has_a_share_of_each_joint_and_no_more(name: str, many: int) -> None:
    count = len(_short(name)["arms"][0]["q"][0])
    shares = [0.5] * {-1: count - 1, 1000: count + 1}.get(many, many)
    links = _short(name)["arms"][0]["links"]
    angles = [
        ("links", k, key, "joints") for k, link in enumerate(links) for key in ("yaw", "pitch", "roll") if link[key]
    ]
    assert len(angles) >= len(links)
    for path in [("sums", 0, "joints"), *(("arms", 0, *each) for each in angles)]:
        with pytest.raises(InputError, match=f"joints: got .*; allowed: a list of {count}"):
            read(replaced(short(name), path, shares))


def test_the_fields_of_a_table_are_its_columns_one_after_the_other() -> None:
    left_out = {"limits": {c.LIMIT_JERKS}}
    for table, form in forms.SECTIONS.items():
        columns = set(range(c.WIDTHS[table])) - left_out.get(table, set())
        own = [
            column + k for (_, many, *_), column, _ in form for k in range(1 if many is None else many or c.MOST_JOINTS)
        ]
        assert own == sorted(columns), table
        for (name, *_), column, _ in form:
            known = getattr(c, f"{table.upper().rstrip('S')}_{name.upper()}", column)
            assert known in (column, c.RATE_POINT, c.DISTANCE_PIECE), (table, name)
    kinds = {(table, key.name): kind for table, form in forms.SECTIONS.items() for key, _, kind in form}
    assert kinds["axes", "other"] == kinds["rows", "pieces"] == kinds["sums", "order"] == "whole"
    assert kinds["axes", "place"] == "flag"
    assert kinds["axes", "low"] == kinds["points", "tool"] == kinds["limits", "jerk"] == "number"


def test_laws_have_no_more_powers_than_the_tables_have_columns_for() -> None:
    for powers, accepted in ((c.MOST_POWERS, True), (c.MOST_POWERS + 1, False)):
        document = replaced(short("demo"), ("frames", 0, "edges"), [0.0, 1.0])
        replaced(document, ("frames", 0, "acceleration"), [[[1.0] * powers, [], [], []]])
        if accepted:
            assert document_of(*read(document)) == document
            continue
        with pytest.raises(InputError, match="up to 12 numbers"):
            read(document)

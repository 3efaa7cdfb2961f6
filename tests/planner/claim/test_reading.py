"""A proof bundle is read as it was written, and nothing else is read."""

from __future__ import annotations

import copy
from functools import cache
from typing import Any

import pytest

from assur.planner.claim import columns as c
from assur.planner.claim import document as forms
from assur.planner.claim.document import document_of
from assur.planner.errors import InputError
from tests.planner.claim.reading import read
from tests.prover.bundles import Document, bundle

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


def replaced(document: Document, path: Path, value: Any) -> Document:
    """The document with another value there."""
    *above, last = path
    at: Any = document
    for key in above:
        at = at[key]
    at[last] = value
    return document


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

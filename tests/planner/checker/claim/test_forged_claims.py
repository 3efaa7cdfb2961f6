"""Tables that are none get a verdict, which refuses them; and so does a row that is an ulp too short."""

from __future__ import annotations

import math

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim.verdict import check_claim
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from tests.forgeries.claims import lasting, read
from tests.forgeries.stated import STATED, document_of
from tests.prover.bundles import Document, bundle

SHORTENED = ("demo", "five-bar", "beside-a-neighbour", "dense-flow")
"""Scenarios of whose claims rows are shortened."""
ROWS_EACH = 40


def is_needed(rows: list[Document], row: Document) -> bool:
    """Whether no other row could keep the same bodies apart at the end of a row."""
    return not any(
        other is not row
        and set(other["bodies"]) == set(row["bodies"])
        and other["t0"] <= row["t1"] <= other["t1"]
        and other["t0"] < row["t1"]
        for other in rows
    )


@pytest.mark.parametrize("name", SHORTENED)
def test_a_needed_row_that_is_an_ulp_too_short_is_refused(name: str) -> None:
    document = bundle(name)
    claim, rng, refused = read(document), np.random.default_rng(7), 0
    numbers = [
        i for i, row in enumerate(document["rows"]) if row["t1"] > row["t0"] and is_needed(document["rows"], row)
    ]
    assert len(numbers) > ROWS_EACH
    for i in rng.permutation(numbers)[:ROWS_EACH].tolist():
        rows = claim.rows.copy()
        rows[i, c.ROW_T1] = math.nextafter(rows[i, c.ROW_T1], -math.inf)
        verdict = check_claim(claim._replace(rows=rows))
        if verdict.accepted:
            # no pair needs the row: then all of it may go
            assert check_claim(claim._replace(rows=np.delete(claim.rows, i, axis=0))).accepted
        else:
            assert verdict.findings[0].code == Code.COVER
            refused += 1
    assert refused >= ROWS_EACH // 2
    assert lasting(document)


def changed(claim: Claim, table: str, row: int, column: int, value: float) -> Claim:
    """A claim with another number in one place."""
    own = getattr(claim, table).copy()
    own[row, column] = value
    return claim._replace(**{table: own})


def wrong_numbers() -> list[tuple[str, int, float]]:
    """Table, column and a number that `columns.BOUNDS` does not allow there."""
    found = []
    for table, first, count, low, high in c.BOUNDS:
        last = c.WIDTHS.get(table, first + 1) if count < 0 else first + count
        for column in {first, last - 1}:
            values = [math.nan, math.inf, -math.inf, math.nextafter(low, -math.inf)]
            if isinstance(high, str):
                values += [0.5, 1e6]
            else:
                values.append(math.nextafter(high, math.inf))
            found += [(table, column, value) for value in values]
    return found


def test_a_number_that_its_column_must_not_hold_is_refused() -> None:
    claims = [
        read(document_of(name))
        for name in (STATED, "demo", "five-bar", "belt-to-belt", "dense-flow", "rv-m1", "shutter", "tray")
    ]
    seen = set[tuple[str, int]]()
    for table, column, value in wrong_numbers():
        for claim in claims:
            if len(getattr(claim, table)):
                verdict = check_claim(changed(claim, table, -1, column, value))
                assert not verdict.accepted, (table, column, value)
                assert verdict.findings[0].code == Code.FORM, (table, column, value)
                seen.add((table, column))
                break
    # no shipped scenario has a rule for some pairs
    assert {(table, column) for table, column, _ in wrong_numbers()} - seen == {
        ("rules", c.RULE_TRAVEL), ("rules", c.RULE_NEAR), ("rules", c.RULE_SIDE),
    }  # fmt: skip


INDICES = [
    ("arms", c.ARM_LINK, 1.0),
    ("arms", c.ARM_LINKS, 2.0),
    ("arms", c.ARM_KNOTS, 1.0),
    ("arms", c.ARM_ANGLE, 1.0),
    ("links", c.LINK_PARENT, 400.0),
    ("links", c.LINK_SLIDE, 7.0),
    ("links", c.LINK_YAW, -1.0),
    ("links", c.LINK_YAW, 99.0),
    ("links", c.LINK_PITCH, 0.0),
    ("frames", c.FRAME_ARM, 0.0),
    ("frames", c.FRAME_PIECE, 5.0),
    ("bodies", c.BODY_PIECES, 40.0),
    ("bodies", c.BODY_TRIANGLE, 1.0),
    ("pieces", c.PIECE_VERTEX, 1.0),
    ("pieces", c.PIECE_EDGES, 7.0),
    ("triangles", c.TRIANGLE_PIECE, 0.0),
    ("triangles", c.TRIANGLE_VERTEX, 0.0),
    ("seats", c.SEAT_BODY, 0.0),
    ("seated", 0, 1.0),
    ("rows", c.ROW_PIECE, 40.0),
    ("rows", c.ROW_PIECE, -2.0),
]
"""Indices of rows that exist, or may exist, and are wrong in the last row of a table."""


@pytest.mark.parametrize(("table", "column", "value"), INDICES)
def test_an_index_that_does_not_fit_is_refused(table: str, column: int, value: float) -> None:
    verdict = check_claim(changed(read(bundle("demo")), table, -1, column, value))
    assert [finding.code for finding in verdict.findings] == [Code.FORM]


def is_right(table: object, right: FloatArray) -> bool:
    """Whether a table has shape, type and order of the right one. One with a row or none is in both orders."""
    if not isinstance(table, np.ndarray) or table.shape != right.shape or table.dtype != right.dtype:
        return False
    return bool(table.flags.c_contiguous)


def test_tables_of_another_shape_or_type_are_refused() -> None:
    claim = read(bundle("demo"))
    for name, own in zip(Claim._fields, claim, strict=True):
        forms = [own[:, :-1].copy(), own.astype(np.float32), own.ravel(), np.asfortranarray(own), own.tolist(), None]
        for form in forms:
            if not is_right(form, own):
                verdict = check_claim(claim._replace(**{name: form}))
                assert [finding.code for finding in verdict.findings] == [Code.FORM], (name, form)
    for name in ("arms", "bodies", "phases", "required", "links", "knots", "seats", "pieces"):
        assert not check_claim(claim._replace(**{name: getattr(claim, name)[:0]})).accepted


ANY = (math.nan, math.inf, -math.inf, -1.0, 0.0, 0.5, 1.0, 3.0, 1e-300, 1e300, -1e300, 1e9)
DRAWS = 60


@pytest.mark.parametrize("name", ["demo", "five-bar", "rv-m1", "tray"])
def test_any_number_at_any_place_gets_a_verdict(name: str) -> None:
    claim, rng = read(bundle(name)), np.random.default_rng(3)
    filled = [table for table in Claim._fields if getattr(claim, table).size]
    for _ in range(DRAWS):
        table = filled[rng.integers(len(filled))]
        rows, columns = getattr(claim, table).shape
        row, column, value = int(rng.integers(rows)), int(rng.integers(columns)), ANY[rng.integers(len(ANY))]
        verdict = check_claim(changed(claim, table, row, column, value))
        assert verdict.accepted == (verdict.findings == ())
        assert not (verdict.accepted and not math.isfinite(value)), (table, row, column, value)

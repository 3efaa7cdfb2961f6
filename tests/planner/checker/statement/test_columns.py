"""Every number of a claim but those of its rows is changed, one at a time. The statement checker reports it, or no
claim may hold the number, or it is one of those that are free.

A number that may be larger or smaller because the claim then states more is changed in both directions; one of them has
to be reported.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import pytest

from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from tests.planner.checker.statement.cases import Case, case_of, copied, differences
from tests.planner.checker.statement.form import is_formed

CASES = ("demo, more uncertain", "dense-flow, more uncertain", "rv-m1", "five-bar", "two-robots")


class Free(NamedTuple):
    """Columns of a table that may hold something else in some rows, and why."""

    table: str
    columns: range
    why: str
    rows: Callable[[Claim, int], bool] = lambda *_: True


def beyond(column: int, of: int) -> range:
    """The columns of joints that an arm has not, of those that begin at a column."""
    return range(column + of, column + c.MOST_JOINTS)


def free_of(claim: Claim) -> list[Free]:
    """The numbers of a claim that are free."""
    missing, unused = "the arm has no such joint", "nobody reads it"
    longer = "the claim may hold for longer, and the claim checker requires enough"
    own = int(claim.arms[0, c.ARM_JOINTS])
    found = [Free("limits", beyond(c.LIMIT_LOWER + k * c.MOST_JOINTS, own), missing) for k in range(5)]
    found += [
        Free("required", beyond(c.REQUIRED_LAG, own), missing),
        Free("frames", range(c.FRAME_POSE, c.FRAME_RATE), unused, lambda k, row: k.frames[row, c.FRAME_ARM] > 0.0),
        Free("frames", range(c.FRAME_RATE, c.FRAME_PIECE), unused, lambda k, row: k.frames[row, 11] == 0.0),
        Free("frames", range(c.FRAME_STEP, c.FRAME), unused, lambda k, row: k.frames[row, c.FRAME_PERIOD] == 0.0),
        Free("links", range(c.LINK_SLIDE, c.LINK_YAW), unused, lambda k, row: k.links[row, c.LINK_SLIDE] == -1.0),
        Free("pieces", range(c.PIECE_AXIS, c.PIECE_DISC), unused, lambda k, row: k.pieces[row, c.PIECE_DISC] == 0.0),
        Free("knots", range(1), longer, lambda k, row: not k.knots[row, c.KNOT_QD :].any()),
        Free("laws", range(c.LAW_END, c.LAW_POWER), longer, last_piece),
    ]
    for bound in (c.AXIS_LOW, c.AXIS_HIGH):
        found.append(Free("axes", range(bound, bound + 1), "no axis and no way is so long", partial(is_endless, bound)))
    for n in range(2, 6):
        for first in (c.KNOT_Q, c.KNOT_QD, c.KNOT_QDD):
            found.append(Free("knots", beyond(first, n), missing, partial(has_joints, n, c.ARM_KNOT)))
        found.append(Free("angles", beyond(c.ANGLE_SHARE, n), missing, partial(has_joints, n, c.ARM_ANGLE)))
    for n in range(c.MOST_EDGES):
        found.append(Free("pieces", range(c.PIECE_EDGE + 3 * n, c.PIECE), unused, partial(has_edges, n)))
    return found


def has_joints(count: int, span: int, claim: Claim, row: int) -> bool:
    """Whether the arm whose span of rows begins in this column has so many joints."""
    arm = next(each for each in claim.arms if each[span] <= row < each[span] + each[span + 1])
    return bool(arm[c.ARM_JOINTS] == count)


def has_edges(count: int, claim: Claim, row: int) -> bool:
    """Whether a piece has so many edges."""
    return bool(claim.pieces[row, c.PIECE_EDGES] == count)


def is_endless(bound: int, claim: Claim, row: int) -> bool:
    """Whether a row of axes has no bound on this side."""
    return bool(abs(claim.axes[row, bound]) >= c.FARTHEST_M)


def last_piece(claim: Claim, row: int) -> bool:
    """Whether a piece of a law is the last one of its frame."""
    return row + 1 in claim.frames[:, c.FRAME_PIECE] + claim.frames[:, c.FRAME_PIECES]


def real_columns(claim: Claim) -> set[tuple[str, int]]:
    """The columns that hold no index, by table and number."""
    found = set[tuple[str, int]]()
    for name, first, count, _, high in c.BOUNDS:
        last = getattr(claim, name).shape[1] if count < 0 else first + count
        found |= set() if isinstance(high, str) else {(name, column) for column in range(first, last)}
    return found


def accepted(case: Case) -> list[tuple[str, int, int]]:
    """Table, column and row of the numbers that may be changed in both directions: in the first and last row of each
    table."""
    claim, found = copied(case.claim), []
    real = real_columns(claim)
    for name in claim._fields:
        numbers = getattr(claim, name)
        for row in sorted({0, len(numbers) - 1}) if name != "rows" and len(numbers) else ():
            for column in range(numbers.shape[1]):
                old, step = numbers[row, column], 1e-3 if (name, column) in real else 1.0
                for value in (old + step, old - step):
                    numbers[row, column] = value
                    if not is_formed(claim) or differences(case, claim):
                        break
                else:
                    found.append((name, column, row))
                numbers[row, column] = old
    assert differences(case, claim) == []
    return found


@pytest.mark.parametrize("name", CASES)
def test_every_number_of_a_claim_is_compared_or_free(name: str) -> None:
    case = case_of(name)
    free = free_of(case.claim)
    for table, column, row in accepted(case):
        reasons = [each.why for each in free if each.table == table and column in each.columns]
        rows = [each for each in free if each.table == table and column in each.columns and each.rows(case.claim, row)]
        assert (table, column, row, reasons, bool(rows)) == (table, column, row, reasons, True)

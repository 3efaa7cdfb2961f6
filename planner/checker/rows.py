"""Whether each row of the certificate proves the distance required (C1 to C5).

A row whose second body is −1 is of the first alone, against the origin of the world: no distance is required of it
by itself, `assur.planner.checker.far` says what follows from it (C6).

A row says where to look: an interval, two bodies and a normal. Gaps and bounds of motion are computed here; where they
do not prove the row's distance over its interval, halves of it are looked at with the same normal.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.ranges import Ranges
from assur.planner.checker.required import required
from assur.planner.checker.stage import Stage
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Certificate
from assur.planner.model.phases import Phase
from assur.planner.robots.protocol import Sweep

Array = TypeVar("Array", FloatArray, IntArray)

UNIT_NORMAL = 1e-12
"""| |n| - 1 | of a normal at most: a normalised vector is off by 2e-16; in a cell of 50 m this is 0.05 nm of gap."""
SLACK_M = 1e-9
"""What is taken off each gap, m, for its rounding: some twenty terms of a few metres, each rounded to 1e-15 m."""
HALVINGS = 8
"""How often an interval may be halved, with the normal of its row. One proves a row whose maker keeps 1 µm by bounds of
some other form; the others are for bounds that are several times as large."""


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows that make sense: their `number` in the certificate, their `phase`, and bodies as our own numbers; the
    second is -1 in a row of the first alone."""

    number: IntArray
    phase: IntArray
    first: IntArray
    second: IntArray
    first_piece: IntArray
    second_piece: IntArray
    t0: FloatArray
    t1: FloatArray

    def some(self, which: BoolArray | IntArray) -> Rows:
        """Some of them."""
        return Rows(*(getattr(self, name)[which] for name in Rows.__dataclass_fields__))

    def halved(self) -> Rows:
        """The first halves of their intervals, and then the second."""
        middle = (self.t0 + self.t1) / 2
        twice = self.some(np.tile(np.arange(len(self)), 2))
        return replace(twice, t0=np.concatenate([self.t0, middle]), t1=np.concatenate([middle, self.t1]))

    def __len__(self) -> int:
        return len(self.number)


def sorted_out(stage: Stage, phases: tuple[Phase, ...], certificate: Certificate) -> tuple[Rows, list[Finding]]:
    """The rows that name bodies and pieces that exist, over an interval inside one phase; findings for the others.

    A row of one body alone is of the whole body or of its box, never of some other piece of several.
    """
    solids = stage.solids
    known = np.array([solids.number.get(name, -1) for name in certificate.names] or [-1], dtype=np.int64)
    index = [np.where((i >= 0) & (i < len(certificate.names)), i, 0) for i in (certificate.first, certificate.second)]
    one, other = (known[i] for i in index)
    named = (one >= 0) & (other >= 0) & (one != other)
    named &= (index[0] == certificate.first) & (index[1] == certificate.second)
    pieces = (certificate.first_piece, certificate.second_piece)
    for body, piece in zip((one, other), pieces, strict=True):
        named &= (piece >= -1) & (piece < solids.count[np.maximum(body, 0)])
    alone = (certificate.second == -1) & (certificate.second_piece == -1)
    alone &= (one >= 0) & (index[0] == certificate.first) & (pieces[0] >= -1)
    alone &= pieces[0] < np.where(solids.count[np.maximum(one, 0)] == 1, 1, 0)
    named, other = named | alone, np.where(alone, -1, other)
    begins, ends = np.array([phase.t0 for phase in phases]), np.array([phase.t1 for phase in phases])
    phase = np.searchsorted(begins, certificate.t0, side="right") - 1
    within = (phase >= 0) & (certificate.t0 <= certificate.t1) & (certificate.t1 <= ends[np.maximum(phase, 0)])
    found = _some(Code.ROW, "names a body or a piece that does not exist", ~named, certificate)
    found += _some(Code.ROW, "is not inside one phase", ~within, certificate)
    good = np.flatnonzero(named & within)
    numbers = np.arange(len(certificate))
    whole = Rows(numbers, phase, one, other, pieces[0], pieces[1], certificate.t0, certificate.t1)
    return whole.some(good), found


def spare_of(
    stage: Stage, phases: tuple[Phase, ...], certificate: Certificate, rows: Rows, ranges: Ranges
) -> tuple[FloatArray, list[Finding]]:
    """By how much, m, each row (N,) proves more than the required distance (rows of one body alone: the distance), -inf
    where it does not, and findings for those."""
    if not len(rows):
        return np.zeros(0), []
    normal = certificate.normal[rows.number]
    unit = np.abs(np.sqrt((normal * normal).sum(1)) - 1.0) <= UNIT_NORMAL
    spare = np.full(len(rows), np.inf)
    part, row = rows, np.arange(len(rows))
    for halving in range(HALVINGS + 1):
        bound, taken = _bounded(stage, phases, part, normal[row], ranges)
        # what is too near already at an end of its interval is not proved by halves of it
        open_ = ~(bound >= 0) & (taken >= 0) & (halving < HALVINGS)
        np.minimum.at(spare, row[~open_], np.where(np.isnan(bound), -np.inf, bound)[~open_])
        if not open_.any():
            break
        part, row = part.some(open_).halved(), np.tile(row[open_], 2)
    apart = (spare >= 0) | ((rows.second < 0) & (spare > -np.inf))
    if (unit & apart).all():
        return spare, []
    away = np.abs(np.sqrt((normal * normal).sum(1)) - 1)
    findings = [
        *_worst(Code.NORMAL, "has a normal whose length is not 1", ~unit, away, "1", certificate, rows),
        *_worst(Code.SEPARATION, "does not prove the required distance", ~apart, -spare, "m", certificate, rows),
    ]
    return np.where(unit & apart, spare, -np.inf), findings


def _bounded(
    stage: Stage, phases: tuple[Phase, ...], rows: Rows, n: FloatArray, ranges: Ranges
) -> tuple[FloatArray, FloatArray]:
    """By how much, m, the gap exceeds what is required over each interval (N,), by C2 and C3, and at its ends; of one
    body alone nothing is required."""
    # Both bodies of all rows one behind the other, each with the normal that points out of it.
    seat = np.concatenate([stage.seat[rows.phase, body] for body in (rows.first, rows.second)])
    piece, outward = np.concatenate([rows.first_piece, rows.second_piece]), np.concatenate([n, -n])
    # Many rows share an interval; complex numbers sort by both of its ends at once.
    spans, span = np.unique(rows.t0 + 1j * rows.t1, return_inverse=True)
    swept = _each(ranges.sweep(spans.real.copy(), spans.imag.copy()), _twice(span.ravel()))
    bounds = stage.bounds(seat, piece, outward, _twice(rows.t0), _twice(rows.t1), swept)
    pair = rows.second >= 0  # the origin of the world does not move
    v, m = (bound[: len(rows)] + np.where(pair, bound[len(rows) :], 0.0) for bound in bounds)
    g0, g1 = _gaps(stage, ranges, seat, piece, outward, rows)
    h = rows.t1 - rows.t0
    asked = np.where(pair, required(stage, phases, rows, n), 0.0) + SLACK_M
    least = np.fmax((g0 + g1 - v * h) / 2, np.minimum(g0, g1) - m * h**2 / 8)
    return least - asked, np.where(pair, np.minimum(g0, g1) - asked, -np.inf)


def _gaps(
    stage: Stage, ranges: Ranges, seat: IntArray, piece: IntArray, outward: FloatArray, rows: Rows
) -> tuple[FloatArray, FloatArray]:
    """Support gaps (N,), (N,) at both ends of each row (C1); `seat`, `piece`, `outward` (2N, ...): the first bodies,
    and then the second."""
    times, at = np.unique(np.concatenate([rows.t0, rows.t1]), return_inverse=True)
    position, rotation = stage.where(ranges.spline.position(times), times)
    which, carrier = np.concatenate([_twice(x) for x in np.split(at.ravel(), 2)]), _twice(stage.carrier[seat])
    reach = stage.support(
        _twice(seat), _twice(piece), _twice(outward), position[which, carrier], rotation[which, carrier]
    ).reshape(2, 2, len(rows))
    # no second body: the origin of the world
    gaps = -reach[:, 0] - np.where(rows.second >= 0, reach[:, 1], 0.0)
    return gaps[0], gaps[1]


def _twice(x: Array) -> Array:
    """An array (N, ...) and then the same again."""
    return np.concatenate([x, x])


def _each(sweep: Sweep, rows: IntArray) -> Sweep:
    return Sweep(sweep.lower[rows], sweep.upper[rows], sweep.rate[rows], sweep.rate_d[rows])


def _some(code: Code, what: str, bad: BoolArray, certificate: Certificate) -> list[Finding]:
    """One finding for all bad rows."""
    which = np.flatnonzero(bad)
    if not len(which):
        return []
    i = int(which[0])
    span = f"row {i}, {certificate.t0[i]:.6g} to {certificate.t1[i]:.6g} s"
    return [Finding(code, f"a row {what}", float(len(which)), "rows", span)]


def _worst(
    code: Code, what: str, bad: BoolArray, amount: FloatArray, unit: str, certificate: Certificate, rows: Rows
) -> list[Finding]:
    """One finding for all bad rows: the worst of them."""
    which = np.flatnonzero(bad)
    if not len(which):
        return []
    worst = int(which[np.argmax(np.where(np.isnan(amount[which]), np.inf, amount[which]))])
    i = int(rows.number[worst])
    names = f"{certificate.names[certificate.first[i]]} and {certificate.names[certificate.second[i]]}"
    text = f"a row of {names} {what} ({len(which)} such rows)"
    return [Finding(code, text, float(amount[worst]), unit, f"row {i}, {rows.t0[worst]:.6g} to {rows.t1[worst]:.6g} s")]

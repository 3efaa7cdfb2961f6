"""Whether each row of the certificate is true, and whether it amounts to the distance required (C1 to C5).

A row whose second body is −1 is of the first alone, against the origin of the world: no distance is required of it
by itself, `assur.planner.checker.far` says what follows from it (C6).

Nothing in a row is believed: gaps and bounds are computed again and compared, and the proof goes through with the
worse of the two. So a false row is found even where it would not have mattered, and a slip of ours in the comparison
could not have let one pass.
"""

from __future__ import annotations

from dataclasses import dataclass
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
GAP_M = 2e-10
"""A claimed gap may be above ours by this, m: both are sums of some twenty terms of a few metres, rounded to 1e-15 m
each, and a proof keeps 1e-9 m for them."""
BOUND = 1e-9
"""A claimed bound may be below ours by this part of it: both are tight to some 1e-13 of the fastest motion."""
SPEED_FLOOR = 1e-10
"""m/s. Claimed speeds may be below ours by this, too: a joint that stands still between knots moves by rounding."""
ACCELERATION_FLOOR = 1e-7
"""m/s². The same for accelerations, whose rounding grows as 1/h between close knots."""
SLACK_M = 0.5e-9
"""What is taken off each gap here, m: half of what its maker must take off (1e-9 m). The other half is for the
differences of rounding between the two of us; both are a million times the rounding of one gap."""


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


def proved(
    stage: Stage, phases: tuple[Phase, ...], certificate: Certificate, rows: Rows, ranges: Ranges
) -> tuple[BoolArray, list[Finding]]:
    """Which rows (N,) are true and prove the required distance, and findings for those that are not or do not."""
    least, findings = least_of(stage, phases, certificate, rows, ranges)
    return least > -np.inf, findings


def least_of(
    stage: Stage, phases: tuple[Phase, ...], certificate: Certificate, rows: Rows, ranges: Ranges
) -> tuple[FloatArray, list[Finding]]:
    """What each row (N,) proves, m, −inf where it is not true or does not prove the required distance, and findings for
    those."""
    if not len(rows):
        return np.zeros(0), []
    c, i = certificate, rows.number
    n, speed, acceleration = c.normal[i], c.speed[i], c.acceleration[i]
    # Both bodies of all rows one behind the other, each with the normal that points out of it.
    seat = np.concatenate([stage.seat[rows.phase, body] for body in (rows.first, rows.second)])
    piece, outward = np.concatenate([rows.first_piece, rows.second_piece]), np.concatenate([n, -n])
    # Many rows share an interval; complex numbers sort by both of its ends at once.
    spans, span = np.unique(rows.t0 + 1j * rows.t1, return_inverse=True)
    swept = _each(ranges.sweep(spans.real.copy(), spans.imag.copy()), _twice(span.ravel()))
    bounds = stage.bounds(seat, piece, outward, _twice(rows.t0), _twice(rows.t1), swept)
    pair = rows.second >= 0  # the origin of the world does not move
    own_speed, own_acceleration = (bound[: len(rows)] + np.where(pair, bound[len(rows) :], 0.0) for bound in bounds)
    gap0, gap1 = _gaps(stage, ranges, seat, piece, outward, rows)

    length = np.sqrt((n * n).sum(1))
    unit = np.abs(length - 1.0) <= UNIT_NORMAL
    gaps = (c.gap0[i] <= gap0 + GAP_M) & (c.gap1[i] <= gap1 + GAP_M)
    fast = (speed >= own_speed * (1 - BOUND) - SPEED_FLOOR) & (
        acceleration >= own_acceleration * (1 - BOUND) - ACCELERATION_FLOOR
    )
    g0, g1 = np.minimum(gap0, c.gap0[i]), np.minimum(gap1, c.gap1[i])
    v, m, h = np.maximum(speed, own_speed), np.maximum(acceleration, own_acceleration), rows.t1 - rows.t0
    least = np.fmax((g0 + g1 - v * h) / 2, np.minimum(g0, g1) - m * h**2 / 8) - SLACK_M
    asked = np.where(pair, required(stage, phases, rows, n), -np.inf)
    apart = least >= asked
    good = unit & gaps & fast & apart
    if good.all():
        return least, []
    over = np.fmax(c.gap0[i] - gap0, c.gap1[i] - gap1)
    under = np.fmax(own_speed - speed, own_acceleration - acceleration)
    findings = [
        *_worst(Code.NORMAL, "has a normal whose length is not 1", ~unit, np.abs(length - 1), "1", c, rows),
        *_worst(Code.GAP, "claims a gap above the true one", ~gaps, over, "m", c, rows),
        *_worst(Code.BOUND, "claims a bound of speed or acceleration below ours", ~fast, under, "m/s, m/s²", c, rows),
        *_worst(Code.SEPARATION, "does not prove the required distance", ~apart, asked - least, "m", c, rows),
    ]
    return np.where(good, least, -np.inf), findings


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

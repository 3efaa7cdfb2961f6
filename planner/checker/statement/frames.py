"""Do the frames of a claim move as the laws of the request say, and is as much uncertain of them?

A claim has the acceleration of a frame as polynomials on pieces of time (N6 of docs/bundle.md). Two polynomials of
degree d are the same if they agree at d + 1 instants, so each piece is compared with the law's formula at so many,
unless the powers of both show it already.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import islice

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import laws
from assur.planner.checker.statement.differences import SAME, Interval, Requirements
from assur.planner.checker.statement.statement import Statement
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.laws.law import Frame

PERIODS = (0, 1, 2, -1)
"""Periods over which a motion that repeats is compared with its formula."""


def require_frames(report: Requirements, frames: Mapping[str, Frame], claim: c.Claim) -> None:
    """The frames are those of the request, in its order. Links of other arms: see `arms`."""
    many = f"the claim has {len(claim.frames)} frames, not {len(frames)}"
    report.require(len(claim.frames) == len(frames), Code.LAW, many)
    displaced = claim.displaced.tolist()
    for number, (frame, row) in enumerate(zip(frames.values(), claim.frames, strict=False)):
        _require_uncertainty(report, frame, row.tolist(), [each for each in displaced if each[0] == number])
        if laws.link_of(frame.law) is None:
            _require_motion(report, frame, row, claim)


def require_known(statement: Statement) -> None:
    """The motion of each frame is known while a body is on it, and where the tool has to be at a point of it; lateness
    and shifts included."""
    claim, late = statement.claim, statement.scene.execution.start_tolerance_s
    for number, frame in enumerate(statement.scene.frames.values()):
        earliest, latest = laws.known(frame.law)
        if (earliest, latest) == (-math.inf, math.inf) or laws.link_of(frame.law) is not None:
            continue
        seated = (statement.seats[:, :, c.SEAT_FRAME] == number).any(axis=1)
        spans = [claim.phases[seated, c.PHASE_T0 : c.PHASE_T1 + 1]]
        for table, column in (
            (claim.points, c.POINT_FRAME),
            (claim.rates, c.RATE_FRAME),
            (claim.guides, c.GUIDE_FRAME),
            (claim.guides, c.GUIDE_FRAME + 1),
        ):
            spans.append(table[table[:, column] == number, :2])
        times, (least, most) = np.concatenate(spans), frame.uncertainty.shift_s
        known = (earliest <= times[:, 0] - most) & (times[:, 1] + late - least <= latest)
        what = f"the motion of {frame.name} is known from {earliest:g} s to {latest:g} s only"
        for t0, t1 in times[~known][:1].tolist():
            statement.require(False, Code.LAW, what, (t0, t1))


def _require_uncertainty(report: Requirements, frame: Frame, row: list[float], stated: list[list[float]]) -> None:
    """At least as much is uncertain of the frame: its time, its yaw, and displacements along some directions. `stated`:
    the frame's displacements."""
    required, name = frame.uncertainty, frame.name
    least, most = required.shift_s
    late = row[c.FRAME_SHIFT] <= least and row[c.FRAME_SHIFT + 1] >= most
    report.require_all(
        Code.UNCERTAINTY,
        None,
        (late, f"the motion of {name} may be earlier or later than the claim states"),
        (row[c.FRAME_YAW] >= required.yaw_rad, f"{name} may be turned by more than the claim states"),
    )
    line, side = laws.line_of(frame.law), None
    if line is not None and math.hypot(line[0], line[1]) > 0.0:
        length = math.hypot(line[0], line[1])
        side = (-line[1] / length, line[0] / length, 0.0)
    for along, direction, amount, growth, shared in (
        ("its line", line, required.position_m, required.speed_m_s, True),
        ("the horizontal across it", side, required.lateral_m, 0.0, False),
        ("the vertical", (0.0, 0.0, 1.0), required.vertical_m, 0.0, False),
    ):
        if not (amount > 0.0 or growth > 0.0):
            continue
        fits = [
            each
            for each in stated
            if each[c.DISPLACED_AMOUNT] >= amount
            and each[c.DISPLACED_GROWTH] >= growth
            and (shared or each[c.DISPLACED_SHARED] == 0.0)
            and _is_along(each, direction)
        ]
        what = f"{name} may be displaced by more along {along} than the claim states"
        report.require(fits, Code.UNCERTAINTY, what)
        if fits:
            stated.remove(fits[0])  # two displacements along one direction add up: each has a row of its own


def _is_along(row: list[float], direction: tuple[float, ...] | None) -> bool:
    """Whether a displacement has this direction, either way round; None: any horizontal direction."""
    if direction is None or row[c.DISPLACED_LEVEL] == 1.0:
        return direction is None and row[c.DISPLACED_LEVEL] == 1.0
    stated = row[c.DISPLACED_DIRECTION : c.DISPLACED_DIRECTION + 3]
    return min(max(abs(x - s * y) for x, y in zip(stated, direction, strict=True)) for s in (1.0, -1.0)) <= SAME


def _require_motion(report: Requirements, frame: Frame, row: FloatArray, claim: c.Claim) -> None:
    """The frame is on no arm, and its polynomials and sines are those of its law."""
    name, law = frame.name, frame.law
    if row[c.FRAME_ARM] != -1.0 or row[c.FRAME_LINK] != -1.0:
        report.require(False, Code.LAW, f"{name} is a link of an arm in the claim, and not in the request")
        return
    first, count = int(row[c.FRAME_PIECE]), int(row[c.FRAME_PIECES])
    sines = claim.waves[int(row[c.FRAME_WAVE]) :][: int(row[c.FRAME_WAVES])].tolist()
    pieces = claim.laws[first : first + count]
    begin, end = (float(pieces[0, c.LAW_BEGIN]), float(pieces[-1, c.LAW_END])) if count else (0.0, 0.0)
    formula = laws.formula_of(law, begin, end)
    report.require(_are_same_sines(sines, formula.sines), Code.LAW, f"the sines of {name} are others")
    if not count:
        at = [powers[0] for powers in formula.powers[0]]
        same = formula.degree == 0 and math.dist(row[c.FRAME_POSE : c.FRAME_RATE].tolist(), at) <= SAME
        report.require(same, Code.LAW, f"{name} is at another pose, or moves")
        return
    period = row[c.FRAME_PERIOD]
    if period != 0.0:
        # so often at most: what the step is off adds up
        off = np.abs(row[c.FRAME_STEP : c.FRAME] - formula.step).max() * c.LATEST_S / period
        if not (period == formula.period and abs(end - begin - period) <= SAME and off <= SAME):
            report.require(False, Code.LAW, f"{name} has another period, or goes on by another step")
            return
    elif formula.period == 0.0 and _has_powers(row.tolist(), pieces.tolist(), formula):
        return
    when, most = _farthest_off(row, pieces, formula)
    what = f"{name} is up to {most:.2g} m or rad from where its law has it"
    report.require(most <= SAME, Code.LAW, what, when)


def _has_powers(frame: list[float], pieces: list[list[float]], formula: laws.Formula) -> bool:
    """Whether a motion without a period is that of the formula, by the powers of their difference: on a piece that
    lasts h it is no larger than sum |d_n| h^n. If it may be larger, instants have to show it."""
    now, places, rates = pieces[0][c.LAW_BEGIN], frame[c.FRAME_POSE : c.FRAME_RATE], frame[c.FRAME_RATE :]
    for begin, end, *accelerations in pieces:
        required, h, last = formula.powers_from(begin, end), end - begin, c.MOST_POWERS - 1
        if required is None or begin != now or not h > 0.0:
            return False
        while last >= 0 and not any(accelerations[last :: c.MOST_POWERS]):
            last -= 1
        for k, other in enumerate(required):
            off, first, place, rate = 0.0, k * c.MOST_POWERS - 2, 0.0, 0.0
            for n in range(max(last + 3, len(other))):
                x = places[k] if n == 0 else rates[k] if n == 1 else accelerations[first + n] / (n * (n - 1))
                off += abs(x - (other[n] if n < len(other) else 0.0)) * h**n
                place, rate = place + x * h**n, rate + n * x * h ** (n - 1)
            if not off <= SAME:
                return False
            places[k], rates[k] = place, rate
        now = end
    return True


def _are_same_sines(stated: list[list[float]], required: Sequence[laws.Sine]) -> bool:
    """Whether sines have the same numbers, in any order."""
    same = len(stated) == len(required)
    for one, other in zip(sorted(stated), sorted(required), strict=False):
        for x, y in zip(one, other, strict=True):
            same = same and math.isclose(x, y, rel_tol=1e-12)
    return same


def _farthest_off(frame: FloatArray, pieces: FloatArray, formula: laws.Formula) -> tuple[Interval, float]:
    """Where the motion of a frame differs most from the formula: a piece, and by how much, m or rad. What repeats is
    compared over several periods."""
    starts, whole = pieces[:, c.LAW_BEGIN], (float(pieces[0, c.LAW_BEGIN]), float(pieces[-1, c.LAW_END]))
    period, powers = float(frame[c.FRAME_PERIOD]), _integrated(frame, pieces).tolist()
    stated = laws.Formula(starts.tolist(), powers, whole, (), period, frame[c.FRAME_STEP :].tolist())
    # if the law has many more pieces than the claim, the claim is wrong, and the others need not be computed
    most = 2 * len(pieces) + 8
    inside = list(islice((t for t in formula.ends if whole[0] < t < whole[1]), most))
    if len(inside) == most or not (starts[1:] == pieces[:-1, c.LAW_END]).all():
        return whole, math.inf
    cuts = np.array(sorted({*starts.tolist(), *whole, *inside}))
    degree = max(formula.degree, stated.degree)
    nodes = 0.5 - 0.5 * np.cos(math.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    times, off = (cuts[:-1, None] + np.diff(cuts)[:, None] * nodes).ravel(), np.zeros(len(cuts) - 1)
    for later in (period * k for k in PERIODS) if period != 0.0 else (0.0,):
        apart = np.abs(stated.place(times + later) - formula.place(times + later)).max(axis=1)
        off = np.maximum(off, apart.reshape(len(off), -1).max(axis=1))
    worst = int(np.argmax(np.where(np.isnan(off), math.inf, off)))
    return (float(cuts[worst]), float(cuts[worst + 1])), float(off[worst])


def _integrated(frame: FloatArray, pieces: FloatArray) -> FloatArray:
    """Powers (K, 4, D) of the place on each of K pieces: accelerations are integrated twice from pose and rate when the
    first piece begins (N6)."""
    powers = pieces[:, c.LAW_POWER :].reshape(len(pieces), 4, c.MOST_POWERS)
    powers = powers[:, :, : 1 + max(np.flatnonzero(powers.any(axis=(0, 1))), default=-1)]
    k, h = np.arange(powers.shape[2]), (pieces[:, c.LAW_END] - pieces[:, c.LAW_BEGIN])[:, None]
    rates, places = powers / (k + 1.0), powers / ((k + 1.0) * (k + 2.0))
    faster = (rates * h[:, :, None] ** (k + 1)).sum(2)
    rate = frame[c.FRAME_RATE : c.FRAME_PIECE] + np.cumsum(faster, axis=0) - faster
    moved = h * rate + (places * h[:, :, None] ** (k + 2)).sum(2)
    place = frame[c.FRAME_POSE : c.FRAME_RATE] + np.cumsum(moved, axis=0) - moved
    return np.concatenate([place[:, :, None], rate[:, :, None], places], axis=2)

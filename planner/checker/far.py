"""Pairs that rows of one body alone keep apart: it stays on one side of a plane, and what stands still on the other.

In a large cell most pairs are such, so a few rows do for hundreds of bodies (equation C6 in docs/guarantees.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.required import required
from assur.planner.checker.rows import Rows
from assur.planner.checker.stage import Stage
from assur.planner.frames import Fixed
from assur.planner.model.phases import Phase


@dataclass(frozen=True, eq=False)
class Planes:
    """Bodies (G,) that keep their distance `least`, m, from the planes n·x = 0, n (G, 3), throughout a phase (G,)."""

    phase: IntArray
    body: IntArray
    normal: FloatArray
    least: FloatArray


def planes(phases: tuple[Phase, ...], rows: Rows, normal: FloatArray, least: FloatArray) -> Planes:
    """The planes of rows (N,) of one body alone, with their normals (N, 3) and what they prove (N,), m; −inf: nothing.

    Rows of one phase, body and normal, to the bit, count together, each beginning where the one before ends; if they do
    not last the whole phase, they count for nothing.
    """
    if not len(rows):
        return Planes(rows.phase, rows.first, normal, least)
    _, group = np.unique(np.column_stack([rows.phase, rows.first, normal]), axis=0, return_inverse=True)
    order = np.lexsort((rows.t0, group.ravel()))
    rows, normal, least, group = rows.some(order), normal[order], least[order], group.ravel()[order]
    begins, ends = np.array([p.t0 for p in phases])[rows.phase], np.array([p.t1 for p in phases])[rows.phase]
    fresh = np.append(True, group[1:] != group[:-1])
    joined = np.where(fresh, rows.t0 == begins, rows.t0 == np.append(np.nan, rows.t1[:-1]))
    joined &= np.where(np.append(fresh[1:], True), rows.t1 == ends, True) & (least > -np.inf)
    head = np.flatnonzero(fresh)
    smallest, whole = np.minimum.reduceat(least, head), np.logical_and.reduceat(joined, head)
    head = head[whole]
    return Planes(rows.phase[head], rows.first[head], normal[head], smallest[whole])


def far(
    stage: Stage, phases: tuple[Phase, ...], behind: Planes, phase: IntArray, first: IntArray, second: IntArray
) -> BoolArray:
    """Whether bodies `first` and `second` (N,) are kept apart as required over all of phase number `phase` by a plane
    that the one stays behind while the other stands still before it (C6).

    False where the other's frame moves or is not known throughout, and for pairs within the robot.
    """
    found = np.zeros(len(phase), dtype=bool)
    if not len(behind.phase):
        return found
    robot, count = stage.of_robot, len(stage.solids.count)
    one, other = (np.where(robot[phase, first], x, y) for x, y in ((first, second), (second, first)))
    pairs = np.flatnonzero(robot[phase, one] & ~robot[phase, other] & _still(stage, phases)[phase, other])
    phase, one, other = phase[pairs], one[pairs], other[pairs]
    whose, which = np.unique(phase * count + one, return_inverse=True)
    normals, along = np.unique(behind.normal, axis=0, return_inverse=True)
    nearest = _nearest(stage, normals, min(p.t0 for p in phases))
    gap = np.full((len(whose), count), -np.inf)
    for k, of in enumerate(behind.phase * count + behind.body):
        at = np.flatnonzero(whose == of)
        # how far the one stays behind the plane, and how far the other is before it; NaN gives nothing
        gap[at] = np.fmax(gap[at], behind.least[k] + nearest[along.ravel()[k], stage.seat[behind.phase[k]]])
    begins, ends = np.array([p.t0 for p in phases]), np.array([p.t1 for p in phases])
    box = np.full(len(pairs), -1)
    rows = Rows(pairs, phase, one, other, box, box, begins[phase], ends[phase])
    # what stands still does so along any normal
    asked = required(stage, phases, rows, np.tile([0.0, 0.0, 1.0], (len(pairs), 1)))
    found[pairs] = gap[which, other] >= asked
    return found


def _still(stage: Stage, phases: tuple[Phase, ...]) -> BoolArray:
    """(P, B): whether a body rides on a frame that stands still and is known throughout the phase."""
    laws = [frame.law for frame in stage.scene.frames.values()]
    fixed = np.zeros((len(phases), stage.links + len(laws)), dtype=bool)
    for k, law in enumerate(laws, start=stage.links):
        if isinstance(law, Fixed):
            fixed[:, k] = [law.valid[0] <= phase.t0 and phase.t1 <= law.valid[1] for phase in phases]
    return np.take_along_axis(fixed, stage.carrier[stage.seat], axis=1)


def _nearest(stage: Stage, n: FloatArray, t: float) -> FloatArray:
    """(G, S): least n·x over the body in each seat where it is at time t, for normals n (G, 3); NaN where it is not
    known. Links are where the start has them, which is of no use to anyone."""
    position, rotation = stage.where(stage.scene.start.q[None], np.array([t]))
    seats = np.arange(len(stage.body))
    row, seat = (grid.ravel() for grid in np.indices((len(n), len(seats))))
    carrier = stage.carrier[seat]
    piece = np.where(stage.solids.count[stage.body[seat]] == 1, 0, -1)
    found = -stage.support(seat, piece, -n[row], position[0, carrier], rotation[0, carrier])
    return found.reshape(len(n), len(seats))

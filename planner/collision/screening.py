"""Refuses most colliding drafts in one NumPy batch: all drafts × sampled times × pairs of bodies.

First the vertical order and the distance between outlines from above, for all rows at once; then, for what is left, the
likely normals. Where no normal parts a pair, a common point is looked for, and where none is found FCL decides (design:
screen, ask, prove). What passes is not yet proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.arrangement import COVER, Carriers, Solids, carriers, exempted
from assur.planner.collision.gjk import separate
from assur.planner.collision.proof import Prover
from assur.planner.collision.support_gaps import Placed, likely_gaps, meet, place, rough_gaps, swept_gaps
from assur.planner.model.assembly_mode import lost_at
from assur.planner.model.clearance import SLACK_M, clearance, is_certain, worst
from assur.planner.model.outcome import Reason, Refusal
from assur.planner.model.phases import Phase

STEP_S = 0.02
"""Sampling of drafts, s. It decides how much work a colliding draft causes, not what is accepted."""


class Timed(Protocol):
    """A timed motion in phases: an outline or a draft."""

    @property
    def phases(self) -> tuple[Phase, ...]: ...

    def at(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,)."""
        ...


@dataclass(frozen=True, slots=True)
class Screened:
    """What became of a draft: None, or why it is refused; and the share of samples at which it was in the way."""

    refusal: Refusal | None
    bad: float
    also: tuple[Refusal, ...] = ()
    """The deepest confirmed encounters with other bodies of the surroundings."""


def screen(prover: Prover, drafts: Sequence[Timed], step: float = STEP_S) -> list[Screened]:
    """One `Screened` for each draft, in order."""
    groups: dict[int, tuple[Solids, list[tuple[int, Phase]]]] = {}
    for number, draft in enumerate(drafts):
        for phase in draft.phases:
            solids = prover.solids(phase.carried, phase.rides)
            groups.setdefault(id(solids), (solids, []))[1].append((number, phase))
    found: list[Screened] = [Screened(None, 0.0)] * len(drafts)
    for solids, members in groups.values():
        for number, screened in _screen_group(prover, solids, drafts, members, step).items():
            if found[number].refusal is None:
                found[number] = screened
    return found


@dataclass(frozen=True, slots=True)
class _Samples:
    """Sampled times of a group: owner (T,) is the draft, phase (T,) the number in `members`."""

    t: FloatArray
    owner: IntArray
    phase: IntArray
    where: Carriers


def _sampled(
    prover: Prover, drafts: Sequence[Timed], members: list[tuple[int, Phase]], step: float
) -> tuple[_Samples | None, dict[int, Screened]]:
    """Samples of the members; those that do not stay assembled on the way are refused, and not among them."""
    begins, ends = np.array([(phase.t0, phase.t1) for _, phase in members]).T
    counts = np.maximum(2, np.ceil((ends - begins) / step).astype(np.int64) + 1)
    numbers, last = np.repeat(np.arange(len(members)), counts), np.cumsum(counts)
    share = (np.arange(len(numbers)) - np.repeat(last - counts, counts)) / (counts - 1)[numbers]
    t = np.minimum(begins[numbers] + (ends - begins)[numbers] * share, ends[numbers])
    every = zip(members, np.split(t, last[:-1]), strict=True)
    q = np.concatenate([drafts[draft].at(mine) for (draft, _), mine in every])
    owners = np.array([draft for draft, _ in members])[numbers]
    refused: dict[int, Screened] = {}
    robot = prover.scene.robot
    kept = robot.assembled(q, q)
    if not kept.all():
        for draft in np.unique(owners[~kept]):
            rows = ~kept & (owners == draft)
            there = robot.parallel_margin(q[rows])
            refusal = lost_at(robot, "screening", members[int(numbers[rows][0])][1].step, t[rows], there)
            refused[int(draft)] = Screened(refusal, float(rows.sum() / (owners == draft).sum()))
        free = ~np.isin(owners, list(refused))
        t, q, owners, numbers = t[free], q[free], owners[free], numbers[free]
    samples = _Samples(t, owners, numbers, carriers(prover.scene, q, t)) if len(t) else None
    return samples, refused


def _screen_group(
    prover: Prover, solids: Solids, drafts: Sequence[Timed], members: list[tuple[int, Phase]], step: float
) -> dict[int, Screened]:
    samples, result = _sampled(prover, drafts, members, step)
    if samples is None:
        return result
    a, b = prover.asked(solids)
    required, like = _required(prover, solids, members, a, b)
    near = np.flatnonzero(~(swept_gaps(solids, samples.where, a, b) - SLACK_M > required.max(0)))
    rough = rough_gaps(solids, samples.where, a[near], b[near])
    wanted = required[:, near] if len(required) == 1 else required[like[samples.phase]][:, near]
    row, which = np.nonzero(~(rough - SLACK_M > wanted))
    if not len(row):
        return result
    which = near[which]
    one, other = place(solids, samples.where, row, a[which]), place(solids, samples.where, row, b[which])
    need = required[like[samples.phase[row]], which]
    gap = likely_gaps(one, other)
    bad = np.flatnonzero(~(gap - SLACK_M > need))
    if not len(bad):
        return result
    close = _Close(row[bad], gap[bad], need[bad], one.rows(bad), other.rows(bad))
    return result | _confirmed(prover, solids, members, samples, close)


@dataclass(frozen=True, slots=True)
class _Close:
    """Pairs (r,) that no likely normal parts: the number of the sample, the gap found, what is needed, m, and where
    both are."""

    row: IntArray
    gap: FloatArray
    need: FloatArray
    one: Placed
    other: Placed


def _confirmed(
    prover: Prover, solids: Solids, members: list[tuple[int, Phase]], samples: _Samples, close: _Close
) -> dict[int, Screened]:
    """What becomes of the drafts that have a close pair."""
    owner, body = samples.owner[close.row], solids.body[close.other.unit]
    # rows of one draft and body together, deepest first
    encounter = owner * len(solids.names) + body
    order = np.lexsort((close.gap, encounter))
    first = np.flatnonzero(np.append(True, np.diff(encounter[order]) > 0))
    deepest = order[first]
    touch = meet(close.one.rows(deepest), close.other.rows(deepest))
    hit = np.zeros(len(samples.owner), dtype=bool)
    hit[close.row] = True
    count = np.bincount(samples.owner)[: owner.max() + 1]
    # a draft that left its assembly has no samples here
    shares = np.bincount(samples.owner[hit], minlength=owner.max() + 1) / np.maximum(count, 1)
    met: dict[int, list[int]] = {}
    for k in np.argsort(close.gap[deepest], kind="stable").tolist():
        met.setdefault(int(owner[deepest[k]]), []).append(k)
    found = {}
    for draft, encounters in met.items():
        confirmed: list[tuple[float, Refusal]] = []
        for k in encounters[:MOST_BODIES]:
            # a few rows of each body that is in the way, deepest first, until one is confirmed
            last = first[k + 1] if k + 1 < len(first) else len(order)
            for i in order[first[k] : min(last, first[k] + MOST_ASKED)].tolist():
                phase = members[int(samples.phase[close.row[i]])][1]
                refusal = _ask(prover, solids, phase, samples, close, i, known=bool(touch[k]) and i == deepest[k])
                if refusal is not None:
                    confirmed.append((float(close.gap[i]), refusal))
                    break
        confirmed.sort(key=lambda pair: pair[0])
        refusals = [refusal for _, refusal in confirmed]
        found[draft] = Screened(refusals[0] if refusals else None, float(shares[draft]), tuple(refusals[1:]))
    return found


MOST_ASKED = 4
"""Rows of one draft and body about which FCL is asked, deepest first; the prover asks about the others."""
MOST_BODIES = 3
"""Bodies about which FCL is asked for one draft: one refuses it, the others are told in the census."""


def _required(
    prover: Prover, solids: Solids, members: list[tuple[int, Phase]], a: IntArray, b: IntArray
) -> tuple[FloatArray, IntArray]:
    """Distances, m, in rows (kinds of phase, pairs), -inf for pairs that may touch; the kind of each phase."""
    scene = prover.scene
    drifts = not is_certain(scene)
    known: dict[tuple[object, ...], int] = {}
    found: list[FloatArray] = []
    like = np.zeros(len(members), dtype=np.int64)
    own = solids.carrier[b] < solids.links
    frame = np.maximum(solids.carrier[b] - solids.links, 0)
    for k, (_, phase) in enumerate(members):
        key = (phase.near, phase.glued, phase.beside, phase.exempt, phase.t1 if drifts else None)
        if key not in known:
            by_frame = np.array([worst(scene, phase, name) for name in scene.frames])
            need = np.where(own, clearance(scene, phase), by_frame[frame])
            if phase.exempt:
                need[exempted(solids, phase, a, b)] = -np.inf
            known[key] = len(found)
            found.append(need)
        like[k] = known[key]
    return np.array(found), like


def _ask(
    prover: Prover, solids: Solids, phase: Phase, samples: _Samples, close: _Close, i: int, *, known: bool
) -> Refusal | None:
    """What FCL, and where it says free GJK, say about row `i`; boxes of several pieces are opened first. `known`: that
    the two touch."""
    one, other, need, time_row = close.one, close.other, float(close.need[i]), int(close.row[i])
    gap = {i: float(close.gap[i])}
    first, second = int(one.unit[i]), int(other.unit[i])
    if solids.piece[first] == COVER or solids.piece[second] == COVER:
        pairs = [(x, y) for x in _opened(solids, first) for y in _opened(solids, second)]
        row = np.full(len(pairs), time_row)
        one = place(solids, samples.where, row, np.array([x for x, _ in pairs]))
        other = place(solids, samples.where, row, np.array([y for _, y in pairs]))
        gaps = likely_gaps(one, other)
        gap = {k: float(gaps[k]) for k in range(len(pairs))}
        order = np.argsort(gaps, kind="stable")
        rows = order[~(gaps[order] - SLACK_M > need)]
    else:
        rows = np.array([i])
    names = (solids.names[solids.body[first]], solids.names[solids.body[second]])
    reason = Reason.SELF_COLLISION if solids.body[second] < solids.robot_bodies else Reason.BODY_COLLISION
    t = float(samples.t[time_row])
    # the standstill after the last leg belongs to the last step
    step = phase.step if phase.step >= 0 else len(prover.scene.task) - 1
    for k in rows:
        if known or prover.collider.touch(one, other, int(k)):
            depth = need - float(gap[int(k)])
            return Refusal("screening", reason, step, names, (t, t), depth, "m", "touch")
        distance, _ = separate(one, other, int(k))
        if not distance - SLACK_M > need:
            return Refusal("screening", reason, step, names, (t, t), float(need - distance), "m", "too close")
    return None


def _opened(solids: Solids, unit: int) -> tuple[int, ...]:
    return solids.pieces[int(solids.body[unit])] if solids.piece[unit] == COVER else (unit,)

"""Refuses most colliding drafts in one NumPy batch: all drafts × sampled times × pairs of bodies.

First the vertical order and the distance between bounding circles, for all rows at once; then, for what is left, the
likely normals. Where no normal parts a pair, FCL decides (design: screen, ask, prove). What passes is not yet proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from planner.arrays import FloatArray, IntArray
from planner.certificate import Prover
from planner.gjk import separate
from planner.loops import lost_at
from planner.outcome import Reason, Refusal
from planner.phases import Phase
from planner.requirement import SLACK_M, clearance, is_certain, worst
from planner.separation import Placed, likely_gaps, place, rough_gaps, swept_gaps
from planner.solids import COVER, Carriers, Solids, carriers, exempted

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
    times, joints, owner, number = [], [], [], []
    for k, (draft, phase) in enumerate(members):
        count = max(2, int(np.ceil((phase.t1 - phase.t0) / step)) + 1)
        t = np.linspace(phase.t0, phase.t1, count)
        times.append(t)
        joints.append(drafts[draft].at(t))
        owner.append(np.full(count, draft))
        number.append(np.full(count, k))
    t, q, owners = np.concatenate(times), np.concatenate(joints), np.concatenate(owner)
    numbers, refused = np.concatenate(number), {}
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
    required = _required(prover, solids, members, a, b)
    near = np.flatnonzero(~(swept_gaps(solids, samples.where, a, b) - SLACK_M > required.max(0)))
    rough = rough_gaps(solids, samples.where, a[near], b[near])
    row, which = np.nonzero(~(rough - SLACK_M > required[:, near][samples.phase]))
    if not len(row):
        return result
    which = near[which]
    one, other = place(solids, samples.where, row, a[which]), place(solids, samples.where, row, b[which])
    need = required[samples.phase[row], which]
    gap = likely_gaps(one, other)
    bad = ~(gap - SLACK_M > need)
    row, which, gap, need, one, other = row[bad], which[bad], gap[bad], need[bad], one.rows(bad), other.rows(bad)
    for draft in np.unique(samples.owner[row]):
        mine = np.flatnonzero(samples.owner[row] == draft)
        share = len(np.unique(row[mine])) / max(1, int((samples.owner == draft).sum()))
        order = mine[np.argsort(gap[mine], kind="stable")]
        confirmed: list[Refusal] = []
        asked: dict[int, int] = {}
        for i in order:
            # a few rows of each body that is in the way, deepest first, until one is confirmed
            body = int(solids.body[other.unit[i]])
            if asked.get(body, 0) >= MOST_ASKED or (len(asked) >= MOST_BODIES and body not in asked):
                continue
            asked[body] = asked.get(body, 0) + 1
            phase = members[int(samples.phase[row[i]])][1]
            refusal = _ask(prover, solids, phase, samples, int(row[i]), one, other, int(i), gap[i], float(need[i]))
            if refusal is not None:
                confirmed.append(refusal)
                asked[body] = MOST_ASKED
        result[int(draft)] = Screened(confirmed[0] if confirmed else None, share, tuple(confirmed[1:]))
    return result


MOST_ASKED = 4
"""Rows of one draft and body about which FCL is asked, deepest first; the prover asks about the others."""
MOST_BODIES = 3
"""Bodies about which FCL is asked for one draft: one refuses it, the others are told in the census."""


def _required(prover: Prover, solids: Solids, members: list[tuple[int, Phase]], a: IntArray, b: IntArray) -> FloatArray:
    """(phases, pairs) metres; -inf for pairs that may touch."""
    scene = prover.scene
    drifts = not is_certain(scene)
    known: dict[tuple[object, ...], FloatArray] = {}
    found = np.zeros((len(members), len(a)))
    own = solids.carrier[b] < solids.links
    frame = np.maximum(solids.carrier[b] - solids.links, 0)
    for k, (_, phase) in enumerate(members):
        key = (phase.near, phase.glued, phase.beside, phase.t1 if drifts else None)
        if key not in known:
            by_frame = np.array([worst(scene, phase, name) for name in scene.frames])
            known[key] = np.where(own, clearance(scene, phase), by_frame[frame])
        found[k] = known[key]
        if phase.exempt:
            found[k, exempted(solids, phase, a, b)] = -np.inf
    return found


def _ask(
    prover: Prover,
    solids: Solids,
    phase: Phase,
    samples: _Samples,
    time_row: int,
    one: Placed,
    other: Placed,
    i: int,
    gap_i: float,
    need: float,
) -> Refusal | None:
    """What FCL, and where it says free GJK, say about row `i`; boxes of several pieces are opened first."""
    gap = {i: gap_i}
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
        if prover.collider.touch(one, other, int(k)):
            depth = need - float(gap[int(k)])
            return Refusal("screening", reason, step, names, (t, t), depth, "m", "touch")
        distance, _ = separate(one, other, int(k))
        if not distance - SLACK_M > need:
            return Refusal("screening", reason, step, names, (t, t), float(need - distance), "m", "too close")
    return None


def _opened(solids: Solids, unit: int) -> tuple[int, ...]:
    return solids.pieces[int(solids.body[unit])] if solids.piece[unit] == COVER else (unit,)

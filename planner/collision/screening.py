"""Refuses most colliding candidates at sampled instants: a kernel finds what is too near, FCL says if it touches.

What passes is not yet proved (design: screen, ask, prove).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover
from assur.planner.kernels.proof import RESERVE_M
from assur.planner.kernels.screening import (
    HIT_A,
    HIT_AT,
    HIT_B,
    HIT_COLUMNS,
    HIT_GAP,
    HIT_NEED,
)
from assur.planner.model.assembly_mode import lost_at
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Bodies, Quantity, Reason, Refusal, Separation, Stage

STEP_S = 0.02
"""Sampling of candidates, s. It decides how much work a colliding candidate causes, not what is accepted."""
MOST_BODIES = 3
"""Bodies about which FCL is asked for one candidate: one refuses it, the others are reported in the census."""
EVERY = 1 << 30
"""Instants with a hit after which no further ones are evaluated: none, for the census names the deepest."""
MOST_HITS = 64
"""Pairs of one phase of which the deepest hit is kept."""


class Timed(Protocol):
    """A timed motion in phases."""

    @property
    def phases(self) -> tuple[Phase, ...]: ...

    def at(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,)."""
        ...


@dataclass(frozen=True, slots=True)
class Screened:
    """What became of a candidate: None, or why it is refused; and the share of samples at which it was in the way."""

    refusal: Refusal | None
    bad: float
    also: tuple[Refusal, ...] = ()
    """The deepest confirmed encounters with other bodies of the surroundings."""


def screen(prover: Prover, candidates: Sequence[Timed], step: float = STEP_S) -> list[Screened]:
    """One `Screened` for each candidate, in order."""
    return [_screened(prover, candidate, step) for candidate in candidates]


@dataclass(frozen=True, slots=True)
class _Hit:
    """Units a and b are `gap` m apart at time t with joints q, `need` is required: the deepest with the body of b."""

    gap: float
    need: float
    a: int
    b: int
    t: float
    q: FloatArray
    phase: Phase


def _screened(prover: Prover, candidate: Timed, step: float) -> Screened:
    times = [_instants(phase, step) for phase in candidate.phases]
    every = candidate.at(np.concatenate(times))
    lost = _lost(prover, candidate, times, every)
    if lost is not None:
        return lost
    evaluated = bad = first = 0
    deepest: dict[str, _Hit] = {}
    for phase, t in zip(candidate.phases, times, strict=True):
        q, first = every[first : first + len(t)], first + len(t)
        many, hit, rows = hits(prover, phase, q, t)
        evaluated, bad = evaluated + many, bad + hit
        names, body = prover.of(phase).names, prover.of(phase).body
        for row in rows:
            k, name = int(row[HIT_AT]), names[body[int(row[HIT_B])]]
            if name not in deepest or row[HIT_GAP] < deepest[name].gap:
                gap, need = float(row[HIT_GAP]), float(row[HIT_NEED])
                deepest[name] = _Hit(gap, need, int(row[HIT_A]), int(row[HIT_B]), float(t[k]), q[k], phase)
    if not deepest:
        return Screened(None, 0.0)
    order = sorted(deepest.values(), key=lambda hit: hit.gap)[:MOST_BODIES]
    refusals = [_refusal(prover, hit) for hit in order]
    return Screened(refusals[0], bad / evaluated, tuple(refusals[1:]))


def _instants(phase: Phase, step: float) -> FloatArray:
    """Sampled times of a phase, its ends among them."""
    count = max(2, int(np.ceil((phase.t1 - phase.t0) / step)) + 1)
    t = np.linspace(phase.t0, phase.t1, count)
    t[-1] = phase.t1
    return t


def _lost(prover: Prover, candidate: Timed, times: list[FloatArray], q: FloatArray) -> Screened | None:
    """The refusal of a candidate that does not stay assembled on its way."""
    if not prover.has_loop:
        return None
    robot = prover.scene.robot
    kept = robot.assembled(q, q)
    if kept.all():
        return None
    t = np.concatenate(times)
    number = np.repeat(np.arange(len(times)), [len(each) for each in times])[~kept][0]
    step = candidate.phases[int(number)].step
    refusal = lost_at(robot, Stage.SCREENING, step, t[~kept], robot.parallel_margin(q[~kept]))
    return Screened(refusal, float((~kept).mean()))


def hits(
    prover: Prover, phase: Phase, q: FloatArray, t: FloatArray, enough: int = EVERY
) -> tuple[int, int, FloatArray]:
    """What is too near at instants t (T,) with joints q (T, n): instants evaluated, those with a hit, hits."""
    arrangement = prover.of(phase)
    found = np.empty((MOST_HITS, HIT_COLUMNS))
    q, t = np.ascontiguousarray(q), np.ascontiguousarray(t)
    evaluated, bad, count = prover.screened(arrangement, prover.near(phase, q, t), q, t, phase.t1, enough, found)
    return evaluated, bad, found[:count]


def _refusal(prover: Prover, hit: _Hit) -> Refusal:
    """A confirmed hit as a refusal: FCL says whether the true shapes touch."""
    arrangement, phase = prover.of(hit.phase), hit.phase
    first, second = int(arrangement.body[hit.a]), int(arrangement.body[hit.b])
    names = (arrangement.names[first], arrangement.names[second])
    reason = Reason.SELF_COLLISION if arrangement.of_robot[second] else Reason.BODY_COLLISION
    # the standstill after the last leg belongs to the last step
    step = phase.step if phase.step >= 0 else len(prover.scene.task) - 1
    # what has a gap does not touch
    touching = not hit.gap > 0.0 and prover.touch(arrangement, hit.q, hit.t, hit.a, hit.b)
    required = hit.need - RESERVE_M
    return Refusal(
        stage=Stage.SCREENING,
        reason=reason,
        step=step,
        subject=Bodies(names),
        interval=(hit.t, hit.t),
        amount=Quantity.of(max(0.0, required - hit.gap), "m"),
        facts=Separation(touching=touching, gap_m=hit.gap, required_m=required),
    )

"""Refuses most colliding candidates: a kernel finds what is too near at sampled instants, FCL says if it touches.

The instants are the middles of intervals that are halved down to a step, as in a proof, whose bounds leave out all
instants at which a pair cannot be too near. What passes is not yet proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from assur.planner.collision.proof import Prover
from assur.planner.kernels.intervals import RESERVE_M
from assur.planner.kernels.screening import HIT_A, HIT_B, HIT_GAP, HIT_NEED, HIT_T
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Bodies, Quantity, Reason, Refusal, Separation, Stage
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.spline import Spline

STEP_S = 0.04
"""Sampling of candidates, s. It decides how much work a colliding candidate causes, not what is accepted."""
MOST_BODIES = 3
"""Bodies about which FCL is asked for one candidate: one refuses it, the others are reported in the census."""


class Timed(Protocol):
    """A timed motion in phases."""

    @property
    def phases(self) -> tuple[Phase, ...]: ...

    @property
    def trajectory(self) -> Trajectory:
        """Before it and after it the arm stands still."""
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
    """Units a and b are `gap` m apart at time t, `need` is required: the deepest with the body of b."""

    gap: float
    need: float
    a: int
    b: int
    t: float
    phase: Phase


def _screened(prover: Prover, candidate: Timed, step: float) -> Screened:
    lost = _lost(prover, candidate)
    if lost is not None:
        return lost
    spline, bad, length = prover.spline(candidate.trajectory), 0.0, 0.0
    deepest: dict[str, _Hit] = {}
    for phase in candidate.phases:
        rows, share = prover.screened(phase, candidate.trajectory, step)
        # a phase of no length counts as one step
        lasts = max(phase.t1 - phase.t0, step)
        bad, length = bad + share * lasts, length + lasts
        arrangement = prover.of(phase)
        for row in rows.tolist():
            name = arrangement.names[arrangement.body[int(row[HIT_B])]]
            if name not in deepest or row[HIT_GAP] < deepest[name].gap:
                deepest[name] = _Hit(row[HIT_GAP], row[HIT_NEED], int(row[HIT_A]), int(row[HIT_B]), row[HIT_T], phase)
    if not deepest:
        return Screened(None, 0.0)
    order = sorted(deepest.values(), key=lambda hit: hit.gap)[:MOST_BODIES]
    refusals = [_refusal(prover, hit, spline) for hit in order]
    return Screened(refusals[0], bad / length, tuple(refusals[1:]))


def _lost(prover: Prover, candidate: Timed) -> Screened | None:
    """The refusal of a candidate that does not stay assembled on its way."""
    lost = leaves_assembly(prover.scene.robot, candidate.phases[0].step, candidate.trajectory)
    return None if lost is None else Screened(replace(lost, stage=Stage.SCREENING), 1.0)


def _refusal(prover: Prover, hit: _Hit, spline: Spline) -> Refusal:
    """A confirmed hit as a refusal: FCL says whether the true shapes touch."""
    arrangement, phase = prover.of(hit.phase), hit.phase
    first, second = int(arrangement.body[hit.a]), int(arrangement.body[hit.b])
    names = (arrangement.names[first], arrangement.names[second])
    reason = Reason.SELF_COLLISION if arrangement.of_robot[second] else Reason.BODY_COLLISION
    # the standstill after the last leg belongs to the last step
    step = phase.step if phase.step >= 0 else len(prover.scene.task) - 1
    # what has a gap does not touch
    touching = not hit.gap > 0.0 and prover.touch(arrangement, spline, hit.t, hit.a, hit.b)
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

"""Refuses colliding candidates: a kernel finds an instant at which something is too near, FCL says if it touches.

The instants are the middles of intervals that are halved, as in a proof, whose bounds leave out all instants at which a
pair cannot be too near. What passes is not yet proved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover
from assur.planner.kernels.intervals import RESERVE_M
from assur.planner.kernels.screening import HIT_A, HIT_B, HIT_GAP, HIT_NEED, HIT_T
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Bodies, Quantity, Reason, Refusal, Separation, Stage
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.spline import Spline

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
    """What became of a candidate: None, or why it is refused."""

    refusal: Refusal | None
    also: tuple[Refusal, ...] = ()
    """With other bodies of the surroundings at that instant."""


def screen(prover: Prover, candidates: Sequence[Timed]) -> list[Screened]:
    """One `Screened` for each candidate, in order."""
    return [_screened(prover, candidate) for candidate in candidates]


@dataclass(frozen=True, slots=True)
class _Hit:
    """Units a and b are `gap` m apart at time t, `need` is required: the deepest with the body of b."""

    gap: float
    need: float
    a: int
    b: int
    t: float
    phase: Phase


def _screened(prover: Prover, candidate: Timed) -> Screened:
    lost = leaves_assembly(prover.scene.robot, candidate.phases[0].step, candidate.trajectory)
    if lost is not None:
        return Screened(replace(lost, stage=Stage.SCREENING))
    for phase in candidate.phases:
        hits = prover.screened(phase, candidate.trajectory)
        if len(hits):
            return _refused(prover, phase, prover.spline(candidate.trajectory), hits)
    return Screened(None)


def _refused(prover: Prover, phase: Phase, spline: Spline, hits: FloatArray) -> Screened:
    """The refusal for hits (H, HIT_COLUMNS) at an instant: the deepest with each body of the surroundings."""
    arrangement, deepest = prover.of(phase), dict[str, _Hit]()
    for row in hits.tolist():
        name = arrangement.names[arrangement.body[int(row[HIT_B])]]
        if name not in deepest or row[HIT_GAP] < deepest[name].gap:
            deepest[name] = _Hit(row[HIT_GAP], row[HIT_NEED], int(row[HIT_A]), int(row[HIT_B]), row[HIT_T], phase)
    order = sorted(deepest.values(), key=lambda hit: hit.gap)[:MOST_BODIES]
    refusals = [_refusal(prover, hit, spline) for hit in order]
    return Screened(refusals[0], tuple(refusals[1:]))


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

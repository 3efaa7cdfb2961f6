"""Arches: the lift joint goes up and down while the others go across, timed apart and laid over each other.

On a standard cycle of 25/300/25 mm, overlapping the corners takes half of the time that stopping at them does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.legs.pace import Pace, part
from assur.planner.model.joint_range import beyond
from assur.planner.model.refusal import JointName, Quantity, Reason, Refusal, Stage
from assur.planner.model.scene import Scene
from assur.planner.model.task import Arch
from assur.planner.timing import Numbers, RawProfile, TimingRefusal

SPARE_S = 1e-12
"""A motion across that is shorter than its time by more than this is timed again, s: before a moving end nothing can
stand still."""


@dataclass(frozen=True, slots=True)
class Hop:
    """Over an arch: the lift joint goes to `top`, the other joints set out when `rise` of the way up (in time) is done
    and arrive when `fall` of the way down is left. 1: corners are stopped at; 0: full overlap."""

    top: float
    rise: float
    fall: float


def height_of(scene: Scene, arch: Arch, q: FloatArray) -> float:
    """The lift joint's value at the top of an arch, m; `q` (n,): any joint position: the lift moves the flange one to
    one, so heights differ by a constant."""
    flange, _ = scene.robot.forward(q)
    return arch.top_m - scene.tool.tcp.z - (float(flange[2]) - float(q[scene.robot.lift or 0]))


def too_high(scene: Scene, number: int, q: FloatArray, rounding: float = 0.0) -> Refusal | None:
    """Why the arch that step `number` asks for cannot be: the lift ends more than `rounding`, m, below it;
    None: it can, or none is asked. `q` (n,): any joint position."""
    lift, arch = scene.robot.lift, scene.task[number].arch
    if lift is None or arch is None:
        return None
    over = height_of(scene, arch, q) - float(scene.robot.limits.upper[lift])
    if not over > rounding:
        return None
    return Refusal(
        stage=Stage.INVERSE,
        reason=Reason.JOINT_LIMIT,
        step=number,
        subject=JointName(scene.robot.joints[lift].name),
        amount=Quantity.of(over, "m"),
        facts=replace(beyond(scene, lift, height_of(scene, arch, q)), arch_top_m=arch.top_m),
    )


Vertical = tuple[RawProfile, RawProfile]
"""The lift joint's motion up and its motion down."""


def vertical(start: Numbers, goal: Numbers, top: float, pace: Pace) -> Vertical | TimingRefusal:
    """The fastest motions of the lift joint from the start up to `top` and from there down to the goal."""
    high = [top], [0.0], [0.0]
    up = pace.lifting.raw_profile(part(start, pace.lift), high)
    if isinstance(up, TimingRefusal):
        return up
    down = pace.lifting.raw_profile(high, part(goal, pace.lift))
    return down if isinstance(down, TimingRefusal) else (up, down)


def arch(
    start: Numbers,
    goal: Numbers,
    hop: Hop,
    pace: Pace,
    duration: float | None,
    lifted: Vertical | TimingRefusal | None = None,
) -> RawProfile | TimingRefusal:
    """The arch from one joint state to another, the fastest or the one that takes `duration` seconds.

    The lift joint goes up and down, the others across, overlapping at the corners where both ends of the motion across
    are at rest; at a moving end there is no time to spare, so the joints across fill it. `lifted`: from `vertical`,
    where it is known already.
    """
    lifted = vertical(start, goal, hop.top, pace) if lifted is None else lifted
    if isinstance(lifted, TimingRefusal):
        return lifted
    up, down = lifted
    begin, end = part(start, pace.others), part(goal, pace.others)
    resting, arriving = (not (any(state[1]) or any(state[2])) for state in (begin, end))
    before = hop.rise * up.duration if resting else 0.0
    after = hop.fall * down.duration if arriving else 0.0
    across = pace.across.raw_profile(begin, end)
    if isinstance(across, TimingRefusal):
        return across
    total = max(before + across.duration + after, up.duration + down.duration)
    if duration is not None:
        if total > duration:
            return TimingRefusal("too short", total - duration, "the arch takes longer")
        total = duration
    if not resting or not arriving:
        # moving ends leave no time to spare at that end: the joints across fill it
        required = total - before - after
        if required > across.duration + SPARE_S:
            across = pace.across.raw_profile(begin, end, required)
            if isinstance(across, TimingRefusal):
                return across
    return _laid_over(start, goal, (up, down), across, before, total, pace)


def _laid_over(
    start: Numbers, goal: Numbers, lifted: Vertical, across: RawProfile, before: float, total: float, pace: Pace
) -> RawProfile:
    """Up from 0, down to the end, the joints across from `before` on; in between each stands still."""
    up, down = lifted
    stands, flat = up.phases.shape[2], across.phases.shape[2]
    phases = np.zeros((len(start[0]), 2, max(stands + 1 + down.phases.shape[2], 1 + flat)))
    phases[pace.lift, :, :stands] = up.phases
    spent = float(up.phases[0, 0].sum() + down.phases[0, 0].sum())
    phases[pace.lift, 0, stands] = max(0.0, total - spent)
    phases[pace.lift, :, stands + 1 : stands + 1 + down.phases.shape[2]] = down.phases
    phases[pace.others, 0, 0] = before
    phases[pace.others, :, 1 : 1 + flat] = across.phases
    return RawProfile(total, start, goal, phases)

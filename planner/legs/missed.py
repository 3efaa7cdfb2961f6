"""Windows that are missed: why, and by how much at least."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.laws.belt_window import HORIZON_S, PARTS, ROUNDS
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.line import ScaledLimits, part
from assur.planner.model.refusal import JointName, LawEnds, Quantity, Reason, Refusal, Stage, law_ends, window_missed
from assur.planner.model.scene import Scene, beyond
from assur.planner.model.task import Arch
from assur.planner.model.window_missed import FOR_ALL_TIMES, Miss, WindowMissed
from assur.planner.timing import Numbers, RawProfile, TimingRefusal


def window_is_missed(scene: Scene, point: ControlPoint, earliest: float) -> Refusal:
    """Why no meeting time is left: the window is over before `earliest`, or the dwell does not fit into it."""
    intervals, valid = point.intervals, scene.frames[point.frame].law.valid
    if not intervals:
        ended = _law_ends_too_soon(scene, point)
        if ended is not None:
            return ended
        whole = replace(point, dwell=0.0).intervals
        if not whole:
            amount, facts = _never_open(scene, point)
            return window_missed(Stage.WINDOW, point.step, facts, amount=amount)
        low, high = max(whole, key=lambda span: span[1] - span[0])
        short, belt = point.dwell - (high - low), _belt(point, high, high + point.dwell - (high - low))
        searched = None if point.outside_for_good else HORIZON_S
        facts = WindowMissed(
            miss=Miss.TOO_SHORT, open_s=high - low, needed_s=point.dwell, belt_m=belt, searched_s=searched
        )
        return window_missed(Stage.WINDOW, point.step, facts, amount=Quantity.of(short, "s"), interval=(low, high))
    low, high = intervals[-1]
    latest = scene.options.latest_end_s
    # the same difference as that of the intervals, to the bit
    if high == valid[1] - point.dwell:
        return law_ends_on_arrival(point, earliest + point.dwell, (low, high))
    by_latest = latest is not None and high == latest - point.dwell
    miss = Miss.LATEST_END_ON_ARRIVAL if by_latest else Miss.CLOSED_ON_ARRIVAL
    facts = WindowMissed(miss=miss, belt_m=_belt(point, high, earliest))
    late = Quantity.of(earliest - high, "s")
    return window_missed(Stage.WINDOW, point.step, facts, amount=late, interval=(low, high))


def by_law(point: ControlPoint, last: float | None, refusal: Refusal) -> Refusal:
    """The refusal of a way that takes too long for the last meeting; where that is at `last`, s, because the motion of
    the frame is not known for longer, the frame is to blame."""
    facts, late, interval = refusal.facts, refusal.amount, refusal.interval
    if not (isinstance(facts, WindowMissed) and facts.miss is Miss.NO_MEETING_LEFT) or late is None or interval is None:
        return refusal
    if interval[1] != last:
        return refusal
    ends = point.scene.frames[point.frame].law.valid[1]
    return replace(law_ends_on_arrival(point, ends + late.value, interval), stage=refusal.stage)


def law_ends_on_arrival(point: ControlPoint, needed: float, interval: tuple[float, float] | None) -> Refusal:
    """The refusal of an arm that comes so late that the motion of the point's frame would be needed until `needed`."""
    valid = point.scene.frames[point.frame].law.valid
    return law_ends(
        Stage.WINDOW, point.step, point.frame, valid, needed, interval=interval, tracked=point.dwell, on_arrival=True
    )


def _law_ends_too_soon(scene: Scene, point: ControlPoint) -> Refusal | None:
    """The refusal of a frame whose motion is known for too short a time: if it went on, the point could be met. None:
    something else is to blame for it that the point is met at no time."""
    frame = scene.frames[point.frame]
    law = frame.law
    if law.valid[1] == math.inf:
        return None
    if not law.valid[1] >= scene.start.time:
        return law_ends(Stage.WINDOW, point.step, point.frame, law.valid, scene.start.time, tracked=point.dwell)
    latest, closes = scene.options.latest_end_s, math.inf if point.window.time is None else point.window.time[1]
    low, high = point.span[0], min(closes, math.inf if latest is None else latest)
    spans = [(low, high)]
    if point.window.along is not None:
        if law.way is None:
            return None  # no other law has a way along it
        endless = replace(frame, law=replace(law, valid=(law.valid[0], math.inf)))
        goes_on = replace(point, scene=replace(scene, frames={**scene.frames, point.frame: endless}))
        spans = [(max(low, a), min(high, b)) for a, b in goes_on.inside(point.window.along)]
    begins = [a for a, b in spans if b - point.dwell >= a]
    if not begins:
        return None
    needed = min(begins) + point.dwell
    return law_ends(Stage.WINDOW, point.step, point.frame, law.valid, needed, tracked=point.dwell)


def never_in_window(scene: Scene, point: ControlPoint) -> Refusal | None:
    """Why the window of a point is missed whenever the arm comes; None: it is open for long enough at some time, or
    nobody knows."""
    if point.intervals:
        return None
    refusal = window_is_missed(scene, point, scene.start.time)
    return refusal if holds_for_all_times(refusal) else None


def holds_for_all_times(refusal: Refusal) -> bool:
    """Whether the miss of a window does not depend on when, or whether, the arm comes."""
    # how early the arm can come depends on how it comes; that a window is over or too short does not
    return (isinstance(refusal.facts, LawEnds) and not refusal.facts.on_arrival) or (
        isinstance(refusal.facts, WindowMissed)
        and refusal.facts.miss in FOR_ALL_TIMES
        and refusal.facts.searched_s is None
    )


def _never_open(scene: Scene, point: ControlPoint) -> tuple[Quantity | None, WindowMissed]:
    """By how much and why the point may be met at no time, however short it would have to be tracked.

    A number is a fact for all times; there is none where some of them are unknown or were not evaluated.
    """
    (low, high), start, latest = point.span, scene.start.time, scene.options.latest_end_s
    ends = scene.frames[point.frame].law.valid[1]
    if point.window.time is not None and point.window.time[1] < start:
        return Quantity.of(start - point.window.time[1], "s"), WindowMissed(miss=Miss.OVER_BEFORE_START)
    if latest is not None and high == latest < low:
        miss = Miss.OPENS_AFTER_LATEST_END if low > start else Miss.LATEST_END_BEFORE_START
        return Quantity.of(low - latest, "s"), WindowMissed(miss=miss)
    if high < low:
        return None, WindowMissed(miss=Miss.OPENS_AFTER_LAW)
    if point.window.along is None:
        raise FaultError("a span that is not empty, without a window along a conveyor, is one of the intervals")
    inside = point.inside(point.window.along)
    if not inside:
        return _never_inside(point, point.window.along)
    if high == ends:
        return None, WindowMissed(miss=Miss.NOT_INSIDE_WHILE_KNOWN)
    if high > start + HORIZON_S:
        return None, WindowMissed(miss=Miss.NOT_INSIDE_SOON, searched_s=HORIZON_S)
    gap = min(max(a - high, low - b) for a, b in inside)
    closes = math.inf if point.window.time is None else point.window.time[1]
    if any(a <= closes and b >= low for a, b in inside):
        return Quantity.of(gap, "s"), WindowMissed(miss=Miss.ENTERS_AFTER_LATEST_END)
    return Quantity.of(gap, "s"), WindowMissed(miss=Miss.NO_COMMON_INSTANT)


def _never_inside(point: ControlPoint, window: tuple[float, float]) -> tuple[Quantity | None, WindowMissed]:
    """The same for a point that is in its window along a conveyor at no time that is searched."""
    grid = point.scene.start.time + HORIZON_S * np.arange(1001) / 1000
    way = point.along(grid)
    if way is None or not np.isfinite(way).all():
        return None, WindowMissed(miss=Miss.NOT_INSIDE_WHILE_KNOWN)
    if not point.outside_for_good:
        return None, WindowMissed(miss=Miss.NOT_INSIDE_SOON, searched_s=HORIZON_S)
    return Quantity.of(_stays_away(point, window, grid, way), "m"), WindowMissed(miss=Miss.NEVER_INSIDE)


def _stays_away(point: ControlPoint, window: tuple[float, float], grid: FloatArray, way: FloatArray) -> float:
    """How far, m, a point stays outside its window along a conveyor; between two times of a grid it is looked for
    again and again."""
    low, high = window
    for _ in range(ROUNDS):
        away = np.maximum(low - way, way - high)
        k = int(away.argmin())
        grid = np.linspace(grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)], PARTS + 1)
        finer = point.along(grid)
        if finer is None or not np.isfinite(finer).all():
            break
        way = finer
    return float(np.maximum(low - way, way - high).min())


def _belt(point: ControlPoint, t0: float, t1: float) -> float | None:
    """How far the point goes along its conveyor from t0 to t1, m."""
    way = point.along(np.array([t0, t1]))
    if way is None or not np.isfinite(way).all():
        return None
    return abs(float(way[1] - way[0]))


# Arches: the lift joint goes up and down while the others go across, timed apart and laid over each other.
#
# On a standard cycle of 25/300/25 mm, overlapping the corners takes half of the time that stopping at them does.

SPARE_S = 1e-12
"""A motion across that is shorter than its time by more than this is timed again, s: before a moving end nothing can
stand still."""


@dataclass(frozen=True, slots=True)
class ArchForm:
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


def too_high(scene: Scene, number: int, q: FloatArray) -> Refusal | None:
    """Why the arch that step `number` asks for cannot be: the lift ends below it; None: it can, or the
    step has none. `q` (n,): any joint position."""
    lift, arch = scene.robot.lift, scene.task[number].arch
    if lift is None or arch is None:
        return None
    over = height_of(scene, arch, q) - float(scene.robot.limits.upper[lift])
    if not over > 0.0:
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
SHORTEST_PART_S = 1e-3
"""s. Parts of an arch last at least so long: a part makes up for what its shared switches miss."""


def vertical(start: Numbers, goal: Numbers, top: float, scaled: ScaledLimits) -> Vertical | TimingRefusal:
    """The fastest motions of the lift joint from the start up to `top` and from there down to the goal."""
    high = [top], [0.0], [0.0]
    up = scaled.lifting.raw_profile(part(start, scaled.lift), high)
    if isinstance(up, TimingRefusal):
        return up
    down = scaled.lifting.raw_profile(high, part(goal, scaled.lift))
    return down if isinstance(down, TimingRefusal) else (up, down)


def arch(
    start: Numbers,
    goal: Numbers,
    form: ArchForm,
    scaled: ScaledLimits,
    duration: float | None,
    lifted: Vertical | TimingRefusal | None = None,
) -> RawProfile | TimingRefusal:
    """The arch from one joint state to another, the fastest or the one that takes `duration` seconds.

    The lift joint goes up and down, the others across, overlapping at the corners where both ends of the motion across
    are at rest; at a moving end there is no time to spare, so the joints across fill it. `lifted`: from `vertical`,
    where it is known already.
    """
    lifted = vertical(start, goal, form.top, scaled) if lifted is None else lifted
    if isinstance(lifted, TimingRefusal):
        return lifted
    up, down = lifted
    begin, end = part(start, scaled.others), part(goal, scaled.others)
    resting, arriving = (not (any(state[1]) or any(state[2])) for state in (begin, end))
    before = form.rise * up.duration if resting else 0.0
    after = form.fall * down.duration if arriving else 0.0
    across = scaled.across.raw_profile(begin, end)
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
            across = scaled.across.raw_profile(begin, end, required)
            if isinstance(across, TimingRefusal):
                return across
    return _laid_over(start, goal, (up, down), across, before, total, scaled)


def _laid_over(
    start: Numbers, goal: Numbers, lifted: Vertical, across: RawProfile, wait: float, total: float, scaled: ScaledLimits
) -> RawProfile:
    """Up from 0, down to the end, the joints across from `wait` on; in between each stands still."""
    up, down = lifted
    stands, flat = up.phases.shape[2], across.phases.shape[2]
    phases = np.zeros((len(start[0]), 2, max(stands + 1 + down.phases.shape[2], 1 + flat)))
    phases[scaled.lift, :, :stands] = up.phases
    spent = float(up.phases[0, 0].sum() + down.phases[0, 0].sum())
    phases[scaled.lift, 0, stands] = max(0.0, total - spent)
    phases[scaled.lift, :, stands + 1 : stands + 1 + down.phases.shape[2]] = down.phases
    phases[scaled.others, 0, 0] = wait
    phases[scaled.others, :, 1 : 1 + flat] = across.phases
    return ArchProfile(total, start, goal, phases, lifted, across, wait, scaled)


@dataclass(frozen=True, slots=True, eq=False)
class ArchProfile(RawProfile):
    """An arch: the lift joint up from 0, and down to the end, the joints `across` from `before` on.

    It is cut into parts at its top: where the lift joint comes there and leaves it, and where the others arrive in
    between. There the states are exact. What shared switches miss is made up for within the part, and what rests at the
    top does so to the bit, however long.
    """

    lifted: Vertical
    across: RawProfile
    before: float
    scaled: ScaledLimits

    @property
    def parts(self) -> list[RawProfile]:
        (up, down), across, scaled = self.lifted, self.across, self.scaled
        high, arrived = (up.duration, self.duration - down.duration), self.before + across.duration
        cuts = [0.0, self.duration]
        for t in (*high, min(max(arrived, high[0]), high[1])):
            if all(abs(t - cut) >= SHORTEST_PART_S for cut in cuts):
                cuts.append(t)
        cuts.sort()
        states = [self.begin]
        for t in cuts[1:-1]:
            others = across.begin if t <= self.before else across.goal if t >= arrived else across.at(t - self.before)
            states.append(_together(up.goal, others, scaled))
        states.append(self.goal)
        ends, edges = self.phases[:, 0].cumsum(1), np.array(cuts)[:, None, None]
        begins, own = ends - self.phases[:, 0], np.repeat(self.phases[None], len(cuts) - 1, axis=0)
        own[:, :, 0] = ends.clip(edges[:-1], edges[1:]) - begins.clip(edges[:-1], edges[1:])
        found = list[RawProfile]()
        for (t0, t1), (first, last), phases in zip(pairwise(cuts), pairwise(states), own, strict=True):
            if high[0] <= t0 and t1 <= high[1]:
                phases[scaled.lift] = 0.0
            if t1 <= self.before or t0 >= arrived:
                phases[scaled.others] = 0.0
            found.append(RawProfile(t1 - t0, first, last, phases))
        return found


def _together(lift: Numbers, others: Numbers, scaled: ScaledLimits) -> Numbers:
    """The state of all joints from that of the lift joint and that of the others."""
    rows = [row.copy() for row in others]
    for row, (value,) in zip(rows, lift, strict=True):
        row.insert(scaled.lift[0], value)
    return rows[0], rows[1], rows[2]

"""Random laws of every kind, and what their tests share: the times at which they switch, and samples of the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.laws import (
    Change,
    Law,
    Pose,
    conveyor,
    fixed,
    indexer,
    keyframes,
    linear,
    oscillation,
    swing,
    turntable,
)


@dataclass(frozen=True)
class Case:
    """A law, a stretch of time in which it does something, the times in it at which a derivative jumps, and the
    lowest derivative that jumps there (4: none does)."""

    law: Law
    window: tuple[float, float]
    switches: tuple[float, ...] = ()
    jumps: int = 4


def number(least: float, most: float) -> st.SearchStrategy[float]:
    return st.floats(least, most, allow_nan=False)


poses = st.builds(Pose, number(-1, 1), number(-1, 1), number(-1, 1), st.sampled_from([0.0, math.pi / 2, -0.7, 3.0]))
valid_kinds = (
    "fixed", "linear", "conveyor", "turntable", "turn", "travel", "swing", "oscillation", "keyframes", "repeated",
)  # fmt: skip


@st.composite
def changes(draw: st.DrawFn, speed: float) -> tuple[tuple[Change, ...], tuple[float, ...]]:
    """Commands that do not overlap, some back to back, some that change nothing; and the times of their phases."""
    made: list[Change] = []
    switches: list[float] = []
    time = draw(number(-1, 1))
    for _ in range(draw(st.integers(0, 3))):
        jerk = draw(st.sampled_from([2.0, 10.0, 400.0, math.inf]))
        change = Change(time, draw(st.sampled_from([0.0, 0.3, speed, -0.2, 1.0])), draw(number(0.5, 5.0)), jerk)
        made.append(change)
        for duration, _, _ in change.phases(speed):
            switches.append(time)
            time += duration
        switches.append(time)
        time += draw(st.sampled_from([0.0, 0.25, 1.0]))
        speed = change.speed
    return tuple(made), tuple(switches)


@st.composite
def cases(draw: st.DrawFn, kinds: tuple[str, ...] = valid_kinds) -> Case:
    kind, pose = draw(st.sampled_from(kinds)), draw(poses)
    if kind == "fixed":
        return Case(fixed(pose), (-2.0, 2.0))
    if kind == "linear":
        velocity = (draw(number(-1, 1)), draw(number(-1, 1)), draw(st.sampled_from([0.0, 0.1])))
        return Case(linear(pose, velocity, draw(number(-1, 1))), (-2.0, 2.0))
    if kind in ("conveyor", "turntable"):
        speed = draw(st.sampled_from([0.0, 0.25, -0.5, 1.0]))
        commands, switches = draw(changes(speed))
        jumps = 2 if any(change.jerk == math.inf for change in commands) else 3
        end = max((2.0, *switches)) + 0.5
        at_time = draw(st.sampled_from([0.0, *switches, 1.3]))
        if kind == "conveyor":
            return Case(conveyor(pose, speed, commands, at_time), (-2.0, end), switches, jumps)
        rise = draw(st.sampled_from([0.0, 0.02, -0.1]))
        return Case(turntable(pose, speed, rise, commands, at_time), (-2.0, end), switches, jumps)
    if kind in ("turn", "travel"):
        move, dwell, start = draw(number(0.2, 1.0)), draw(st.sampled_from([0.0, 0.5, 0.3])), draw(number(-1, 1))
        step = draw(st.sampled_from([0.8, -0.3, 0.0]))
        law = indexer(pose, step, move, dwell, "turn" if kind == "turn" else "travel", start)
        begins = [start + k * (move + dwell) for k in range(-5, 6)]
        switches = tuple(time for begin in begins for time in (begin, begin + move))
        return Case(law, (-2.0, 2.0), tuple(time for time in switches if -2.0 <= time <= 2.0))
    if kind == "swing":
        period = draw(number(0.5, 4.0))
        return Case(swing(pose, draw(st.sampled_from([0.9, -0.4, 0.0])), period, draw(number(-4, 4))), (-2.0, 2.0))
    if kind == "oscillation":
        along = draw(st.sampled_from([(0.0, 0.0, 1.0), (0.6, -0.8, 0.0), (-1.0, 0.3, 0.2)]))
        amplitude, period = draw(st.sampled_from([0.2, -0.05, 0.0])), draw(number(0.5, 4.0))
        return Case(oscillation(pose, along, amplitude, period, draw(number(-4, 4))), (-2.0, 2.0))
    steps = draw(st.lists(st.sampled_from([0.2, 0.5, 1.0]), min_size=1, max_size=5))
    times = np.cumsum([draw(number(-1, 1)), *steps])
    way = tuple(draw(poses) for _ in times)
    if kind == "keyframes":
        once = keyframes(times, way, draw(st.sampled_from(["natural", "clamped"])))
        return Case(once, (float(times[0]), float(times[-1])), tuple(times.tolist()), 3)
    turns = draw(st.sampled_from([0, 0, 1, -2]))
    again = keyframes(times, (*way[:-1], replace(way[0], yaw=way[0].yaw + turns * math.tau)), "periodic")
    period = float(times[-1] - times[0])
    rounds = [k * period + time for k in range(-12, 13) for time in times[:-1].tolist()]
    return Case(again, (-2.0, 2.0), tuple(time for time in rounds if -2.0 <= time <= 2.0), 3)


@st.composite
def directions(draw: st.DrawFn) -> FloatArray:
    """A unit vector (3,), often along an axis."""
    axis = draw(st.sampled_from([(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), None]))
    if axis is not None:
        return np.array(axis)
    around, up = draw(number(-math.pi, math.pi)), draw(number(-1, 1))
    flat = math.sqrt(1 - up**2)
    return np.array([flat * math.cos(around), flat * math.sin(around), up])


@st.composite
def intervals(draw: st.DrawFn, case: Case) -> tuple[float, float]:
    """A closed interval in the case's window: of no length, short, from switch to switch, or all of it."""
    low, high = case.window
    grid = st.sampled_from([low, high, *case.switches, 0.5 * (low + high)])
    start = draw(st.one_of(number(low, high), grid))
    end = draw(st.one_of(st.just(start), st.just(start + 1e-3), number(low, high), grid))
    start, end = min(start, end), max(start, end)
    return max(start, low), min(end, high)


def samples(case: Case, start: float, end: float, count: int = 1500) -> FloatArray:
    """Times in [start, end], ends and switches among them."""
    inside = [time for time in case.switches if start <= time <= end]
    times = np.unique([*np.linspace(start, end, count), *inside])
    return times[(start <= times) & (times <= end)]

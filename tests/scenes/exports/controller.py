"""ROS 2's joint_trajectory_controller as far as it decides the motion: what it interpolates between two points, and
what it does with a trajectory that arrives while another one runs. Written from its rules (docs/export.md), with powers
of the time as that controller has them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray

KEYS = ("positions", "velocities", "accelerations")


def seconds(since: dict[str, int]) -> float:
    """A duration of ROS."""
    return since["sec"] + 1e-9 * since["nanosec"]


def sampled(message: dict[str, Any], t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions, velocities and accelerations (T, n) at times t (T,) after the start."""
    points = message["points"]
    times = np.array([seconds(point["time_from_start"]) for point in points])
    found = np.empty((3, len(t), len(message["joint_names"])))
    for row, now in enumerate(t.tolist()):
        k = int(np.clip(np.searchsorted(times, now, side="right") - 1, 0, len(points) - 2))
        found[:, row] = _between(points[k], points[k + 1], times[k + 1] - times[k], now - times[k])
    return found[0], found[1], found[2]


def _between(one: dict[str, Any], other: dict[str, Any], whole: float, tau: float) -> FloatArray:
    """Position, velocity and acceleration (3, n): a line, a cubic or a quintic, as many states as both points have."""
    known = sum(key in one and key in other for key in KEYS)
    zero = np.zeros(len(one["positions"]))
    p0, v0, a0 = (np.array(one.get(key, zero)) for key in KEYS)
    p1, v1, a1 = (np.array(other.get(key, zero)) for key in KEYS)
    power = [whole**k for k in range(6)]
    if known == 1:
        c = [p0, (p1 - p0) / whole]
    elif known == 2:
        c = [
            p0,
            v0,
            (3.0 * (p1 - p0) - (2.0 * v0 + v1) * whole) / power[2],
            (2.0 * (p0 - p1) + (v0 + v1) * whole) / power[3],
        ]
    else:
        c = [
            p0,
            v0,
            0.5 * a0,
            (-20.0 * p0 + 20.0 * p1 - 3.0 * a0 * power[2] + a1 * power[2] - 12.0 * v0 * whole - 8.0 * v1 * whole)
            / (2.0 * power[3]),
            (30.0 * p0 - 30.0 * p1 + 3.0 * a0 * power[2] - 2.0 * a1 * power[2] + 16.0 * v0 * whole + 14.0 * v1 * whole)
            / (2.0 * power[4]),
            (-12.0 * p0 + 12.0 * p1 - a0 * power[2] + a1 * power[2] - 6.0 * v0 * whole - 6.0 * v1 * whole)
            / (2.0 * power[5]),
        ]
    return np.array(
        [
            sum((c[i] * tau**i for i in range(len(c))), zero),
            sum((i * c[i] * tau ** (i - 1) for i in range(1, len(c))), zero),
            sum((i * (i - 1) * c[i] * tau ** (i - 2) for i in range(2, len(c))), zero),
        ]
    )


class Rule(Enum):
    """What a controller does with a trajectory that arrives during another one."""

    HUMBLE = "replaces at arrival, samples at the present time"
    JAZZY = "replaces at arrival, samples one update period ahead; Jazzy, Kilted, and later ones that must not merge"
    LYRICAL = "defers a future stamp, then replaces; samples one update period ahead"
    MERGING = "after 6.9.0: merges, and shifts what is late; samples one update period ahead"


@dataclass
class Held:
    """A trajectory in the controller: points at times of its clock, and the state that it had when it took it."""

    times: list[float]
    points: list[dict[str, Any]]
    taken: float
    state: dict[str, Any] | None = None

    def at(self, t: float) -> dict[str, Any]:
        """The state that is commanded at a time."""
        if t < self.times[0]:
            if self.state is None:
                return self.points[0]
            begin, whole = self.taken, self.times[0] - self.taken
            return _point(_between(self.state, self.points[0], whole, max(t - begin, 0.0)))
        if t >= self.times[-1]:
            return self.points[-1]
        k = int(np.searchsorted(self.times, t, side="right")) - 1
        return _point(
            _between(self.points[k], self.points[k + 1], self.times[k + 1] - self.times[k], t - self.times[k])
        )


def _point(states: FloatArray) -> dict[str, Any]:
    return dict(zip(KEYS, states, strict=True))


def _merged(old: Held, new: Held, now: float) -> Held:
    """The old points up to the first new one, and the new ones; these begin now if they are late."""
    shift = max(0.0, now - new.times[0])
    handoff = new.times[0] + shift
    kept = [(t, p) for t, p in zip(old.times, old.points, strict=True) if now < t < handoff]
    first = [] if handoff <= now else [(now, old.at(now)), *kept]
    rows = [*first, (handoff, old.at(handoff)), *((t + shift, p) for t, p in zip(new.times, new.points, strict=True))]
    rows = [row for row, after in zip(rows, [*rows[1:], None], strict=True) if after is None or after[0] > row[0]]
    return Held([t for t, _ in rows], [p for _, p in rows], now)


def commanded(
    rule: Rule, sent: list[tuple[int, float, dict[str, Any]]], period: float, ticks: int, speed: float = 1.0
) -> FloatArray:
    """The positions (ticks, n) that a controller commands at its ticks, from 0 on. `sent`: at which tick a message
    arrives, its stamp, s, and the message; the first one runs from tick 0. `speed`: the share at which time passes for
    a trajectory, which begins at the present time when it is taken."""
    active: Held | None = None
    pending: Held | None = None
    last: dict[str, Any] | None = None
    since, found = 0, []
    for k in range(ticks):
        now = k * period
        cursor = since * period + speed * (k - since) * period
        for tick, stamp, message in sent:
            if tick != k:
                continue
            times = [stamp + seconds(point["time_from_start"]) for point in message["points"]]
            new = Held(times, message["points"], now, last)
            if active is not None and rule is Rule.LYRICAL and new.times[0] > now:
                pending = new
            elif active is not None and rule is Rule.MERGING:
                active = _merged(active, new, cursor)
            else:
                active, since, cursor = new, k, now
        if pending is not None and pending.times[0] <= now:
            active, pending, since, cursor = pending, None, k, now
        assert active is not None
        last = active.at(cursor + (0.0 if rule is Rule.HUMBLE else period))
        found.append(np.asarray(last["positions"]))
    return np.array(found)

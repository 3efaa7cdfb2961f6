"""Random motions to time: robots' limits, states legal under them, moves from a nanometre to metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from assur.planner.timing import Numbers, Solver, TimingRefusal, trajectory_of
from assur.planner.trajectory import Trajectory

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Question:
    """Two states and limits."""

    q0: Floats
    v0: Floats
    a0: Floats
    q1: Floats
    v1: Floats
    a1: Floats
    velocity: Floats
    acceleration: Floats
    jerk: Floats

    @property
    def args(self) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats, Floats, Floats, Floats]:
        """In the order of `time_joints`."""
        return (*self.start, *self.goal, *self.limits)

    @property
    def start(self) -> tuple[Floats, Floats, Floats]:
        return self.q0, self.v0, self.a0

    @property
    def goal(self) -> tuple[Floats, Floats, Floats]:
        return self.q1, self.v1, self.a1

    @property
    def limits(self) -> tuple[Floats, Floats, Floats]:
        return self.velocity, self.acceleration, self.jerk

    @property
    def n(self) -> int:
        return len(self.q0)

    @property
    def states(self) -> tuple[Numbers, Numbers]:
        """Start and goal as a `Solver` takes them."""
        return numbers(self.start), numbers(self.goal)

    @property
    def solver(self) -> Solver:
        """A new one for these limits."""
        return Solver(*numbers(self.limits))


def numbers(rows: tuple[Floats, Floats, Floats]) -> Numbers:
    """Three vectors as plain numbers."""
    first, second, third = (row.tolist() for row in rows)
    return first, second, third


RH6 = (np.array([6.98, 11.69, 2.4, 43.6]), np.array([125.64, 210.42, 43.02, 785.34]))
"""Velocity and acceleration of a real SCARA, rad and m."""
ROBOTS = ("real", "problems", "soft", "sharp")
KINDS = ("rest", "moving", "at the limit", "accelerating")


def limits(rng: np.random.Generator, robot: str, n: int) -> tuple[Floats, Floats, Floats]:
    """Velocity, acceleration, jerk: of the real robot (estimated jerk), of the problems, or drawn."""
    if robot == "real":
        joints = rng.integers(0, 4, n)
        return RH6[0][joints], RH6[1][joints], RH6[1][joints] / 0.02
    if robot == "problems":
        return np.full(n, 4.0), np.full(n, 30.0), np.full(n, 600.0)
    if robot == "soft":
        return rng.uniform(0.5, 10, n), rng.uniform(2, 60, n), rng.uniform(100, 3000, n)
    acceleration = rng.uniform(5, 200, n)
    return rng.uniform(0.5, 10, n), acceleration, acceleration / rng.uniform(0.005, 0.05, n)


def question(rng: np.random.Generator, robot: str, kind: str, n: int = 4, least: float = 1e-6) -> Question:
    """A legal question; some joint moves by `least` at least, sizes spread over all orders up to 3."""
    v, a, j = limits(rng, robot, n)
    zero = np.zeros(n)
    way = rng.choice([-1.0, 1.0], n) * rng.uniform(0.05, 1, n) * 10 ** rng.uniform(np.log10(least), 0.5)
    way[rng.integers(n)] *= max(1.0, least / np.abs(way).max())
    way[0] = np.sign(way[0]) * max(abs(way[0]), least)
    states = [zero, zero, zero, zero]
    if kind == "moving":
        states = [rng.uniform(-0.9, 0.9, n) * v, zero, rng.uniform(-0.9, 0.9, n) * v, zero]
    if kind == "at the limit":
        states = [rng.choice([-1, -0.9995, 0, 0.9995, 1], n) * v, zero, rng.choice([-1, 0, 0.9999, 1], n) * v, zero]
    if kind == "accelerating":
        while True:
            v0, v1 = rng.uniform(-0.9, 0.9, (2, n)) * v
            a0, a1 = rng.uniform(-1, 1, (2, n)) * a
            # What the accelerations lead to, with the jerk that the solver gets.
            led = np.abs([v0 + a0 * np.abs(a0) / (1.9 * j), v1 - a1 * np.abs(a1) / (1.9 * j)])
            if (led <= v).all():
                break
            v, a, j = limits(rng, robot, n)
        states = [v0, a0, v1, a1]
    q0 = rng.uniform(-3, 3, n)
    return Question(q0, states[0], states[1], q0 + way, states[2], states[3], v, a, j)


def time_joints(*rows: Floats, duration: float | None = None, begin: float = 0.0) -> Trajectory | TimingRefusal:
    """The fastest motion, or the one of `duration`, s, that begins at `begin`, s. `rows`: q, q̇, q̈ of start and goal,
    and limits of velocity, acceleration and jerk, each (n,)."""
    start, goal, limits = (numbers(rows[k : k + 3]) for k in (0, 3, 6))  # type: ignore[arg-type]
    found = Solver(*limits).raw_profile(start, goal, duration)
    return found if isinstance(found, TimingRefusal) else trajectory_of([found], [begin, begin + found.duration])

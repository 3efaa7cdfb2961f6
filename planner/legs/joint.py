"""Joint legs: from a state of the arm to a meeting, all joints timed by Ruckig, through free vias or over an arch."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.candidates import passing_velocity
from assur.planner.legs.limits import beyond_limits
from assur.planner.legs.line import ScaledLimits
from assur.planner.legs.meeting import GRID_S
from assur.planner.legs.missed import ArchForm, Vertical, arch, vertical
from assur.planner.legs.state import Branch, State
from assur.planner.legs.tool_motion import RESERVE, tool_peak
from assur.planner.model.outcome import Course, Route
from assur.planner.model.refusal import Obstacle, Quantity, Refusal, Stage, unmoved, window_missed
from assur.planner.model.scene import Scene
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.robots.facts import Limits
from assur.planner.timing import SHORTEST, Numbers, RawProfile, TimingRefusal, trajectory_of
from assur.planner.trajectory import Trajectory

TRIES = 12
"""Calls of Ruckig after which a rendezvous is given up: it converges in three or four."""


@dataclass(frozen=True, eq=False)
class Via:
    """A joint position, n numbers, that is flown by at `pace` times the mean joint velocity of the whole leg."""

    q: list[float]
    pace: float


@dataclass(frozen=True, eq=False)
class Shape:
    """A way to go: wait first, then directly, by vias, or over an arch; `late` seconds after the earliest meeting;
    `effort`: share of the limits of acceleration (velocity by its root, jerk by its power of 3/2) that is used."""

    wait: float = 0.0
    late: float = 0.0
    vias: tuple[Via, ...] = ()
    form: ArchForm | None = None
    effort: float = 1.0
    pull: float = 1.0
    """Share of the acceleration that the joints across use, velocity and jerk left as they are."""
    through: float = 0.0
    """Speed at which a via control point is flown by, in mean joint velocities of the way to the one behind it."""

    @property
    def route(self) -> Route:
        course = Course.ARCH if self.form else Course.DIRECT
        return Route(course, len(self.vias), after_wait=self.wait > 0, later=self.late > 0)


class JointMotion:
    """The legs of one shape from one state towards one branch. `scaled`: limits for the shape's effort and of what the
    gripper holds; None: the gripper is empty."""

    def __init__(
        self,
        scene: Scene,
        step: int,
        state: State,
        shape: Shape,
        branch: Branch,
        ahead: FloatArray | None = None,
        scaled: ScaledLimits | None = None,
    ) -> None:
        self.scene, self.step, self.state, self.shape, self.branch = scene, step, state, shape, branch
        self.ahead: list[float] | None = None if ahead is None else ahead.tolist()
        self.scaled = scaled or ScaledLimits(scene.limits_with(None), scene.robot.lift, shape.effort)
        self.origin: Numbers = (state.q.tolist(), state.qd.tolist(), state.qdd.tolist())
        """Where the last leg sets out: at the arm's state, or at the last via."""
        self.prefix: list[RawProfile] = []
        self._verticals: dict[tuple[float, ...], Vertical | TimingRefusal] = {}

    def meet(self) -> Trajectory | Refusal:
        """The leg to the earliest meeting on the branch's grid that this shape reaches (or `late` seconds later). Its
        last knot is at the time of the meeting to the bit, as the control point is.

        Ruckig must take exactly the time that is left: to the first grid time that a lower bound allows, and then to
        the first one that its shortest duration allows, until it fits.
        """
        failed = self._through_vias()
        if failed is not None:
            return failed
        branch, begin = self.branch, self.state.time + self.shape.wait
        if branch.still:
            return self._at_any_time(begin)
        spent = sum(profile.duration for profile in self.prefix)
        # velocity limits alone say that nothing earlier can be met; Ruckig says the rest
        least = branch.velocity_times(self.origin[0], self.scaled.rates[0])
        # an arm that moves with the point already is at it now: a leg that takes no time is none
        rows = np.flatnonzero(branch.time >= begin + spent + np.maximum(least, SHORTEST))
        times = branch.time[rows]
        number, late = 0, self.shape.late
        for _ in range(TRIES):
            if not number < len(rows):
                break
            row, time = int(rows[number]), float(times[number])
            goal, left = self._goal(row), time - begin - spent
            found = None if late > 0 or left < SHORTEST else self._last(goal, left)
            if found is None or (isinstance(found, TimingRefusal) and found.reason != "too short"):
                # not tried yet, or not possible in exactly this time: what is the shortest time?
                shortest = self._shortest(goal)
                if isinstance(shortest, TimingRefusal):
                    number = int(times.searchsorted(time + max(GRID_S, shortest.excess)))
                    continue
                if begin + spent + shortest > time:
                    number = int(times.searchsorted(begin + spent + shortest))
                    continue
                if late > 0:
                    later, late = int(times.searchsorted(time + late)), 0.0
                    number = later if later < len(rows) else number
                    continue
                found = self._last(goal, left) if found is None else found
            if not isinstance(found, TimingRefusal):
                return self._leg(found, begin, time)
            step = found.excess if found.reason == "too short" else max(GRID_S, found.excess)
            number = int(times.searchsorted(time + step))
        return self._missed(begin, begin + spent, float(least[-1]))

    def _missed(self, begin: float, ready: float, least: float) -> Refusal:
        """Why no meeting was found; `least`: s that the way to the last one takes at least, after `ready`."""
        end, soonest = float(self.branch.time[-1]), self._shortest(self._goal(len(self.branch.time) - 1))
        need = ready + (least if isinstance(soonest, TimingRefusal) else soonest)
        if not need > end:
            return unmoved(Stage.TIMING, self.step, Obstacle.NO_SUCH_DURATION, interval=(begin, end))
        facts, late = WindowMissed(miss=Miss.NO_MEETING_LEFT), Quantity.of(need - end, "s")
        return window_missed(Stage.TIMING, self.step, facts, amount=late, interval=(begin, end))

    def _shortest(self, goal: Numbers) -> float | TimingRefusal:
        """How long the last leg takes at least, s."""
        if self.shape.form is None:
            return self.scaled.together.shortest(self.origin, goal)
        found = self._arch(self.shape.form, goal, None)
        return found if isinstance(found, TimingRefusal) else found.duration

    def _goal(self, row: int) -> Numbers:
        """The state to be met; a via control point is met with a velocity towards what is `ahead`."""
        numbers, n = self.branch.table[row].tolist(), len(self.origin[0])
        q = numbers[1 : 1 + n]
        if self.ahead is None or not self.shape.through > 0:
            return q, numbers[1 + n : 1 + 2 * n], numbers[1 + 2 * n :]
        return q, self._passing(self.state.q.tolist(), q, self.ahead, self.shape.through), [0.0] * len(q)

    def _passing(self, before: list[float], at: list[float], behind: list[float], share: float) -> list[float]:
        stations, found = np.array([before, at, behind, *self.scaled.rates[:2]]), np.empty(len(at))
        passing_velocity(stations[0], stations[1], stations[2], share, stations[3], stations[4], found)
        row: list[float] = found.tolist()
        return row

    def _through_vias(self) -> Refusal | None:
        """Times the legs up to the last via."""
        shape = self.shape
        if not shape.vias:
            return None
        goal = self.branch.table[0, 1 : 1 + len(self.origin[0])].tolist()
        stations = [self.origin[0], *[via.q for via in shape.vias], goal]
        for i, via in enumerate(shape.vias, start=1):
            v = self._passing(stations[i - 1], stations[i], stations[i + 1], via.pace)
            passed: Numbers = (stations[i], v, [0.0] * len(v))
            found = self.scaled.together.raw_profile(self.origin, passed)
            if isinstance(found, TimingRefusal):
                return unmoved(Stage.TIMING, self.step, Obstacle.NO_PROFILE)
            self.prefix.append(found)
            self.origin = passed
        return None

    def _last(self, goal: Numbers, duration: float | None) -> RawProfile | TimingRefusal:
        if self.shape.form is not None:
            return self._arch(self.shape.form, goal, duration)
        return self.scaled.together.raw_profile(self.origin, goal, duration)

    def _at_any_time(self, begin: float) -> Trajectory | Refusal:
        """The way to a point that stands: the fastest."""
        last = self._last(self._goal(0), None)
        if isinstance(last, TimingRefusal):
            return unmoved(Stage.TIMING, self.step, Obstacle.NO_PROFILE)
        return self._leg(last, begin, None)

    def _leg(self, last: RawProfile, begin: float, end: float | None) -> Trajectory | Refusal:
        """The leg whose last part is `last`, if its spline keeps the limits; `end` None: when that ends."""
        parts, begins = [*self.prefix, last], [begin]
        for profile in parts:
            begins.append(begins[-1] + profile.duration)
        if end is not None:
            begins[-1] = end
        trajectory = trajectory_of(parts, begins)
        return beyond_limits(self.scene, self.step, trajectory, self.scaled.limits) or trajectory

    def _arch(self, form: ArchForm, goal: Numbers, duration: float | None) -> RawProfile | TimingRefusal:
        # on a belt the lift joint meets all later points as it meets the first: its motions are timed once
        key = tuple(row[self.scaled.lift[0]] for row in goal)
        if key not in self._verticals:
            self._verticals[key] = vertical(self.origin, goal, form.top, self.scaled)
        return arch(self.origin, goal, form, self.scaled, duration, self._verticals[key])


# A joint motion, slowed down where it pulls too hard at the held part, and nowhere else.
#
# The way stays the same; the clock runs slower on it. With s the time of the motion as it was and w = ds/dt ≤ 1, the
# tool point is accelerated by p'' w² + p' w w'. The fastest w that keeps the carry limit is found as for a motion on a
# given path: bounded by what pulls across the way, then by what may speed it up and slow it down along the way,
# forwards and backwards. A cubic B-spline through lower ends of it is smooth enough for jerk. What comes out is checked
# like any other motion. Source: Bobrow, Dubowsky and Gibson, Time-Optimal Control of Robotic Manipulators Along
# Specified Paths (1985).

CELLS = 48
"""Pieces of the spline over a motion."""
PER_CELL = 8
"""Instants of a piece at which the pull is evaluated."""
ROUNDS, GENTLER = 6, 0.98
"""Motions that are made, each for as much less of the limit as the one before was beyond it, and a little less."""
SLOWEST = 0.02
"""The clock does not run slower than this."""


def slowed(scene: Scene, step: int, motion: Trajectory, limit: float, limits: Limits) -> Trajectory | None:
    """The motion on the same way, from rest or not, which pulls with `limit`, m/s², at most and keeps the joints' own
    `limits`; None: none was found.

    At ends in motion the clock is not slowed: their states are kept, as all positions are.
    """
    allowed = limit * (1 - RESERVE)
    for _ in range(ROUNDS):
        found = _paced(scene, motion, allowed)
        if found is None or beyond_limits(scene, step, found, limits) is not None:
            return None
        peak, _ = tool_peak(scene, found, found.start, found.end)
        if peak <= limit * (1 - RESERVE):
            return found
        allowed *= GENTLER * limit * (1 - RESERVE) / peak
    return None


def _paced(scene: Scene, motion: Trajectory, allowed: float) -> Trajectory | None:
    cell = motion.duration / CELLS
    s = np.linspace(0.0, motion.duration, CELLS * PER_CELL + 1)
    fast = np.sqrt(_squared(scene, motion, s, allowed))
    # the lowest within a cell on either side: the spline is a mean of what is around
    low = np.array([fast[max(0, (k - 1) * PER_CELL) : (k + 1) * PER_CELL + 1].min() for k in range(CELLS + 1)])
    moving = [bool(rates.any()) for rates in (motion.knots[0, 1 + motion.n :], motion.knots[-1, 1 + motion.n :])]
    for ends, inner in ((low[:2], moving[0]), (low[-2:], moving[1])):
        if inner and not (ends == 1.0).all():
            return None  # the pull begins where the motion does, which cannot be slowed there
    coefficients = np.concatenate([[low[0]], np.maximum(low, SLOWEST), [low[-1]]])
    if (coefficients == 1.0).all():
        return None
    return _timed(motion, coefficients, cell)


def _squared(scene: Scene, motion: Trajectory, s: FloatArray, allowed: float) -> FloatArray:
    """The largest w² (N,) at instants s (N,) with which the tool point is accelerated by `allowed` at most."""
    tcp, h = scene.tool.tcp, float(s[1] - s[0])
    flange, yaw = scene.robot.forward(motion.evaluate(motion.start + s))
    p = flange + np.stack(
        [np.cos(yaw) * tcp.x - np.sin(yaw) * tcp.y, np.sin(yaw) * tcp.x + np.cos(yaw) * tcp.y, 0 * yaw + tcp.z], -1
    )
    d, c = np.gradient(p, h, axis=0), np.zeros_like(p)
    c[1:-1] = (p[2:] - 2 * p[1:-1] + p[:-2]) / h**2
    c[0], c[-1] = c[1], c[-2]
    speed = np.sqrt((d**2).sum(-1))
    direction = d / np.maximum(speed, 1e-9)[:, None]
    along = (c * direction).sum(-1)
    across = np.sqrt(((c - along[:, None] * direction) ** 2).sum(-1))
    bound = np.minimum(1.0, allowed / np.maximum(across, 1e-9))
    for order, sign in ((range(len(s) - 1), 1.0), (range(len(s) - 1, 0, -1), -1.0)):
        b, v, t, n = bound.tolist(), speed.tolist(), along.tolist(), across.tolist()
        for i in order:
            spare = math.sqrt(max(0.0, allowed**2 - (n[i] * b[i]) ** 2))
            after = b[i] + 2 * h * (spare - sign * t[i] * b[i]) / max(v[i], 1e-9)
            k = i + int(sign)
            b[k] = max(SLOWEST**2, min(b[k], after))
        bound = np.array(b)
    return np.asarray(bound)


def _timed(motion: Trajectory, coefficients: FloatArray, cell: float) -> Trajectory:
    """The motion with the clock of a uniform cubic B-spline over cells of `cell` s."""
    edges = motion.edges - motion.start
    s = np.unique(np.concatenate([edges, np.arange(CELLS + 1) * cell]))
    s = s[np.concatenate([[True], np.diff(s) > 1e-6 * cell])]
    s[-1] = motion.duration
    nodes, weights = np.polynomial.legendre.leggauss(6)
    middles, halves = (s[1:] + s[:-1]) / 2, (s[1:] - s[:-1]) / 2
    inside = middles[:, None] + halves[:, None] * nodes
    spent = ((1 / _clock(coefficients, cell, inside.ravel())[0]).reshape(inside.shape) * weights).sum(1) * halves
    w, slope = _clock(coefficients, cell, s)
    q, qd, qdd = motion.states(motion.start + s)
    w, slope = w[:, None], slope[:, None]
    knots = np.concatenate(
        [(motion.start + np.concatenate([[0.0], np.cumsum(spent)]))[:, None], q, qd * w, qdd * w**2 + qd * w * slope], 1
    )
    # to the bit: what comes before and behind begins and ends there
    knots[0], knots[-1, 1:] = motion.knots[0], motion.knots[-1, 1:]
    return Trajectory.of_knots(knots)


def _clock(coefficients: FloatArray, cell: float, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """w and dw/ds at s (N,)."""
    k = np.minimum((s / cell).astype(np.int64), CELLS - 1)
    x = s / cell - k
    four = np.stack([coefficients[k + i] for i in range(4)])
    basis = np.stack([(1 - x) ** 3, 3 * x**3 - 6 * x**2 + 4, -3 * x**3 + 3 * x**2 + 3 * x + 1, x**3]) / 6
    slope = np.stack([-((1 - x) ** 2), 3 * x**2 - 4 * x, -3 * x**2 + 2 * x + 1, x**2]) / (2 * cell)
    return (four * basis).sum(0), (four * slope).sum(0)

"""A plan, run many times at once with realised uncertainties: collisions, clearances that are too small, errors of
arrivals.

Time is that of the plan; a robot that starts late does everything late, and the clock of all that moves by itself is
ahead of the plan's by as much.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from benchmarks.judge.cell import Cell, grasp_of
from benchmarks.judge.poses import Document, Floats, Poses, short
from benchmarks.judge.realisations import PoseErrors, Realisations, drawn, put_corners
from benchmarks.judge.solids import apart_at_least, gaps
from benchmarks.judge.spline import Spline
from benchmarks.judge.stages import Pair, Stage, stages

STEP_S = 2e-3
"""Time between two instants at which all pairs are evaluated."""
COARSER = 8
"""Every so many instants the distance of a pair is bounded first; a pair that is far apart then is so between, too."""
FINER = 20
"""Number of parts of a step that are evaluated where a pair is so near that a collision between may be missed."""
FASTEST_M_S = 5.0
"""Largest closing speed of two bodies for which no collision is missed, m/s."""
FADES_S = 1.0
"""How long after the end of the motion a correction may have faded out."""
ROUNDING_M, ROUNDING_RAD = 1e-6, 1e-6


@dataclass(frozen=True)
class Fault:
    """A promise of a plan that a run does not keep: the `amount` and what is `allowed`, m or rad."""

    kind: str
    about: tuple[str, ...]
    run: int
    time_s: float
    amount: float
    allowed: float


@dataclass(eq=False)
class Outcome:
    """Faults of all runs, `collisions` among them counted by pair; the deepest contact beside what was allowed, m; and
    of each arrival the error that the answer reports and the worst that was realised, m."""

    faults: list[Fault] = field(default_factory=list)
    collisions: int = 0
    deepest_m: float = 0.0
    deepest_allowed_m: float = 0.0
    errors: list[tuple[str, float, float]] = field(default_factory=list)


def simulated(
    request: Document, answer: Document, count: int, rng: np.random.Generator
) -> tuple[Outcome, Realisations]:
    """`count` runs of a planned answer to a request in SI."""
    cell = Cell.of(request)
    found = drawn(cell, answer, count, rng)
    run = Run(cell, answer, found)
    times = np.array([arrival["until_s"] for arrival in answer["arrivals"]])
    put_corners(found, cell, answer, cell.arm.links(run.spline.evaluate(times))["flange"].yaw)
    return run.outcome(), found


class Run:
    """R runs of one plan."""

    def __init__(self, cell: Cell, answer: Document, real: Realisations) -> None:
        self.cell, self.answer, self.real = cell, answer, real
        self.spline = Spline.of(answer["trajectory"])
        self.seats: dict[str, tuple[str, Poses]] = {}
        """Frame and real pose in it (R,), of every body that is not held."""
        self.held: tuple[str, Poses] | None = None
        """The part in the gripper and its real pose in the flange (R,)."""
        for name, (frame, pose) in cell.seats.items():
            error, unknown = real.parts.get(name), cell.unknown_of.get(name, {})
            planned = pose.still((real.count,))
            self.seats[name] = (frame, planned if error is None else _off(planned, unknown, error))
        if cell.held is not None:
            self._grip("start", *cell.held, cell.request["start"]["holding"].get("within", {}))

    def _grip(self, name: str, part: str, in_flange: Poses, within: Document) -> None:
        planned, error = in_flange.still((self.real.count,)), self.real.grips.get(name)
        self.held = part, planned if error is None else _off(planned, within, error)
        self.seats.pop(part, None)

    # where everything is

    def frame(self, name: str, clock: Floats) -> Poses:
        """A frame at clock times (R, T), as it is."""
        frame, error = self.cell.frames[name], self.real.frames.get(name)
        if frame.shift_s:
            clock = clock - (frame.shift_s * self.real.shifts[name.split("/", maxsplit=1)[0]])[:, None]
        pose = frame.at(clock)
        if error is None:
            return pose
        by = self.frame_error(name, clock)
        unknown, line = frame.unknown, frame.line
        if line is not None and np.hypot(line[0], line[1]) > 0.0:
            across = np.array([-line[1], line[0], 0.0]) / np.hypot(line[0], line[1])
            by = by + unknown.get("lateral_m", 0.0) * error.across[:, None, None] * across
        by = by + unknown.get("vertical_m", 0.0) * error.up[:, None, None] * np.array([0.0, 0.0, 1.0])
        return pose.moved(by, unknown.get("yaw_rad", 0.0) * error.turned[:, None])

    def frame_error(self, name: str, clock: Floats) -> Floats:
        """What a frame is off along its line, or in the horizontal direction that is realised, (R, T, 3) m."""
        frame, error = self.cell.frames[name], self.real.frames[name]
        lasts = np.maximum(clock - self.cell.start_s, 0.0)
        size = frame.unknown.get("position_m", 0.0) + frame.unknown.get("speed_m_s", 0.0) * lasts
        if frame.line is not None:
            return np.asarray((size * error.along[:, None])[..., None] * frame.line)
        flat = np.concatenate([error.flat, np.zeros((len(error.flat), 1))], axis=1)
        return np.asarray(size[..., None] * flat[:, None, :])

    def joints(self, t: Floats) -> tuple[Floats, Floats]:
        """Joints (R, T, n) at plan times (R, T), as commanded and as they are."""
        inside = np.clip(t, self.spline.time[0], self.spline.time[-1])
        q = self.spline.evaluate(inside.reshape(-1)).reshape(*t.shape, -1)
        if self.cell.corrected:
            q = self.cell.arm.corrected(q, self._shift(t))
        if not self.cell.lag.any():
            return q, q
        nodes, k = self.real.lag_s, np.clip(np.searchsorted(self.real.lag_s, t) - 1, 0, len(self.real.lag_s) - 2)
        share = np.clip((t - nodes[k]) / (nodes[k + 1] - nodes[k]), 0.0, 1.0)[..., None]
        rows = np.arange(len(t))[:, None]
        lag = self.real.lag[rows, k] * (1.0 - share) + self.real.lag[rows, k + 1] * share
        return q, q + lag * self.cell.lag

    def _shift(self, t: Floats) -> Floats:
        """By how much the controller shifts the tool (R, T, 3), m: by all of a belt's error while its leg tracks it,
        by less and less, or more and more, of it on the way from and to."""
        clock, found = t + self.real.late[:, None], np.zeros((*t.shape, 3))
        fades, sets_in = self.real.ramps[:, 0, :, None], self.real.ramps[:, 1, :, None]
        spans, shares = self.cell.tracked_spans(self.answer), dict[str, Floats]()
        for k, (name, t0, t1) in enumerate(spans):
            before = spans[k - 1][2] if k else self.answer["start_s"]
            after = spans[k + 1][1] if k + 1 < len(spans) else max(t1, float(self.spline.time[-1])) + FADES_S
            rising = (t - before) / max(t0 - before, 1e-12)
            falling = (t - t1) / max(after - t1, 1e-12)
            share = np.where(t < t0, _ramp(rising, sets_in), 1.0 - _ramp(falling, fades))
            share = np.where((t >= t0) & (t <= t1), 1.0, np.where((t < before) | (t > after), 0.0, share))
            shares[name] = np.maximum(shares.get(name, 0.0), share)  # no more than all of it
        for name, share in shares.items():
            # a controller corrects for what an encoder counts, and that is the way of a belt
            if self.cell.frames[name].line is not None and name in self.real.frames:
                found += share[..., None] * self.frame_error(name, clock)
        return found

    # what happens

    def outcome(self) -> Outcome:
        """Everything, from the start to the end of the standstill."""
        found = Outcome()
        for stage in stages(self.cell, self.answer, self.spline):
            for part in stage.gone & self.seats.keys():
                del self.seats[part]
            self._look(stage, found)
            for number in stage.arrivals:
                self._arrive(self.answer["arrivals"][number], found)
            if stage.handed_over is not None:
                self._hand_over(stage.handed_over)
        return found

    def _look(self, stage: Stage, found: Outcome) -> None:
        steps = max(int(np.ceil((stage.t1 - stage.t0) / STEP_S)), 1)
        grid = np.broadcast_to(np.linspace(stage.t0, stage.t1, steps + 1), (self.real.count, steps + 1))
        snapshot, some = Snapshot(self, grid), np.unique([*range(0, steps, COARSER), steps])
        coarse = Snapshot(self, grid[:, some])
        self._within_range(snapshot, found)
        held = None if self.held is None else self.held[0]
        for pair in self.cell.pairs(stage, held, {name: frame for name, (frame, _) in self.seats.items()}):
            if self._apart(pair, coarse).min() > COARSER * FASTEST_M_S * STEP_S:
                continue
            margin = self._margins(pair, snapshot)
            rows, best = np.arange(self.real.count), margin.argmin(axis=1)
            if margin[rows, best].min() < FASTEST_M_S * STEP_S / 2.0:
                around = grid[rows, best][:, None] + np.linspace(-STEP_S, STEP_S, 2 * FINER + 1)
                finer = Snapshot(self, np.clip(around, stage.t0, stage.t1))
                margin, at = self._margins(pair, finer), finer.t
            else:
                at = grid
            self._judge(pair, margin, at, found)

    def _margins(self, pair: Pair, snapshot: Snapshot) -> Floats:
        """By how much two bodies are farther apart than they must be (R, T), m; lower bounds where that is plenty."""
        found = self._apart(pair, snapshot)
        near = found < FASTEST_M_S * STEP_S
        if near.any():
            a, b = snapshot.body(pair.first)[near], snapshot.body(pair.second)[near]
            exact = gaps(self.cell.solids[pair.first], a, self.cell.solids[pair.second], b, pair.required)
            found[near] = np.maximum(found[near], exact - pair.required)
        return found

    def _apart(self, pair: Pair, snapshot: Snapshot) -> Floats:
        """Lower bounds of the same, (R, T), m."""
        one, other = self.cell.solids[pair.first], self.cell.solids[pair.second]
        return apart_at_least(one, snapshot.body(pair.first), other, snapshot.body(pair.second)) - pair.required

    def _judge(self, pair: Pair, margin: Floats, at: Floats, found: Outcome) -> None:
        gap = margin + pair.required
        if pair.contact:
            deepest = float(-gap.min())
            if deepest - pair.allowed > found.deepest_m - found.deepest_allowed_m or found.deepest_allowed_m == 0.0:
                found.deepest_m, found.deepest_allowed_m = deepest, pair.allowed
        unknown = ~np.isfinite(margin)
        bad = (margin < -ROUNDING_M) | unknown
        for r in np.flatnonzero(bad.any(axis=1)):
            k = int(np.argmin(np.where(unknown[r], -np.inf, margin[r])))
            hit = bool(not pair.contact and not gap[r, k] >= -ROUNDING_M)
            found.collisions += hit
            kind = "contact" if pair.contact else "collision" if hit else "clearance"
            place = (pair.first, pair.second)
            found.faults.append(Fault(kind, place, int(r), float(at[r, k]), float(gap[r, k]), pair.required))

    def _within_range(self, snapshot: Snapshot, found: Outcome) -> None:
        arm, q = self.cell.arm, snapshot.commanded
        over = np.maximum(arm.lower - q, q - arm.upper) - 1e-9 * np.maximum(arm.upper - arm.lower, 1.0)
        bad = ~(over <= 0.0)
        for r in np.flatnonzero(bad.any(axis=(1, 2))):
            k, j = np.argwhere(bad[r])[0]
            found.faults.append(
                Fault("range", (arm.names[j],), int(r), float(snapshot.t[r, k]), float(over[r, k, j]), 0.0)
            )

    def _arrive(self, arrival: Document, found: Outcome) -> None:
        """How far the tool is from its point, and a held part from its place, when a step is done."""
        step = self.cell.request["task"][arrival["step"]]
        snapshot = Snapshot(self, np.full((self.real.count, 1), arrival["until_s"]))
        tool, ((kind, given),) = snapshot.tool(), step.items()
        if kind == "pick":
            part = snapshot.body(given["part"])
            grasp = grasp_of(given, arrival["yaw_offset_rad"])
            wanted, real = tool.then(grasp.inverse()), part
            at_grasp = np.linalg.norm(part.then(grasp).p - tool.p, axis=-1)[:, 0]
        else:
            name, pose = self.cell.seat(given["to"])
            wanted = snapshot.frame(name).then(pose)
            real = snapshot.body(given["part"]) if kind == "place" else tool
            if kind != "place":
                wanted = wanted.moved(0.0, arrival["yaw_offset_rad"])
            at_grasp = np.zeros(self.real.count)
        delta, turn = (real.p - wanted.p)[:, 0], short(real.yaw - wanted.yaw)[:, 0]
        if kind not in ("pick", "place") and not self.cell.arm.turns:
            turn = np.zeros_like(turn)
        elif kind not in ("pick", "place") and given["to"].get("yaw_rad") is None:
            turn = turn - turn[0]
        flat, high = np.hypot(delta[:, 0], delta[:, 1]), np.abs(delta[:, 2])
        size = np.maximum(np.hypot(flat, high), at_grasp)
        stated = arrival.get("error") or {"position_m": 2e-6, "horizontal_m": 2e-6, "vertical_m": 2e-6, "yaw_rad": 2e-6}
        for key, values in (
            ("position_m", size),
            ("horizontal_m", flat),
            ("vertical_m", high),
            ("yaw_rad", np.abs(turn)),
        ):
            r, slack = int(values.argmax()), ROUNDING_RAD if key == "yaw_rad" else ROUNDING_M
            if not values[r] <= stated[key] + slack:
                about = (arrival["control_point"], key)
                found.faults.append(Fault("error", about, r, arrival["until_s"], float(values[r]), stated[key]))
        if arrival.get("error") and stated["position_m"] > 1e-5:
            found.errors.append((arrival["control_point"], stated["position_m"], float(size.max())))

    def _hand_over(self, number: int) -> None:
        """The part changes hands as it is: into the gripper, or into the frame in which it is put down."""
        ((kind, given),) = self.cell.request["task"][number].items()
        arrival = next(each for each in self.answer["arrivals"] if each["step"] == number)
        snapshot = Snapshot(self, np.full((self.real.count, 1), arrival["until_s"]))
        part = given["part"]
        if kind == "pick":
            real = snapshot.links["flange"].inverse().then(snapshot.body(part))
            self._grip(f"step {number}", part, self.cell.grasped(given, arrival), given.get("held_within", {}))
            if "held_within" not in given:
                self.held = part, real[:, 0]
            return
        name, _ = self.cell.seat(given["to"])
        self.seats[part] = (name, snapshot.frame(name).inverse().then(snapshot.body(part))[:, 0])
        self.held = None


class Snapshot:
    """Where everything is at plan times t (R, T)."""

    def __init__(self, run: Run, t: Floats) -> None:
        self.run, self.t = run, t
        self.commanded, self.joints = run.joints(t)
        self.clock = t + run.real.late[:, None]
        self._frames: dict[str, Poses] = {}
        self._bodies: dict[str, Poses] = {}

    @cached_property
    def links(self) -> dict[str, Poses]:
        return self.run.cell.arm.links(self.joints)

    def tool(self) -> Poses:
        return self.links["flange"].then(self.run.cell.arm.tcp)

    def frame(self, name: str) -> Poses:
        if name not in self._frames:
            self._frames[name] = self.run.frame(name, self.clock)
        return self._frames[name]

    def body(self, name: str) -> Poses:
        if name not in self._bodies:
            self._bodies[name] = self._body(name)
        return self._bodies[name]

    def _body(self, name: str) -> Poses:
        run = self.run
        if run.held is not None and run.held[0] == name:
            return self.links["flange"].then(run.held[1][:, None])
        if name in run.seats:
            frame, pose = run.seats[name]
            return self.frame(frame).then(pose[:, None])
        carried = run.cell.carried[name]
        return self.links[carried.link].then(carried.pose)


def _off(pose: Poses, unknown: Document, error: PoseErrors) -> Poses:
    """Poses (R,) off by what is not known of a part, realised."""
    flat = unknown.get("position_m", 0.0) * error.flat
    by = np.concatenate([flat, unknown.get("vertical_m", 0.0) * error.up[:, None]], axis=1)
    return pose.moved(by, unknown.get("yaw_rad", 0.0) * error.turned)


def _ramp(way: Floats, between: Floats) -> Floats:
    """From 0 to 1 between two shares of a way, (R, 2, 1)."""
    begin, end = between[:, 0], between[:, 1]
    return np.asarray(np.clip((way - begin) / np.maximum(end - begin, 1e-9), 0.0, 1.0))

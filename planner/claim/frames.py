"""Frames: links of other arms, or laws of motion; and by how much each may be displaced."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.errors import InputError
from assur.planner.kernels import law_columns as own
from assur.planner.laws import Frame, Law
from assur.planner.model.scene import Scene
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

# Arms as rows: their links, the distinct angles of these, their loops, and their motion as knots.


class Arms:
    """The arms of a cell, the robot first."""

    def __init__(self) -> None:
        self._arms: list[tuple[float, ...]] = []
        self._links: list[tuple[float, ...]] = []
        self._angles: list[tuple[float, ...]] = []
        self._loops: list[tuple[float, ...]] = []

    def add(self, robot: Robot) -> int:
        """Adds the chain of an arm; the row of its base in `links`. Raises `InputError` for too many joints."""
        first, start, n = len(self._links), len(self._angles), len(robot.joints)
        if n > c.MOST_JOINTS:
            raise unstated(f"an arm with {n} joints")
        rows = robot.chain_rows
        links, loops = rows.links.copy(), rows.loops.copy()
        links[:, c.LINK_PARENT] += np.where(links[:, c.LINK_PARENT] >= 0.0, first, 0)
        turns = links[:, c.LINK_YAW : c.LINK_COUPLER]
        turns += np.where(turns >= 0.0, start, 0)
        loops[:, c.LOOP_CRANK : c.LOOP_LENGTH] += first
        loops[:, c.LOOP_BETWEEN] += start
        loop = len(self._loops) if len(loops) else -1
        self._arms.append((first, len(links), n, 0, 0, start, len(rows.angles), loop))
        self._links += links.tolist()
        self._angles += rows.angles.tolist()
        self._loops += loops.tolist()
        return first

    def tables(self) -> dict[str, FloatArray]:
        """Arms (without their knots), links, angles and loops."""
        rows = {"arms": self._arms, "links": self._links, "angles": self._angles, "loops": self._loops}
        return {name: c.table(name, each) for name, each in rows.items()}


def knots_at_rest(path: Trajectory) -> FloatArray:
    """Knots (K, c.KNOT) of an arm that follows a trajectory, and of its rest before and after it for all times that a
    claim may have. Where it does not begin or end at rest its motion is stated no farther."""
    begins, ends = (not (path.qd[k].any() or path.qdd[k].any()) for k in (0, -1))
    begin = -c.LATEST_S if begins else float(path.time[0])
    return knots_of(path, min(begin, float(path.time[0])), c.LATEST_S if ends else float(path.time[-1]))


def knots_of(path: Trajectory, begin: float, until: float) -> FloatArray:
    """Knots (K, c.KNOT) of an arm that follows a trajectory and rests before and after it, from `begin` to `until`, s.

    Raises `InputError` for a trajectory that does not rest at an end beyond which it is required.
    """
    before, after, count, n = int(begin < path.time[0]), int(until > path.time[-1]), len(path.time), path.n
    found = np.zeros((count + before + after, c.KNOT))
    own = found[before : before + count]
    own[:, c.KNOT_TIME] = path.time
    for first, states in ((c.KNOT_Q, path.q), (c.KNOT_QD, path.qd), (c.KNOT_QDD, path.qdd)):
        own[:, first : first + n] = states
    for needed, end, t in ((before, 0, begin), (after, -1, until)):
        if needed:
            if path.qd[end].any() or path.qdd[end].any():
                when = "begins, and is needed before" if end == 0 else "ends, and is needed after"
                raise unstated(f"a motion that is not at rest when it {when}")
            found[end, c.KNOT_TIME], found[end, c.KNOT_Q : c.KNOT_Q + n] = t, path.q[end]
    return found


def unstated(what: str) -> InputError:
    """The refusal of a plan with something that no claim can state."""
    return InputError("plan", what, "an answer without it: a proof bundle cannot state it yet")


# Laws of motion in a claim: pieces, sines and period of the planner's table of a law.
#
# They belong to the cell: no law is cut to the time of a plan, and none to the time for which it is known, which the
# statement checker compares with each plan.

NO_PERIOD = (0.0, 0.0, 0.0, 0.0, 0.0)


class StatedLaw(NamedTuple):
    """A law in a claim: `at` (8), its pose and rate when its first piece begins; rows of `laws`; its sines; its
    period, s, and by how much it has gone on after that (4)."""

    at: list[float]
    pieces: list[list[float]]
    waves: list[tuple[float, ...]]
    period: tuple[float, ...] = NO_PERIOD


def law_of(law: Law, early: float) -> StatedLaw:
    """A law from `early`, s, on at the latest, until the last time that a claim may have.

    Pieces that end before `early` are left out: what they round would add up. A first piece of constant speed begins at
    `early`, when the law is stated, or when the second one begins, whichever is first. What repeats begins where its
    law does, or the whole periods before that are needed.

    Raises `InputError` for a law that begins too early or too late for any claim.
    """
    count, period = int(law.row[own.COUNT]), float(law.row[own.PERIOD])
    pieces, waves = law.side[:count].tolist(), [tuple(each) for each in law.side[count:, : c.WAVE].tolist()]
    # the first one that ends later; all of them if none does
    later = (k for k, piece in enumerate(pieces) if period > 0.0 or piece[own.PIECE_END] > early)
    left_out = next(later, 0)
    pieces = pieces[left_out:]
    pose, rate = pieces[0][own.POSE : own.RATE], pieces[0][own.RATE : own.CORNER]
    if law.is_fixed or waves:
        return StatedLaw([*pose, 0.0, 0.0, 0.0, 0.0], [], waves)
    starts, ends = [piece[own.PIECE_BEGIN] for piece in pieces], [piece[own.PIECE_END] for piece in pieces]
    repeated = NO_PERIOD
    if period > 0.0:
        step, start = law.row[own.STEP : own.STEP + 4].tolist(), float(law.row[own.START])
        whole = -math.ceil(max(start - early, 0.0) / period) + math.ceil(max(-c.LATEST_S - start, 0.0) / period)
        starts = [t + (start + whole * period) for t in starts]
        pose = [x + whole * far for x, far in zip(pose, step, strict=True)]
        ends = [*starts[1:], starts[0] + period]
        repeated = (period, *step)
    elif left_out == 0 and not any(pieces[0][own.POWER :]):
        begin = max(min(early, law.stated_s, starts[0]), -c.LATEST_S)
        pose = [x - (starts[0] - begin) * v for x, v in zip(pose, rate, strict=True)]
        starts[0] = begin
    times = zip(starts, (min(t, c.LATEST_S) for t in ends), pieces, strict=True)
    found = [[t0, t1, *piece[own.POWER :]] for t0, t1, piece in times if t0 < t1]  # some last no time
    if not (found and starts[0] >= -c.LATEST_S):
        raise unstated(f"a frame whose motion begins before {-c.LATEST_S:g} s or after {c.LATEST_S:g} s")
    return StatedLaw([*pose, *rate], found, waves, repeated)


BEYOND_S = 1e-3
"""Motions are stated for so long before the first time at which they count, s: sums of times are rounded."""


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of a cell. `others`: the other arms and what they follow, in their order from arm 1 on; `tables`: of
    this kind, but for the knots of the robot."""

    tables: dict[str, FloatArray]
    others: tuple[tuple[Robot, Trajectory], ...]
    early: float
    """From when on all motions are stated that have no begin, s."""

    def around(self, path: Trajectory, robot_until: float) -> dict[str, FloatArray]:
        """The tables of arms and knots with those of a robot that follows `path` and then rests until `robot_until`, s.
        Raises `InputError` for a path that does not end at rest, and is needed longer."""
        arms, knots = self.tables["arms"].copy(), knots_of(path, path.start, robot_until)
        arms[0, c.ARM_KNOTS], others = len(knots), self.tables["knots"]
        if len(others):
            arms[1:, c.ARM_KNOT] += len(knots)
        return {"arms": arms, "knots": np.concatenate((knots, others)) if len(others) else knots}


def early_of(scene: Scene) -> float:
    """The time, s, from which on a plan for a scene may need the motions of frames: whole seconds, so that many scenes
    share it."""
    latest = max((frame.uncertainty.shift_s[1] for frame in scene.frames.values()), default=0.0)
    return math.floor(scene.start.time - latest - BEYOND_S)


def frames_of(scene: Scene) -> Frames:
    """The frames of a cell. Raises `InputError` for an arm or a law that cannot be stated."""
    arms, rows, waves, laws = Arms(), list[list[float]](), list[tuple[float, ...]](), list[list[float]]()
    followed, first = list[tuple[Robot, Trajectory]](), list[int]()
    early = early_of(scene)
    arms.add(scene.robot)
    for frame in scene.frames.values():
        link, known, on = frame.law.link, frame.uncertainty, (-1, -1)
        if link is None:
            law = law_of(frame.law, early)
        else:
            law = StatedLaw([0.0] * 8, [], [])
            same = [k for k, (robot, path) in enumerate(followed) if robot is link.robot and path is link.trajectory]
            if not same:
                same = [len(followed)]
                followed.append((link.robot, link.trajectory))
                first.append(arms.add(link.robot))
            on = same[0] + 1, first[same[0]] + link.link
        own = len(laws), len(law.pieces), len(waves), len(law.waves)
        rows.append([*on, *law.at, *own, *known.shift_s, known.yaw_rad, *law.period])
        laws += law.pieces
        waves += law.waves
    tables = arms.tables()
    knots = [knots_at_rest(path) for _, path in followed]
    counts = np.array([0, *map(len, knots)], dtype=float)
    tables["arms"][:, c.ARM_KNOT], tables["arms"][:, c.ARM_KNOTS] = np.cumsum(counts) - counts, counts
    tables |= {
        "frames": c.table("frames", rows),
        "laws": c.table("laws", laws),
        "waves": c.table("waves", waves),
        "displaced": displaced_of(scene),
        "knots": np.concatenate((c.table("knots", []), *knots)),
    }
    return Frames(tables, tuple(followed), early)


def displaced_of(scene: Scene) -> FloatArray:
    """What is uncertain of where frames are."""
    return c.table(
        "displaced", [each for row, frame in enumerate(scene.frames.values()) for each in _displaced(row, frame)]
    )


def _displaced(row: int, frame: Frame) -> list[tuple[float, ...]]:
    """What is uncertain of a frame: along the line on which it travels (else in every horizontal direction), across
    that line, and up or down."""
    known, line = frame.uncertainty, frame.law.line
    x, y, z = (0.0, 0.0, 0.0) if line is None else line.tolist()
    level = math.hypot(x, y)
    across = (-y / level, x / level, 0.0) if level > 0.0 else (0.0, 0.0, 0.0)
    terms = (
        (float(line is None), (x, y, z), known.position_m, known.speed_m_s, 1.0),
        (float(not level > 0.0), across, known.lateral_m, 0.0, 0.0),
        (0.0, (0.0, 0.0, 1.0), known.vertical_m, 0.0, 0.0),
    )
    return [
        (row, any_, *way, amount, growth, shared)
        for any_, way, amount, growth, shared in terms
        if amount != 0.0 or growth != 0.0
    ]

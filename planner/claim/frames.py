"""Frames: links of other arms, or laws of motion; and by how much each may be displaced."""

from __future__ import annotations

import math
from collections.abc import Sequence
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

EMPTY = {name: c.table(name, []) for name in c.WIDTHS}
"""Tables without rows, which many claims share."""


def table_of(name: str, rows: Sequence[Sequence[float]]) -> FloatArray:
    """Rows as the table of this name."""
    return c.table(name, rows) if rows else EMPTY[name]


# Arms as rows: their links, the distinct angles of these, their loops, and their motion as knots.


def arms_of(robots: Sequence[Robot]) -> dict[str, FloatArray]:
    """The chains of the arms of a cell, the robot first: arms (without their knots), links, angles and loops. Raises
    `InputError` for too many joints."""
    arms, first, start, loop = list[tuple[float, ...]](), 0, 0, 0
    tables: dict[str, list[FloatArray]] = {"links": [], "angles": [], "loops": []}
    for robot in robots:
        n = len(robot.joints)
        if n > c.MOST_JOINTS:
            raise unstated(f"an arm with {n} joints")
        rows = robot.chain_rows
        links, loops = rows.links, rows.loops
        if arms:
            links, loops = links.copy(), loops.copy()
            parents, turns = links[:, c.LINK_PARENT], links[:, c.LINK_YAW : c.LINK_COUPLER]
            parents += first * (parents >= 0.0)
            turns += start * (turns >= 0.0)
            loops[:, c.LOOP_CRANK : c.LOOP_LENGTH] += first
            loops[:, c.LOOP_BETWEEN] += start
        arms.append((first, len(links), n, 0, 0, start, len(rows.angles), loop if len(loops) else -1))
        for table, each in zip(tables.values(), (links, rows.angles, loops), strict=True):
            table.append(each)
        first, start, loop = first + len(links), start + len(rows.angles), loop + len(loops)
    found = {name: np.concatenate(each) if len(each) > 1 else each[0] for name, each in tables.items()}
    return {"arms": c.table("arms", arms), **found}


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
    knots, n = path.knots, path.n
    before, after, count = int(begin < path.start), int(until > path.end), len(knots)
    found = np.zeros((count + before + after, c.KNOT))
    own = found[before : before + count]
    own[:, c.KNOT_TIME] = knots[:, 0]
    for k, first in enumerate((c.KNOT_Q, c.KNOT_QD, c.KNOT_QDD)):
        own[:, first : first + n] = knots[:, 1 + k * n : 1 + (k + 1) * n]
    for needed, end, t in ((before, 0, begin), (after, -1, until)):
        if needed:
            if knots[end, 1 + n :].any():
                when = "begins, and is needed before" if end == 0 else "ends, and is needed after"
                raise unstated(f"a motion that is not at rest when it {when}")
            found[end, c.KNOT_TIME], found[end, c.KNOT_Q : c.KNOT_Q + n] = t, knots[end, 1 : 1 + n]
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
    left_out = 0  # all of them, if none ends later
    for k, piece in enumerate(pieces if period == 0.0 else ()):
        if piece[own.PIECE_END] > early:
            left_out = k
            break
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
    found = list[list[float]]()
    for t0, t1, piece in zip(starts, ends, pieces, strict=True):
        if t0 < min(t1, c.LATEST_S):  # some last no time
            found.append([t0, min(t1, c.LATEST_S), *piece[own.POWER :]])
    if not (found and starts[0] >= -c.LATEST_S):
        raise unstated(f"a frame whose motion begins before {-c.LATEST_S:g} s or after {c.LATEST_S:g} s")
    return StatedLaw([*pose, *rate], found, waves, repeated)


BEYOND_S = 1e-3
"""Motions are stated for so long before the first time at which they count, s: sums of times are rounded."""


def with_knots(tables: dict[str, FloatArray], path: Trajectory, until: float) -> dict[str, FloatArray]:
    """The tables of arms and knots of a cell, with those of a robot that follows `path` and then rests until `until`,
    s. Raises `InputError` for a path that does not end at rest, and is needed longer."""
    arms, knots, others = tables["arms"].copy(), knots_of(path, path.start, until), tables["knots"]
    arms[0, c.ARM_KNOTS] = len(knots)
    arms[1:, c.ARM_KNOT] += len(knots)
    return {"arms": arms, "knots": np.concatenate((knots, others)) if len(others) else knots}


def early_of(scene: Scene) -> float:
    """The time, s, from which on a plan for a scene may need the motions of frames: whole seconds, so that many scenes
    share it."""
    latest = max([frame.uncertainty.shift_s[1] for frame in scene.frames.values()], default=0.0)
    return math.floor(scene.start.time - latest - BEYOND_S)


def frames_of(scene: Scene, early: float) -> tuple[dict[str, FloatArray], tuple[tuple[Robot, Trajectory], ...]]:
    """The tables of the frames and arms of a cell, without the knots of the robot; and the other arms with what they
    follow, from arm 1 on. `early`: from when on all motions are stated that have no begin, s (`early_of`).

    Raises `InputError` for an arm or a law that cannot be stated.
    """
    rows, waves, laws = list[list[float]](), list[tuple[float, ...]](), list[list[float]]()
    followed = list[tuple[Robot, Trajectory]]()
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
            on = same[0] + 1, link.link
        own = len(laws), len(law.pieces), len(waves), len(law.waves)
        rows.append([*on, *law.at, *own, *known.shift_s, known.yaw_rad, *law.period])
        laws += law.pieces
        waves += law.waves
    tables, knots = arms_of([scene.robot, *[robot for robot, _ in followed]]), [EMPTY["knots"]]
    arms, frames, own_knots = tables["arms"], table_of("frames", rows), 0
    for row, (_, path) in zip(arms[1:], followed, strict=True):
        knots.append(knots_at_rest(path))
        row[c.ARM_KNOT], row[c.ARM_KNOTS], own_knots = own_knots, len(knots[-1]), own_knots + len(knots[-1])
    linked = frames[:, c.FRAME_ARM] >= 0.0
    frames[linked, c.FRAME_LINK] += arms[frames[linked, c.FRAME_ARM].astype(int), c.ARM_LINK]
    tables |= {
        "frames": frames,
        "laws": table_of("laws", laws),
        "waves": table_of("waves", waves),
        "displaced": displaced_of(scene),
        "knots": np.concatenate(knots) if followed else EMPTY["knots"],
    }
    return tables, tuple(followed)


def displaced_of(scene: Scene) -> FloatArray:
    """What is uncertain of where frames are, which is kept with the cell."""
    return scene.kept.of(_displacements, scene)


def _displacements(scene: Scene) -> FloatArray:
    rows = list[tuple[float, ...]]()
    for row, frame in enumerate(scene.frames.values()):
        known = frame.uncertainty
        if known.position_m or known.speed_m_s or known.lateral_m or known.vertical_m:
            rows += _displaced(row, frame)
    return table_of("displaced", rows)


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

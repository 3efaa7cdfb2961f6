"""Frames: links of other arms, or laws of motion; and by how much each may be displaced."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.chain import Arms, knots_at_rest, knots_of
from assur.planner.claim.laws import StatedLaw, law_of
from assur.planner.laws import Frame
from assur.planner.model.scene import Scene
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

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
        """The same with the knots of a robot that follows `path` and then rests until `robot_until`, s. Raises
        `InputError` for a path that does not end at rest, and is needed longer."""
        arms, knots = self.tables["arms"].copy(), knots_of(path, path.start, robot_until)
        arms[0, c.ARM_KNOTS] = len(knots)
        arms[1:, c.ARM_KNOT] += len(knots)
        others = self.tables["knots"]
        return {**self.tables, "arms": arms, "knots": np.concatenate((knots, others)) if len(others) else knots}


def early_of(scene: Scene) -> float:
    """The time, s, from which on a plan for a scene may need the motions of frames: whole seconds, so that many scenes
    share it."""
    latest = max((frame.uncertainty.shift_s[1] for frame in scene.frames.values()), default=0.0)
    return math.floor(scene.start.time - latest - BEYOND_S)


def frames_of(scene: Scene) -> Frames:
    """The frames of a cell. Raises `InputError` for an arm or a law that cannot be stated."""
    arms, rows, waves, laws = Arms(), list[list[float]](), list[tuple[float, ...]](), [c.table("laws", [])]
    followed, first, pieces = list[tuple[Robot, Trajectory]](), list[int](), 0
    early = early_of(scene)
    arms.add(scene.robot)
    for frame in scene.frames.values():
        link, known, on = frame.law.link, frame.uncertainty, (-1, -1)
        if link is None:
            law = law_of(frame.law, early)
        else:
            law = StatedLaw([0.0] * 8, laws[0], [])
            same = [k for k, (robot, path) in enumerate(followed) if robot is link.robot and path is link.trajectory]
            if not same:
                same = [len(followed)]
                followed.append((link.robot, link.trajectory))
                first.append(arms.add(link.robot))
            on = same[0] + 1, first[same[0]] + link.link
        own = pieces, len(law.pieces), len(waves), len(law.waves)
        rows.append([*on, *law.at, *own, *known.shift_s, known.yaw_rad, *law.period])
        laws.append(law.pieces)
        pieces += len(law.pieces)
        waves += law.waves
    tables = arms.tables()
    knots = [knots_at_rest(path) for _, path in followed]
    counts = np.array([0, *map(len, knots)], dtype=float)
    tables["arms"][:, c.ARM_KNOT], tables["arms"][:, c.ARM_KNOTS] = np.cumsum(counts) - counts, counts
    tables |= {
        "frames": c.table("frames", rows),
        "laws": np.concatenate(laws),
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

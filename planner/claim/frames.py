"""Frames: links of other arms, or laws of motion; and by how much each may be displaced."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.chain import Arms, knots_of
from assur.planner.claim.laws import endless, law_of
from assur.planner.laws import Frame, Law
from assur.planner.model.scene import Scene
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

NO_PERIOD = (0.0, 0.0, 0.0, 0.0, 0.0)
BEYOND_S = 1e-3
"""Motions around the robot are stated for so long before and after they count, s: sums of times are rounded."""


@dataclass(frozen=True, eq=False)
class Frames:
    """The frames of a cell. `laws`: those that are stated piece by piece, for a time, by row; `others`: the other arms
    and what they follow, in their order from arm 1 on; `tables`: of this kind, as far as they depend on no time."""

    tables: dict[str, FloatArray]
    laws: tuple[tuple[int, Law], ...]
    others: tuple[tuple[Robot, Trajectory], ...]
    shifts: tuple[float, float]
    """The least lateness of a frame and the greatest, s."""
    late: float
    """The greatest lateness of the robot's start, s."""

    def around(self, path: Trajectory, robot_until: float, end: float) -> dict[str, FloatArray]:
        """The same with the knots of all arms and with laws, for a robot that follows `path` and then rests until
        `robot_until`, s, in a plan that ends at `end`, s. Raises `InputError` for what cannot be stated."""
        begin = path.start - self.shifts[1] - BEYOND_S
        end = end + self.late - self.shifts[0] + BEYOND_S
        arms, knots = self.tables["arms"].copy(), [knots_of(path, path.start, robot_until)]
        knots += [knots_of(other, begin, end) for _, other in self.others]
        counts = np.array([len(each) for each in knots], dtype=float)
        arms[:, c.ARM_KNOT], arms[:, c.ARM_KNOTS] = np.cumsum(counts) - counts, counts
        found = {**self.tables, "arms": arms, "knots": knots[0] if len(knots) == 1 else np.concatenate(knots)}
        if self.laws:
            frames, blocks = self.tables["frames"].copy(), []
            for row, law in self.laws:
                placed, pieces, _ = law_of(law, begin, end)
                frames[row, c.FRAME_POSE : c.FRAME_PIECE], frames[row, c.FRAME_PIECES] = placed, len(pieces)
                blocks.append(pieces)
            frames[:, c.FRAME_PIECE] = np.cumsum(frames[:, c.FRAME_PIECES]) - frames[:, c.FRAME_PIECES]
            found |= {"frames": frames, "laws": np.concatenate(blocks)}
        return found


def frames_of(scene: Scene) -> Frames:
    """The frames of a cell. Raises `InputError` for an arm that cannot be stated."""
    arms, rows, waves, laws = Arms(), list[list[float]](), list[tuple[float, ...]](), list[tuple[int, Law]]()
    followed, first = list[tuple[Robot, Trajectory]](), list[int]()
    arms.add(scene.robot)
    for row, frame in enumerate(scene.frames.values()):
        law, known, on, placed = frame.law, frame.uncertainty, (-1, -1), [0.0] * 8
        own: list[tuple[float, ...]] = []
        link = law.link
        if link is not None:
            same = [k for k, (robot, path) in enumerate(followed) if robot is link.robot and path is link.trajectory]
            if not same:
                same = [len(followed)]
                followed.append((link.robot, link.trajectory))
                first.append(arms.add(link.robot))
            on = same[0] + 1, first[same[0]] + link.link
        elif endless(law):
            placed, _, own = law_of(law, -math.inf, math.inf)
        else:
            laws.append((row, law))
        rows.append([*on, *placed, 0, 0, len(waves), len(own), *known.shift_s, known.yaw_rad, *NO_PERIOD])
        waves += own
    shifts = [frame.uncertainty.shift_s for frame in scene.frames.values()]
    displaced = [each for row, frame in enumerate(scene.frames.values()) for each in _displaced(row, frame)]
    tables = {
        **arms.tables(),
        "frames": c.table("frames", rows),
        "laws": c.table("laws", []),
        "waves": c.table("waves", waves),
        "displaced": c.table("displaced", displaced),
    }
    least, most = min((low for low, _ in shifts), default=0.0), max((high for _, high in shifts), default=0.0)
    late = scene.execution.start_tolerance_s
    return Frames(tables, tuple(laws), tuple(followed), (least, most), late)


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

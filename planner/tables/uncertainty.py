"""What is not known of where bodies are, phase by phase, as the sets that kernels read (equation N8).

Errors that two bodies have in common do not part them: the bodies on a belt are off by one error, and a controller that
corrects for it shifts the tool by the same. So of each frame's error along its line a body has a share: all of it where
it sits on the frame, all of it for the tool while it tracks the frame with correction, anything from none to all of it
for the tool on its way there, none for all else. What counts of a pair is the greatest difference of both shares.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.uncertainty import (
    FLAT,
    FLAT_GROWTH,
    MOST_SEGMENTS,
    SEGMENT,
    SEGMENTS,
    SET_COLUMNS,
    UPRIGHT,
    UPRIGHT_GROWTH,
)
from assur.planner.laws.law import EXACT, Frame, PoseUncertainty, Uncertainty
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene

BASE, ARM, TOOL, HELD = range(4)
"""Kinds of the robot's bodies: on what never moves, on its arms, on the flange, and the part in the gripper."""
KINDS = 4


def tool_shares(scene: Scene, phase: Phase) -> dict[str, tuple[float, float]]:
    """The frames in whose error along their line the tool has a share, with the least and the greatest share."""
    if phase.tracked is None:
        return dict.fromkeys(phase.corrected, (0.0, 1.0))
    if scene.corrects(phase.tracked):
        return {phase.tracked: (1.0 if scene.corrects_all(phase.tracked) else 0.0, 1.0)}
    return {}


@dataclass(frozen=True, slots=True)
class Seat:
    """Where a body sits, as far as its errors depend on it: its frame's name, how far its points are from the frame's
    axis and from its own, m, and what is not known of its pose."""

    frame: str
    far: float
    radius: float
    within: PoseUncertainty


class Displacements:
    """The sets of one phase: pairs ask for theirs, and get its number."""

    def __init__(self, scene: Scene, phase: Phase) -> None:
        self.scene, self.phase = scene, phase
        self._rows: list[FloatArray] = []
        self._numbers: dict[bytes, int] = {}
        self.tool = tool_shares(scene, phase)
        exact = all(within == EXACT for _, within in phase.handled.within)
        self.known = exact and not any(map(self._unsure, scene.frames.values()))
        """Whether there is nothing that is not known, so that no pair has a set."""
        self.known = self.known and all(body.uncertainty == EXACT for body in scene.bodies)

    @staticmethod
    def _unsure(frame: Frame) -> bool:
        known = frame.uncertainty
        return any((known.position_m, known.speed_m_s, known.lateral_m, known.vertical_m, known.yaw_rad))

    @property
    def table(self) -> FloatArray:
        """The sets (N, SET_COLUMNS)."""
        return np.array(self._rows).reshape(-1, SET_COLUMNS)

    @property
    def shift(self) -> tuple[float, float]:
        """How far, m, a correction may shift the tool, and by how much that grows, m/s."""
        known = [self.scene.frames[name].uncertainty for name in self.tool]
        return sum(each.position_m for each in known), sum(each.speed_m_s for each in known)

    def of_others(self, seat: Seat) -> int:
        """The first of KINDS numbers of sets: a body of the surroundings against each kind of the robot's bodies."""
        first = len(self._rows)
        for kind in range(KINDS):
            self._rows.append(self._set(kind, seat))
        return first

    def within_robot(self, one: int, other: int) -> int:
        """The set of two of the robot's own bodies, of these kinds; -1: none."""
        row = np.zeros(SET_COLUMNS)
        if (one >= TOOL) != (other >= TOOL):
            for name in self.tool:
                _add_error(row, self.scene.frames[name])
        if HELD in (one, other):
            self._add_held(row)
        return self._numbered(row)

    def placed(self, one: Seat, other: Seat) -> int:
        """The set of a part that was put down and another body on another frame; -1: none."""
        row = np.zeros(SET_COLUMNS)
        for seat in (one, other):
            _add_error(row, self.scene.frames[seat.frame])
            self._add_seat(row, seat)
        return self._numbered(row)

    def _numbered(self, row: FloatArray) -> int:
        if not row.any():
            return -1
        key = row.tobytes()
        if key not in self._numbers:
            self._numbers[key] = len(self._rows)
            self._rows.append(row)
        return self._numbers[key]

    def _set(self, kind: int, seat: Seat) -> FloatArray:
        row = np.zeros(SET_COLUMNS)
        shares = self.tool if kind >= TOOL else {}
        for name in dict.fromkeys((seat.frame, *shares)):
            low, high = shares.get(name, (0.0, 0.0))
            own = 1.0 if name == seat.frame else 0.0
            if max(abs(own - low), abs(own - high)) > 0.0:
                _add_error(row, self.scene.frames[name])
        self._add_seat(row, seat)
        if kind == HELD:
            self._add_held(row)
        return row

    def _add_seat(self, row: FloatArray, seat: Seat) -> None:
        """What counts for a body in any case: the rest of its frame's errors, and its own."""
        frame = self.scene.frames[seat.frame]
        known, along = frame.uncertainty, frame.law.line
        if known.lateral_m > 0.0 and along is not None:
            level = math.hypot(along[0], along[1])
            across = np.array([-along[1], along[0], 0.0]) / level if level > 0.0 else None
            if across is None:
                row[FLAT] += known.lateral_m  # what travels straight up has no side
            else:
                _add_segment(row, known.lateral_m, 0.0, across)
        row[UPRIGHT] += known.vertical_m
        row[FLAT] += known.yaw_rad * seat.far
        _add_pose(row, seat.within, seat.radius)

    def _add_held(self, row: FloatArray) -> None:
        held = self.phase.attached.held
        within = None if held is None else self.phase.handled.of(held.part)
        if held is not None and within is not None:
            _add_pose(row, within, self.scene.index[held.part].body.radius)


def _add_pose(row: FloatArray, within: PoseUncertainty, radius: float) -> None:
    row[FLAT] += within.position_m + within.yaw_rad * radius
    row[UPRIGHT] += within.vertical_m


def _add_error(row: FloatArray, frame: Frame) -> None:
    """The error of a frame that grows: along its line, or in every horizontal direction."""
    known: Uncertainty = frame.uncertainty
    if not (known.position_m > 0.0 or known.speed_m_s > 0.0):
        return
    along = frame.law.line
    if along is None:
        row[FLAT] += known.position_m
        row[FLAT_GROWTH] += known.speed_m_s
    else:
        _add_segment(row, known.position_m, known.speed_m_s, along)


def _add_segment(row: FloatArray, length: float, growth: float, along: FloatArray) -> None:
    for i in range(MOST_SEGMENTS):
        at = SEGMENTS + i * SEGMENT
        if row[at] == 0.0 and row[at + 1] == 0.0:
            row[at], row[at + 1], row[at + 2 : at + 5] = length, growth, along
            return
    # more than there is room for: in every direction
    row[FLAT] += length
    row[FLAT_GROWTH] += growth
    row[UPRIGHT] += length * abs(along[2])
    row[UPRIGHT_GROWTH] += growth * abs(along[2])

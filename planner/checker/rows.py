"""A certificate before the checker's kernels: what is required of each pair, and what is found, in words."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker import cover
from assur.planner.checker.cover import AWAY, CONTACT, JUDGED, OUTSIDE, SPARED, STATUS, UNIT_NORMAL, UNKNOWN, Cell
from assur.planner.checker.motion import Tables
from assur.planner.checker.separation import CLAIMED, MOST, REACHED, STATE, WRONG
from assur.planner.checker.solids import Solids
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Certificate
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene

ROOM = 64
"""Pairs that may be open at a time, beyond some for each row, at first; who needs more gets it."""


@dataclass(frozen=True, eq=False)
class Apart:
    """What must be kept apart: the phases of a plan, its solids, and for the kernels the tables, what is required
    (`cover.Cell`) and which pairs may touch (P, U, B)."""

    phases: tuple[Phase, ...]
    table: Solids
    tables: Tables
    cell: Cell
    marks: IntArray

    @staticmethod
    def of(scene: Scene, phases: tuple[Phase, ...], table: Solids, tables: Tables) -> Apart:
        """What `scene` requires in some phases (C5)."""
        robot, mine, number = scene.robot, table.mine, table.number
        wanted = np.zeros((table.links, table.links), dtype=np.int64)
        for names in robot.self_pairs:
            i, k = (robot.links.index(name) for name in names)
            wanted[i, k] = wanted[k, i] = i != k
        robots = (mine >= 0).nonzero()[0]
        marks = np.zeros((len(phases), len(robots), len(mine)), dtype=np.int64)
        for i, phase in enumerate(phases):
            for first, second in phase.contacts:
                if first in number and second in number:
                    a, b = cover.ordered(mine, number[first], number[second])
                    if mine[a] >= 0:
                        marks[i, mine[a], b] = CONTACT
        spans = np.array([(phase.t0, phase.t1) for phase in phases]).reshape(-1, 2)
        need, drift = _required(scene, phases)
        late = float(scene.execution.start_tolerance_s)
        cell = (table.seat, table.seats, wanted, table.count, mine, robots[None], spans, need, drift, late)
        return Apart(phases, table, (*tables[:4], table.table, table.vertices), cell, marks)

    def found(self, certificate: Certificate, claimed: float) -> tuple[list[Finding], FloatArray]:
        """Rows that mean or prove nothing, and pairs that are not kept apart; and what stands against the clearance
        `claimed` of all pairs that may not touch, m (`separation.STATE`; -inf: none is claimed)."""
        verdicts, holes, state = self.judged(certificate, claimed)
        wrong = _found(certificate, verdicts) if state[WRONG] > 0.0 else []
        return wrong + self._holes(holes), state

    def judged(self, c: Certificate, claimed: float = -math.inf) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What is found of each row (M, cover.VERDICT), of each phase (P, cover.HOLES) and of the claim (STATE,)."""
        table, state, room = self.table, np.zeros(STATE), 4 * len(c) + ROOM
        numbers = np.array([table.number.get(name, -1) for name in c.names], dtype=np.int64)
        order, rows = np.lexsort((c.t1, c.t0)), np.empty((len(c), cover.COLUMNS))
        rows[:, cover.T0], rows[:, cover.T1], rows[:, cover.N :] = c.t0, c.t1, c.normal
        rows[:, cover.NAME], rows[:, cover.PIECE] = c.first, c.first_piece
        rows[:, cover.OTHER_NAME], rows[:, cover.OTHER_PIECE] = c.second, c.second_piece
        verdicts, holes = np.zeros((len(c), cover.VERDICT)), np.zeros((len(self.phases), cover.HOLES))
        while True:
            state[:], state[CLAIMED], state[REACHED] = 0.0, claimed, math.nan if claimed == -math.inf else math.inf
            if cover.judge(
                rows, order, numbers, self.cell, self.marks.copy(), self.tables, room, verdicts, holes, state
            ):
                return verdicts, holes, state
            room *= 4
            if room > MOST:
                verdicts[:], state[WRONG], state[REACHED] = 0.0, 1.0, math.nan
                return verdicts, holes, state

    def _holes(self, holes: FloatArray) -> list[Finding]:
        """A finding for each phase in which a pair is not covered throughout, by rows or by a plane."""
        findings = []
        for phase, (many, hole, *pair) in zip(self.phases, holes.tolist(), strict=True):
            if many > 0:
                names = " and ".join(self.table.bodies[int(body)].name for body in sorted(pair))
                where = f"{phase.kind}, {hole:.6g} s"
                findings.append(Finding(Code.COVER, f"no row keeps {names} apart", many, "pairs", where))
        return findings

    def required(self, phase: int, a: int, b: int) -> bool:
        """Whether two bodies must stay apart in a phase and may not touch."""
        first, second = cover.ordered(self.table.mine, a, b)
        if a == b or not cover.required(self.cell, phase, a, b):
            return False
        return not self.marks[phase, self.table.mine[first], second] & CONTACT


def _found(c: Certificate, verdicts: FloatArray) -> list[Finding]:
    """One finding for all rows that are wrong in the same way, the worst of them named."""
    status, spared, away = verdicts[:, STATUS], verdicts[:, SPARED], verdicts[:, AWAY]
    judged, alone = status == JUDGED, (c.second == -1) & (c.second_piece == -1)
    proved = (spared >= 0.0) | (alone & (spared > -np.inf))
    findings: list[Finding] = []
    for code, what, bad, amount, unit in (
        (Code.ROW, "names a body or a piece that does not exist", status == UNKNOWN, None, ""),
        (Code.ROW, "is not inside one phase", status == OUTSIDE, None, ""),
        (Code.NORMAL, "has a normal whose length is not 1", judged & ~(away <= UNIT_NORMAL), away, "1"),
        (Code.SEPARATION, "does not prove the required distance", judged & ~proved, -spared, "m"),
    ):
        at = np.flatnonzero(bad)
        if len(at):
            k = int(at[0] if amount is None else at[np.argmax(np.where(np.isnan(amount[at]), np.inf, amount[at]))])
            names = [c.names[n] if 0 <= n < len(c.names) else "none" for n in (int(c.first[k]), int(c.second[k]))]
            text = f"a row of {names[0]} and {names[1]} {what} ({len(at)} such rows)"
            worst = math.nan if amount is None else float(amount[k])
            findings.append(Finding(code, text, worst, unit, f"row {k}, {c.t0[k]:.6g} to {c.t1[k]:.6g} s"))
    return findings


def _required(scene: Scene, phases: tuple[Phase, ...]) -> tuple[FloatArray, FloatArray]:
    """The distance (P, F + 1) m required of bodies on each frame at time 0, the last column for the robot itself, and
    what is added each second (P, F): equation C5 without the term of a late start.

    Whom the controller corrects for counts: a frame that a corrected leg follows takes the arm with it.
    """
    frames, execution = list(scene.frames.values()), scene.execution
    number = {frame.name: k for k, frame in enumerate(frames)}
    unsure = np.array([(frame.uncertainty.position_m, frame.uncertainty.speed_m_s) for frame in frames]).reshape(-1, 2)
    need, drift = np.empty((len(phases), len(frames) + 1)), np.empty((len(phases), len(frames)))
    for i, phase in enumerate(phases):
        clearance = scene.options.clearance.near_m if phase.near else scene.options.clearance.travel_m
        counts = unsure
        if execution.belt_correction:
            shifts = sorted({number[name] for name in (phase.corrected if phase.tracked is None else [phase.tracked])})
            counts = unsure + unsure[shifts].sum(0)
            # what shifts the arm with a frame does not part it from that frame
            counts[shifts] = 0.0 if phase.tracked is not None else counts[shifts] - unsure[shifts]
        drift[i] = counts[:, 1]
        need[i, :-1] = clearance + execution.tracking_m + counts[:, 0] - drift[i] * scene.start.time
        need[i, -1] = clearance
    return need, drift

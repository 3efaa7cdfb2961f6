"""A certificate before the checker's kernels: what is required of each pair, and what is found, in words."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker import cover, row_table
from assur.planner.checker.cover import (
    AWAY,
    CONTACT,
    JUDGED,
    OUTSIDE,
    PUT_DOWN,
    REVERSED,
    SPARED,
    STATUS,
    UNIT_NORMAL,
    UNKNOWN,
    Cell,
)
from assur.planner.checker.doubts import ahead, doubt_of, reaches, stands
from assur.planner.checker.motion import Tables
from assur.planner.checker.separation import CLAIMED, MOST, PUT_CLAIMED, REACHED, STATE, WRONG
from assur.planner.checker.solids import CARRIER, Solids
from assur.planner.checker.uncertainty import Doubt
from assur.planner.checker.verdict import Code, Finding
from assur.planner.geometry.containment import nothing
from assur.planner.model.outcome import Certificate
from assur.planner.model.phases import CONTACT_M, Phase
from assur.planner.model.scene import Scene

BLOCK = 250
"""Rows that are judged between two looks at the time: some hundredths of a second."""
Given = tuple[IntArray, Cell, IntArray, Tables, Doubt, int, FloatArray, FloatArray, FloatArray]
"""What `cover.judge` and `cover.judge_planes` take beyond rows and their order."""
NONE = (-math.inf, -math.inf)
"""No clearance is claimed, neither of what the arm bears nor of parts that were put down."""
ROOM = 64
"""Pairs that may be open at a time, at first, beyond some for each row and those behind planes; who needs more gets
it."""


@dataclass(frozen=True, eq=False)
class Apart:
    """What must be kept apart: the phases of a plan, its solids, and for the kernels the tables, what is required
    (`cover.Cell`), what is not known of them, and which pairs may touch (P, U, B)."""

    phases: tuple[Phase, ...]
    table: Solids
    tables: Tables
    cell: Cell
    doubt: Doubt
    marks: IntArray

    @staticmethod
    def of(scene: Scene, phases: tuple[Phase, ...], table: Solids, tables: Tables) -> Apart:
        """What `scene` requires in some phases (C5)."""
        robot, mine = scene.robot, table.mine
        wanted = np.zeros((table.links, table.links), dtype=np.int64)
        for names in robot.self_pairs:
            i, k = (robot.links.index(name) for name in names)
            wanted[i, k] = wanted[k, i] = i != k
        robots = (mine >= 0).nonzero()[0]
        marks = _marks(scene, phases, table)
        spans = np.array([(phase.t0, phase.t1) for phase in phases]).reshape(-1, 2)
        kinds = np.array(
            [(float(p.near), float(p.robot), -CONTACT_M - p.contact_tolerance_m) for p in phases], dtype=np.float64
        ).reshape(-1, 3)
        doubt = doubt_of(scene, phases, table)
        cell = (
            table.seat, table.seats, wanted, table.count, mine, robots[None], spans, kinds,
            _clearances(scene, table, robots), reaches(table, doubt), ahead(scene, table.links),
        )  # fmt: skip
        tables = (*tables[:4], table.table, table.vertices)
        return Apart(phases, table, tables, cell, doubt, marks)

    def found(
        self, certificate: Certificate, claimed: tuple[float, float] = NONE, between: Callable[[], None] = nothing
    ) -> tuple[list[Finding], FloatArray]:
        """Rows that mean or prove nothing, and pairs that are not kept apart; and what stands against the clearance
        `claimed` of all pairs that may not touch, m: of those of the arm, its tool and what it holds, and of parts that
        were put down (`separation.STATE`; -inf: none is claimed). `between` is called
        between blocks of the work; what it raises is raised."""
        verdicts, holes, state = self.judged(certificate, claimed, between)
        wrong = _found(certificate, verdicts) if state[WRONG] > 0.0 else []
        return wrong + self._holes(holes), state

    def judged(
        self, c: Certificate, claimed: tuple[float, float] = NONE, between: Callable[[], None] = nothing
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What is found of each row (M, cover.VERDICT), of each phase (P, cover.HOLES) and of the claim (STATE,)."""
        table, state = self.table, np.zeros(STATE)
        numbers = np.array([table.number.get(name, -1) for name in c.names], dtype=np.int64)
        order, rows = np.lexsort((c.t1, c.t0)), np.empty((len(c), row_table.COLUMNS))
        rows[:, row_table.T0], rows[:, row_table.T1], rows[:, row_table.N : row_table.N + 3] = c.t0, c.t1, c.normal
        rows[:, row_table.S0], rows[:, row_table.S1] = (0.0, 0.0) if c.shift0 is None else (c.shift0, c.shift1)
        rows[:, row_table.NAME], rows[:, row_table.PIECE] = c.first, c.first_piece
        rows[:, row_table.OTHER_NAME], rows[:, row_table.OTHER_PIECE] = c.second, c.second_piece
        verdicts, spared = np.zeros((len(c), cover.VERDICT)), np.empty(len(c))
        blocks = _blocks(rows, order)
        room = 4 * max(map(len, blocks)) + math.prod(self.marks.shape[1:]) + ROOM
        while True:
            state[:], state[REACHED] = 0.0, math.nan if claimed == NONE else math.inf
            state[CLAIMED], state[PUT_CLAIMED] = claimed
            spared[:], marks = np.inf, self.marks.copy()
            given = (numbers, self.cell, marks, self.tables, self.doubt, room, verdicts, spared, state)
            if self._judged(rows, blocks, given, between) and cover.judge_planes(rows, order, *given):
                return verdicts, self._uncovered(rows, order, numbers, marks, verdicts, between), state
            room *= 4
            if room > MOST:
                verdicts[:], state[WRONG], state[REACHED] = 0.0, 1.0, math.nan
                return verdicts, np.zeros((len(self.phases), cover.HOLES)), state

    @staticmethod
    def _judged(rows: FloatArray, blocks: list[IntArray], given: Given, between: Callable[[], None]) -> bool:
        """Judges all rows; whether there was room enough."""
        for block in blocks:
            between()
            if not cover.judge(rows, block, *given):
                return False
        return True

    def _uncovered(
        self,
        rows: FloatArray,
        order: IntArray,
        numbers: IntArray,
        marks: IntArray,
        verdicts: FloatArray,
        between: Callable[[], None],
    ) -> FloatArray:
        """What is not covered of each phase (P, cover.HOLES)."""
        head, chain = np.zeros(marks.shape, dtype=np.int64), np.zeros((len(rows), 2), dtype=np.int64)
        cover.chained(rows, order, numbers, self.cell, marks, verdicts, head, chain)
        holes = np.zeros((len(self.phases), cover.HOLES))
        holes[:, cover.HOLE] = np.inf
        for p, phase in enumerate(self.phases):
            for u in range(marks.shape[1] if phase.t1 > phase.t0 else 0):
                between()
                cover.holes_of(rows, self.cell, marks, p, u, head, chain, holes[p])
        return holes

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
        if a == b or not cover.required(self.cell, self.marks, phase, a, b):
            return False
        return not self.marks[phase, self.table.mine[first], second] & CONTACT


def _blocks(rows: FloatArray, order: IntArray) -> list[IntArray]:
    """The rows in their order, `BLOCK` of them at a time or somewhat more: none cuts an interval."""
    if not len(order):
        return [order]
    spans = rows[order][:, [row_table.T0, row_table.T1]]
    begins = np.flatnonzero(np.append(True, (spans[1:] != spans[:-1]).any(1)))
    cuts = begins[np.flatnonzero(np.diff(begins // BLOCK)) + 1]
    return np.split(order, cuts)


def _marks(scene: Scene, phases: tuple[Phase, ...], table: Solids) -> IntArray:
    """Which pairs may touch, and which of a part that was put down and what moves against it must be kept clear."""
    mine, number, seats = table.mine, table.number, table.seats
    marks = np.zeros((len(phases), int((mine >= 0).sum()), len(mine)), dtype=np.int64)
    moves = np.zeros(table.links + len(scene.frames), dtype=np.bool_)
    moves[table.links :] = [not stands(frame.law) for frame in scene.frames.values()]
    for i, phase in enumerate(phases):
        for first, second in phase.contacts:
            if first in number and second in number:
                a, b = cover.ordered(mine, number[first], number[second])
                if mine[a] >= 0:
                    marks[i, mine[a], b] |= CONTACT
        held = None if phase.attached.held is None else phase.attached.held.part
        carrier = seats[table.seat[i], CARRIER]
        for part in (name for name, _ in phase.handled.within if name != held):
            own = number[part]
            for other in np.flatnonzero(carrier >= table.links).tolist():
                both = {part, table.bodies[other].name}
                passes = carrier[own] != carrier[other] and (moves[carrier[own]] or moves[carrier[other]])
                if not passes or any(both == set(each) for each in phase.handled.supports):
                    continue
                a, b = cover.ordered(mine, own, other)
                if not marks[i, mine[a], b] & PUT_DOWN:
                    marks[i, mine[a], b] |= PUT_DOWN | (REVERSED if a != own else 0)
    return marks


def _clearances(scene: Scene, table: Solids, robots: IntArray) -> FloatArray:
    """Distances asked, travel and near, of each body that is the robot's at some time from all (2, U, B)."""
    asked = scene.options.clearance
    found = np.empty((2, len(robots), len(table.bodies)))
    found[0], found[1] = asked.travel_m, asked.near_m
    names = [body.name for body in table.bodies]
    for rule in asked.exceptions:
        one, other = ([not named or name in named for name in names] for named in (rule.first, rule.second))
        for u, body in enumerate(robots.tolist()):
            for b in range(len(names)):
                if (one[body] and other[b]) or (other[body] and one[b]):
                    found[:, u, b] = rule.travel_m, rule.near_m
    return found


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

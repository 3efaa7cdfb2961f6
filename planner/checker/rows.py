"""Whether the certificate keeps every asked pair of bodies apart over the whole of every phase.

Times are compared as they are: a row may begin where another ends, and not an ulp later.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.jets import F1, F2
from assur.planner.checker.motion import Tables
from assur.planner.checker.separation import DRIFT, LATE, NEED, NORMAL, ONE, ONE_ON, OTHER, OTHER_ON, ROW, T0, T1, spare
from assur.planner.checker.solids import Solids
from assur.planner.checker.verdict import Code, Finding
from assur.planner.compiled import kernel
from assur.planner.frames import Fixed
from assur.planner.model.outcome import Certificate
from assur.planner.model.phases import CONTACT_M, Phase
from assur.planner.model.scene import Scene

UNIT_NORMAL = 1e-12
"""| |n| - 1 | of a normal at most: a normalised vector is off by 2e-16; in a cell of 50 m this is 0.05 nm of gap."""
NONE = -1
"""In place of a second body: the row is of the first alone; in place of a piece: the box of the body."""


class Apart:
    """The rows of a certificate against what a scene asks for in the phases of a plan."""

    def __init__(
        self, scene: Scene, phases: tuple[Phase, ...], table: Solids, tables: Tables, certificate: Certificate
    ) -> None:
        self.scene, self.phases, self.table, self.tables, self.rows = scene, phases, table, tables, certificate
        self.t0 = np.array([phase.t0 for phase in phases])
        self.t1 = np.array([phase.t1 for phase in phases])
        self.need, self.drift = _required(scene, phases)
        self.contact = np.zeros((len(phases), len(table.count), len(table.count)), dtype=np.bool_)
        for i, phase in enumerate(phases):
            for first, second in phase.contacts:
                if first in table.number and second in table.number:
                    a, b = table.number[first], table.number[second]
                    self.contact[i, a, b] = self.contact[i, b, a] = True
        self.findings: list[Finding] = []

    def found(self) -> list[Finding]:
        """Rows that mean or prove nothing, and pairs that are not kept apart."""
        certificate, table = self.rows, self.table
        known = np.array([table.number.get(name, NONE) for name in certificate.names] or [NONE], dtype=np.int64)
        one, other = (_named(known, body) for body in (certificate.first, certificate.second))
        alone = (certificate.second == NONE) & (certificate.second_piece == NONE)
        named = (one >= 0) & (_has(table, one, certificate.first_piece)) & (alone | (other >= 0)) & (one != other)
        named &= alone | _has(table, other, certificate.second_piece)
        # a row of one body alone is of the whole of it
        named &= ~alone | (certificate.first_piece < np.where(table.count[one] == 1, 1, 0))
        phase = np.searchsorted(self.t0, certificate.t0, side="right") - 1
        inside = (phase >= 0) & (certificate.t0 <= certificate.t1) & (certificate.t1 <= self.t1[phase])
        self._tell(Code.ROW, "names a body or a piece that does not exist", ~named)
        self._tell(Code.ROW, "is not inside one phase", ~inside)
        which = np.flatnonzero(named & inside)
        # rows of one interval one after the other: what moves is computed once for them
        which = which[np.lexsort((certificate.t1[which], certificate.t0[which]))]
        phase, one, other = phase[which], one[which], np.where(alone, NONE, other)[which]
        spared = self.spare(which, phase, one, other)
        away = np.abs(np.sqrt((certificate.normal[which] ** 2).sum(1)) - 1.0)
        unit = away <= UNIT_NORMAL
        good = np.where(other < 0, spared > -np.inf, spared >= 0.0)
        self._tell(Code.NORMAL, "has a normal whose length is not 1", ~unit, away, "1", which)
        self._tell(Code.SEPARATION, "does not prove the required distance", ~good, -spared, "m", which)
        proved, pair = good & unit, other >= 0
        behind = self._planes(which[proved & ~pair], phase[proved & ~pair], one[proved & ~pair], spared[proved & ~pair])
        self._cover(which[proved & pair], phase[proved & pair], one[proved & pair], other[proved & pair], behind)
        return self.findings

    def spare(self, which: IntArray, phase: IntArray, one: IntArray, other: IntArray) -> FloatArray:
        """What the rows `which` prove beyond what is required, m (`separation.spare`)."""
        table, found = self.table, np.zeros(len(which))
        rows = self.asked(which, phase, one, other)
        spare(rows, table.links, table.tilts, table.table, table.vertices, self.tables, found)
        return found

    def asked(self, which: IntArray, phase: IntArray, one: IntArray, other: IntArray) -> FloatArray:
        """The table (N, ROW) of rows `which` of the certificate, with the distances required (C5)."""
        table, rows = self.table, np.zeros((len(which), ROW))
        rows[:, T0], rows[:, T1] = self.rows.t0[which], self.rows.t1[which]
        rows[:, NORMAL:NEED] = self.rows.normal[which]
        for body, piece, solid, on in (
            (one, self.rows.first_piece, ONE, ONE_ON),
            (other, self.rows.second_piece, OTHER, OTHER_ON),
        ):
            seat = table.seat[phase, body]
            rows[:, solid] = np.where(body < 0, NONE, table.row(seat, piece[which]))
            rows[:, on] = np.where(body < 0, NONE, table.carrier[seat])
        pair = other >= 0
        contact = self.contact[phase, one, other] & pair
        world = np.maximum(rows[:, ONE_ON], rows[:, OTHER_ON]).astype(np.int64) - table.links
        free = pair & ~contact
        # pairs of the surroundings are nobody's concern: no distance is required of them
        robot = np.minimum(rows[:, ONE_ON], rows[:, OTHER_ON]) < table.links
        rows[:, NEED] = np.where(free, np.where(robot, self.need[phase, np.maximum(world, NONE)], -np.inf), 0.0)
        rows[contact, NEED] = -CONTACT_M
        around = free & (world >= 0)
        rows[around, DRIFT] = self.drift[phase[around], world[around]]
        rows[around, LATE] = self.scene.execution.start_tolerance_s
        return rows

    def _planes(self, which: IntArray, phase: IntArray, body: IntArray, least: FloatArray) -> BoolArray:
        """(P, B, B): pairs of which the first stays behind a plane all the while, and the other, that stands still, is
        before it at the distance required (C6).

        Rows of one phase, body and normal, to the bit, count together, each beginning where the one before ends; if
        they do not last the whole phase, they count for nothing.
        """
        many, table, c = len(self.table.count), self.table, self.rows
        found = np.zeros((len(self.phases), many, many), dtype=np.bool_)
        if not len(which):
            return found
        _, group = np.unique(np.column_stack([phase, body, c.normal[which]]), axis=0, return_inverse=True)
        for k in range(int(group.max()) + 1):
            rows = np.flatnonzero(group.ravel() == k)
            rows = rows[np.argsort(c.t0[which[rows]], kind="stable")]
            p, one, row = int(phase[rows[0]]), int(body[rows[0]]), which[rows]
            joined = np.append(self.t0[p], c.t1[row]) == np.append(c.t0[row], self.t1[p])
            if joined.all() and table.carrier[table.seat[p, one]] < table.links:
                found[p, one] |= self._before(p, one, c.normal[row[0]], float(least[rows].min()))
        return found

    def _before(self, p: int, one: int, normal: FloatArray, least: float) -> BoolArray:
        """(B,): bodies that stand still throughout phase p, before the plane that `one` stays behind by `least`."""
        table, phase, tolerance = self.table, self.phases[p], self.scene.execution.start_tolerance_s
        seats = table.seat[p]
        world = table.carrier[seats] - table.links
        still = np.array(
            [
                isinstance(frame.law, Fixed) and frame.law.valid[0] <= phase.t0 and phase.t1 <= frame.law.valid[1]
                for frame in self.scene.frames.values()
            ]
            + [False],
            dtype=np.bool_,
        )[np.maximum(world, NONE)]
        rows = np.zeros((int(still.sum()), ROW))
        # the whole body against the origin, along the normal turned round: its gap is the least of n·x
        box = np.where(table.count == 1, 0, NONE)
        rows[:, T0] = rows[:, T1] = phase.t0
        rows[:, ONE], rows[:, ONE_ON] = table.row(seats, box)[still], table.carrier[seats][still]
        rows[:, NORMAL:NEED], rows[:, OTHER], rows[:, OTHER_ON] = -normal, NONE, NONE
        near = np.zeros(len(rows))
        spare(rows, table.links, table.tilts, table.table, table.vertices, self.tables, near)
        of, found = world[still], np.zeros(len(seats), dtype=np.bool_)
        need = self.need[p, of] + self.drift[p, of] * (phase.t1 + tolerance)
        found[still] = least + near >= np.where(self.contact[p, one, still], -CONTACT_M, need)
        return found

    def _cover(self, which: IntArray, phase: IntArray, one: IntArray, other: IntArray, behind: BoolArray) -> None:
        """A finding for each phase in which an asked pair is not covered throughout, by rows or by a plane."""
        table, c = self.table, self.rows
        asked = asked_pairs(self.scene, table) & ~(behind | np.swapaxes(behind, 1, 2))
        asked[~(self.t1 > self.t0)] = False
        pairs = np.argwhere(asked)
        many = len(table.count)
        low, high = np.minimum(one, other), np.maximum(one, other)
        keys, key = (pairs[:, 0] * many + pairs[:, 1]) * many + pairs[:, 2], (phase * many + low) * many + high
        order = np.lexsort((c.t0[which], key))
        row, swap = which[order], (one > other)[order]
        pieces = np.stack([c.first_piece[row], c.second_piece[row]], -1).astype(np.int64).reshape(-1, 2)
        pieces[swap] = pieces[swap, ::-1]
        spans = np.stack([np.searchsorted(key[order], keys, side) for side in ("left", "right")], -1).reshape(-1, 2)
        holes = np.full(len(pairs), np.nan)
        lasts = np.stack([self.t0[pairs[:, 0]], self.t1[pairs[:, 0]]], -1).reshape(-1, 2)
        times = np.stack([c.t0[row], c.t1[row]], -1).reshape(-1, 2)
        covered(lasts, np.ascontiguousarray(table.count[pairs[:, 1:]]), spans.astype(np.int64), times, pieces, holes)
        for p in np.unique(pairs[~np.isnan(holes), 0]):
            of = np.flatnonzero((pairs[:, 0] == p) & ~np.isnan(holes))
            i = int(of[np.argmin(holes[of])])
            names = " and ".join(table.bodies[b].name for b in pairs[i, 1:])
            where = f"{self.phases[p].kind} of step {self.phases[p].step}, {holes[i]:.6g} s"
            self.findings.append(Finding(Code.COVER, f"no row keeps {names} apart", float(len(of)), "pairs", where))

    def _tell(
        self,
        code: Code,
        what: str,
        bad: BoolArray,
        amount: FloatArray | None = None,
        unit: str = "",
        which: IntArray | None = None,
    ) -> None:
        """One finding for all bad rows, the worst of them named."""
        if not bad.any():
            return
        at = np.flatnonzero(bad)
        k = int(at[0] if amount is None else at[np.argmax(np.where(np.isnan(amount[at]), np.inf, amount[at]))])
        i, c = int(k if which is None else which[k]), self.rows
        names = [c.names[body] if 0 <= body < len(c.names) else "none" for body in (int(c.first[i]), int(c.second[i]))]
        text = f"a row of {names[0]} and {names[1]} {what} ({len(at)} such rows)"
        worst = float("nan") if amount is None else float(amount[k])
        self.findings.append(Finding(code, text, worst, unit, f"row {i}, {c.t0[i]:.6g} to {c.t1[i]:.6g} s"))


def asked_pairs(scene: Scene, table: Solids) -> BoolArray:
    """(P, B, B), above the diagonal: the pairs of bodies that must stay apart in each phase."""
    robot, carrier = table.of_robot, table.carrier[table.seat]
    count = len(table.tilts)
    wanted = np.zeros((count, count), dtype=np.bool_)
    for names in scene.robot.self_pairs:
        i, k = (scene.robot.links.index(name) for name in names)
        wanted[i, k] = wanted[k, i] = i != k
    found = (robot[:, :, None] != robot[:, None, :]) | wanted[carrier[:, :, None], carrier[:, None, :]]
    return np.triu(found, 1)


def _required(scene: Scene, phases: tuple[Phase, ...]) -> tuple[FloatArray, FloatArray]:
    """The distance (P, F + 1) m required of bodies on each frame at time 0, the last column for the robot itself, and
    what is added each second (P, F): equation C5 without the term of a late start.

    Whom the controller corrects for counts: a frame that a corrected leg follows takes the arm with it.
    """
    frames, execution = list(scene.frames.values()), scene.execution
    number = {frame.name: k for k, frame in enumerate(frames)}
    place = np.array([frame.uncertainty.position_m for frame in frames])
    speed = np.array([frame.uncertainty.speed_m_s for frame in frames])
    need, drift = np.zeros((len(phases), len(frames) + 1)), np.zeros((len(phases), len(frames)))
    for i, phase in enumerate(phases):
        clearance = scene.options.clearance.near_m if phase.near else scene.options.clearance.travel_m
        counts = np.eye(len(frames))  # whether the uncertainty of a frame (column) counts for bodies on another (row)
        if execution.belt_correction and phase.tracked is not None:
            k = number[phase.tracked]
            counts[:, k] = 1.0
            counts[k, k] = 0.0
        elif execution.belt_correction:
            counts[:, [number[name] for name in phase.corrected]] = 1.0
        drift[i] = counts @ speed
        need[i, :-1] = clearance + execution.tracking_m + counts @ place - drift[i] * scene.start.time
        need[i, -1] = clearance
    return need, drift


def _named(known: IntArray, index: IntArray) -> IntArray:
    """Our numbers of the bodies that a column names; NONE for none."""
    inside = (index >= 0) & (index < len(known))
    return np.where(inside, known[np.where(inside, index, 0)], NONE)


def _has(table: Solids, body: IntArray, piece: IntArray) -> BoolArray:
    return np.asarray((piece >= NONE) & (piece < table.count[np.maximum(body, 0)]))


@kernel(f"void({F2}, int64[:, ::1], int64[:, ::1], {F2}, int64[:, ::1], {F1})")
def covered(
    lasts: FloatArray, counts: IntArray, spans: IntArray, times: FloatArray, pieces: IntArray, holes: FloatArray
) -> None:
    """When each pair (N,), to be kept apart over `lasts`, is first not covered, into `holes`; not written: never.

    Its rows are spans[i, 0] to spans[i, 1] - 1 of `times` and `pieces`, in the order of their begins; -1 is all pieces.
    """
    for i in range(len(lasts)):
        one, other = counts[i, 0], counts[i, 1]
        whole, split = lasts[i, 0], False
        for r in range(spans[i, 0], spans[i, 1]):
            mine = (pieces[r, 0] < 0 or one == 1) and (pieces[r, 1] < 0 or other == 1)
            split = split or not mine
            if mine and times[r, 0] <= whole:
                whole = max(whole, times[r, 1])
        if whole >= lasts[i, 1]:
            continue
        if not split:
            holes[i] = whole
            continue
        reached = np.full((one, other), lasts[i, 0])
        for r in range(spans[i, 0], spans[i, 1]):
            a, b = pieces[r, 0], pieces[r, 1]
            for j in range(0 if a < 0 else a, one if a < 0 else a + 1):
                for k in range(0 if b < 0 else b, other if b < 0 else b + 1):
                    if times[r, 0] <= reached[j, k]:
                        reached[j, k] = max(reached[j, k], times[r, 1])
        if not reached.min() >= lasts[i, 1]:
            holes[i] = reached.min()

"""Proves phases, round by round: what is not proved is halved, boxes become pieces, and FCL decides what touches."""

from __future__ import annotations

import math
import time

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.collision.arrangement import COVER, Solids, SolidsMaker, asked_pairs
from assur.planner.collision.claim import Claim, put, take
from assur.planner.collision.fcl_door import Collider
from assur.planner.collision.gjk import separate
from assur.planner.collision.planes import MANY, planes
from assur.planner.collision.proof_facts import Facts, Intervals, Thrice
from assur.planner.collision.rows import Rows, Unproved, no_rows
from assur.planner.collision.support_gaps import centre_normals, face_normals
from assur.planner.model.clearance import SLACK_M
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

COARSEST_S = 0.08
"""Intervals with which a phase begins, where vertical order alone does not prove it, s."""
FINEST_S = 2e-5
"""Intervals are halved no further than this, s: what is not proved by then is NOT_CERTIFIED."""
MOST_ROWS = 200_000
"""A phase that needs more rows than this is not certified: it would be neither quick nor small."""


class Prover:
    """Proves phases of one scene. Keeps the arrangements and the FCL objects of the scene."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.solids = SolidsMaker(scene)
        self.deadline = math.inf
        """Reading of `time.perf_counter` at which proofs are given up: what is not proved by then is not certified."""
        self.collider = Collider()
        self._asked: dict[int, tuple[IntArray, IntArray]] = {}

    def asked(self, solids: Solids) -> tuple[IntArray, IntArray]:
        """Units (P,), (P,) of all pairs of bodies that must be kept apart in this arrangement."""
        if id(solids) not in self._asked:
            self._asked[id(solids)] = asked_pairs(self.scene, solids)
        return self._asked[id(solids)]

    def prove(self, phase: Phase, trajectory: Trajectory) -> Rows | Unproved:
        """Rows that cover every asked pair over the whole phase, or the first pair that resists."""
        if not phase.t1 > phase.t0:
            return no_rows(self.solids(phase.carried, phase.rides))
        return _Proof(self, phase, trajectory).run()


class _Proof:
    """The proof of one phase, round by round."""

    def __init__(self, prover: Prover, phase: Phase, trajectory: Trajectory) -> None:
        self.prover, self.phase = prover, phase
        self.solids = prover.solids(phase.carried, phase.rides)
        self.facts = Facts(prover.scene, self.solids, phase, trajectory)
        self.done: list[tuple[IntArray, IntArray, FloatArray, FloatArray, Claim]] = []

    @np.errstate(invalid="ignore")  # where a law is not known there is NaN, and nothing is proved by it
    def run(self) -> Rows | Unproved:
        a, b = self.prover.asked(self.solids)
        count = max(1, int(np.ceil((self.phase.t1 - self.phase.t0) / COARSEST_S)))
        edges = np.linspace(self.phase.t0, self.phase.t1, count + 1)
        # interval 0 is the whole phase, the parts with which it begins otherwise are behind it
        table = self.facts.intervals(np.append(edges[0], edges[:-1]), np.append(edges[-1], edges[1:]))
        if len(a) > MANY:
            behind, done = planes(self.facts, (table.some(slice(1)), table.some(slice(1, None))), a, b)
            self.done += [(rows.unit, rows.second, rows.t0, rows.t1, rows.claim) for rows in behind]
            a, b = a[~done], b[~done]
        row = np.zeros(len(a), dtype=np.int64)
        placed = self.facts.thrice(table, row, a, b)
        left = self.keep(table, row, a, b, self.facts.claim(table, row, a, b, placed, placed.vertical()))
        a, b = a[left], b[left]
        return self.rounds(table, 1 + np.repeat(np.arange(count), len(a)), np.tile(a, count), np.tile(b, count), None)

    def rounds(
        self, table: Intervals, row: IntArray, a: IntArray, b: IntArray, seed: FloatArray | None
    ) -> Rows | Unproved:
        """`seed`: for each row a normal that has been the best for longer intervals."""
        while len(row):
            if len(row) > MOST_ROWS or time.perf_counter() >= self.prover.deadline:
                return self.unproved(table, row, a, b, 0, np.nan, np.nan, touching=False)
            placed = self.facts.thrice(table, row, a, b)
            normals = centre_normals(*placed.middle())
            if seed is not None:
                normals = np.concatenate([normals, seed[:, None]], axis=1)
            claim = self.facts.claim(table, row, a, b, placed, normals)
            rest = self.keep(table, row, a, b, claim)
            if not rest.any():
                break
            row, a, b, claim, placed = row[rest], a[rest], b[rest], take(claim, rest), placed.some(rest)
            close = ~(claim.gap_mid - SLACK_M > claim.required)
            if close.any():
                claim = self.look_closer(table, row, a, b, placed, claim, close)
                rest = self.keep(table, row, a, b, claim)
                row, a, b, claim, placed = row[rest], a[rest], b[rest], take(claim, rest), placed.some(rest)
                close = ~(claim.gap_mid - SLACK_M > claim.required)
            boxes = close & ((self.solids.piece[a] == COVER) | (self.solids.piece[b] == COVER))
            solid = np.flatnonzero(close & ~boxes)
            if len(solid):
                resisted = self.ask(table, row, a, b, placed, claim, solid)
                if resisted is not None:
                    return resisted
                # GJK's normals: some rows may be proved by them at once
                rest = self.keep(table, row, a, b, claim)
                row, a, b, claim, boxes = row[rest], a[rest], b[rest], take(claim, rest), boxes[rest]
            fine = np.flatnonzero(~boxes & ~(table.t1[row] - table.t0[row] > FINEST_S))
            if len(fine):
                i = int(fine[0])
                return self.unproved(table, row, a, b, i, claim.gap_mid[i], claim.required[i], touching=False)
            table, row, a, b, seed = self.refine(table, row, a, b, claim.normal, boxes)
        return self.rows()

    def refine(
        self, table: Intervals, row: IntArray, a: IntArray, b: IntArray, normal: FloatArray, boxes: BoolArray
    ) -> tuple[Intervals, IntArray, IntArray, IntArray, FloatArray]:
        """The next round: boxes become pieces on the same interval, everything else halves its interval."""
        old, whole = _ranked(row[boxes], len(table))
        halved, place_in = _ranked(row[~boxes], len(table))
        middle = (table.t0[halved] + table.t1[halved]) / 2
        t0 = np.concatenate([table.t0[old], table.t0[halved], middle])
        t1 = np.concatenate([table.t1[old], middle, table.t1[halved]])
        rows = [place_in + len(old), place_in + len(old) + len(halved)]
        firsts, seconds, seeds = [a[~boxes]] * 2, [b[~boxes]] * 2, [normal[~boxes]] * 2
        for i, k in zip(np.flatnonzero(boxes), whole, strict=True):
            one, other = self._pieces(int(a[i])), self._pieces(int(b[i]))
            rows.append(np.full(len(one) * len(other), k))
            firsts.append(np.repeat(one, len(other)))
            seconds.append(np.tile(other, len(one)))
            seeds.append(np.tile(normal[i], (len(one) * len(other), 1)))
        return (
            self.facts.intervals(t0, t1),
            np.concatenate(rows),
            np.concatenate(firsts),
            np.concatenate(seconds),
            np.concatenate(seeds),
        )

    def _pieces(self, unit: int) -> IntArray:
        if self.solids.piece[unit] != COVER:
            return np.array([unit], dtype=np.int64)
        return np.array(self.solids.pieces[int(self.solids.body[unit])], dtype=np.int64)

    def look_closer(
        self,
        table: Intervals,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        placed: Thrice,
        claim: Claim,
        close: BoolArray,
    ) -> Claim:
        """Face normals for the rows that the first normals do not part."""
        which = np.flatnonzero(close)
        near = placed.some(which)
        closer = self.facts.claim(table, row[which], a[which], b[which], near, face_normals(*near.middle()))
        return put(claim, which, take(claim, which).better(closer))

    def ask(
        self,
        table: Intervals,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        placed: Thrice,
        claim: Claim,
        solid: IntArray,
    ) -> Unproved | None:
        """FCL, then GJK, about rows that nothing parted yet; `claim` takes the normals that GJK found."""
        am, bm = placed.middle()
        solid = solid[np.argsort(claim.gap_mid[solid] - claim.required[solid], kind="stable")]
        for i in solid:
            allowed = claim.required[i] < 0
            if not allowed and self.prover.collider.touch(am, bm, int(i)):
                return self.unproved(table, row, a, b, int(i), claim.gap_mid[i], claim.required[i], touching=True)
            distance, normal = separate(am, bm, int(i))
            if normal is None:
                return self.unproved(table, row, a, b, int(i), claim.gap_mid[i], claim.required[i], touching=True)
            one = np.array([i])
            found = self.facts.claim(table, row[one], a[one], b[one], placed.some(one), normal[None, None])
            if not found.gap_mid[0] - SLACK_M > found.required[0]:
                gap = max(distance, float(found.gap_mid[0]))
                return self.unproved(table, row, a, b, int(i), gap, found.required[0], touching=False)
            for name in Claim.__slots__:
                getattr(claim, name)[i] = getattr(found, name)[0]
        return None

    def unproved(
        self,
        table: Intervals,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        i: int,
        gap: float,
        required: float,
        *,
        touching: bool,
    ) -> Unproved:
        names, body = self.solids.names, self.solids.body
        middle = float(table.t0[row[i]] + table.t1[row[i]]) / 2
        of_robot = bool(body[b[i]] < self.solids.robot_bodies)
        bodies = (names[body[a[i]]], names[body[b[i]]])
        return Unproved(bodies, middle, float(gap), float(required), touching, of_robot)

    def keep(self, table: Intervals, row: IntArray, a: IntArray, b: IntArray, claim: Claim) -> BoolArray:
        """Stores the rows that are proved; returns which are not."""
        proved = claim.proved
        if proved.any():
            r = row[proved]
            self.done.append((a[proved], b[proved], table.t0[r], table.t1[r], take(claim, proved)))
        rest: BoolArray = ~proved
        return rest

    def rows(self) -> Rows:
        if not self.done:
            return no_rows(self.solids)
        first, second, t0, t1, claims = zip(*self.done, strict=True)

        def column(name: str) -> FloatArray:
            return np.concatenate([getattr(claim, name) for claim in claims])

        return Rows(
            self.solids,
            np.concatenate(t0),
            np.concatenate(t1),
            np.concatenate(first),
            np.concatenate(second),
            column("normal"),
            column("gap0"),
            column("gap1"),
            column("speed"),
            column("acceleration"),
        )


def _ranked(numbers: IntArray, many: int) -> tuple[IntArray, IntArray]:
    """Which of 0..many-1 occur, ascending, and the place of each among them."""
    rank = np.zeros(many, dtype=np.int64)
    rank[numbers] = 1
    which = np.flatnonzero(rank)
    rank[which] = np.arange(len(which))
    return which, rank[numbers]

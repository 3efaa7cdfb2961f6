"""The proof of a phase: each round in one kernel, from the spline to the best claim of every row."""

from __future__ import annotations

import time
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from benchmarks.compiled.bounding import curve, swept, tables
from benchmarks.compiled.claiming import CLOSER, OPEN, PROVED, halved, judged
from benchmarks.compiled.curves import positions
from benchmarks.compiled.packing import FALLBACKS, Cell, Units, cell, units
from benchmarks.compiled.placing import everywhere
from planner.arrays import FloatArray, IntArray
from planner.certificate import Prover, Rows, Unproved
from planner.certificate.claim import Claim
from planner.phases import Phase
from planner.requirement import SLACK_M, clearance, is_certain
from planner.scene import Scene
from planner.trajectory import Trajectory

proof: Any = import_module("planner.certificate.proof")
"""By name, for its inner functions are nobody's business: what is missing is found by `replacements`."""
original = Prover.prove
"""What it is put in the place of, as it was when this was imported."""


@dataclass(frozen=True, eq=False)
class _Ground:
    """What all rounds of a proof share."""

    cell: Cell
    units: Units
    rates: FloatArray
    required: float
    trajectory: Trajectory
    tables: tuple[FloatArray, FloatArray, FloatArray]

    def claims(
        self,
        t0: FloatArray,
        t1: FloatArray,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        seed: FloatArray,
        *,
        vertical: bool,
    ) -> tuple[FloatArray, IntArray]:
        way, known, packed = curve(self.trajectory), self.cell, self.units
        t = np.concatenate([t0, (t0 + t1) / 2, t1])
        where = everywhere(known.arm, known.laws, positions(way.edges, way.c, way.last, t), t)
        rests = self.trajectory.rest_at_start, self.trajectory.rest_at_end
        bounds = swept(way.edges, way.c, *self.tables, self.rates, rests, t0, t1)
        return judged(
            where, bounds, known.arm, known.laws, packed.number, packed.table, packed.vertices,
            t0, t1, row, a, b, seed, self.required, SLACK_M, vertical,
        )  # fmt: skip


def simple(scene: Scene, phase: Phase) -> bool:
    """Whether the distance asked for is one number."""
    execution = scene.execution
    plain = execution.tracking_m == 0 and execution.start_tolerance_s == 0
    return plain and is_certain(scene) and not phase.exempt


def prove(self: Prover, phase: Phase, trajectory: Trajectory) -> Rows | Unproved:
    known, packed = cell(self.scene), units(self.solids(phase.carried, phase.rides))
    if not (phase.t1 > phase.t0 and known is not None and packed.plain and simple(self.scene, phase)):
        FALLBACKS["prove"] += 1
        return original(self, phase, trajectory)
    way = curve(trajectory)
    rates = np.ascontiguousarray(self.scene.robot.rate_matrix).copy()
    made = tables(np.diff(way.edges), *way.hulls, rates)
    ground = _Ground(known, packed, rates, clearance(self.scene, phase), trajectory, made)
    found: Rows | Unproved = _rounds(proof._Proof(self, phase, trajectory), ground)
    return found


def _claim(claims: FloatArray, required: float) -> Claim:
    gap0, gap_mid, gap1, speed, acceleration, low = claims.T[3:9]
    return Claim(claims[:, :3], gap0, gap_mid, gap1, speed, acceleration, low, np.full(len(claims), required))


def _rounds(of: Any, ground: _Ground) -> Any:
    phase, prover, facts = of.phase, of.prover, of.facts
    a, b = prover.asked(of.solids)
    t0, t1 = np.array([phase.t0]), np.array([phase.t1])
    row, seed = np.zeros(len(a), dtype=np.int64), np.zeros((len(a), 3))
    claims, stage = ground.claims(t0, t1, row, a, b, seed, vertical=True)
    left = _kept(of, t0, t1, row, a, b, claims, stage, ground.required)
    a, b = a[left], b[left]
    count = max(1, int(np.ceil((phase.t1 - phase.t0) / proof.COARSEST_S)))
    edges = np.linspace(phase.t0, phase.t1, count + 1)
    edges[-1] = phase.t1
    t0, t1, row = edges[:-1].copy(), edges[1:].copy(), np.repeat(np.arange(count), len(a))
    a, b = np.tile(a, count), np.tile(b, count)
    seed = np.zeros((len(row), 3))
    seed[:, 2] = 1.0
    while len(row):
        if len(row) > proof.MOST_ROWS or time.perf_counter() >= prover.deadline:
            return of.unproved(facts.intervals(t0, t1), row, a, b, 0, np.nan, np.nan, touching=False)
        claims, stage = ground.claims(t0, t1, row, a, b, seed, vertical=False)
        left = _kept(of, t0, t1, row, a, b, claims, stage, ground.required)
        if not len(left):
            break
        row, a, b, claims = row[left], a[left], b[left], claims[left]
        solid = np.flatnonzero(~(claims[:, 4] - SLACK_M > ground.required))
        if len(solid):
            # FCL and GJK about single rows: the original's business
            table, claim = facts.intervals(t0, t1), _claim(claims, ground.required)
            resisted = of.ask(table, row, a, b, facts.thrice(table, row, a, b), claim, solid)
            if resisted is not None:
                return resisted
            rest = of.keep(table, row, a, b, claim)
            row, a, b, claims = row[rest], a[rest], b[rest], claims[rest]
        fine = np.flatnonzero(~((t1 - t0)[row] > proof.FINEST_S))
        if len(fine):
            i = int(fine[0])
            gap_mid = claims[i, 4]
            return of.unproved(facts.intervals(t0, t1), row, a, b, i, gap_mid, ground.required, touching=False)
        t0, t1, row, a, b, seed = halved(t0, t1, row, a, b, claims[:, :3].copy())
    return of.rows()


def _kept(
    of: proof._Proof,
    t0: FloatArray,
    t1: FloatArray,
    row: IntArray,
    a: IntArray,
    b: IntArray,
    claims: FloatArray,
    stage: IntArray,
    required: float,
) -> IntArray:
    """Stores the rows that are proved, in the order in which the original does; the numbers of the others."""
    for kind in (PROVED, CLOSER):
        some = np.flatnonzero(stage == kind)
        if len(some):
            r = row[some]
            of.done.append((a[some], b[some], t0[r], t1[r], _claim(claims[some], required)))
    return np.flatnonzero(stage == OPEN)

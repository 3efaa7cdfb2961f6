"""Proves phases: the kernel settles all pairs over halved intervals, and FCL decides what touches where it cannot."""

from __future__ import annotations

import math
import time

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.collision.fcl_door import Collider, Posed
from assur.planner.collision.rows import Rows, Unproved
from assur.planner.kernels.carriers import place_carriers
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.planes import SIDES, behind, drop_spare, not_behind
from assur.planner.kernels.proof import (
    ALONG,
    DONE,
    ITEM_COLUMNS,
    ITEMS_FULL,
    OTHER,
    RESISTED,
    RESISTED_A,
    RESISTED_B,
    RESISTED_GAP,
    RESISTED_NEED,
    RESISTED_T,
    ROW_COLUMNS,
    ROWS,
    ROWS_FULL,
    STATE_COLUMNS,
    T0,
    T1,
    TOP,
    UNIT,
    prove,
)
from assur.planner.kernels.screening import depth_at, sampled_behind, screen
from assur.planner.kernels.solids import FIRST, PAIR_COLUMNS, SECOND, place
from assur.planner.kernels.spline import spline_state
from assur.planner.model.assembly_mode import has_loop
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.tables.bodies import Arrangement, Bodies
from assur.planner.tables.laws import law_tables
from assur.planner.tables.pairs import Pairs, PairTables
from assur.planner.tables.robot import robot_row
from assur.planner.tables.spline import Spline, spline_table
from assur.planner.trajectory import Trajectory

MOST_ROWS = 200_000
"""A phase that needs more rows than this is not certified: it would be neither quick nor small."""
BUDGET = 20_000
"""Pairs and intervals that the kernel settles between two looks at the clock: some milliseconds."""
MANY = 64
"""Pairs of a phase from which on planes are looked for: for fewer, rows of pairs cost less."""
PART_S = 0.08
"""Intervals over which planes are proved, s."""
ROOM = 128
"""Rows, and open pairs, for which there is room at first; it is doubled when it runs out."""
STACK = 64
"""Intervals on the stack at a time: two for each halving, and no motion is halved so often."""
ORIGIN = -1.0
"""Stands in a row for the second unit where the row is of the first alone: the origin of the world."""


class Prover:
    """Proves phases of one scene. Keeps the tables and the FCL objects of the scene."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.arrangement = Bodies(scene)
        self.pairs = PairTables(scene)
        self.robot = robot_row(scene.robot)
        self.laws, self.side = law_tables([frame.law for frame in scene.frames.values()])
        self.deadline = math.inf
        """Reading of `time.perf_counter` at which proofs are given up: what is not proved by then is not certified."""
        self.collider = Collider()
        self.has_loop = has_loop(scene.robot)
        self._spline: tuple[Trajectory, Spline] | None = None

    def of(self, phase: Phase) -> Arrangement:
        """The arrangement of a phase."""
        return self.arrangement(phase.attached)

    def spline(self, trajectory: Trajectory) -> Spline:
        """The tables of a trajectory; those of the last one are kept, for its phases are proved one after the other."""
        if self._spline is None or self._spline[0] is not trajectory:
            self._spline = trajectory, spline_table(trajectory, self.scene.robot.rate_matrix)
        return self._spline[1]

    def prove(self, phase: Phase, trajectory: Trajectory) -> Rows | Unproved:
        """Rows that cover every asked pair over the whole phase, or the first pair that resists."""
        arrangement = self.of(phase)
        if not phase.t1 > phase.t0:
            return Rows(arrangement, np.zeros((0, ROW_COLUMNS)))
        spline, pairs = self.spline(trajectory), self.pairs(arrangement, phase)
        if len(pairs.mine) * len(pairs.others) > MANY:
            planes, asked = self._planes(phase, arrangement, spline, pairs)
        else:
            planes, asked = np.zeros((0, ROW_COLUMNS)), pairs.every
        found = self._settled(phase, arrangement, spline, pairs.latest, asked)
        if isinstance(found, Unproved):
            return found
        return Rows(arrangement, np.concatenate([planes, found]) if len(planes) else found)

    def _planes(
        self, phase: Phase, arrangement: Arrangement, spline: Spline, pairs: Pairs
    ) -> tuple[FloatArray, FloatArray]:
        """Rows of single units of the robot, and the pairs that they do not keep apart."""
        edges = _parts(phase)
        least = self._behind(phase, spline, pairs, edges)
        used = np.zeros_like(least)
        left = self._left(phase, arrangement, pairs, pairs.others, least, used)
        since = self.scene.start.time
        drop_spare(arrangement.boxes, pairs.mine, least, pairs.others, since, phase.t1, used)
        # what does not move needs no parts
        ends = edges[[0, -1]]
        whole: BoolArray = np.all(self._behind(phase, spline, pairs, ends) >= least, axis=1)
        planes = [np.zeros((0, ROW_COLUMNS))]
        for r, side in zip(*np.nonzero(used), strict=True):
            t = ends if whole[r] else edges
            rows = np.zeros((len(t) - 1, ROW_COLUMNS))
            rows[:, T0], rows[:, T1], rows[:, UNIT], rows[:, OTHER] = t[:-1], t[1:], pairs.mine[r], ORIGIN
            rows[:, ALONG + side % 3] = 1.0 if side < 3 else -1.0
            planes.append(rows)
        return np.concatenate(planes), left

    def _behind(self, phase: Phase, spline: Spline, pairs: Pairs, edges: FloatArray) -> FloatArray:
        """How far behind planes the robot's units are proved to stay (R, 6), interval by interval between `edges`."""
        arrangement, least = self.of(phase), np.empty((len(pairs.mine), SIDES))
        behind(
            self.robot, self.laws, self.side, spline.tk, spline.c, spline.whole, spline.matrix,
            arrangement.rows, arrangement.vertices, arrangement.still, pairs.mine, edges, least,
        )  # fmt: skip
        return least

    def _left(
        self,
        phase: Phase,
        arrangement: Arrangement,
        pairs: Pairs,
        others: FloatArray,
        least: FloatArray,
        used: FloatArray,
    ) -> FloatArray:
        """The pairs that no plane keeps apart; `used` (R, 6) becomes 1 for planes that are needed for the others."""
        left = np.empty((len(pairs.mine) * len(others), PAIR_COLUMNS))
        since = self.scene.start.time
        many = not_behind(arrangement.boxes, pairs.mine, least, others, pairs.allowed, since, phase.t1, used, left)
        return np.concatenate([left[:many], pairs.own])

    def behind(self, phase: Phase, spline: Spline, pairs: Pairs) -> FloatArray:
        """How far behind planes the robot's units are proved to stay throughout a phase (R, 6)."""
        return self._behind(phase, spline, pairs, _parts(phase))

    def not_behind(self, phase: Phase, pairs: Pairs, others: FloatArray, least: FloatArray) -> FloatArray:
        """The pairs (P, PAIR_COLUMNS) of a phase that no plane of `least` keeps as far apart as `others` says."""
        return self._left(phase, self.of(phase), pairs, others, least, np.zeros_like(least))

    def _settled(
        self, phase: Phase, arrangement: Arrangement, spline: Spline, latest: float, pairs: FloatArray
    ) -> FloatArray | Unproved:
        """Rows (N, ROW_COLUMNS) of all pairs, or the first that resists."""
        items, rows = np.zeros((ROOM + 2 * len(pairs), ITEM_COLUMNS)), np.empty((ROOM + len(pairs), ROW_COLUMNS))
        items[: len(pairs), 0], items[: len(pairs), 1] = pairs[:, FIRST], pairs[:, SECOND]
        items[: len(pairs), 2] = np.arange(len(pairs))
        stack, state = np.zeros((STACK, 4)), np.zeros(STATE_COLUMNS)
        stack[0], state[TOP] = (phase.t0, phase.t1, 0, len(pairs)), 1
        while True:
            status = prove(
                self.robot, self.laws, self.side, spline.tk, spline.c, spline.whole, spline.matrix,
                arrangement.rows, arrangement.vertices, arrangement.still, pairs, self.scene.start.time, latest,
                items, stack, state, rows, BUDGET,
            )  # fmt: skip
            if status == DONE:
                return rows[: int(state[ROWS])].copy()
            if status == RESISTED:
                return self._resisted(arrangement, spline, state)
            if status == ROWS_FULL:
                rows = np.concatenate([rows, np.empty_like(rows)])
            elif status == ITEMS_FULL:
                items, stack = (np.concatenate([table, np.zeros_like(table)]) for table in (items, stack))
            if state[ROWS] > MOST_ROWS or time.perf_counter() >= self.deadline:
                top = int(state[TOP]) - 1
                open_item = items[int(stack[top, 2])]
                state[RESISTED_A], state[RESISTED_B] = open_item[0], open_item[1]
                state[RESISTED_T], state[RESISTED_GAP], state[RESISTED_NEED] = stack[top, :2].mean(), np.nan, np.nan
                return self._unproved(arrangement, state, touching=False)

    def _resisted(self, arrangement: Arrangement, spline: Spline, state: FloatArray) -> Unproved:
        """What FCL says of the true shapes of a pair that resisted."""
        a, b, t = int(state[RESISTED_A]), int(state[RESISTED_B]), float(state[RESISTED_T])
        q = np.empty(spline.c.shape[1])
        spline_state(spline.tk, spline.c, t, q)
        touching = bool(state[RESISTED_GAP] <= state[RESISTED_NEED]) and self.touch(arrangement, q, t, a, b)
        return self._unproved(arrangement, state, touching=touching)

    def _unproved(self, arrangement: Arrangement, state: FloatArray, *, touching: bool) -> Unproved:
        units = int(state[RESISTED_A]), int(state[RESISTED_B])
        names = (arrangement.names[arrangement.body[units[0]]], arrangement.names[arrangement.body[units[1]]])
        of_robot = bool(arrangement.of_robot[arrangement.body[units[1]]])
        gap, required = float(state[RESISTED_GAP]), float(state[RESISTED_NEED])
        return Unproved(names, float(state[RESISTED_T]), gap, required, touching, of_robot)

    def near(self, phase: Phase, q: FloatArray, t: FloatArray) -> FloatArray:
        """The pairs (P, PAIR_COLUMNS) of a phase that can be too near at instants t (T,) with joints q (T, n)."""
        arrangement = self.of(phase)
        pairs = self.pairs(arrangement, phase)
        if len(pairs.mine) * len(pairs.others) <= MANY:
            return pairs.every
        least = np.empty((len(pairs.mine), SIDES))
        sampled_behind(
            self.robot, self.laws, self.side, q, t, arrangement.rows, arrangement.vertices, arrangement.still,
            pairs.mine, least,
        )  # fmt: skip
        return self._left(phase, arrangement, pairs, pairs.others, least, np.zeros_like(least))

    def screened(
        self,
        arrangement: Arrangement,
        pairs: FloatArray,
        q: FloatArray,
        t: FloatArray,
        until: float,
        enough: int,
        hits: FloatArray,
    ) -> tuple[int, int, int]:
        """`kernels.screening.screen` with the tables of the scene."""
        return screen(
            self.robot, self.laws, self.side, q, t, arrangement.rows, arrangement.vertices, arrangement.still, pairs,
            self.scene.start.time, until, enough, hits,
        )  # fmt: skip

    def depth(self, phase: Phase, q: FloatArray, t: FloatArray, deepest: float) -> FloatArray:
        """By how much the worst pair is nearer than required at instants t (T,) with joints q (T, n), as a share of
        `deepest`, m (`kernels.screening.depth_at`)."""
        arrangement, found = self.of(phase), np.zeros(len(t))
        depth_at(
            self.robot, self.laws, self.side, q, t, arrangement.rows, arrangement.vertices, arrangement.still,
            self.near(phase, q, t), self.scene.start.time, phase.t1, deepest, found,
        )  # fmt: skip
        return found

    def touch(self, arrangement: Arrangement, q: FloatArray, t: float, a: int, b: int) -> bool:
        """Whether units a and b touch at time t with joints q, by FCL."""
        return self.collider.touch(*self.posed(arrangement, q, t, np.array([a, b])))

    def carriers(self, q: FloatArray, t: float) -> FloatArray:
        """Where links and frames are at time t with joints q: (K, 12), position and rotation, row by row."""
        found = np.empty((len(self.scene.robot.links) + len(self.laws), POSE_COLUMNS))
        place_carriers(self.robot, self.laws, self.side, np.array(q), t, found)
        return found

    def posed(self, arrangement: Arrangement, q: FloatArray, t: float, units: IntArray) -> list[Posed]:
        """The shapes of units (N,) where they are at time t with joints q."""
        carriers = self.carriers(q, t)
        placed = np.empty((1, len(arrangement.rows), POSE_COLUMNS))
        found = []
        for i in units.tolist():
            place(arrangement.rows, i, carriers, placed, 0)
            axes = placed[0, i, 3:].reshape(3, 3)
            position = placed[0, i, :3] - axes @ arrangement.offset[i]
            found.append(Posed(arrangement.names[arrangement.body[i]], arrangement.shapes[i], position, axes))
        return found


def _parts(phase: Phase) -> FloatArray:
    """Times that part a phase into intervals over which planes are proved."""
    edges = np.linspace(phase.t0, phase.t1, max(1, math.ceil((phase.t1 - phase.t0) / PART_S)) + 1)
    edges[-1] = phase.t1
    return edges

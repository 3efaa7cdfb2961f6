"""Proves phases: the kernel settles all pairs over halved intervals, and FCL decides what touches where it cannot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.collision.fcl_entry import Collider, PlacedShape
from assur.planner.collision.pairs import Pairs, pair_tables_of
from assur.planner.collision.rows import ProofFailure, Rows
from assur.planner.kernels.carriers import Carried, place_carriers
from assur.planner.kernels.interval_search import PROVE, SCREEN, search_intervals
from assur.planner.kernels.intervals import (
    DONE,
    FOUND,
    HIT,
    ITEM_COLUMNS,
    ITEM_FROM,
    ITEM_TO,
    ITEMS_FULL,
    RESISTED,
    ROWS_FULL,
    STATE_COLUMNS,
    TOP,
    Motion,
)
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.proof import (
    ALONG,
    OTHER,
    RESISTED_A,
    RESISTED_B,
    RESISTED_GAP,
    RESISTED_NEED,
    RESISTED_S,
    RESISTED_T,
    ROW_COLUMNS,
    SIDES,
    T0,
    T1,
    UNIT,
    Planes,
    behind,
    drop_spare,
    not_behind,
)
from assur.planner.kernels.screening import HIT_COLUMNS, HIT_GAP, HITS, depths, sampled_behind
from assur.planner.kernels.solids import EARLY, FIRST, LATE, PAIR_COLUMNS, REQUIRED, SECOND, SET
from assur.planner.kernels.spline import Spline, spline_state
from assur.planner.kernels.uncertainty import SET_COLUMNS, Errors, growing_for
from assur.planner.model.assembly_mode import has_loop
from assur.planner.model.deadline import out_of_time
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import Scene, laws_of
from assur.planner.trajectory import Trajectory

MOST_ROWS = 200_000
"""A phase that needs more rows than this is not certified: it would be neither quick nor small."""
BUDGET = 20_000
"""Pairs and intervals that the kernel decides between two readings of the clock: some milliseconds."""
PART_S = 0.08
"""Intervals over which planes are proved, s."""
MOST_PARTS = 1_000
"""Maximum number of these intervals in a phase: in a long phase they are longer and prove fewer pairs."""
ROOM = 128
"""Rows, and open pairs, for which there is room at first; it is doubled when it runs out."""
MOST_HITS = 64
"""Most pairs of one phase whose deepest hit is kept."""
STACK = 64
"""Intervals on the stack at a time: two for each halving, and no motion is halved so often."""
ANY_GAP_M = 1e3
"""Required where a gap is wanted, whatever it is, m."""
ORIGIN = -1.0
"""Stands in a row for the second unit where the row is of the first alone: the origin of the world."""


class Search:
    """A search over the halved intervals of one phase (`kernels.interval_search`); its room grows where it runs out.

    `pairs` (P, PAIR_COLUMNS) are evaluated, over all of the phase, and before that over other `spans` of time, with
    their uncertainty (`errors`); `rows` and `hits` take what is written, `most_hits` at most.
    """

    def __init__(
        self,
        prover: Prover,
        phase: Phase,
        spline: Spline,
        pairs: FloatArray,
        errors: Errors,
        spans: Sequence[tuple[float, float]] = (),
        most_hits: int = 0,
    ) -> None:
        self.prover, self.spline, self.pairs, self.cell = prover, spline, pairs, prover.of(phase).cell
        self.errors = errors
        self.rows, self.hits = np.empty((ROOM + len(pairs), ROW_COLUMNS)), np.empty((most_hits, HIT_COLUMNS))
        self.state, self.stack = np.zeros(STATE_COLUMNS), np.zeros((STACK, 4))
        count, many = len(pairs), 1 + len(spans)
        self.items = np.zeros((ROOM + (many + 1) * count, ITEM_COLUMNS))
        mine = self.items[: many * count].reshape(many, count, ITEM_COLUMNS)
        mine[:, :, :2], mine[:, :, 2] = pairs[:, FIRST : SECOND + 1], np.arange(count)
        mine[:, :, ITEM_FROM : ITEM_TO + 1] = pairs[:, EARLY : LATE + 1]
        for k, (t0, t1) in enumerate(((phase.t0, phase.t1), *spans)):
            self.stack[k] = t0, t1, k * count, count
        self.state[TOP], self.done = many, False

    def go_on(self, task: int) -> int:
        """Goes on until it is done, a pair resists, or the budget of a call is spent, and gives room for the next."""
        prover = self.prover
        status = search_intervals(
            task, prover.motion(self.spline), self.cell, self.pairs, self.errors, self.items, self.stack,
            self.state, self.rows, self.hits, BUDGET,
        )  # fmt: skip
        if status == ROWS_FULL:
            self.rows = np.concatenate([self.rows, np.empty_like(self.rows)])
        elif status == ITEMS_FULL:
            self.items = np.concatenate([self.items, np.zeros_like(self.items)])
            self.stack = np.concatenate([self.stack, np.zeros_like(self.stack)])
        self.done = status == DONE
        return status

    @property
    def proved(self) -> FloatArray:
        """The rows (N, ROW_COLUMNS) that were written."""
        return self.rows[: int(self.state[FOUND])].copy()

    @property
    def too_near(self) -> FloatArray:
        """The hits (H, HIT_COLUMNS): the deepest of each pair."""
        return self.hits[: int(self.state[HITS])]

    @property
    def over(self) -> bool:
        """Whether the clock, or the number of rows, ends a proof."""
        return self.state[FOUND] > MOST_ROWS or out_of_time()


class Prover:
    """Proves phases of one scene. Keeps the tables and the FCL objects of the scene. What is not proved when the
    deadline in force passes is not certified."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.pairs = pair_tables_of(scene)
        self.arrangement = self.pairs.bodies
        self.laws, self.side = scene.kept.of(laws_of, scene)
        self.carried_by: Carried = scene.robot.row, self.laws, self.side
        self.collider = Collider()
        none = np.zeros(len(scene.robot.joints))
        self.exact: Errors = (np.zeros((0, SET_COLUMNS)), none, np.array([scene.start.time, 0.0, 0.0, 0.0]))
        """The uncertainty for kernels where everything is where it is planned."""
        self.has_loop = has_loop(scene.robot)
        self._boxes: dict[int, tuple[FloatArray, FloatArray, FloatArray]] = {}
        self._phase: Phase | None = None
        self._arrangement: Arrangement
        self._pairs: Pairs | None = None
        self._screened: Trajectory | None = None
        self._rows: dict[tuple[float, float], tuple[Pairs, FloatArray]] = {}
        """By begin and end of phases of that trajectory: their pairs, and the rows of these that screening wrote."""

    def of(self, phase: Phase) -> Arrangement:
        """The arrangement of a phase. That of the last phase is kept, as its pairs are: to look them up takes longer
        than to compare the parts of two phases by their identity."""
        last = self._phase
        if last is not phase:
            if last is None or not phase.is_of_kind(last):
                self._arrangement, self._pairs = self.arrangement(phase.attached), None
            self._phase = phase
        return self._arrangement

    def pairs_of(self, phase: Phase) -> Pairs:
        """The pairs of a phase."""
        arrangement = self.of(phase)
        if self._pairs is None:
            self._pairs = self.pairs(arrangement, phase, self.scene.start.time)
        return self._pairs

    def rule(self, phase: Phase, *names: str) -> tuple[Rule, float]:
        """What says how far two bodies must stay apart in a phase, before what is uncertain of them, and how far, m:
        less than 0 for a pair that may touch."""
        arrangement = self.of(phase)
        one, other = (int(arrangement.roots[arrangement.number[name]]) for name in names)
        return self.pairs_of(phase).rule(one, other)

    def standing(self, q: FloatArray, t: float) -> Spline:
        """The arm at rest at q (n,) from time t on."""
        knots = np.zeros((2, 1 + 3 * len(q)))
        knots[:, 0], knots[:, 1 : 1 + len(q)] = (t, t + 1.0), q
        return Trajectory.of_knots(knots).spline

    def motion(self, spline: Spline) -> Motion:
        """What moves the carriers, as kernels read it."""
        return self.carried_by, spline

    def prove(self, phase: Phase, trajectory: Trajectory) -> Rows | ProofFailure:
        """Rows that cover every required pair over the whole phase, or the first pair that resists."""
        spline, pairs = trajectory.spline, self.pairs_of(phase)
        of_pairs, known = self._rows.get((phase.t0, phase.t1), (None, None))
        if trajectory is self._screened and of_pairs is pairs and known is not None:
            remaining = pairs.touching
        else:
            known, remaining = self._planes(phase, spline, pairs)
        return self._shown(phase, spline, known, remaining, pairs.errors)

    def prove_gaps(self, phase: Phase, trajectory: Trajectory, arm: float, placed: float) -> Rows | ProofFailure:
        """The same for other distances, m, where all is where it is planned: `arm` for pairs with a body of the robot,
        `placed` for those of parts that were put down; less than 0: none is required. Pairs in contact do not count."""
        pairs = self.pairs_of(phase).exactly(arm, placed)
        return self._shown(phase, trajectory.spline, np.zeros((0, ROW_COLUMNS)), pairs, self.exact)

    def _shown(
        self, phase: Phase, spline: Spline, known: FloatArray, remaining: FloatArray, errors: Errors
    ) -> Rows | ProofFailure:
        """The rows that are `known`, and those that show all pairs that are left, or the first pair that resists."""
        arrangement = self.of(phase)
        if not (len(remaining) and phase.t1 > phase.t0):
            return Rows(arrangement, known)
        search = Search(self, phase, spline, remaining, errors)
        while True:
            status = search.go_on(PROVE)
            if status == DONE:
                return Rows(arrangement, np.concatenate([known, search.proved]) if len(known) else search.proved)
            if status == RESISTED:
                return self._resisted(arrangement, spline, search.state)
            if search.over:
                # what is still open where a proof is given up
                t0, t1, first, _ = search.stack[int(search.state[TOP]) - 1]
                a, b = search.items[int(first), :2]
                return _unproved(arrangement, a, b, (t0 + t1) / 2, np.nan, np.nan)

    def screened(self, phase: Phase, trajectory: Trajectory) -> FloatArray:
        """What is too near at an instant of a phase of a trajectory (H, HIT_COLUMNS), the deepest of each pair. Where
        that is shown to be nothing, at any instant, the rows that show it are kept for `prove`."""
        if self._screened is not trajectory:
            self._screened, self._rows = trajectory, {}
        spline, pairs = trajectory.spline, self.pairs_of(phase)
        search = self.hits(phase, spline, self.near(phase, spline))
        if search.done and not pairs.many:
            self._rows[phase.t0, phase.t1] = pairs, search.proved
        return search.too_near

    def hits(self, phase: Phase, spline: Spline, pairs: FloatArray, *, displaced_links: bool = True) -> Search:
        """A search for an instant of a phase at which some of `pairs` (P, PAIR_COLUMNS), which must not touch, are too
        near. `displaced_links`: whether links count where they may be displaced to."""
        # the end is an instant of its own: often what is near is nearest there; and nothing is proved of the start
        t0, t1 = phase.t0, phase.t1
        ends = [(t1, t1)] if t1 > t0 else []
        if t0 == self.scene.start.time < t1:
            ends.append((t0, t0))
        errors = self.pairs_of(phase).errors if displaced_links else self.exact
        search = Search(self, phase, spline, pairs, errors, ends, MOST_HITS)
        while search.go_on(SCREEN) not in (DONE, HIT, RESISTED) and not search.over:
            pass
        return search

    def near(self, phase: Phase, spline: Spline) -> FloatArray:
        """The pairs (P, PAIR_COLUMNS) of a phase that must not touch and are not kept apart by planes, if there are
        many."""
        pairs = self.pairs_of(phase)
        if not pairs.many:
            return pairs.apart
        return self.not_behind(phase, pairs, pairs.apart, self.behind(phase, spline, pairs))

    def behind(self, phase: Phase, spline: Spline, pairs: Pairs, edges: FloatArray | None = None) -> FloatArray:
        """How far behind planes the robot's units are proved to stay (R, 6), interval by interval between `edges`."""
        least = np.empty((len(pairs.mine), SIDES))
        behind(
            self.motion(spline),
            self.of(phase).cell,
            pairs.errors,
            pairs.mine,
            _parts(phase) if edges is None else edges,
            least,
        )
        return least

    def not_behind(
        self, phase: Phase, pairs: Pairs, rows: FloatArray, least: FloatArray, used: FloatArray | None = None
    ) -> FloatArray:
        """Those of `rows` (P, PAIR_COLUMNS) of a phase that no plane of `least` keeps as far apart as is required;
        `used` (R, 6) becomes 1 for planes that are needed for the others."""
        left, used = np.empty_like(rows), np.zeros_like(least) if used is None else used
        return left[: not_behind(self._beyond(phase, pairs, least), rows, used, left)]

    def _beyond(self, phase: Phase, pairs: Pairs, least: FloatArray) -> Planes:
        """The planes of `least` in a phase, as kernels read them."""
        arrangement, lasts = self.of(phase), growing_for(pairs.errors[2], phase.t1)
        return arrangement.boxes, pairs.number(arrangement), least, pairs.errors[0], lasts

    def _planes(self, phase: Phase, spline: Spline, pairs: Pairs) -> tuple[FloatArray, FloatArray]:
        """Rows of single units of the robot, and the pairs that they do not keep apart."""
        if not (pairs.many and phase.t1 > phase.t0):
            return np.zeros((0, ROW_COLUMNS)), pairs.rows
        edges = _parts(phase)
        least = self.behind(phase, spline, pairs, edges)
        used = np.zeros_like(least)
        left = self.not_behind(phase, pairs, pairs.rows, least, used)
        drop_spare(self._beyond(phase, pairs, least), pairs.rows, used)
        # what does not move needs no parts
        ends = edges[[0, -1]]
        whole: BoolArray = np.all(self.behind(phase, spline, pairs, ends) >= least, axis=1)
        planes = [np.zeros((0, ROW_COLUMNS))]
        for r, side in zip(*np.nonzero(used), strict=True):
            t = ends if whole[r] else edges
            rows = np.zeros((len(t) - 1, ROW_COLUMNS))
            rows[:, T0], rows[:, T1], rows[:, UNIT], rows[:, OTHER] = t[:-1], t[1:], pairs.mine[r], ORIGIN
            rows[:, ALONG + side % 3] = 1.0 if side < 3 else -1.0
            planes.append(rows)
        return np.concatenate(planes), left

    def _resisted(self, arrangement: Arrangement, spline: Spline, state: FloatArray) -> ProofFailure:
        """What FCL says of the true shapes of a pair that resisted."""
        a, b, t, gap, need = state[[RESISTED_A, RESISTED_B, RESISTED_T, RESISTED_GAP, RESISTED_NEED]].tolist()
        touching = gap <= need and self.touch(arrangement, spline, t, int(a), int(b), float(state[RESISTED_S]))
        return _unproved(arrangement, a, b, t, gap, need, touching=touching)

    def planned_gap(self, phase: Phase, q: FloatArray, t: float, a: int, b: int, ahead: float) -> float:
        """How far piece a at time t with joints q (n,) is from piece b, which is `ahead` s of the clock, where all is
        where it is planned, m; less than 0: how deep they are in each other, at most; infinitely: it is not known."""
        pairs = np.zeros((1, PAIR_COLUMNS))
        pairs[0, FIRST], pairs[0, SECOND], pairs[0, REQUIRED], pairs[0, SET] = a, b, ANY_GAP_M, -1.0
        pairs[0, EARLY], pairs[0, LATE] = ahead, ahead
        found = self.hits(replace(phase, t0=t, t1=t), self.standing(q, t), pairs, displaced_links=False).too_near
        return float(found[0, HIT_GAP]) if len(found) else -math.inf

    def depths(self, phase: Phase, q: FloatArray, t: FloatArray, deepest: float, most: float) -> FloatArray:
        """How deep (W,) motions are in something at instants `t` (W, T) with joints `q` (W, T, n), up to about `most`
        (`kernels.screening.depths`)."""
        arrangement, pairs, found = self.of(phase), self.pairs_of(phase), np.empty(len(t))
        remaining = pairs.rows
        if pairs.many:
            least = np.empty((len(pairs.mine), SIDES))
            flat = q.reshape(-1, q.shape[-1]), t.reshape(-1)
            sampled_behind(self.carried_by, *flat, arrangement.cell, pairs.mine, least)
            remaining = self.not_behind(phase, pairs, pairs.rows, least)
        depths(
            self.carried_by, self.scene.robot.limits.table, q, t, arrangement.cell, remaining, pairs.errors[0],
            growing_for(pairs.errors[2], phase.t1), deepest, most, found,
        )  # fmt: skip
        return found

    def touch(self, arrangement: Arrangement, spline: Spline, t: float, a: int, b: int, ahead: float = 0.0) -> bool:
        """Whether units a and b touch at time t of a motion, by FCL, the second being `ahead` s of the clock."""
        q = np.empty(spline[1].shape[1])
        spline_state(spline, t, q)
        return self.touching(arrangement, q, t, a, b, ahead)

    def touching(self, arrangement: Arrangement, q: FloatArray, t: float, a: int, b: int, ahead: float = 0.0) -> bool:
        """Whether unit a at time t with joints q (n,) touches unit b, which is `ahead` s of the clock, by FCL."""
        one, other = self.posed(arrangement, q, t, np.array([a])), self.posed(arrangement, q, t + ahead, np.array([b]))
        return self.collider.touch(*one, *other)

    def box(self, vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The least and the greatest coordinates (3,) of vertices (m, 3), which are kept: many bodies have one mesh."""
        if id(vertices) not in self._boxes:
            self._boxes[id(vertices)] = vertices, vertices.min(0), vertices.max(0)
        return self._boxes[id(vertices)][1:]

    def carriers(self, q: FloatArray, t: float) -> FloatArray:
        """Where links and frames are at time t with joints q: (K, 12), position and rotation, row by row."""
        found = np.empty((len(self.scene.robot.links) + len(self.laws), POSE_COLUMNS))
        place_carriers(self.carried_by, np.array(q), t, found)
        return found

    def posed(self, arrangement: Arrangement, q: FloatArray, t: float, units: IntArray) -> list[PlacedShape]:
        """The shapes of units (N,), which are pieces, where they are at time t with joints q."""
        (_, _, placed), names = arrangement.placed(self.carriers(q, t), units), arrangement.names
        axes = placed[0, :, 3:].reshape(-1, 3, 3)
        return [
            PlacedShape(
                names[arrangement.body[i]],
                arrangement.shape(i),
                placed[0, i, :3] - axes[i] @ arrangement.offset(i),
                axes[i],
            )
            for i in units.tolist()
        ]


def _parts(phase: Phase) -> FloatArray:
    """Times that part a phase into intervals over which planes are proved."""
    count = min(MOST_PARTS, max(1, math.ceil((phase.t1 - phase.t0) / PART_S)))
    edges = np.linspace(phase.t0, phase.t1, count + 1)
    edges[-1] = phase.t1
    return edges


def _unproved(
    arrangement: Arrangement, a: float, b: float, t: float, gap: float, required: float, *, touching: bool = False
) -> ProofFailure:
    """What is not proved of units a and b around time t."""
    one, other = arrangement.body[[int(a), int(b)]].tolist()
    names = arrangement.names[one], arrangement.names[other]
    return ProofFailure(names, float(t), gap, required, touching, bool(arrangement.of_robot[other]))

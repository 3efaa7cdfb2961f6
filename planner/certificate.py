"""Proves a plan's phases free of collision in continuous time, and writes the proof down (docs/guarantees.md, C1-C5).

A pair over an interval is proved by one normal that stays fixed: the support gaps at both ends, and how fast, or with
how much acceleration, the two can approach along it. What is not proved is halved; bounding boxes that are not apart are
replaced by the convex pieces inside. One NumPy batch a round. A pair that no likely normal parts is put to FCL: if it
says they touch, the phase is refused; if not, GJK gives the distance and a normal to go on with.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from planner.arrays import BoolArray, FloatArray, IntArray
from planner.collision import Collider
from planner.digest import digest
from planner.gjk import separate
from planner.outcome import Arrival, Certificate, Leg
from planner.phases import Phase, pair
from planner.requirement import CONTACT_GAP, SLACK_M, clearance, uncertainty
from planner.robots.protocol import Sweep
from planner.scene import Scene
from planner.separation import Placed, centre_normals, face_normals, gaps, place
from planner.solids import COVER, Carriers, Solids, SolidsMaker, carriers, standing
from planner.sweep import sweep
from planner.trajectory import Trajectory

COARSEST_S = 0.02
"""Intervals with which a phase begins, where vertical order alone does not prove it, s."""
FINEST_S = 2e-5
"""Intervals are halved no further than this, s: what is not proved by then is NOT_CERTIFIED."""
MOST_ROWS = 200_000
"""A phase that needs more rows than this is not certified: it would be neither quick nor small."""


@dataclass(frozen=True, slots=True)
class Unproved:
    """Two bodies that could not be shown to stay apart around `time`: `gap` m where `required` m is asked.

    `touching`: FCL says that they touch.
    """

    bodies: tuple[str, str]
    time: float
    gap: float
    required: float
    touching: bool
    of_robot: bool


@dataclass(frozen=True, slots=True)
class Rows:
    """Proved rows of one phase; bodies are numbers in `solids.names`."""

    solids: Solids
    t0: FloatArray
    t1: FloatArray
    first: IntArray
    second: IntArray
    normal: FloatArray
    gap0: FloatArray
    gap1: FloatArray
    speed: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True, slots=True)
class _Intervals:
    """A table of intervals with all carriers at start, middle and end, and the arm's sweep over them."""

    t0: FloatArray
    t1: FloatArray
    where: Carriers
    swept: Sweep

    def __len__(self) -> int:
        return len(self.t0)


@dataclass(frozen=True, slots=True)
class _Claim:
    """What one normal a row amounts to: gaps at start, middle, end, bounds, and the bound of the gap in between."""

    normal: FloatArray
    gap0: FloatArray
    gap_mid: FloatArray
    gap1: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    least: FloatArray
    required: FloatArray

    @property
    def proved(self) -> BoolArray:
        return self.least - SLACK_M >= self.required

    def better(self, other: _Claim) -> _Claim:
        """Row by row, the one with more to spare."""
        take = ~(self.least - self.required >= other.least - other.required)
        chosen = {}
        for name in _Claim.__slots__:
            mine, its = getattr(self, name), getattr(other, name)
            chosen[name] = np.where(take[:, None] if mine.ndim == 2 else take, its, mine)
        return _Claim(**chosen)


class Prover:
    """Proves phases of one scene. Keeps the arrangements and the FCL objects of the scene."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.solids = SolidsMaker(scene)
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
            return _no_rows(self.solids(phase.carried, phase.rides))
        return _Proof(self, phase, trajectory).run()


def asked_pairs(scene: Scene, solids: Solids) -> tuple[IntArray, IntArray]:
    """The robot's bodies against all others, and against each other where the robot's `self_pairs` ask for it."""
    roots = np.array(solids.roots, dtype=np.int64)
    mine, others = roots[: solids.robot_bodies], roots[solids.robot_bodies :]
    first, second = np.repeat(mine, len(others)), np.tile(others, len(mine))
    name = scene.robot.links
    wanted = {frozenset(links) for links in scene.robot.self_pairs}
    own = [
        (a, b)
        for i, a in enumerate(mine)
        for b in mine[i + 1 :]
        if frozenset((name[solids.carrier[a]], name[solids.carrier[b]])) in wanted
        and solids.carrier[a] != solids.carrier[b]
    ]
    if own:
        first = np.concatenate([first, [a for a, _ in own]])
        second = np.concatenate([second, [b for _, b in own]])
    return first, second


class _Proof:
    """The proof of one phase, round by round."""

    def __init__(self, prover: Prover, phase: Phase, trajectory: Trajectory) -> None:
        self.prover, self.scene, self.phase, self.trajectory = prover, prover.scene, phase, trajectory
        self.solids = prover.solids(phase.carried, phase.rides)
        self.frames = tuple(self.scene.frames.values())
        self.done: list[tuple[IntArray, IntArray, FloatArray, FloatArray, _Claim]] = []
        self.exempt = self._exempt()

    def _exempt(self) -> set[tuple[int, int]]:
        number = {name: i for i, name in enumerate(self.solids.names)}
        found = set()
        for first, second in self.phase.exempt:
            if first in number and second in number:
                found |= {(number[first], number[second]), (number[second], number[first])}
        return found

    def run(self) -> Rows | Unproved:
        a, b = self.prover.asked(self.solids)
        phase = self.phase
        whole = self.intervals(np.array([phase.t0]), np.array([phase.t1]))
        row = np.zeros(len(a), dtype=np.int64)
        claim = self.claim(whole, row, a, b, self.vertical(whole, row, a, b))
        left = self.keep(whole, row, a, b, claim)
        a, b = a[left], b[left]
        count = max(1, int(np.ceil((phase.t1 - phase.t0) / COARSEST_S)))
        edges = np.linspace(phase.t0, phase.t1, count + 1)
        edges[-1] = phase.t1
        table = self.intervals(edges[:-1], edges[1:])
        row = np.repeat(np.arange(count), len(a))
        seed = np.tile(np.array([0.0, 0.0, 1.0]), (len(a) * count, 1))
        return self.rounds(table, row, np.tile(a, count), np.tile(b, count), seed)

    def rounds(
        self, table: _Intervals, row: IntArray, a: IntArray, b: IntArray, seed: FloatArray
    ) -> Rows | Unproved:
        while len(row):
            if len(row) > MOST_ROWS:
                return self.unproved(table, row, a, b, 0, np.nan, np.nan, touching=False)
            middle = row + len(table)
            am, bm = self.at(table, middle, a), self.at(table, middle, b)
            normals = np.concatenate([centre_normals(am, bm), seed[:, None]], axis=1)
            claim = self.claim(table, row, a, b, normals)
            rest = self.keep(table, row, a, b, claim)
            row, a, b, claim, am, bm = row[rest], a[rest], b[rest], _take(claim, rest), am.rows(rest), bm.rows(rest)
            close = ~(claim.gap_mid - SLACK_M > claim.required)
            if close.any():
                claim = self.look_closer(table, row, a, b, am, bm, claim, close)
                rest = self.keep(table, row, a, b, claim)
                row, a, b, claim, am, bm = row[rest], a[rest], b[rest], _take(claim, rest), am.rows(rest), bm.rows(rest)
                close = ~(claim.gap_mid - SLACK_M > claim.required)
            boxes = close & ((self.solids.piece[a] == COVER) | (self.solids.piece[b] == COVER))
            solid = np.flatnonzero(close & ~boxes)
            if len(solid):
                resisted = self.ask(table, row, a, b, am, bm, claim, solid)
                if resisted is not None:
                    return resisted
                # GJK's normals: some rows may be proved by them at once
                rest = self.keep(table, row, a, b, claim)
                row, a, b, claim, boxes = row[rest], a[rest], b[rest], _take(claim, rest), boxes[rest]
            fine = np.flatnonzero(~boxes & ~(table.t1[row] - table.t0[row] > FINEST_S))
            if len(fine):
                i = int(fine[0])
                return self.unproved(table, row, a, b, i, claim.gap_mid[i], claim.required[i], touching=False)
            table, row, a, b, seed = self.refine(table, row, a, b, claim.normal, boxes)
        return self.rows()

    def refine(
        self, table: _Intervals, row: IntArray, a: IntArray, b: IntArray, normal: FloatArray, boxes: BoolArray
    ) -> tuple[_Intervals, IntArray, IntArray, IntArray, FloatArray]:
        """The next round: boxes become pieces on the same interval, everything else halves its interval."""
        old, whole = np.unique(row[boxes], return_inverse=True)
        halved, place_in = np.unique(row[~boxes], return_inverse=True)
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
            self.intervals(t0, t1),
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
        table: _Intervals,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        am: Placed,
        bm: Placed,
        claim: _Claim,
        close: BoolArray,
    ) -> _Claim:
        """Face normals for the rows that the first normals do not part."""
        which = np.flatnonzero(close)
        faces = face_normals(am.rows(which), bm.rows(which))
        closer = self.claim(table, row[which], a[which], b[which], faces)
        return _put(claim, which, _take(claim, which).better(closer))

    def ask(
        self,
        table: _Intervals,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        am: Placed,
        bm: Placed,
        claim: _Claim,
        solid: IntArray,
    ) -> Unproved | None:
        """FCL, then GJK, about rows that nothing parted yet; `claim` takes the normals that GJK found."""
        solid = solid[np.argsort(claim.gap_mid[solid] - claim.required[solid], kind="stable")]
        for i in solid:
            allowed = claim.required[i] < 0
            if not allowed and self.prover.collider.touch(am, bm, int(i)):
                return self.unproved(table, row, a, b, int(i), claim.gap_mid[i], claim.required[i], touching=True)
            distance, normal = separate(am, bm, int(i))
            if normal is None:
                return self.unproved(table, row, a, b, int(i), claim.gap_mid[i], claim.required[i], touching=True)
            one = np.array([i])
            found = self.claim(table, row[one], a[one], b[one], normal[None, None])
            if not found.gap_mid[0] - SLACK_M > found.required[0]:
                gap = max(distance, float(found.gap_mid[0]))
                return self.unproved(table, row, a, b, int(i), gap, found.required[0], touching=False)
            for name in _Claim.__slots__:
                getattr(claim, name)[i] = getattr(found, name)[0]
        return None

    def unproved(
        self,
        table: _Intervals,
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

    def intervals(self, t0: FloatArray, t1: FloatArray) -> _Intervals:
        t = np.concatenate([t0, (t0 + t1) / 2, t1])
        where = carriers(self.scene, standing(self.trajectory, t), t)
        return _Intervals(t0, t1, where, sweep(self.trajectory, t0, t1, self.scene.robot.rate_matrix))

    def at(self, table: _Intervals, row: IntArray, unit: IntArray) -> Placed:
        return place(self.solids, table.where, row, unit)

    def vertical(self, table: _Intervals, row: IntArray, a: IntArray, b: IntArray) -> FloatArray:
        """(r, 1, 3): up or down, from a to b."""
        am, bm = self.at(table, row + len(table), a), self.at(table, row + len(table), b)
        n = np.zeros((len(row), 1, 3))
        n[:, 0, 2] = np.where(bm.centre[:, 2] >= am.centre[:, 2], 1.0, -1.0)
        return n

    def claim(self, table: _Intervals, row: IntArray, a: IntArray, b: IntArray, normals: FloatArray) -> _Claim:
        """The best of the normals (r, N, 3) for each row."""
        count, many = normals.shape[:2]
        size = len(table)
        each = [gaps(self.at(table, row + k * size, a), self.at(table, row + k * size, b), normals) for k in range(3)]
        wide = np.repeat(np.arange(count), many)
        flat = normals.reshape(-1, 3)
        speed_a, acceleration_a = self.bounds(table, row[wide], a[wide], flat)
        speed_b, acceleration_b = self.bounds(table, row[wide], b[wide], flat)
        speed, acceleration = (speed_a + speed_b).reshape(count, many), (acceleration_a + acceleration_b).reshape(count, many)
        h = (table.t1 - table.t0)[row][:, None]
        gap0, gap_mid, gap1 = each
        least = np.fmax((gap0 + gap1 - speed * h) / 2, np.minimum(gap0, gap1) - acceleration * h**2 / 8)
        required = self.required(table, row, a, b, speed_b.reshape(count, many), flat, wide)
        best = np.argmax(np.where(np.isnan(least - required), -np.inf, least - required), axis=1)
        pick = np.arange(count), best
        return _Claim(
            normals[pick], gap0[pick], gap_mid[pick], gap1[pick], speed[pick], acceleration[pick], least[pick], required[pick]
        )

    def bounds(self, table: _Intervals, row: IntArray, unit: IntArray, n: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Bounds (r,) of |n·ẋ| and |n·ẍ| over the rows' intervals, for all points of their units."""
        solids, swept = self.solids, table.swept
        carrier = solids.carrier[unit]
        speed, acceleration = np.zeros(len(row)), np.zeros(len(row))
        mine = np.flatnonzero(carrier < solids.links)
        if len(mine):
            r = row[mine]
            part = Sweep(swept.lower[r], swept.upper[r], swept.rate[r], swept.rate_d[r])
            speed[mine], acceleration[mine] = self.scene.robot.point_bounds(
                carrier[mine], solids.reach[unit[mine]], n[mine], part
            )
        for k in np.unique(carrier[carrier >= solids.links]):
            rows = np.flatnonzero(carrier == k)
            found = self.frame_bounds(int(k), table.t0[row[rows]], table.t1[row[rows]], unit[rows], n[rows])
            speed[rows], acceleration[rows] = found
        return speed, acceleration

    def frame_bounds(
        self, carrier: int, t0: FloatArray, t1: FloatArray, unit: IntArray, n: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """The same for units that all ride on one frame of the cell."""
        bound = self.frames[carrier - self.solids.links].law.bounds(t0, t1, n)
        across = np.hypot(n[:, 0], n[:, 1]) * self.solids.reach[unit]
        speed = bound.speed + across * bound.yaw_rate
        return speed, bound.acceleration + across * np.hypot(bound.yaw_acceleration, bound.yaw_rate**2)

    def required(
        self,
        table: _Intervals,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        speed_b: FloatArray,
        flat: FloatArray,
        wide: IntArray,
    ) -> FloatArray:
        """(r, N) metres: equation C5."""
        scene, phase, solids = self.scene, self.phase, self.solids
        base = clearance(scene, phase)
        found = np.full(speed_b.shape, base)
        carrier = solids.carrier[b]
        t1 = table.t1[row]
        tolerance = scene.execution.start_tolerance_s
        for k in np.unique(carrier[carrier >= solids.links]):
            rows = np.flatnonzero(carrier == k)
            frame = self.frames[k - solids.links].name
            found[rows] += (scene.execution.tracking_m + uncertainty(scene, phase, frame, t1[rows]))[:, None]
            if tolerance > 0:
                every = np.flatnonzero(carrier[wide] == k)
                r = row[wide[every]]
                late, _ = self.frame_bounds(int(k), table.t0[r], table.t1[r] + tolerance, b[wide[every]], flat[every])
                found[rows] += tolerance * late.reshape(len(rows), -1)
        for first, second in self.exempt:
            found[(solids.body[a] == first) & (solids.body[b] == second)] = CONTACT_GAP
        return found

    def keep(self, table: _Intervals, row: IntArray, a: IntArray, b: IntArray, claim: _Claim) -> BoolArray:
        """Stores the rows that are proved; returns which are not."""
        proved = claim.proved
        if proved.any():
            r = row[proved]
            self.done.append((a[proved], b[proved], table.t0[r], table.t1[r], _take(claim, proved)))
        rest: BoolArray = ~proved
        return rest

    def rows(self) -> Rows:
        if not self.done:
            return _no_rows(self.solids)
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


def _no_rows(solids: Solids) -> Rows:
    none, index = np.zeros(0), np.zeros(0, dtype=np.int64)
    return Rows(solids, none, none, index, index, np.zeros((0, 3)), none, none, none, none)


def _take(claim: _Claim, key: BoolArray | IntArray) -> _Claim:
    return _Claim(*(getattr(claim, name)[key] for name in _Claim.__slots__))


def _put(claim: _Claim, where: IntArray, found: _Claim) -> _Claim:
    result = _Claim(*(getattr(claim, name).copy() for name in _Claim.__slots__))
    for name in _Claim.__slots__:
        getattr(result, name)[where] = getattr(found, name)
    return result


def written(
    scene: Scene, trajectory: Trajectory, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], proofs: list[Rows]
) -> Certificate:
    """The certificate of a whole plan from the rows of its phases."""
    names = tuple(dict.fromkeys(name for rows in proofs for name in rows.solids.names))
    number = {name: i for i, name in enumerate(names)}

    def bodies(rows: Rows, unit: IntArray) -> IntArray:
        of = np.array([number[name] for name in rows.solids.names], dtype=np.int64)
        return of[rows.solids.body[unit]]

    def column(name: str) -> FloatArray:
        return np.concatenate([getattr(rows, name) for rows in proofs])

    certificate = Certificate(
        names=names,
        t0=column("t0"),
        t1=column("t1"),
        first=np.concatenate([bodies(rows, rows.first) for rows in proofs]),
        first_piece=np.concatenate([rows.solids.piece[rows.first] for rows in proofs]),
        second=np.concatenate([bodies(rows, rows.second) for rows in proofs]),
        second_piece=np.concatenate([rows.solids.piece[rows.second] for rows in proofs]),
        normal=column("normal"),
        gap0=column("gap0"),
        gap1=column("gap1"),
        speed=column("speed"),
        acceleration=column("acceleration"),
    )
    return replace(certificate, digest=digest(scene.digest, trajectory, legs, arrivals, certificate))


__all__ = ["Prover", "Rows", "Unproved", "asked_pairs", "pair", "written"]

"""What is true of a phase over intervals: placements, bounds of motion, required distances, and claims from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.collision.arrangement import Carriers, Solids, carriers, exempted, standing
from assur.planner.collision.claim import Claim
from assur.planner.collision.support_gaps import Placed, gaps, place
from assur.planner.frames import Fixed
from assur.planner.model.clearance import CONTACT_GAP, clearance, is_certain, uncertainty
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.robots.protocol import Sweep
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.sweep import sweep


@dataclass(frozen=True, slots=True)
class Intervals:
    """A table of intervals with all carriers at start, middle and end, and the arm's sweep over them."""

    t0: FloatArray
    t1: FloatArray
    where: Carriers
    swept: Sweep

    def __len__(self) -> int:
        return len(self.t0)

    def some(self, key: slice) -> Intervals:
        """Some of the intervals, as a table of their own."""
        size = len(self)
        rows = (np.arange(size)[key] + size * np.arange(3)[:, None]).ravel()
        where, swept = self.where, self.swept
        return Intervals(
            self.t0[key],
            self.t1[key],
            Carriers(where.position[rows], where.rotation[rows]),
            Sweep(swept.lower[key], swept.upper[key], swept.rate[key], swept.rate_d[key]),
        )


@dataclass(frozen=True, slots=True)
class Thrice:
    """Pairs of units of r rows at start, middle and end of their intervals: 3 r rows, the starts first."""

    one: Placed
    other: Placed

    def some(self, key: BoolArray | IntArray) -> Thrice:
        """Some of the rows."""
        count = len(self.one.unit) // 3
        which = np.arange(count)[key]
        rows = np.concatenate([which, which + count, which + 2 * count])
        return Thrice(self.one.rows(rows), self.other.rows(rows))

    def middle(self) -> tuple[Placed, Placed]:
        """The pairs in the middle of their intervals, r rows."""
        count = len(self.one.unit) // 3
        return self.one.rows(slice(count, 2 * count)), self.other.rows(slice(count, 2 * count))

    def vertical(self) -> FloatArray:
        """(r, 1, 3): up or down, from the one to the other."""
        one, other = self.middle()
        n = np.zeros((len(one.unit), 1, 3))
        n[:, 0, 2] = np.where(other.centre[:, 2] >= one.centre[:, 2], 1.0, -1.0)
        return n


class Facts:
    """The facts of one phase of one trajectory, for the arrangement of solids that the phase has."""

    def __init__(self, scene: Scene, solids: Solids, phase: Phase, trajectory: Trajectory) -> None:
        self.scene, self.solids, self.phase, self.trajectory = scene, solids, phase, trajectory
        self.frames = tuple(scene.frames.values())
        self.certain = is_certain(scene)
        # carriers of which nothing need be computed: frames that stand still and are known for as long as it matters
        last = phase.t1 + scene.execution.start_tolerance_s
        laws = [frame.law for frame in self.frames]
        fixed = [isinstance(law, Fixed) and law.valid[0] <= phase.t0 and last <= law.valid[1] for law in laws]
        self.still = np.array([False] * solids.links + fixed)

    def intervals(self, t0: FloatArray, t1: FloatArray) -> Intervals:
        t = np.concatenate([t0, (t0 + t1) / 2, t1])
        where = carriers(self.scene, standing(self.trajectory, t), t)
        return Intervals(t0, t1, where, sweep(self.trajectory, t0, t1, self.scene.robot.rate_matrix))

    def thrice(self, table: Intervals, row: IntArray, a: IntArray, b: IntArray) -> Thrice:
        """Units a and b (r,) at start, middle and end of the intervals `row` (r,)."""
        size = len(table)
        rows = np.concatenate([row, row + size, row + 2 * size])
        one, other = (place(self.solids, table.where, rows, np.concatenate([unit] * 3)) for unit in (a, b))
        return Thrice(one, other)

    def claim(
        self, table: Intervals, row: IntArray, a: IntArray, b: IntArray, placed: Thrice, normals: FloatArray
    ) -> Claim:
        """The best of the normals (r, N, 3) for each row, the units being `placed` there."""
        count, many = normals.shape[:2]
        each = gaps(placed.one, placed.other, np.concatenate([normals] * 3)).reshape(3, count, many)
        wide = np.repeat(np.arange(count), many)
        flat = normals.reshape(-1, 3)
        speed_a, acceleration_a = self.bounds(table, row[wide], a[wide], flat)
        speed_b, acceleration_b = self.bounds(table, row[wide], b[wide], flat)
        speed, acceleration = (
            (speed_a + speed_b).reshape(count, many),
            (acceleration_a + acceleration_b).reshape(count, many),
        )
        h = (table.t1 - table.t0)[row][:, None]
        gap0, gap_mid, gap1 = each
        least = np.fmax((gap0 + gap1 - speed * h) / 2, np.minimum(gap0, gap1) - acceleration * h**2 / 8)
        required = self.required(table, row, a, b, speed_b.reshape(count, many), flat, wide)
        best = np.argmax(np.where(np.isnan(least - required), -np.inf, least - required), axis=1)
        pick = np.arange(count), best
        return Claim(
            normals[pick],
            gap0[pick],
            gap_mid[pick],
            gap1[pick],
            speed[pick],
            acceleration[pick],
            least[pick],
            required[pick],
        )

    def bounds(self, table: Intervals, row: IntArray, unit: IntArray, n: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Bounds (r,) of |n·ẋ| and |n·ẍ| over the rows' intervals, for all points of their units."""
        solids, swept = self.solids, table.swept
        carrier = solids.carrier[unit]
        speed, acceleration = np.zeros(len(row)), np.zeros(len(row))
        mine = np.flatnonzero(carrier < solids.links)
        if len(mine):
            r = row[mine]
            part = Sweep(swept.lower[r], swept.upper[r], swept.rate[r], swept.rate_d[r])
            mine_units = unit[mine]
            speed[mine], acceleration[mine] = self.scene.robot.point_bounds(
                carrier[mine], solids.reach[mine_units], solids.distance[mine_units], n[mine], part
            )
        for k in self._moving(carrier):
            rows = np.flatnonzero(carrier == k)
            found = self.frame_bounds(int(k), table.t0[row[rows]], table.t1[row[rows]], unit[rows], n[rows])
            speed[rows], acceleration[rows] = found
        return speed, acceleration

    def _moving(self, carrier: IntArray) -> IntArray:
        """The frames among carriers (r,) that do not stand still."""
        moving = (carrier >= self.solids.links) & ~self.still[carrier]
        return np.unique(carrier[moving]) if moving.any() else carrier[:0]

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
        table: Intervals,
        row: IntArray,
        a: IntArray,
        b: IntArray,
        speed_b: FloatArray,
        flat: FloatArray,
        wide: IntArray,
    ) -> FloatArray:
        """(r, N) metres: equation C5."""
        scene, phase, solids = self.scene, self.phase, self.solids
        found = np.full(speed_b.shape, clearance(scene, phase))
        carrier = solids.carrier[b]
        around = carrier >= solids.links
        found[around] += scene.execution.tracking_m
        tolerance = scene.execution.start_tolerance_s
        if not self.certain:
            late_t1 = table.t1[row] + tolerance  # the arm may be there as late as that
            for k in np.unique(carrier[around]):
                rows = np.flatnonzero(carrier == k)
                found[rows] += uncertainty(scene, phase, self.frames[k - solids.links].name, late_t1[rows])[:, None]
        if tolerance > 0:
            for k in self._moving(carrier):
                every = np.flatnonzero(carrier[wide] == k)
                r = row[wide[every]]
                late, _ = self.frame_bounds(int(k), table.t0[r], table.t1[r] + tolerance, b[wide[every]], flat[every])
                found[carrier == k] += tolerance * late.reshape(-1, speed_b.shape[1])
        if phase.exempt:
            found[exempted(solids, phase, a, b)] = CONTACT_GAP
        return found

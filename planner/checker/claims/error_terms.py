"""What adds to the error of an arrival (equation U4): which vectors count with either sign, where a late start or a lag
of joints brings the tool, and what counts in full; each with its cause.

Joints that lag move the tool along a bent way: the arm is looked at with its joints at the ends of their lag, and in
between the way is bent by no more than the second derivative lets it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import motion
from assur.planner.checker.doubts import counted, line_of, stands
from assur.planner.checker.targets import Target
from assur.planner.checker.uncertainty import sway
from assur.planner.checker.world import World
from assur.planner.frames.motion import Pose
from assur.planner.laws.law import EXACT
from assur.planner.model.arrival_error import Cause
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import Handled
from assur.planner.model.scene import Pick, Place
from assur.planner.robots.scara import Scara

STEPS = 64
"""Parts of the time by which a start may be late."""
LATE, DIRECTION = "late start s", "direction rad"
"""What a realisation calls the lateness of the start, and the direction of what is the same in all of them."""


@dataclass(eq=False)
class Terms:
    """`signed`: vectors (3,) by cause and name, m. `late`: how far the point has gone on (K, 3), m, at these times, s.
    `lagged`: where joints at the ends of their lag bring the tool (L, 3), m, by their signs (L, n). By cause: what
    counts in every horizontal direction, up and down, m, and as yaw, rad. `grasp`: m of the tool beside the part."""

    signed: list[tuple[Cause, str, FloatArray]] = field(default_factory=list)
    late: FloatArray = field(default_factory=lambda: np.zeros((1, 3)))
    late_s: FloatArray = field(default_factory=lambda: np.zeros(1))
    lagged: FloatArray = field(default_factory=lambda: np.zeros((1, 3)))
    signs: FloatArray = field(default_factory=lambda: np.zeros((1, 0)))
    joints: dict[str, float] = field(default_factory=dict)
    """By how much, m, the lag of each joint alone moves the tool."""
    flat: dict[Cause, float] = field(default_factory=dict)
    upright: dict[Cause, float] = field(default_factory=dict)
    yaw: dict[Cause, float] = field(default_factory=dict)
    grasp: float = 0.0

    def add(self, cause: Cause, flat: float = 0.0, upright: float = 0.0, yaw: float = 0.0) -> None:
        """Adds what counts in full."""
        for table, amount in ((self.flat, flat), (self.upright, upright), (self.yaw, yaw)):
            if amount != 0.0:
                table[cause] = table.get(cause, 0.0) + amount

    @property
    def bows(self) -> float:
        """What counts for bent ways, m: of joints that lag, and of points that go on."""
        bent = (Cause.LAG, Cause.LATE)
        return sum(table.get(cause, 0.0) for table in (self.flat, self.upright) for cause in bent)

    def sums(self, cause: Cause | None = None) -> FloatArray:
        """All combinations (N, 3) of what has a direction; of one cause, or of all."""
        used = [vector for own, _, vector in self.signed if cause in (None, own) and vector.any()]
        sums = np.array([
            np.sum([sign * vector for sign, vector in zip(signs, used, strict=True)], axis=0) + np.zeros(3)
            for signs in product((-1.0, 1.0), repeat=len(used))
        ])  # fmt: skip
        late = self.late if cause in (None, Cause.LATE) else np.zeros((1, 3))
        lagged = self.lagged if cause in (None, Cause.LAG) else np.zeros((1, 3))
        off = sums[:, None, None, :] + late[None, :, None, :] - lagged[None, None, :, :]
        return np.asarray(off.reshape(-1, 3))

    def bound(self, cause: Cause | None = None) -> tuple[float, float, float, float]:
        """No error is larger: distance, horizontal distance, height, m, and yaw, rad; of one cause, or of all. Of one
        cause the distance is that of the part itself, not of the tool beside it."""
        flat, upright, yaw = (
            sum(amount for own, amount in table.items() if cause in (None, own))
            for table in (self.flat, self.upright, self.yaw)
        )
        off = self.sums(cause)
        side, height = np.hypot(off[:, 0], off[:, 1]) + flat, np.abs(off[:, 2]) + upright
        far = float(np.hypot(side, height).max())
        if cause is None:
            far += yaw * self.grasp
        return far, float(side.max()), float(height.max()), yaw


def terms_of(world: World, arrival: Arrival, target: Target, handled: Handled, shifting: set[str]) -> Terms:
    """What adds to the error of an arrival. `shifting`: the belts for which a correction may have shifted the tool on
    its way."""
    scene, step, until, terms = world.scene, target.step, arrival.until, Terms()
    if isinstance(step, Pick):
        own = handled.of(step.part) or scene.index[step.part].uncertainty
        terms.add(Cause.PART, own.position_m, own.vertical_m, own.yaw_rad)
        terms.grasp = math.hypot(step.grasp.x, step.grasp.y)
    elif isinstance(step, Place):
        own = handled.of(step.part) or EXACT
        terms.add(Cause.GRIP, own.position_m, own.vertical_m, own.yaw_rad)
    _add_frame(world, arrival, target, shifting, terms)
    _add_late(world, target, until, terms)
    (point,) = world.states([(world.frame[target.frame], target.point, until)])
    _add_lag(world, (point.x, point.y, point.z), until, terms)
    return terms


def _add_frame(world: World, arrival: Arrival, target: Target, shifting: set[str], terms: Terms) -> None:
    """Errors of the frame, each with either sign, and of belts that shift the tool."""
    scene, until, name = world.scene, arrival.until, target.frame
    frame, carrier = scene.frames[name], world.frame[name]
    known, line = frame.uncertainty, line_of(frame.law)
    lasts = max(until + scene.execution.start_tolerance_s - scene.start.time, 0.0)
    terms.signed.append((Cause.FRAME, f"{name} up", np.array([0.0, 0.0, known.vertical_m])))
    along = known.position_m + known.speed_m_s * lasts
    if scene.execution.belt_correction and target.step.tracks and counted(frame.law):
        along = 0.0  # an encoder counts the way of a belt
    level = 0.0 if line is None else math.hypot(line[0], line[1])
    if line is None:
        terms.add(Cause.FRAME, along)
    else:
        terms.signed.append((Cause.FRAME, f"{name} along", along * np.array(line)))
    if level > 0.0 and line is not None:
        across = known.lateral_m / level * np.array([-line[1], line[0], 0.0])
        terms.signed.append((Cause.FRAME, f"{name} across", across))
    else:
        terms.add(Cause.FRAME, known.lateral_m)
    for belt in sorted(shifting):
        doubt, way = scene.frames[belt].uncertainty, line_of(scene.frames[belt].law) or (0.0, 0.0, 0.0)
        size = doubt.position_m + doubt.speed_m_s * lasts
        terms.signed.append((Cause.FRAME, f"{belt} along", -size * np.array(way)))
    point, origin = world.states([(carrier, target.point, until), (carrier, Pose(), until)])
    ax, ay = point.x - origin.x, point.y - origin.y
    terms.signed.append((Cause.FRAME, f"{name} turned", known.yaw_rad * np.array([-ay, ax, 0.0])))
    terms.add(Cause.FRAME, math.hypot(ax, ay) * known.yaw_rad**2 / 2.0, yaw=known.yaw_rad)


def _add_late(world: World, target: Target, until: float, terms: Terms) -> None:
    """How far the point has gone on when the robot is late or the frame shifted in time; by how much its way is bent
    between; and by how much it has turned."""
    frame = world.scene.frames[target.frame]
    low, high = frame.uncertainty.shift_s
    first, last = -high, world.scene.execution.start_tolerance_s - low
    if stands(frame.law) or not last > first:
        return
    carrier, times = world.frame[target.frame], np.linspace(first, last, STEPS + 1)
    here, *there = world.states([(carrier, target.point, until + t) for t in (0.0, *times.tolist())])
    terms.late, terms.late_s = np.array([np.subtract(state.p, here.p) for state in there]), times
    jets = motion.all_jets(world.tables) * np.nan
    if not motion.carry(carrier, until + first, until + last, world.tables, jets):
        terms.add(Cause.LATE, math.inf, math.inf, math.inf)
        return
    reach = math.sqrt(target.point.x**2 + target.point.y**2 + target.point.z**2)
    step = (last - first) / STEPS
    bow = _second(jets[carrier], reach) * step**2 / 8.0
    rate = float(np.hypot(*np.abs(jets[carrier, 3:5, 2:4]).max(1)))
    turns = max(abs(math.remainder(state.yaw - here.yaw, math.tau)) for state in there)
    terms.add(Cause.LATE, bow, bow, turns + rate * step / 2.0 if rate > 0.0 else 0.0)


def gone(world: World, target: Target, until: float, late: float) -> FloatArray:
    """How far (3,), m, the point has gone on when the robot is late by so much, s; NaN where it is not known."""
    carrier = world.frame[target.frame]
    here, there = world.states([(carrier, target.point, until), (carrier, target.point, until + late)])
    return np.subtract(there.p, here.p)


def _second(jets: FloatArray, reach: float) -> float:
    """A bound of the second derivative of a point of a carrier that is `reach` from its origin."""
    own = np.abs(jets[:3, 4:6]).max(1)
    axes = np.abs(jets[3:, 4:6]).max(1)
    return float(np.sqrt((own**2).sum()) + reach * np.sqrt((axes**2).sum()))


def _add_lag(world: World, point: tuple[float, float, float], until: float, terms: Terms) -> None:
    """Where the tool at a point of the world is moved by joints at the ends of their lag; by how much more in between;
    and how far it is turned."""
    scene, lag = world.scene, np.array(world.scene.execution.lag)
    if not scene.execution.lags:
        return
    row, q, n = world.tables[0][0], world.joints(until, until)[:, 0], len(lag)
    tilts = bool(scene.robot.tilting)

    def flange(joints: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Position (3,) and rotation (3, 3) of the flange for joints (n,)."""
        still, jets = np.zeros((8, 6)), motion.all_jets(world.tables) * np.nan
        still[:n, 0] = still[:n, 1] = joints
        motion.links(row, still, jets, 0)
        return jets[world.flange, :3, 0], jets[world.flange, 3:, 0].reshape(3, 3).T

    place, axes = flange(q)
    local = np.zeros(3) if tilts else axes.T @ (np.array(point) - place)

    def moved(signs: FloatArray) -> tuple[FloatArray, float]:
        there, turned = flange(q + lag * signs)
        return there + turned @ local - place - axes @ local, abs(_turn(axes, turned))

    terms.signs = np.array(list(product((-1.0, 1.0), repeat=n)))
    found = [moved(signs) for signs in terms.signs]
    terms.lagged = np.array([each for each, _ in found])
    for j, joint in enumerate(scene.robot.joints):
        if lag[j] > 0.0:
            terms.joints[joint.name] = float(np.linalg.norm(moved(np.eye(n)[j])[0]))
    jets = motion.all_jets(world.tables) * np.nan
    doubt = (np.zeros((0, 11)), np.zeros((1, 1, 2)), np.zeros((1, 0, 2)), np.append(lag, np.zeros(4)), np.zeros(4))
    if not sway(world.tables, doubt, until, until, jets):
        terms.add(Cause.LAG, math.inf, math.inf, math.inf)
        return
    # the flange stays upright: its own axis does not turn (of an arm that tilts the point is the flange's own)
    bent = _second(jets[world.flange], math.hypot(*local[:2].tolist()))
    turn = max(turn for _, turn in found)
    if tilts:
        turn = 0.0  # such an arm has no yaw to be asked for
    elif not isinstance(scene.robot, Scara):
        # the heading of a closed chain is bent, too: its chord is no longer than the longest and what it leaves
        chord = 2.0 * math.sin(turn / 2.0) + float(np.hypot(*np.abs(jets[world.flange, 3:5, 4:6]).max(1)))
        turn = 2.0 * math.asin(chord / 2.0) if chord < 2.0 else math.inf
    terms.add(Cause.LAG, bent, bent if tilts else 0.0, turn)


def _turn(before: FloatArray, after: FloatArray) -> float:
    """By how much an upright flange has turned, rad."""
    both = before.T @ after
    return math.atan2(float(both[1, 0]), float(both[0, 0]))

"""Plans made by hand for the checker: a SCARA, simple cells, quintics through a few states, and a plain prover.

None of it uses the planner's own search, legs, timing, sweep, separation or certificate: the checker is tried on what
nobody it will meet has made.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import Body, Hull, Piece, box, capsule, cylinder, sphere, support
from assur.planner.laws import Frame, conveyor, fixed, linear, turntable
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Arrival, Certificate, Leg, LegKind, Plan
from assur.planner.model.phases import CONTACT_M, Phase, phases
from assur.planner.model.scene import Clearance, Move, Options, Pick, Place, Scene, Start, Target, Tool, WorldBody
from assur.planner.robots.facts import Code, Limits, RobotBody
from assur.planner.robots.scara import BASE, FLANGE, LINK1, LINK2, QUILL, Scara
from assur.planner.trajectory import Trajectory
from tests.planner.convex import reach
from tests.planner.laws.bounded import bounded
from tests.planner.robots.point_bounds import point_bounds

MODE = 1
Height = Callable[[FloatArray], tuple[FloatArray, ...]]
"""A height above a point at times (T,), with its first two rates."""
SLACK_M = 1e-6


def solid(name: str, shape: object, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Body:
    """A body of one piece at a place in its own frame."""
    return Body(name, (Piece(shape, np.array([x, y, z])),))  # type: ignore[arg-type]


def arm() -> Scara:
    """A SCARA of 225 + 175 mm with a column, two links and a quill."""
    limits = Limits(
        lower=np.array([-2.6, -2.6, 0.05, -6.5]),
        upper=np.array([2.6, 2.6, 0.35, 6.5]),
        velocity=np.array([8.0, 10.0, 2.0, 40.0]),
        acceleration=np.array([120.0, 200.0, 40.0, 800.0]),
        jerk=np.array([6e3, 1e4, 2e3, 4e4]),
    )
    bodies = (
        RobotBody(solid("column", cylinder(0.05, 0.36), z=0.18), BASE),
        RobotBody(solid("upper arm", box(0.3, 0.08, 0.06), x=0.11, z=0.42), LINK1),
        RobotBody(solid("forearm", capsule(0.04, 0.1), x=0.09, z=0.52), LINK2),
        RobotBody(solid("quill", cylinder(0.012, 0.3), z=0.15), QUILL),
    )
    pairs = (("base", "link2"), ("base", "flange"), ("link1", "flange"), ("base", "quill"))
    return Scara(name="by hand", l1=0.225, l2=0.175, axes=4, limits=limits, bodies=bodies, self_pairs=pairs)


TOOL = Tool(Pose(0.005, 0.0, -0.08), (solid("cup", cylinder(0.01, 0.08), x=0.005, z=-0.04),), 0.2)


def carton() -> Body:
    """Four walls: a body of several pieces that is not convex."""
    walls = [(0.0, 0.05, 0.1, 0.005), (0.0, -0.05, 0.1, 0.005), (0.05, 0.0, 0.005, 0.1), (-0.05, 0.0, 0.005, 0.1)]
    return Body("carton", tuple(Piece(box(w, d, 0.06), np.array([x, y, 0.0])) for x, y, w, d in walls))


def wedge() -> Body:
    """A hull of five vertices."""
    vertices = np.array([[-0.04, -0.03, 0], [0.04, -0.03, 0], [0.04, 0.03, 0], [-0.04, 0.03, 0], [0, 0, 0.09]])
    faces = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    return Body("wedge", (Piece(Hull(vertices, faces)),))


def frame(name: str, law: object) -> Frame:
    return Frame(name, law)  # type: ignore[arg-type]


WORLD = frame("world", fixed(Pose()))


def joints_at(robot: Scara, tcp: Pose, tool: Motion) -> tuple[FloatArray, FloatArray, FloatArray]:
    """q, q̇, q̈ (..., 4) for a motion of the tool point."""
    found = robot.inverse(tool.at(tcp.inverse()), MODE)
    if not (found.code == Code.ASSEMBLED).all():
        raise FaultError("out of reach by hand")
    return found.q, found.qd, found.qdd


@dataclass
class Hand:
    """Writes a plan down, leg by leg: knots, legs and arrivals."""

    scene: Scene
    time: list[FloatArray] = field(default_factory=list)
    q: list[FloatArray] = field(default_factory=list)
    qd: list[FloatArray] = field(default_factory=list)
    qdd: list[FloatArray] = field(default_factory=list)
    legs: list[Leg] = field(default_factory=list)
    arrivals: list[Arrival] = field(default_factory=list)

    def __post_init__(self) -> None:
        start = self.scene.start
        self._knots(np.array([start.time]), start.q[None], start.qd[None], start.qdd[None])

    @property
    def now(self) -> float:
        return float(self.time[-1][-1])

    def _knots(self, t: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> None:
        for column, values in zip((self.time, self.q, self.qd, self.qdd), (t, q, qd, qdd), strict=True):
            column.append(values)

    def leg(self, kind: LegKind, step: int, t1: float) -> None:
        before = self.legs[-1].t1 if self.legs else self.scene.start.time
        self.legs.append(Leg(kind, step, before, t1))

    def wait(self, step: int, t1: float) -> None:
        self._knots(np.array([t1]), self.q[-1][-1:], np.zeros((1, 4)), np.zeros((1, 4)))
        self.leg(LegKind.WAIT, step, t1)

    def go(self, step: int, tool: Callable[[FloatArray], Motion], t1: float, kind: LegKind = LegKind.MOVE) -> None:
        """One quintic to where `tool` is at t1, with its velocity and acceleration."""
        t = np.array([t1])
        self._knots(t, *joints_at(self.scene.robot, self.scene.tool.tcp, tool(t)))  # type: ignore[arg-type]
        self.leg(kind, step, t1)

    def glide(self, step: int, tool: Callable[[FloatArray], Motion], t1: float, kind: LegKind) -> None:
        """Along `tool`, a knot every 5 ms."""
        t0 = self.now
        t = np.linspace(t0, t1, 2 + int((t1 - t0) / 0.005))[1:]
        if t1 > t0:
            self._knots(t, *joints_at(self.scene.robot, self.scene.tool.tcp, tool(t)))  # type: ignore[arg-type]
        self.leg(kind, step, t1)

    def arrive(self, step: int, t: float, until: float, *, matched: bool = True, yaw_offset: float = 0.0) -> None:
        trajectory = self.trajectory()
        p, yaw = self.scene.robot.forward(trajectory.evaluate(np.array(t)))
        pose = Pose(float(p[0]), float(p[1]), float(p[2]), float(yaw)).then(self.scene.tool.tcp)
        self.arrivals.append(Arrival(step, self.scene.task[step].name, t, until, pose, matched, yaw_offset))

    def trajectory(self) -> Trajectory:
        return Trajectory(*(np.concatenate(column) for column in (self.time, self.q, self.qd, self.qdd)))

    def plan(self) -> Plan:
        return proved(self.scene, self.trajectory(), tuple(self.legs), tuple(self.arrivals))


def above(scene: Scene, name: str, pose: Pose, height: Height | float = 0.0) -> Callable[[FloatArray], Motion]:
    """The motion of a tool pose in a frame, lifted by a height with its rates."""

    def motion(t: FloatArray) -> Motion:
        found = scene.frames[name].law.motion(t).at(pose)
        rates = height(t) if callable(height) else (np.full(t.shape, height), np.zeros(t.shape), np.zeros(t.shape))
        for values, rate in zip((found.p, found.v, found.a), rates, strict=True):
            values[..., 2] += rate
        return found

    return motion


def ramp(t0: float, t1: float, high: float, low: float) -> Height:
    """A height that goes from one level to another, at rest at both."""
    length = t1 - t0

    def height(t: FloatArray) -> tuple[FloatArray, ...]:
        s = (t - t0) / length
        step = s**3 * (10 - 15 * s + 6 * s**2)
        rate = 30 * s**2 * (1 - s) ** 2 / length
        bend = (60 * s - 180 * s**2 + 120 * s**3) / length**2
        return high + (low - high) * step, (low - high) * rate, (low - high) * bend

    return height


def start_at(robot: Scara, tcp: Pose, tool: Pose, time: float = 0.0) -> Start:
    q, _, _ = joints_at(robot, tcp, Motion.still(tool))
    return Start(time, q, np.zeros(4), np.zeros(4))


def crossing(
    options: Options | None = None, ball_speed: float = 0.02, bodies: tuple[WorldBody, ...] = (), **changes: object
) -> Scene:
    """Up out of a carton, then past a ball that comes near, to a place beside a wedge, over a floor."""
    robot = arm()
    frames = {
        "world": WORLD,
        "ball": frame("ball", linear(Pose(0.1, 0.33, 0.2), (0.8 * ball_speed, -0.6 * ball_speed, 0.0))),
    }
    around = (
        WorldBody(solid("floor", box(2.0, 2.0, 0.02)), "world", Pose(z=-0.02)),
        WorldBody(solid("ball", sphere(0.03)), "ball"),
        WorldBody(carton(), "world", Pose(0.3, -0.1, 0.03, 0.3)),
        WorldBody(wedge(), "world", Pose(0.22, 0.2, 0.0, 0.1)),
        *bodies,
    )
    task = (
        Move("up", Target("world", Pose(0.3, -0.1, 0.15))),
        Move("there", Target("world", Pose(0.2, 0.25, 0.2, 0.4))),
    )
    start = start_at(robot, TOOL.tcp, Pose(0.3, -0.1, 0.05))
    given = options or Options(clearance=Clearance(0.003, 0.001), stay_safe_s=0.1)
    scene = Scene(robot, TOOL, start, frames, around, task, given, digest="crossing")
    return replace(scene, **changes)  # type: ignore[arg-type]


def crossed(scene: Scene) -> Plan:
    """The plan for `crossing`: a wait, and one quintic a move."""
    hand = Hand(scene)
    hand.wait(0, 0.1)
    for number, (step, t) in enumerate(zip(scene.task, (0.4, 1.0), strict=True)):
        assert isinstance(step, Move)
        hand.go(number, above(scene, step.target.frame, step.target.pose), t)
        hand.arrive(number, t, t, matched=step.match == "velocity" and not step.via)
    return hand.plan()


def belt_to_dial(**changes: object) -> Scene:
    """Pick from a belt, place on a turning dial, go home."""
    robot = arm()
    frames = {
        "world": WORLD,
        "belt": frame("belt", conveyor(Pose(0.0, 0.28), 0.1)),
        "dial": frame("dial", turntable(Pose(0.24, -0.14, 0.0), 0.4)),
    }
    part = solid("part", box(0.04, 0.03, 0.02))
    around = (
        WorldBody(solid("bed", box(1.2, 0.12, 0.05)), "world", Pose(0.0, 0.28, 0.025)),
        WorldBody(part, "belt", Pose(-0.1, 0.0, 0.06, 0.2), 0.1, 2),
        WorldBody(solid("neighbour", box(0.04, 0.03, 0.02)), "belt", Pose(0.05, 0.0, 0.06)),
        WorldBody(solid("plate", cylinder(0.08, 0.02)), "dial", Pose(z=0.03)),
        WorldBody(solid("peg", cylinder(0.01, 0.05)), "dial", Pose(-0.05, 0.0, 0.065)),
    )
    task = (
        Pick("take", "part", Pose(0.0, 0.0, 0.01), 0.03, 0.1, 0.04),
        Place("put", "part", Target("dial", Pose(0.05, 0.0, 0.05, 0.5)), 0.03, 0.06, 0.03),
        Move("home", Target("world", Pose(0.25, 0.1, 0.2))),
    )
    options = Options(clearance=Clearance(0.004, 0.001), stay_safe_s=0.2)
    start = start_at(robot, TOOL.tcp, Pose(0.15, 0.2, 0.2))
    scene = Scene(robot, TOOL, start, frames, around, task, options, digest="belt to dial")
    return replace(scene, **changes)  # type: ignore[arg-type]


def carried_over(scene: Scene, yaw_offset: float = 0.0) -> Plan:
    """The plan for `belt_to_dial`."""
    hand = Hand(scene)
    pick, place, home = scene.task
    assert isinstance(pick, Pick)
    assert isinstance(place, Place)
    assert isinstance(home, Move)
    grasp = Pose(yaw=yaw_offset).then(pick.grasp)
    on_belt = scene.index["part"].pose.then(grasp)
    on_dial = place.to.pose.then(grasp)
    for step, what, name, pose, t in ((0, pick, "belt", on_belt, 0.5), (1, place, "dial", on_dial, 1.7)):
        down, dwell, up = t + 0.2, what.dwell_s, 0.2
        hand.go(step, above(scene, name, pose, what.approach_m), t)
        hand.glide(step, above(scene, name, pose, ramp(t, down, what.approach_m, 0.0)), down, LegKind.APPROACH)
        left = down + dwell
        hand.glide(step, above(scene, name, pose), left, LegKind.FOLLOW)
        hand.glide(step, above(scene, name, pose, ramp(left, left + up, 0.0, what.depart_m)), left + up, LegKind.DEPART)
        hand.arrive(step, down, left, yaw_offset=yaw_offset if step == 0 else 0.0)
    end = hand.now + 0.6
    hand.go(2, above(scene, home.target.frame, home.target.pose), end)
    hand.arrive(2, end, end)
    return hand.plan()


# The plain prover: halves an interval until one of a few normals proves it.


@dataclass(frozen=True)
class Side:
    """A body where it rides in a phase."""

    name: str
    body: Body
    link: int
    frame: str
    pose: Pose

    @property
    def mine(self) -> bool:
        return self.link >= 0


def sides(scene: Scene, phase: Phase) -> list[Side]:
    """All bodies, where they ride in a phase."""
    found = [Side(b.body.name, b.body, b.link, "", Pose()) for b in scene.robot.bodies]
    found += [Side(b.name, b, FLANGE, "", Pose()) for b in scene.tool.bodies]
    for item in scene.bodies:
        if phase.attached.held is not None and phase.attached.held.part == item.name:
            found.append(Side(item.name, item.body, FLANGE, "", phase.attached.held.in_flange))
        else:
            found.append(Side(item.name, item.body, -1, *phase.attached.pose_of(scene, item.name)))
    return found


def box_of(body: Body) -> Piece:
    """The bounding box in the body's axes."""
    axes = np.eye(3)
    high = np.array([max(support(piece, n) for piece in body.pieces) for n in axes])
    low = -np.array([max(support(piece, -n) for piece in body.pieces) for n in axes])
    return Piece(box(*(float(x) for x in high - low)), (high + low) / 2)


def _turn(yaw: float) -> FloatArray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


class PlainProver:
    """Rows for one plan, by halving; slow and simple."""

    def __init__(self, scene: Scene, trajectory: Trajectory) -> None:
        self.scene, self.trajectory = scene, trajectory
        self.rows: list[tuple[object, ...]] = []
        self._poses: dict[tuple[str, str, Pose, float], tuple[FloatArray, FloatArray]] = {}

    def prove(self, phase: Phase) -> None:
        if not phase.t1 > phase.t0:
            return
        present = sides(self.scene, phase)
        links = self.scene.robot.links
        wanted = {frozenset(pair) for pair in self.scene.robot.self_pairs}
        for i, a in enumerate(present):
            for b in present[i + 1 :]:
                both = a.mine and b.mine and frozenset((links[a.link], links[b.link])) in wanted
                if not phase.robot and (a.mine or b.mine):
                    continue
                if both or a.mine != b.mine or self._put_down(phase, a, b):
                    pieces = [list(range(len(s.body.pieces))) if len(s.body.pieces) == 1 else [-1] for s in (a, b)]
                    for k in pieces[0]:
                        for m in pieces[1]:
                            self._pair(phase, a, k, b, m, phase.t0, phase.t1)

    def _put_down(self, phase: Phase, a: Side, b: Side) -> bool:
        """Whether one was put down and the other passes by."""
        still = [self.scene.frames[side.frame].law.is_fixed for side in (a, b) if not side.mine]
        handled = any(phase.handled.of(side.name) is not None for side in (a, b))
        resting = tuple(sorted((a.name, b.name))) in phase.handled.supports
        return not (a.mine or b.mine or all(still) or a.frame == b.frame or resting) and handled

    def _ahead(self, a: Side, b: Side) -> float:
        """How late the start may be, s, where that parts two sides: one is the robot's, and the other moves."""
        if a.mine == b.mine:
            return 0.0
        moves = not self.scene.frames[(b if a.mine else a).frame].law.is_fixed
        return self.scene.execution.start_tolerance_s if moves else 0.0

    def _pair(self, phase: Phase, a: Side, k: int, b: Side, m: int, t0: float, t1: float) -> None:
        if (b.mine and not a.mine) or (not a.mine and phase.handled.of(a.name) is None):
            self._pair(phase, b, m, a, k, t0, t1)  # the robot's first, or what was put down
            return
        required, wait = self._required(phase, a, b), self._ahead(a, b)
        for n in self._normals(a, k, b, m, (t0 + t1) / 2):
            late = wait * self.bounds(b, m, n, t0, t1 + wait)[0] if wait > 0.0 else 0.0
            g0, g1 = (self.gap(a, k, b, m, n, t) for t in (t0, t1))
            va, ma = self.bounds(a, k, n, t0, t1)
            vb, mb = self.bounds(b, m, n, t0, t1)
            v, acc, h = va + vb, ma + mb, t1 - t0
            least = max((g0 + g1 - v * h) / 2, min(g0, g1) - acc * h**2 / 8)
            if least - SLACK_M >= required + late:
                self.rows.append((t0, t1, a.name, k, b.name, m, n, wait))
                return
        middle = (t0 + t1) / 2
        best = max(self.gap(a, k, b, m, n, middle) for n in self._normals(a, k, b, m, middle))
        if (k < 0 or m < 0) and not best > required:
            for i in range(len(a.body.pieces)) if k < 0 else [k]:
                for j in range(len(b.body.pieces)) if m < 0 else [m]:
                    self._pair(phase, a, i, b, j, t0, t1)
            return
        if t1 - t0 < 2e-4:
            raise FaultError(f"{a.name} {k} and {b.name} {m} cannot be kept apart by hand at {t0}")
        self._pair(phase, a, k, b, m, t0, middle)
        self._pair(phase, a, k, b, m, middle, t1)

    def _required(self, phase: Phase, a: Side, b: Side) -> float:
        if tuple(sorted((a.name, b.name))) in phase.contacts:
            return -CONTACT_M
        clearance = self.scene.options.clearance
        found = clearance.near_m if phase.near or not (a.mine or b.mine) else clearance.travel_m
        for side in (a, b):
            if side.mine:
                # no point of the arm is farther than a metre from any of its axes
                found += sum(self.scene.execution.lag)
                continue
            known = self.scene.frames[side.frame].uncertainty
            late = phase.t1 + self.scene.execution.start_tolerance_s - self.scene.start.time
            found += known.position_m + known.speed_m_s * late
        return found

    def _pose(self, side: Side, t: float) -> tuple[FloatArray, FloatArray]:
        key = (side.name, side.frame, side.pose, t)
        if key not in self._poses:
            if side.mine:
                held = min(max(t, self.trajectory.start), self.trajectory.end)
                p, rotation = self.scene.robot.placements(self.trajectory.evaluate(np.array(held)))
                p, rotation = p[side.link], rotation[side.link]
            else:
                motion = self.scene.frames[side.frame].law.motion(np.array(t))
                p, rotation = motion.p, _turn(float(motion.yaw))
            self._poses[key] = p + rotation @ side.pose.position, rotation @ _turn(side.pose.yaw)
        return self._poses[key]

    def _reach(self, side: Side, k: int, n: FloatArray, t: float) -> float:
        piece = box_of(side.body) if k < 0 else side.body.pieces[k]
        p, rotation = self._pose(side, t)
        return float(n @ p) + support(piece, rotation.T @ n)

    def gap(self, a: Side, k: int, b: Side, m: int, n: FloatArray, t: float) -> float:
        return -self._reach(a, k, n, t) - self._reach(b, m, -n, t)

    def _normals(self, a: Side, k: int, b: Side, m: int, t: float) -> list[FloatArray]:
        up = np.array([0.0, 0.0, 1.0])
        (pa, ra), (pb, rb) = self._pose(a, t), self._pose(b, t)
        ca = pa + ra @ (box_of(a.body) if k < 0 else a.body.pieces[k]).position
        cb = pb + rb @ (box_of(b.body) if m < 0 else b.body.pieces[m]).position
        line = cb - ca
        flat = np.array([line[0], line[1], 0.0])
        found = [up, -up, *(r[:, i] * s for r in (ra, rb) for i in (0, 1) for s in (1, -1))]
        found += [v / np.linalg.norm(v) for v in (line, flat) if np.linalg.norm(v) > 1e-6]
        return sorted(found, key=lambda n: -self.gap(a, k, b, m, n, t))[:3]

    def bounds(self, side: Side, k: int, n: FloatArray, t0: float, t1: float) -> tuple[float, float]:
        piece = box_of(side.body) if k < 0 else side.body.pieces[k]
        if side.mine:
            knots = self.trajectory.time
            edges = np.unique(np.concatenate([[t0, t1], knots[(knots > t0) & (knots < t1)]]))
            t = np.concatenate([np.linspace(a, b, 33) for a, b in zip(edges, [*edges[1:], t1], strict=True)])
            t = np.clip(t, self.trajectory.start, self.trajectory.end)
            joints = np.zeros((1, self.trajectory.n, 6))
            for order in range(3 if t0 < self.trajectory.end else 1):
                states = self.trajectory.evaluate(t, order)
                low, high = states.min(0), states.max(0)
                joints[0, :, 2 * order], joints[0, :, 2 * order + 1] = (low + high) / 2, 0.51 * (high - low)
            r = reach(piece, side.pose.position, _turn(side.pose.yaw))
            v, acc = point_bounds(self.scene.robot, side.link, np.zeros((1, 3)), n[None], joints, r)
            return float(v[0]) + 1e-6, float(acc[0]) + 1e-3
        law = bounded(self.scene.frames[side.frame].law, np.array([t0]), np.array([t1]), n[None])
        r = reach(piece, side.pose.position, _turn(side.pose.yaw)) * math.hypot(n[0], n[1])
        v = law.speed + r * law.yaw_rate
        return float(v[0]), float((law.acceleration + r * law.turning)[0])


def proved(scene: Scene, trajectory: Trajectory, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> Plan:
    """A plan with the plain prover's certificate."""
    prover = PlainProver(scene, trajectory)
    for phase in phases(scene, legs, arrivals):
        prover.prove(phase)
    return sealed(scene, Plan(trajectory, legs, arrivals, certificate_of(prover.rows)))


def certificate_of(rows: list[tuple[object, ...]]) -> Certificate:
    names = tuple(dict.fromkeys(str(row[i]) for row in rows for i in (2, 4)))
    number = {name: i for i, name in enumerate(names)}

    def reals(i: int) -> FloatArray:
        return np.array([row[i] for row in rows], dtype=np.float64)

    def integers(values: list[object]) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
        return np.array(values, dtype=np.int64)

    return Certificate(
        names,
        reals(0),
        reals(1),
        integers([number[str(row[2])] for row in rows]),
        integers([row[3] for row in rows]),
        integers([number[str(row[4])] for row in rows]),
        integers([row[5] for row in rows]),
        reals(6).reshape(-1, 3),
        *((np.zeros(len(rows)), reals(7)) if reals(7).any() else (None, None)),
    )


def with_rows(scene: Scene, plan: Plan, **columns: object) -> Plan:
    """The plan with some columns of its certificate replaced, sealed."""
    return sealed(scene, replace(plan, certificate=replace(plan.certificate, **columns)))  # type: ignore[arg-type]


def without(scene: Scene, plan: Plan, rows: FloatArray | BoolArray) -> Plan:
    """The plan without the rows for which `rows` (M,) is true, sealed."""
    c = plan.certificate
    kept = {name: getattr(c, name)[~rows.astype(bool)] for name in COLUMNS}
    return with_rows(scene, plan, **kept)


COLUMNS = ("t0", "t1", "first", "first_piece", "second", "second_piece", "normal")


def asking(scene: Scene, number: int, **changes: Any) -> Scene:
    """The scene with a step changed."""
    task: list[Any] = list(scene.task)
    task[number] = replace(task[number], **changes)
    return replace(scene, task=tuple(task))


@cache
def crossing_case() -> tuple[Scene, Plan]:
    scene = crossing()
    return scene, crossed(scene)


@cache
def belt_case() -> tuple[Scene, Plan]:
    scene = belt_to_dial()
    return scene, carried_over(scene)


def sealed(scene: Scene, plan: Plan) -> Plan:
    """The same plan with a digest that fits: nobody can be caught by the digest alone."""
    c = plan.certificate
    fresh = replace(c, digest=digest(scene.digest, plan.trajectory, plan.legs, plan.arrivals, c))
    return replace(plan, certificate=fresh)

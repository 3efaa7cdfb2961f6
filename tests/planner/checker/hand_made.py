"""Plans made by hand for the checker: a SCARA, simple cells, and quintics through a few states.

None of it uses the planner's own search, legs or timing. Rows of certificates are those of the planner's prover: the
checker judges them by itself, wherever they are from.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import ProofFailure, Rows, written
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.geometry.shapes import Body, Hull, Piece, box, capsule, cylinder, sphere
from assur.planner.laws import Frame, conveyor, fixed, linear, turntable
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Arrival, Certificate, Leg, LegKind, Plan
from assur.planner.model.phases import phases
from assur.planner.model.scene import Clearance, Move, Options, Pick, Place, Scene, Start, Target, Tool, WorldBody
from assur.planner.robots.facts import Code, Limits, RobotBody
from assur.planner.robots.scara import BASE, LINK1, LINK2, QUILL, Scara
from assur.planner.trajectory import Trajectory

MODE = 1
Height = Callable[[FloatArray], tuple[FloatArray, ...]]
"""A height above a point at times (T,), with its first two rates."""


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


def proved(scene: Scene, trajectory: Trajectory, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> Plan:
    """A plan with the rows that the planner's prover finds. Raises `FaultError` if there are none."""
    prover, rows = Prover(scene), list[Rows]()
    for phase in phases(scene, legs, arrivals):
        found = prover.prove(phase, trajectory)
        if isinstance(found, ProofFailure):
            raise FaultError(f"{' and '.join(found.bodies)} cannot be kept apart at {found.time}")
        rows.append(found)
    return Plan(trajectory, legs, arrivals, written(scene, trajectory, legs, arrivals, rows))


def no_rows() -> Certificate:
    """The certificate of a motion for which nothing has to be kept apart."""
    none, numbers = np.zeros(0), np.zeros(0, dtype=np.int64)
    return Certificate((), none, none, numbers, numbers, numbers, numbers, np.zeros((0, 3)), None, None)


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

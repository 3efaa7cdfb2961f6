"""The cell and the task: what a request means once it is valid. Facts only, SI, world frame unless stated."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray, frozen
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Pieces, pieces
from assur.planner.laws.law import EXACT, Frame, PoseUncertainty, Uncertainty, check_rounding, law_tables
from assur.planner.model.execution import AS_PLANNED, Execution, check_execution
from assur.planner.model.forbidden_yaw import YawRange, check_ranges
from assur.planner.model.kept import NOTHING_KEPT, KeptCell
from assur.planner.model.load import UNKNOWN, Load, LoadLimits, Tool, greatest_inertia
from assur.planner.model.options import DEFAULTS, Clearance, ClearanceException, Options, check_timing
from assur.planner.model.refusal import BeyondRange
from assur.planner.model.step_faults import wrong
from assur.planner.model.task import (
    Arch,
    Follow,
    Match,
    Move,
    Pick,
    Place,
    Step,
    Target,
    Trace,
    Window,
    is_taken_away,
    key_of,
)
from assur.planner.robots.facts import Limits, lowered
from assur.planner.robots.robot import Robot
from assur.planner.robots.turns import nearest_turns

__all__ = [
    "WORLD",
    "Arch",
    "Clearance",
    "ClearanceException",
    "Execution",
    "Follow",
    "Holding",
    "LoadLimits",
    "Match",
    "Move",
    "Options",
    "Pick",
    "Place",
    "Scene",
    "Start",
    "Step",
    "Target",
    "Tool",
    "Trace",
    "Window",
    "WorldBody",
]

WORLD = "world"
"""Name of the frame that does not move; every scene has it."""


@dataclass(frozen=True, slots=True)
class Holding:
    """A part that the gripper holds at the start: the tool point is at `grasp` in the part's frame, up to what is not
    known (`within`)."""

    part: str
    grasp: Pose
    within: PoseUncertainty = EXACT


def check_tool_point(robot: Robot, tool: Tool) -> None:
    """Raises `InputError` for a tool point that a flange which tilts, or which is not turned at will, cannot have."""
    tcp = tool.tcp
    if robot.links.index("flange") in robot.tilting and tcp != Pose():
        allowed = f"0, 0, 0: the flange of {robot.name} tilts; a tool's length is a part of the last link's"
        raise InputError("robot.tool.tcp", (tcp.x, tcp.y, tcp.z), allowed)
    if "yaw" not in robot.coordinates and not tcp.x == tcp.y == 0.0:
        allowed = f"a tool point on the flange's axis: {robot.name} has no wrist to turn it with"
        raise InputError("robot.tool.tcp", (tcp.x, tcp.y), allowed)


@dataclass(frozen=True, eq=False)
class Start:
    """The state from which the plan begins: q, q̇, q̈ (n,) at `time` in seconds, and what the gripper holds."""

    time: float
    q: FloatArray
    qd: FloatArray
    qdd: FloatArray
    holding: Holding | None = None

    def __post_init__(self) -> None:
        for name in ("q", "qd", "qdd"):
            object.__setattr__(self, name, frozen(getattr(self, name), (None,), f"start.{name}"))

    @property
    def moving(self) -> bool:
        return any(self.qd.tolist()) or any(self.qdd.tolist())


@dataclass(frozen=True, eq=False)
class WorldBody:
    """A body of the surroundings at a constant pose in a frame. A `part` is a body that a pick or place names.

    `yaw_symmetry`: how many yaws of the body look the same to a gripper (1: one; 2: every half turn; 0: any yaw).
    `uncertainty`: how far it may be from its pose in the frame. `since_s`: the time of the clock from which the pose
    was computed, s; None: it is the request's own.
    """

    body: Body
    frame: str = WORLD
    pose: Pose = Pose()
    mass_kg: float | None = None
    yaw_symmetry: int = 1
    uncertainty: PoseUncertainty = EXACT
    since_s: float | None = None

    @property
    def name(self) -> str:
        return self.body.name


STRAIGHT = 1.1
"""A straight part is so many times as long as the clearance of travel at least: more than it for the errors of what is
planned, less than would cost time."""


@dataclass(frozen=True, eq=False)
class Scene:
    """A whole request, valid: robot, tool, start, frames, bodies, task, options."""

    robot: Robot
    tool: Tool
    start: Start
    frames: dict[str, Frame]
    bodies: tuple[WorldBody, ...]
    task: tuple[Step, ...]
    options: Options = DEFAULTS
    execution: Execution = AS_PLANNED
    carry_acceleration: float | None = None
    """Limit of the tool point's acceleration while a part is held, m/s²."""
    load_limits: LoadLimits = UNKNOWN
    forbidden_yaw: tuple[YawRange, ...] = ()
    """Ranges in which the yaw of the tool point in the world may be at no time."""
    assumptions: tuple[str, ...] = ()
    """Numbers of the robot that are estimated or second hand, in words; they are repeated in the outcome."""
    digest: str = ""
    """Digest of the request document, carried into the certificate."""
    signs: tuple[float, ...] = ()
    """What a value of each joint is multiplied by to be as its maker counts it, 1 or -1 (empty: 1 for all)."""
    zeros: tuple[float, ...] = ()
    """The value of each joint at its maker's zero, rad or m (empty: 0 for all)."""
    kept: KeptCell = field(default=NOTHING_KEPT, repr=False)
    """What was made of the cell. A scene is made with that of another scene of its cell; else it has a new one."""
    index: dict[str, WorldBody] = field(init=False, repr=False)
    pieces: Pieces = field(init=False, repr=False)  # of robot, tool and surroundings, in this order

    def __post_init__(self) -> None:
        n = len(self.robot.joints)
        for name in ("q", "qd", "qdd"):
            if len(getattr(self.start, name)) != n:
                raise InputError(f"start.{name}", len(getattr(self.start, name)), f"{n} joints of {self.robot.name}")
        if not math.isfinite(self.start.time):
            raise InputError("start.at_s", self.start.time, "a finite time")
        if not self.task:
            raise InputError("task", self.task, "at least one step")
        if not self.kept.fits(self):
            before = self.kept if self.kept.begins(self) else None
            object.__setattr__(self, "kept", KeptCell(self.robot, self.tool, self.frames, self.bodies, before))
        self.kept.of(_names, self)
        object.__setattr__(self, "index", self.kept.of(_index, self))
        object.__setattr__(self, "pieces", self.kept.of_solids(_pieces_of, self))
        check_tool_point(self.robot, self.tool)
        holding = self.start.holding
        if holding is not None and holding.part not in self.index:
            raise InputError("start.holding.part", holding.part, f"one of {sorted(self.index)}")
        held, gone = None if holding is None else holding.part, set[str]()
        for i, step in enumerate(self.task):
            for where, value, allowed in wrong(self, step, held, gone):
                raise InputError(f"task[{i}].{key_of(step)}{where}", value, allowed)
            held = step.part if isinstance(step, Pick) else None if isinstance(step, Place) else held
            if is_taken_away(step):
                gone.add(step.part)
        check_execution(self.execution, self.robot, self._tracked() if self.execution.belt_correction else [])
        self._check_rounding()
        check_ranges(self.robot, self.forbidden_yaw, self.execution.lag)
        check_timing(self.options, self.task, self.frames, moving=self.start.moving)

    def _check_rounding(self) -> None:
        """No frame is so fast, or stated so long ago, that proofs about what is on it would be about rounding."""
        reach, lasts = self.kept.of(_reach, self), 0.0
        for step in self.task:
            lasts += step.dwell_s
            if isinstance(step, Place):
                far = _far(self.frames[step.to.frame], step.to.pose, self.index[step.part])
                reach = {**reach, step.to.frame: max(far, reach.get(step.to.frame, 0.0))}
        for frame, far in reach.items():
            check_rounding(
                f"frames.{frame}", self.frames[frame].law, far, self.start.time, lasts + self.options.stay_safe_s
            )

    @cached_property
    def ending(self) -> tuple[tuple[str, tuple[float, float]], ...]:
        """The frames that bear a body, or will, and whose motion is not known for ever; and when it is known, s."""
        bearing = [body.frame for body in self.bodies]
        bearing += [step.to.frame for step in self.task if isinstance(step, Place)]
        valid = {name: self.frames[name].law.valid for name in dict.fromkeys(bearing)}
        return tuple((name, span) for name, span in valid.items() if span[1] != math.inf)

    @cached_property
    def clears(self) -> bool:
        """Whether a part is taken away after it was put down."""
        return any(is_taken_away(step) for step in self.task)

    def straight(self, step: Step) -> tuple[float, float]:
        """Lengths of the straight parts of a step's approach and depart, m: as required, but long enough for what
        touches at the point to be as far apart as in travel where the clearance of travel begins. One with a stop has
        exactly the required length."""
        clear = STRAIGHT * self.options.clearance.travel_m
        approach, depart = step.approach_m, step.depart_m
        if approach > 0.0 and not step.approach_stop:
            approach = max(approach, clear)
        if depart > 0.0 and not step.depart_stop:
            depart = max(depart, clear)
        return approach, depart

    def counted(self, joint: int, value: float) -> float:
        """The value of a joint as its maker counts it."""
        zero = self.zeros[joint] if self.zeros else 0.0
        return self.signs[joint] * (value - zero) + 0.0 if self.signs else value

    @cached_property
    def exact(self) -> bool:
        """Whether the request leaves nothing open: everything is where it is planned, at the time that is planned."""
        holding, execution = self.start.holding, self.execution
        held = [step.held_within for step in self.task if isinstance(step, Pick)]
        held.append(None if holding is None else holding.within)
        # what a request does not state is the same object: to compare that takes no call
        unsure = [within for within in held if within is not None and within is not EXACT and within != EXACT]
        unsure += [b.uncertainty for b in self.bodies if b.uncertainty is not EXACT and b.uncertainty != EXACT]
        exact = Uncertainty()
        displaced = [frame for frame in self.frames.values() if frame.uncertainty != exact]
        return not (unsure or displaced or execution.lags or execution.start_tolerance_s > 0.0)

    def corrects(self, frame: str) -> bool:
        """Whether the controller shifts legs that track a frame by the frame's error along its line: with belt
        correction, for what travels along a line. An encoder counts the way of a belt; where a nest stands, or the
        centre of a dial, no encoder tells."""
        return self.execution.belt_correction and self.frames[frame].law.line is not None

    def corrects_all(self, frame: str) -> bool:
        """Whether it shifts them by all of that error. Of a conveyor that always stands nobody knows: its encoder
        counts nothing, but may tell where it stands."""
        return self.corrects(frame) and self.frames[frame].law.fastest[0] > 0.0

    @cached_property
    def loads(self) -> tuple[Load, ...]:
        """What the flange carries: the tool alone, and with each part that is held from the start or from a pick on."""
        tool = self.tool.mass_kg or 0.0
        own = self.tool.inertia if self.robot.turns_load else None
        found = [Load(-1, None, tool, own, self.load_limits.share(tool))]
        holding = self.start.holding
        taken = [] if holding is None else [(-1, holding.part, holding.grasp, 1)]
        for number, step in enumerate(self.task):
            if isinstance(step, Pick):
                taken.append((number, step.part, step.grasp, self.index[step.part].yaw_symmetry))
        for number, part, grasp, symmetry in taken:
            body = self.index[part]
            mass = body.mass_kg or 0.0
            inertia = None if own is None else own + greatest_inertia(body.body, mass, self.tool.tcp, grasp, symmetry)
            found.append(Load(number, part, tool + mass, inertia, self.load_limits.share(tool + mass)))
        return tuple(found)

    @cached_property
    def _limits(self) -> dict[str | None, Limits]:
        return {load.part: lowered(self.robot.limits, load.share) for load in self.loads}

    def limits_with(self, part: str | None) -> Limits:
        """The joints' limits while the gripper holds `part` (None: nothing): acceleration and jerk are scaled with the
        load (G2)."""
        return self._limits[part]

    def _tracked(self) -> list[Frame]:
        """The frames that steps may track: those of their targets, and those of the parts that they take."""
        names = [step.target.frame for step in self.task if step.target is not None]
        names += [self.index[step.part].frame for step in self.task if step.part is not None]
        return [self.frames[name] for name in dict.fromkeys(names)]


def bodies_in(scene: Scene | KeptCell) -> tuple[Body, ...]:
    """The bodies of the robot, of its tool and those around, in the order of a claim."""
    own = [item.body for item in scene.robot.bodies]
    return (*own, *scene.tool.bodies, *[item.body for item in scene.bodies])


def _names(scene: Scene | KeptCell) -> set[str]:
    """The names of the bodies. Raises `InputError` unless each is the only one with its name, and is in a frame."""
    before, names = scene.kept.before, set[str]()
    if before is None:
        first, added = 0, bodies_in(scene)
    else:
        first, names = len(before.bodies), {*before.of(_names, before)}
        added = tuple([item.body for item in scene.bodies[first:]])
    for body in added:
        if body.name in names:
            raise InputError("bodies", body.name, "names that are unique, the robot's and the tool's bodies included")
        names.add(body.name)
    for i, item in enumerate(scene.bodies[first:], first):
        if item.frame not in scene.frames:
            raise InputError(f"bodies[{i}].pose.frame", item.frame, f"one of {sorted(scene.frames)}")
    return names


def laws_of(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """The rows of the laws of the frames, and their side table (`law_tables`)."""
    return law_tables([frame.law for frame in scene.frames.values()])


def _pieces_of(scene: Scene | KeptCell) -> Pieces:
    before = scene.kept.before
    if before is None:
        return pieces(bodies_in(scene))
    return pieces([item.body for item in scene.bodies[len(before.bodies) :]], before.of_solids(_pieces_of, before))


def _index(scene: Scene) -> dict[str, WorldBody]:
    return {each.body.name: each for each in scene.bodies}


def _reach(scene: Scene | KeptCell) -> dict[str, float]:
    """How far the bodies in each frame reach (`_far`), m."""
    before = scene.kept.before
    reach = {} if before is None else {**before.of(_reach, before)}
    for body in scene.bodies[0 if before is None else len(before.bodies) :]:
        far = _far(scene.frames[body.frame], body.pose, body)
        reach[body.frame] = max(far, reach.get(body.frame, 0.0))
    return reach


def _far(frame: Frame, pose: Pose, body: WorldBody) -> float:
    """How far from the origin of a frame a body at a pose reaches, as far as that frame moves it, m."""
    turned = 0.0 if frame.law.is_fixed else body.body.radius
    return math.hypot(pose.x, pose.y, pose.z) + turned


# JOINT_LIMIT: which joint would be where, and which end of its range that is beyond.


def beyond(scene: Scene, joint: int, value: float) -> BeyondRange:
    """The facts of joint number `joint` at `value`, rad or m, as the planner counts it: the nearer end of its range is
    that which it is beyond."""
    lower, upper = float(scene.robot.limits.lower[joint]), float(scene.robot.limits.upper[joint])
    limit = lower if lower - value > value - upper else upper
    return BeyondRange(value=scene.counted(joint, value), limit=scene.counted(joint, limit))


def beyond_at_nearest_turn(scene: Scene, joint: int, q: FloatArray) -> BeyondRange:
    """The facts of joint number `joint` at q (n,), turned to where it is nearest to being within its range."""
    return beyond(scene, joint, float(np.asarray(nearest_turns(scene.robot, q))[joint]))

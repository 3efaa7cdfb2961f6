"""A plan as a recipe in the language of a maker's controller: points, speeds, accelerations and arches, with notes.

It is not executed here, and nothing of it is proved: the controller makes a motion of its own from it. It states the
points, speeds and heights of the plan for the author of the program.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.errors import InputError
from assur.scenes.conventions import as_maker
from assur.scenes.exports.raised import scale_of

if TYPE_CHECKING:
    from assur.planner.arrays import FloatArray
    from assur.planner.frames.motion import Pose
    from assur.planner.model.outcome import Leg
    from assur.scenes.exports.export import Motion

NOTES = (
    "RECIPE, NOT EXECUTED AND NOT PROVED HERE: the controller makes its own motion from it.",
    "Try it at low speed. Points are those of the plan, in mm and deg in the robot's base frame, with its tool.",
    "Speeds and accelerations are the highest of the plan in each leg; per cent are of the robot's own limits.",
    "Where a leg begins in motion, the acceleration is what reaches the speed within the leg, if that is more.",
)
"""What a recipe says first."""
INSTANTS = 200
"""Number of times of a leg at which its path is sampled."""
UPRIGHT_M = 1e-3
"""An arch counts as vertical while the tool is within this distance, m, of where it began or ends."""
MOVING = 1e-3
"""rad/s or m/s: a joint that is faster when a leg ends does not stop there."""


@dataclass(frozen=True)
class Dialect:
    """How a controller writes comments, points (name, x, y, z, yaw, hand, turns) and motions. `form`: the format of an
    export; `hands`: by working mode; `most`: the highest speed and acceleration, mm/s and mm/s², that it takes for
    straight lines."""

    form: str
    comment: str
    point: str
    hands: dict[str, str]
    joint_rates: str
    line_rates: str
    arch: str
    jump: str
    go: str
    line: str
    on: tuple[str, str]
    wait: str
    first: tuple[str, ...]
    last: tuple[str, ...]
    most: tuple[int, int]


SPEL = Dialect(
    form="spel",
    comment="' ",
    point="P{n} = XY({x:.3f}, {y:.3f}, {z:.3f}, {u:.3f}) {hand}",
    hands={"left": "/L", "right": "/R"},
    joint_rates="Speed {speed}: Accel {accel}, {accel}",
    line_rates="SpeedS {mm_s}: AccelS {mm_s2}, {mm_s2}",
    arch="Arch 0, {up:.1f}, {down:.1f}",
    jump="Jump P{n} C0 LimZ {top:.1f}",
    go="Go P{n}{on}",
    line="Move P{n}{on}",
    on=("", " CP"),
    wait="Wait {s:.3f}",
    first=("Function main", "Motor On", "Power Low  ' High when it has been tried"),
    last=("Fend",),
    most=(2000, 25000),
)
MELFA = Dialect(
    form="melfa",
    comment="' ",
    point="P{n}=({x:.3f},{y:.3f},{z:.3f},0,0,{u:.3f})({hand},{turns})",
    hands={"left": "0", "right": "4"},
    joint_rates="JOvrd {speed}\nAccel {accel},{accel}",
    line_rates="Spd {mm_s}\nAccel {accel},{accel}",
    arch="' arch: straight up {up:.1f} mm, straight down {down:.1f} mm (Mva with Def Arch, if the controller has it)",
    jump="PTOP=P{before}\nPTOP.Z={top:.1f}\nMvs PTOP\nPTOP=P{n}\nPTOP.Z={top:.1f}\nMov PTOP\nMvs P{n}",
    go="Mov P{n}",
    line="Mvs P{n}",
    on=("Cnt 0", "Cnt 1"),
    wait="Dly {s:.3f}",
    first=("Servo On",),
    last=("End",),
    most=(10000, 100000),
)


def recipe(dialect: Dialect, motion: Motion) -> str:
    """The recipe of a motion. Raises `InputError` for an arm that is no SCARA with a wrist."""
    scene = motion.cell.scene
    if not scene.robot.sums_yaw:
        raise InputError("format", dialect.form, f"csv, ros2 or ros2-json: {scene.robot.name} is no SCARA with a wrist")
    legs, facts = motion.plan.legs, motion.facts
    notes = [*NOTES, f"{scene.robot.name}; request {facts['request_digest']}"]
    notes.append(
        f"the plan starts at {facts['start_s']:.3f} s of the cell's clock and lasts {facts['duration_s']:.3f} s"
    )
    tcp = scene.tool.tcp
    notes.append(
        f"tool point from the flange: {1e3 * tcp.x:.3f}, {1e3 * tcp.y:.3f}, {1e3 * tcp.z:.3f} mm, "
        f"{math.degrees(tcp.yaw):.3f} deg"
    )
    points = _point(motion, dialect, 0, motion.plan.trajectory.start)
    steps: list[str] = []
    for number, leg in enumerate(legs, start=1):
        points += _point(motion, dialect, number, leg.t1)
        steps += _leg(motion, dialect, number, leg)
    notes = [f"{dialect.comment}{note}" for note in notes]
    if dialect is MELFA:
        return "\n".join([*notes, *points, *dialect.first, *steps, *dialect.last]) + "\n"
    return "\n".join([*notes, *dialect.first, *points, *steps, *dialect.last]) + "\n"


def _point(motion: Motion, dialect: Dialect, number: int, t: float) -> list[str]:
    """A point, and before it its time, hand and joints: lines of MELFA-BASIC have 127 characters at most."""
    scene = motion.cell.scene
    tool, base = _tool(motion, t), scene.robot.base
    dx, dy, c, s = tool.x - base.x, tool.y - base.y, math.cos(base.yaw), math.sin(base.yaw)
    x, y = c * dx + s * dy, c * dy - s * dx
    yaw = math.degrees(math.remainder(tool.yaw - base.yaw, math.tau))
    q = motion.plan.trajectory.evaluate(t)
    mode = int(scene.robot.mode_of(q))
    name = scene.robot.modes[mode] if mode >= 0 else "none"
    own = as_maker(q, motion.cell.conventions)
    joints = ", ".join(
        f"{joint.name} {math.degrees(value):.3f} deg" if joint.unit == "rad" else f"{joint.name} {1e3 * value:.3f} mm"
        for joint, value in zip(motion.cell.conventions, own.tolist(), strict=True)
    )
    hand = dialect.hands.get(name, dialect.hands["left"])
    if dialect is SPEL:
        yaw = _unwound(motion, q, yaw)
    height, turns = 1e3 * (tool.z - base.z), _turns(motion, own)
    values = {key: round(value, 3) + 0.0 for key, value in (("x", 1e3 * x), ("y", 1e3 * y), ("z", height), ("u", yaw))}
    made = dialect.point.format(n=number, **values, hand=hand, turns=turns)
    return [f"{dialect.comment}P{number}: {t:.4f} s, {name}: {joints}", made]


def _unwound(motion: Motion, q: FloatArray, yaw: float) -> float:
    """The yaw, deg, of the tool that SPEL+ counts without end: the sum of the turning joints. A yaw in any other turn
    would wind the wrist another way."""
    robot = motion.cell.scene.robot
    turned = [value for value, joint in zip(q.tolist(), robot.joints, strict=True) if joint.kind == "revolute"]
    whole = math.degrees(sum(turned) + motion.cell.scene.tool.tcp.yaw)
    return yaw + 360.0 * round((whole - yaw) / 360.0)


def _turns(motion: Motion, own: FloatArray) -> int:
    """The flag of MELFA-BASIC for joints beyond half a turn: four bits for each joint, the first lowest, with how many
    whole turns it is away from -180 to 180 deg."""
    flag = 0
    for k, (value, joint) in enumerate(zip(own.tolist(), motion.cell.conventions, strict=True)):
        if joint.unit == "rad":
            flag |= (math.ceil(value / math.tau - 0.5) & 0xF) << (4 * k)
    return flag


def _leg(motion: Motion, dialect: Dialect, number: int, leg: Leg) -> list[str]:
    from assur.planner.legs.tool_motion import tool_peaks
    from assur.planner.model.outcome import TRACKING, LegKind
    from assur.planner.model.scene import Move, Pick, Place, Trace

    scene, trajectory, step = motion.cell.scene, motion.plan.trajectory, motion.cell.scene.task[leg.step]
    lines = [f"{dialect.comment}{leg.kind} for {step.name}, {leg.t0:.4f} to {leg.t1:.4f} s"]
    if leg.kind is LegKind.FOLLOW and isinstance(step, Pick | Place):
        lines.append(f"{dialect.comment}  {'close' if isinstance(step, Pick) else 'open'} the gripper here")
    if leg.kind is LegKind.WAIT or (leg.kind is LegKind.FOLLOW and not _moves(motion, leg)):
        return [*lines, dialect.wait.format(s=leg.t1 - leg.t0)]
    if leg.kind in TRACKING and _frame_moves(motion, leg):
        lines.append(
            f"{dialect.comment}  the point moves: the controller must track its frame here; P{number} is where"
        )
        lines.append(f"{dialect.comment}  the plan is at {leg.t1:.4f} s of the cell's clock")
    t = np.linspace(leg.t0, leg.t1, INSTANTS)
    # a controller counts per cent of what the robot can do, not of what a request leaves of it
    limits = scene.robot.limits
    velocity = limits.velocity / scale_of(motion.request, "velocity")
    acceleration = limits.acceleration / scale_of(motion.request, "acceleration")
    # a leg that begins in motion pulls at little, and a controller that begins it at rest must get there
    most, lasts = np.abs(np.stack([trajectory.evaluate(t, order) for order in (1, 2)])).max(1), leg.t1 - leg.t0
    speed = float((most[0] / velocity).max())
    accel = float((np.maximum(most[1], most[0] / lasts) / acceleration).max())
    peaks = tool_peaks(scene, trajectory, leg.t0, leg.t1)
    # what the task requires: a leg's route is a note, which nobody verifies
    guided = isinstance(step, Move) and step.leg == "cartesian" and leg.kind is LegKind.MOVE
    guided = guided and any(leg.t0 < each.until for each in motion.plan.arrivals if each.step == leg.step)
    straight = leg.kind in TRACKING or guided
    on = dialect.on[bool((np.abs(trajectory.evaluate(leg.t1, 1)) > MOVING).any())]
    rates = dialect.line_rates if straight else dialect.joint_rates
    traced = leg.kind is LegKind.FOLLOW and isinstance(step, Trace)
    if traced or (guided and isinstance(step, Move) and step.path):
        lines.append(
            f"{dialect.comment}  the plan goes along the path of the step here, not straight: write it with arcs"
        )
    pull = max(peaks.acceleration, peaks.speed / lasts)
    mm_s, mm_s2 = min(_whole(peaks.speed), dialect.most[0]), min(_whole(pull), dialect.most[1])
    if straight and (mm_s, mm_s2) != (_whole(peaks.speed), _whole(pull)):
        own = f"{_whole(peaks.speed)} mm/s and {_whole(pull)} mm/s2"
        lines.append(f"{dialect.comment}  the plan has {own}, more than the controller takes")
    lines += rates.format(speed=_share(speed), accel=_share(accel), mm_s=mm_s, mm_s2=mm_s2).split("\n")
    if not on.startswith(" ") and on:
        lines.append(on)
        on = ""
    if leg.kind is LegKind.ARCH:
        up, down, top = _arch(motion, leg)
        lines.append(dialect.arch.format(up=up, down=down))
        jumped = dialect.jump.format(n=number, before=number - 1, top=top - 1e3 * scene.robot.base.z)
        return lines + jumped.split("\n")
    return "\n".join([*lines, (dialect.line if straight else dialect.go).format(n=number, on=on)]).split("\n")


def _share(ratio: float) -> int:
    """Per cent, rounded down, 1 at least."""
    return max(1, min(100, int(100 * ratio)))


def _whole(si: float) -> int:
    """mm, rounded down, 1 at least."""
    return max(1, int(1e3 * si))


def _tool(motion: Motion, t: float) -> Pose:
    """The pose of the tool point in the world at a time."""
    from assur.planner.frames.motion import Pose

    place, yaw = motion.cell.scene.robot.forward(motion.plan.trajectory.evaluate(t))
    x, y, z = place.tolist()
    return Pose(x, y, z, float(yaw)).then(motion.cell.scene.tool.tcp)


def _moves(motion: Motion, leg: Leg) -> bool:
    one, other = _tool(motion, leg.t0), _tool(motion, leg.t1)
    away = math.dist((one.x, one.y, one.z), (other.x, other.y, other.z))
    return away > UPRIGHT_M or bool((np.abs(motion.plan.trajectory.evaluate(leg.t0, 1)) > MOVING).any())


def _frame_moves(motion: Motion, leg: Leg) -> bool:
    from assur.planner.model.phases import phases

    scene = motion.cell.scene
    tracked = {
        phase.tracked for phase in phases(scene, motion.plan.legs, motion.plan.arrivals) if phase.step == leg.step
    }
    for name in tracked - {None}:
        found = scene.frames[str(name)].law.motion(np.array([leg.t0, leg.t1]))
        if float(np.abs(found.p[1] - found.p[0]).max()) > UPRIGHT_M or abs(float(found.yaw[1] - found.yaw[0])) > MOVING:
            return True
    return False


def _arch(motion: Motion, leg: Leg) -> tuple[float, float, float]:
    """How far up the tool goes straight, how far down, and the height of the top in the world, mm."""
    tools = [_tool(motion, t) for t in np.linspace(leg.t0, leg.t1, INSTANTS).tolist()]
    path = np.array([(tool.x, tool.y, tool.z) for tool in tools])
    from_begin = np.hypot(*(path[:, :2] - path[0, :2]).T) <= UPRIGHT_M
    from_end = np.hypot(*(path[:, :2] - path[-1, :2]).T) <= UPRIGHT_M
    leaves = int(np.argmin(from_begin)) if not from_begin.all() else len(path) - 1
    enters = len(path) - 1 - (int(np.argmin(from_end[::-1])) if not from_end.all() else len(path) - 1)
    up, down = path[leaves, 2] - path[0, 2], path[enters, 2] - path[-1, 2]
    top = path[:, 2].max()
    return 1e3 * max(up, 0.0), 1e3 * max(down, 0.0), 1e3 * top

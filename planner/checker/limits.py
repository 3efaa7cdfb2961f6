"""Whether the joints keep their limits: everywhere; with the load of each phase, which the checker weighs itself (G1,
G2); and where a belt correction shifts the tool (U3)."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from itertools import groupby

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.doubts import doubt_of
from assur.planner.checker.solids import Solids
from assur.planner.checker.spline import excesses
from assur.planner.checker.uncertainty import shifted, turned_by
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Hull
from assur.planner.model.attachments import Held
from assur.planner.model.load import Carried
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene

KINDS = ("position", "velocity", "acceleration", "jerk")
HALVINGS = 14
"""How often an interval is halved before it counts as broken."""
LOAD = 1e-9
"""Relative: by which a mass or an inertia may exceed what is allowed, for rounding of sums."""


def limits(world: World) -> list[Finding]:
    """One finding for each kind of limit and joint that is broken, with the excess found and when.

    Where the acceleration may jump, the jerk has no bound and is not evaluated: the certificate states that.
    """
    return _broken(world, 0, len(world.knots.time) - 1, 1.0, "")


def loads(world: World, phases: tuple[Phase, ...], said: tuple[Carried, ...] | None) -> list[Finding]:
    """A finding for each load that may not be carried, for what breaks the limits that are left with a load, and for
    what is `said` of the loads and is not so (None: nothing is said)."""
    scene, findings, time = world.scene, list[Finding](), world.knots.time.tolist()
    # an inertia that nobody limits or tells of need not be known
    asked = said is not None or scene.load_limits.max_inertia_kgm2 is not None
    own = weighed(scene, phases, turned=asked)
    for load in own:
        with_part, where = f" with {load.part or 'the tool'}", f"{load.t0:.6g} s"
        findings += _too_heavy(scene, load.mass_kg, where)
        most = scene.load_limits.max_inertia_kgm2
        if most is not None and load.inertia_kgm2 is not None and not load.inertia_kgm2 <= most * (1.0 + LOAD):
            what = f"the inertia{with_part} about the wrist's axis exceeds the maximum"
            findings.append(Finding(Code.LOAD, what, load.inertia_kgm2 - most, "kg·m²", where))
        if load.share < 1.0:
            # all pieces that reach into the time with this load, a piece across its begin or end included
            first = max(bisect_right(time, load.t0) - 1, 0)
            last = min(bisect_left(time, load.t1), len(time) - 1)
            told = f"{with_part} (share {load.share:.6g})"
            findings += _broken(world, first, last, load.share, told)
    return findings if said is None else findings + _said(own, said)


def weighed(scene: Scene, phases: tuple[Phase, ...], *, turned: bool) -> list[Carried]:
    """What the flange carries, one entry for all phases that follow each other with the same part; `turned`: with its
    inertia."""
    return [_carried(scene, list(group), turned=turned) for _, group in groupby(filter(_runs, phases), key=_held)]


def _runs(phase: Phase) -> bool:
    return phase.step >= 0


def _held(phase: Phase) -> Held | None:
    return phase.attached.held


def _carried(scene: Scene, phases: list[Phase], *, turned: bool) -> Carried:
    """What the flange carries in phases that follow each other and have the same part in the gripper; its inertia if it
    is asked for and the arm turns it."""
    held, inertia = phases[0].attached.held, None
    part = None if held is None else held.part
    mass = (scene.tool.mass_kg or 0.0) + (0.0 if part is None else scene.index[part].mass_kg or 0.0)
    if turned and "yaw" in scene.robot.coordinates and "pitch" not in scene.robot.coordinates:
        inertia = tool_inertia(scene) + (0.0 if held is None else part_inertia(scene, held.part, held.in_flange))
    return Carried(part, mass, inertia, share_of(scene, mass), phases[0].t0, phases[-1].t1)


def _said(own: list[Carried], said: tuple[Carried, ...]) -> list[Finding]:
    """What is said of the loads and is not so."""
    if [load.part for load in own] != [load.part for load in said]:
        return [Finding(Code.LOAD, "the parts in the gripper are not those that the answer says")]
    found = []
    for true, claim in zip(own, said, strict=True):
        for name, unit in (("mass_kg", "kg"), ("inertia_kgm2", "kg·m²"), ("share", "1"), ("t0", "s"), ("t1", "s")):
            one, other = getattr(true, name), getattr(claim, name)
            if one is None or other is None:
                off = 0.0 if one is other else math.inf
            else:
                off = abs(one - other)
            if not off <= LOAD * max(abs(one or 0.0), 1e-3):
                what = f"the {SAID[name]} with {true.part or 'the tool'} is not what the answer says"
                found.append(Finding(Code.LOAD, what, off, unit, f"{true.t0:.6g} s"))
    return found


SAID = {
    "mass_kg": "mass",
    "inertia_kgm2": "inertia",
    "share": "share of the acceleration",
    "t0": "begin of the time",
    "t1": "end of the time",
}
"""What the numbers of a load are called."""


def _broken(world: World, first: int, last: int, share: float, told: str) -> list[Finding]:
    """The limits that are broken between two knots, where acceleration and jerk have this share."""
    robot = world.scene.robot
    given, n = robot.limits, len(robot.joints)
    worst, when, allowed = np.zeros((4, n)), np.zeros((4, n)), np.empty((5, n))
    allowed[0], allowed[1] = (given.upper + given.lower) / 2, (given.upper - given.lower) / 2
    allowed[2], allowed[3], allowed[4] = given.velocity, share * given.acceleration, share * given.jerk
    findings: list[Finding] = []
    if excesses(world.tables[1][first : last + 1], n, allowed, 3 if world.knots.jumps else 4, worst, when):
        return findings
    for kind, joint in np.argwhere(~(worst <= 0.0)):
        what = f"{robot.joints[joint].name} breaks its {KINDS[kind]} limit{told}"
        unit = ("rad" if robot.joints[joint].kind == "revolute" else "m") + ("", "/s", "/s²", "/s³")[kind]
        findings.append(Finding(Code.LIMIT, what, float(worst[kind, joint]), unit, f"{when[kind, joint]:.6g} s"))
    return findings


def _too_heavy(scene: Scene, mass: float, where: str) -> list[Finding]:
    known = scene.load_limits
    found = [("the maximum load", known.max_kg)]
    if known.shares:
        found.append(("the last mass of the table", known.shares[-1][0]))
    elif known.max_kg is None:
        found.append(("the rated load, beyond which nothing is known", known.rated_kg))
    return [
        Finding(Code.LOAD, f"the load exceeds {what}", mass - most, "kg", where)
        for what, most in found
        if most is not None and not mass <= most * (1.0 + LOAD)
    ]


def share_of(scene: Scene, mass: float) -> float:
    """Of acceleration and jerk that a load leaves (G2)."""
    known = scene.load_limits
    if not known.shares:
        return 1.0 if known.rated_kg is None else min(1.0, known.rated_kg / max(mass, known.rated_kg))
    below, kept = known.shares[0]
    for at, share in known.shares:
        if mass <= at:
            return share if mass <= below or at == below else kept + (share - kept) * (mass - below) / (at - below)
        below, kept = at, share
    return kept


def tool_inertia(scene: Scene) -> float:
    """Of the tool about the flange's axis, kg·m²."""
    tool = scene.tool
    if tool.inertia_kgm2 is not None or not tool.mass_kg:
        return tool.inertia_kgm2 or 0.0
    if not tool.bodies:
        return tool.mass_kg * math.hypot(tool.tcp.x, tool.tcp.y) ** 2
    sums = np.sum([integrals(body) for body in tool.bodies], axis=0)
    return float(tool.mass_kg * sums[3] / sums[0])


def part_inertia(scene: Scene, part: str, in_flange: Pose) -> float:
    """Of a held part about the flange's axis, which is where the inverse of its pose puts it in its own frame."""
    mass, axis = scene.index[part].mass_kg, in_flange.inverse()
    if not mass:
        return 0.0
    volume, x, y, square = integrals(scene.index[part].body)
    whole = square - 2.0 * (axis.x * x + axis.y * y) + (axis.x**2 + axis.y**2) * volume
    return float(mass * whole / volume)


def integrals(body: Body) -> tuple[float, float, float, float]:
    """The integrals of 1, x, y and x² + y² over a body, in its frame."""
    if body.surface is not None:
        return _of_triangles(body.surface[0][body.surface[1]])
    total = np.zeros(4)
    for piece in body.pieces:
        shape, turn, at = piece.shape, piece.rotation, piece.position
        if isinstance(shape, Hull):
            total += _of_triangles((shape.vertices @ turn.T + at)[shape.faces])
            continue
        (a, b, c), r, s = shape.half, shape.disc, shape.ball
        volume, along = 8.0 * a * b * c, np.array([a * a, b * b, c * c]) / 3.0
        if shape.kind == "cylinder":
            volume, along = 2.0 * math.pi * r * r * c, np.array([r * r / 4.0, r * r / 4.0, c * c / 3.0])
        if s > 0.0:
            # a ball that is cut in two by a tube of its radius and the length 2c, which may be 0
            ball, tube = 4.0 * math.pi * s**3 / 3.0, 2.0 * math.pi * s * s * c
            volume = ball + tube
            side = ball * s * s / 5.0 + tube * s * s / 4.0
            up = ball * (s * s / 5.0 + 2.0 * c * 3.0 * s / 8.0 + c * c) + tube * c * c / 3.0
            along = np.array([side, side, up]) / volume
        spread = float((turn[:2] ** 2 @ along).sum() + at[0] ** 2 + at[1] ** 2)
        total += volume * np.array([1.0, at[0], at[1], spread])
    volume, x, y, square = total.tolist()
    return volume, x, y, square


def _of_triangles(corners: FloatArray) -> tuple[float, float, float, float]:
    """`integrals` of what closed triangles (F, 3, 3) enclose: each with the origin is a tetrahedron with a sign."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    six = (a * np.cross(b, c)).sum(-1)
    first = six[:, None] * (a + b + c) / 24.0
    second = six[:, None] * (a * a + b * b + c * c + a * b + b * c + c * a) / 60.0
    return float(six.sum()) / 6.0, float(first[:, 0].sum()), float(first[:, 1].sum()), float(second[:, :2].sum())


def corrected(world: World, phases: tuple[Phase, ...], table: Solids) -> list[Finding]:
    """A finding for each phase in which a correction may bring a joint beyond its range, or the arm out of reach."""
    scene = world.scene
    if not scene.execution.belt_correction:
        return []
    doubt, findings = doubt_of(scene, phases, table), []
    late, start = scene.execution.start_tolerance_s, scene.start.time
    for p, phase in enumerate(phases):
        if not phase.robot or not shifted(doubt, p, 1.0) + shifted(doubt, p, 0.0) > 0.0:
            continue
        stack = [(phase.t0, phase.t1, 0)]
        while stack:
            t0, t1, depth = stack.pop()
            over = _beyond(world, shifted(doubt, p, max(t1 + late - start, 0.0)), t0, t1)
            if over <= 0.0:
                continue
            if depth >= HALVINGS:
                what = "a belt correction may bring a joint beyond its range, or the arm out of reach"
                findings.append(Finding(Code.LIMIT, what, over, "rad", f"{phase.kind}, {t0:.6g} s"))
                break
            middle = (t0 + t1) / 2.0
            stack += [(middle, t1, depth + 1), (t0, middle, depth + 1)]
    return findings


def _beyond(world: World, shift: float, t0: float, t1: float) -> float:
    """By how much, rad, joints may exceed their ranges over [t0, t1] with the tool shifted by `shift`, m, at most;
    infinite: it cannot be."""
    scene, bounds = world.scene, world.joints(t0, t1)
    low, high = bounds[:, 0], bounds[:, 1]
    lag = scene.execution.lag[1] if scene.execution.lag else 0.0
    first, second = turned_by(world.tables[0][0], low[1] - lag, high[1] + lag, shift)
    limits, found = scene.robot.limits, 0.0
    for joint, more in ((0, first), (1, first + second), (3, second)):
        if joint < len(low):
            found = max(found, limits.lower[joint] - low[joint] + more, high[joint] + more - limits.upper[joint])
    return found if found > RATE else 0.0


RATE = 1e-9
"""rad. What rounding may add to a joint at its limit."""

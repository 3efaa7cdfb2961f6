"""Does the claim keep the limits of the request: of the joints, with loads, of accelerated parts, and of yaws?"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from operator import le

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import Four, Interval, inverse_pose
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.statement import ROUNDING, Statement
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c
from assur.planner.geometry.shapes import Body, Hull
from assur.planner.model.load import Carried
from assur.planner.model.scene import Scene

# What the flange carries: masses, and moments of inertia about the axis of the wrist (G1), (G2).

LOAD_ROUNDING = 1e-9
"""Relative: of masses, inertias and shares, which are sums and quotients; and s."""


def loads_of(handling: Handling) -> list[Carried]:
    """What the flange carries, one entry for all legs one after the other in which it holds the same part in the same
    pose, or nothing. No inertia where the last joint does not turn the flange about the vertical."""
    scene, found, held = handling.scene, list[Carried](), list[tuple[str, Four] | None]()
    turns = "yaw" in scene.robot.coordinates and "pitch" not in scene.robot.coordinates
    for stage in handling.stages[: len(handling.plan.legs)]:
        (t0, t1), part = stage.when, stage.held
        carried = None if part is None else (part, handling.place(part, stage.handed)[1])
        if found and carried == held[-1]:
            found[-1] = replace(found[-1], t1=t1)
            continue
        mass = (scene.tool.mass_kg or 0.0) + (0.0 if part is None else scene.index[part].mass_kg or 0.0)
        inertia = tool_inertia(scene) if turns else None
        if inertia is not None and carried is not None:
            inertia += part_inertia(scene, *carried)
        found.append(Carried(part, mass, inertia, share_with_load(scene, mass), t0, t1))
        held.append(carried)
    return found


def require_loads(handling: Handling, stated: tuple[Carried, ...] | None) -> None:
    """The loads are those that the answer states."""
    loads = [] if stated is None else loads_of(handling)
    same = stated is None or [load.part for load in loads] == [load.part for load in stated]
    handling.require(same, Code.LOAD, "the parts in the gripper are not those that are stated")
    for load, own in zip(loads, stated or (), strict=False):
        for name in ("mass_kg", "inertia_kgm2", "share", "t0", "t1"):
            one, other = getattr(load, name), getattr(own, name)
            known = one is not None and other is not None
            same = abs(one - other) <= LOAD_ROUNDING * max(abs(one), 1e-3) if known else one is other
            what = f"{name} of {load.part or 'the tool'} is {one}, and {other} is stated"
            handling.require(same, Code.LOAD, what, (load.t0, load.t1))


def share_with_load(scene: Scene, mass: float) -> float:
    """Of acceleration and jerk that a load leaves (G2)."""
    load = scene.load_limits
    if load.shares:
        masses, shares = zip(*load.shares, strict=True)
        return float(np.interp(mass, masses, shares))
    return 1.0 if load.rated_kg is None else load.rated_kg / max(mass, load.rated_kg)


@lru_cache(maxsize=4)
def tool_inertia(scene: Scene) -> float:
    """Of the tool about the flange's axis, kg·m²."""
    tool = scene.tool
    if tool.inertia_kgm2 is not None or not tool.mass_kg:
        return tool.inertia_kgm2 or 0.0
    if not tool.bodies:
        return tool.mass_kg * math.hypot(tool.tcp.x, tool.tcp.y) ** 2
    sums = np.sum([integrals(body) for body in tool.bodies], axis=0)
    return float(tool.mass_kg * sums[3] / sums[0])


def part_inertia(scene: Scene, part: str, in_flange: Four) -> float:
    """Of a part that is held at a pose in the flange's frame, about the flange's axis, kg·m²."""
    mass, (x, y, *_) = scene.index[part].mass_kg, inverse_pose(in_flange)
    if not mass:
        return 0.0
    volume, first, second, square = integrals(scene.index[part].body)
    return float(mass * (square - 2.0 * (x * first + y * second) + (x * x + y * y) * volume) / volume)


@lru_cache(maxsize=256)
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
        if r > 0.0:  # a cylinder
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


SHARES = (1e-9, 1e-9, 1e-9, 1e-6)
"""By which a position (of half its range), a velocity, an acceleration and a jerk may exceed its limit."""
CARRY_SHARE = 1e-6
"""By which the acceleration of a part may exceed its limit."""


def require_limits(statement: Statement) -> None:
    """The limits of the joints over all of the motion, and those that a load leaves while it is carried."""
    known, stages = statement.scene.load_limits, statement.stages
    whole = (stages[0].when[0], stages[-1].when[1])
    is_limited = _is_limited(statement, 1.0, whole)
    statement.require(is_limited, Code.LIMIT, "the limits of the joints are not kept", whole)
    heaviest = known.rated_kg if known.max_kg is None else known.max_kg
    if known.shares:
        heaviest = min(known.shares[-1][0], math.inf if known.max_kg is None else known.max_kg)
    bounded = heaviest is not None or known.max_inertia_kgm2 is not None
    for load in loads_of(statement) if bounded else ():
        carried, when = load.part or "the tool", (load.t0, load.t1)
        for what, amount, most in (
            ("kg", load.mass_kg, heaviest),
            ("kg·m²", load.inertia_kgm2, known.max_inertia_kgm2),
        ):
            if most is not None and amount is not None:
                fits = amount <= most * (1.0 + ROUNDING)
                statement.require(fits, Code.LOAD, f"{amount:g} {what} with {carried} are too much", when)
        is_limited = load.share == 1.0 or _is_limited(statement, load.share, when)
        statement.require(is_limited, Code.LIMIT, f"the limits with {carried} are not kept", when)


def _is_limited(statement: Statement, share: float, when: Interval) -> bool:
    """Whether a row of the claim has limits that are no wider, for as long, with this share of the accelerations and
    jerks."""
    own, jerk = statement.scene.robot.limits, statement.scene.options.jerk_limited
    lower = [x - ROUNDING * abs(x) for x in own.lower.tolist()]
    sizes = ((own.upper, 1.0), (own.velocity, 1.0), (own.acceleration, share), (own.jerk, share))[: 3 + jerk]
    upper = [[part * x + ROUNDING * abs(part * x) for x in most.tolist()] for most, part in sizes]
    for row in statement.claim.limits.tolist():
        kept = row[c.LIMIT_T0] <= when[0] and when[1] <= row[c.LIMIT_T1] and row[c.LIMIT_JERKS] >= jerk
        kept = kept and all(map(le, row[c.LIMIT_SHARE : c.LIMIT_LOWER], SHARES))
        kept = kept and all(map(le, lower, row[c.LIMIT_LOWER : c.LIMIT_UPPER]))
        for first, most in zip(range(c.LIMIT_UPPER, c.LIMIT, c.MOST_JOINTS), upper, strict=False):
            kept = kept and all(map(le, row[first : first + c.MOST_JOINTS], most))
        if kept:
            return True
    return False


def require_rates(statement: Statement) -> None:
    """How hard the tool point accelerates while a part is held."""
    most, end = statement.scene.carry_acceleration, statement.whole[1]
    for stage in statement.stages if most is not None else []:
        first, last = stage.when
        if most is not None and stage.held is not None and first < end:
            kept = statement.tool_keeps(-1.0, 2, 0.0, most * (1.0 + CARRY_SHARE), (first, min(last, end)))
            statement.require(kept, Code.RATE, f"{stage.held} may be accelerated too hard", stage.when)


def require_yaws(statement: Statement) -> None:
    """The yaw of the tool point is outside of each forbidden range, widened by what lag turns the tool."""
    lag, tool = statement.scene.execution.lag, statement.tcp[3]
    late = lag[0] + lag[1] + lag[3] if len(lag) > 3 else 0.0
    for each in statement.scene.forbidden_yaw:
        width = (each.last - each.first) % math.tau
        middle, half = each.first + width / 2.0, min(width / 2.0 + late, math.pi)
        axis, direction = (math.cos(tool), math.sin(tool), 0.0), (math.cos(middle), math.sin(middle), 0.0)
        about = (statement.flange, 0.0, *axis, -1.0, *direction)
        kept = statement.keeps("axes", about, -math.inf, math.cos(half), statement.whole)
        what = f"the yaw of the tool may be from {each.first:g} to {each.last:g} rad"
        statement.require(kept, Code.YAW, what, statement.whole)

"""What is wrong at the start: a joint beyond a limit, an open chain, a law that is over, a yaw; and loads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

from assur.planner.checker.refusals.postures import forbidden, links_at, yaw_at
from assur.planner.checker.refusals.stated import Proof, exceeded, law_ends
from assur.planner.checker.statement import laws
from assur.planner.checker.statement.differences import inverse_pose, numbers, then
from assur.planner.checker.statement.limits import integrals, part_inertia, share_with_load, tool_inertia
from assur.planner.model.attachments import at_start
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import (
    RATES,
    Bodies,
    Facts,
    MotionLimit,
    Obstacle,
    Overload,
    Quantity,
    Reason,
    Refusal,
    Singular,
    Stage,
    finite,
)
from assur.planner.model.scene import Pick, Scene, beyond
from assur.planner.model.witness import PROVED_S, PROVED_SHARE

Load = Literal["max_load", "table", "max_inertia"]
COUPLERS = ("distal-left", "distal-right")
"""The links of a loop that meet at the tool."""
MARGIN = 1e-6
"""By how much a margin that is stated may be off: the square root of what sums round."""


def beyond_limits(scene: Scene, _: int = 0, least: float = PROVED_SHARE) -> Iterator[Proof]:
    """Joints that are beyond their range, faster than they may be, or accelerate more, by more than a share `least` of
    range or limit."""
    limits, start, held = scene.robot.limits, scene.start, at_start(scene).held
    accelerations = share_with_load(scene, _mass(scene, None if held is None else held.part)) * limits.acceleration
    rows = zip(limits.lower, limits.upper, start.q, start.qd, limits.velocity, start.qdd, accelerations, strict=True)
    for k, row in enumerate(rows):
        low, high, q, *rates = map(float, row)
        found: list[tuple[float, float, Facts]] = [(max(low - q, q - high), high - low, beyond(scene, k, q))]
        for rate, value, limit in zip(RATES, map(abs, rates[::2]), rates[1::2], strict=False):
            facts = MotionLimit(obstacle=Obstacle.RATE, rate=rate, value=value, limit=limit)
            found.append((value - limit, limit, facts))
        for order, (over, of, each) in enumerate(found):
            if over > least * of:
                reason = Reason.MOTION_LIMIT if order else Reason.JOINT_LIMIT
                yield exceeded(scene, reason, k, over, each, order)


def unassembled(scene: Scene, _: int = 0, least: float = PROVED_SHARE) -> Iterator[Proof]:
    """A closed chain that is too near a type 2 singularity, where its couplers are parallel, or does not close."""
    need, names, t = scene.robot.parallel_least, scene.robot.links, scene.start.time
    if not set(COUPLERS) <= set(names):
        return
    links = links_at(scene, scene.start.q)
    one, other = (links[names.index(name)].angles[0] for name in COUPLERS)
    margin = finite(abs(math.sin(other - one)))
    if (margin or 0.0) < need * (1.0 - least):
        facts, amount = Singular(margin=margin, required=need), Quantity(need - (margin or 0.0), "1")
        yield Proof(Reason.NEAR_PARALLEL_SINGULARITY, facts, amount, within=MARGIN, interval=(t, t))


def law_over(scene: Scene, _: int = 0, least: float = PROVED_S) -> Iterator[Proof]:
    """Frames that bear a body and whose motion is not known at the start, by more than `least`, s."""
    t = scene.start.time
    for name in dict.fromkeys(body.frame for body in scene.bodies):
        known = laws.known(scene.frames[name].law)
        if max(known[0] - t, t - known[1]) > least:
            yield law_ends(name, known, t, interval=known)


def turned_into_range(scene: Scene, _: int = 0) -> Iterator[Proof]:
    """Forbidden ranges that the yaw of the tool is in."""
    t = scene.start.time
    return (each._replace(interval=(t, t)) for each in forbidden(scene, yaw_at(scene, scene.start.q)))


def _mass(scene: Scene, part: str | None) -> float:
    """Of the tool and a part, kg."""
    return (scene.tool.mass_kg or 0.0) + (0.0 if part is None else scene.index[part].mass_kg or 0.0)


def overload(scene: Scene, refusal: Refusal) -> Iterator[Proof]:
    """Loads that the robot may not carry: the tool alone, or with the part that is held at the start or that the step
    takes."""
    step, holding, limits = scene.task[refusal.step], scene.start.holding, scene.load_limits
    parts: set[str | None] = {None}
    if refusal.stage is not Stage.START and isinstance(step, Pick):
        parts.add(step.part)
    elif refusal.stage is Stage.START and holding is not None:
        parts.add(holding.part)
    most, table = limits.max_kg, limits.shares[-1][0] if limits.shares else None
    if most is None and table is None:
        most = limits.rated_kg  # beyond which nothing is known
    for part in parts:
        mass, tool = _mass(scene, part), _mass(scene, None)
        inertia = _inertia(scene, refusal, part)
        yield from too_much(part, "max_load", mass, most, tool)
        yield from too_much(part, "table", mass, table, tool)
        yield from too_much(part, "max_inertia", inertia, limits.max_inertia_kgm2, tool_inertia(scene))


def too_much(
    part: str | None, of: Load, value: float, limit: float | None, tool: float, least: float = PROVED_SHARE
) -> Iterator[Proof]:
    """A load of tool and part, kg or kg·m², that is beyond its limit by more than a share `least` of it. None: no part,
    or no limit."""
    if limit is not None and value > limit * (1.0 + least):
        facts = Overload(of=of, value=value, limit=limit, tool=tool, part=part, part_value=value - tool)
        amount = Quantity(value - limit, "kg·m²" if of == "max_inertia" else "kg")
        yield Proof(Reason.LOAD_LIMIT, facts, amount, None if part is None else Bodies((part,)))


def _inertia(scene: Scene, refusal: Refusal, part: str | None) -> float:
    """Of the tool and a part about the wrist's axis, kg·m²: the least of all turns in which the part may be taken; or
    that which is stated, if it is not more than that of some turn and the least is too much. Less than 0: the arm does
    not turn it."""
    if not scene.robot.turns_load:
        return -1.0
    low = high = tool_inertia(scene)
    if part is not None:
        parts = _part_inertias(scene, refusal, part)
        low, high = low + min(parts), high + max(parts)
    most, given = scene.load_limits.max_inertia_kgm2, refusal.facts
    if most is None or not low > most * (1.0 + PROVED_SHARE) or not isinstance(given, Overload):
        return low
    return given.value if low <= given.value <= high else low


def _part_inertias(scene: Scene, refusal: Refusal, part: str) -> list[float]:
    """Of a part, kg·m², for each turn in which it may be taken, or the least and the greatest of all."""
    step, tcp, holding = scene.task[refusal.step], numbers(scene.tool.tcp), scene.start.holding
    if refusal.stage is Stage.START and holding is not None:
        return [part_inertia(scene, part, then(tcp, inverse_pose(numbers(holding.grasp))))]
    if not isinstance(step, Pick):
        return [0.0]
    grasp, offsets = numbers(step.grasp), yaw_offsets(scene, step)
    if offsets is not None:
        turned = (then((0.0, 0.0, 0.0, turn), grasp) for turn in offsets)
        return [part_inertia(scene, part, then(tcp, inverse_pose(each))) for each in turned]
    mass, (ax, ay, *_) = scene.index[part].mass_kg or 0.0, then(grasp, inverse_pose(tcp))
    volume, x, y, square = integrals(scene.index[part].body)
    away, out = math.hypot(ax, ay), math.hypot(x, y)
    return [mass * (square + sign * 2.0 * away * out + away * away * volume) / volume for sign in (-1.0, 1.0)]

"""Does the claim keep the limits of the request: of the joints, with loads, of accelerated parts, and of yaws?"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.checker.statement.differences import Interval
from assur.planner.checker.statement.loads import loads_of
from assur.planner.checker.statement.statement import ROUNDING, Statement, all_of, at_least, at_most
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c

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
    rows = [mass for mass, _ in known.shares[-1:]] + ([] if known.max_kg is None else [known.max_kg])
    heaviest = min(rows) if rows else known.rated_kg
    for load in loads_of(statement):
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
    jerks; of the jerk where the timing that is requested has such a limit."""
    own = statement.scene.robot.limits
    upper = {c.LIMIT_UPPER: own.upper, c.LIMIT_VELOCITY: own.velocity, c.LIMIT_ACCELERATION: share * own.acceleration}
    bounds = [all_of(when), at_most(c.LIMIT_SHARE, *SHARES)]
    bounds.append(at_least(c.LIMIT_LOWER, *(own.lower - ROUNDING * np.abs(own.lower)).tolist()))
    if statement.scene.options.jerk_limited:
        upper[c.LIMIT_JERK] = share * own.jerk
        bounds.append(at_least(c.LIMIT_JERKS, 1.0))
    bounds += [at_most(column, *(most + ROUNDING * np.abs(most)).tolist()) for column, most in upper.items()]
    return statement.states("limits", *bounds)


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

"""Does the claim keep the limits of the request: of the joints, with loads, of accelerated parts, and of yaws?"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import Difference, Interval, Topic
from assur.planner.checker.statement.holding import Handling
from assur.planner.checker.statement.loads import loads_of
from assur.planner.checker.statement.peaks import is_rate_stated
from assur.planner.checker.statement.phases import Stage
from assur.planner.checker.statement.points import is_axis_stated
from assur.planner.claim import columns as c

SHARES = np.array([1e-9, 1e-9, 1e-9, 1e-6])
"""By which a position (of half its range), a velocity, an acceleration and a jerk may exceed its limit."""
CARRY_SHARE = 1e-6
"""By which the acceleration of a part may exceed its limit."""
ROUNDING = 1e-12
"""Of a limit: a share of it that was computed in another order of operations."""


def limits_agree(handling: Handling, stages: list[Stage], claim: c.Claim) -> Iterator[Difference]:
    """The limits of the joints over all of the motion, and those that a load leaves while it is carried."""
    known, whole = handling.scene.load_limits, (stages[0].when[0], stages[-1].when[1])
    if not _is_limited(handling, claim, 1.0, whole):
        yield Difference(Topic.LIMIT, "the limits of the joints are not kept", whole)
    rows = [mass for mass, _ in known.shares[-1:]] + ([] if known.max_kg is None else [known.max_kg])
    heaviest = min(rows) if rows else known.rated_kg
    for load in loads_of(handling, stages):
        carried, when = load.part or "the tool", (load.t0, load.t1)
        for what, amount, most in (
            ("kg", load.mass_kg, heaviest),
            ("kg·m²", load.inertia_kgm2, known.max_inertia_kgm2),
        ):
            if most is not None and amount is not None and not amount <= most * (1.0 + ROUNDING):
                yield Difference(Topic.LOAD, f"{amount:g} {what} with {carried} are too much", when)
        if load.share != 1.0 and not _is_limited(handling, claim, load.share, when):
            yield Difference(Topic.LIMIT, f"the limits with {carried} are not kept", when)


def _is_limited(handling: Handling, claim: c.Claim, share: float, when: Interval) -> bool:
    """Whether a row of the claim has limits that are no wider, for as long, with this share of the accelerations and
    jerks. Without a limit of the jerk only where the timing that is requested has none."""
    scene, n = handling.scene, len(handling.scene.robot.joints)
    own, unlimited = scene.robot.limits, not scene.options.jerk_limited
    required = np.array([-own.lower, own.upper, own.velocity, share * own.acceleration, share * own.jerk])
    for row in claim.limits:
        if row[c.LIMIT_T0] <= when[0] and when[1] <= row[c.LIMIT_T1]:
            stated: FloatArray = row[c.LIMIT_LOWER :].reshape(5, c.MOST_JOINTS)[:, :n] * SIGNS
            kept = stated <= required + ROUNDING * np.abs(required)
            jerk = row[c.LIMIT_JERKS] == 1.0
            counts = slice(None) if jerk else slice(4)
            if (jerk or unlimited) and kept[counts].all() and (row[c.LIMIT_SHARE : c.LIMIT_LOWER] <= SHARES).all():
                return True
    return False


SIGNS = np.array([[-1.0], [1.0], [1.0], [1.0], [1.0]])
"""Limits times these are no greater where they are narrower: of lower limits the opposite is compared."""


def rates_agree(handling: Handling, stages: list[Stage], claim: c.Claim) -> Iterator[Difference]:
    """How hard the tool point accelerates while a part is held."""
    most, end = handling.scene.carry_acceleration, float(handling.plan.trajectory.time[-1])
    if most is None:
        return
    for stage in stages:
        first, last = stage.when
        if stage.held is None or not first < end:
            continue
        if not is_rate_stated(handling, claim, 2, (-1.0, most * (1.0 + CARRY_SHARE)), (first, min(last, end))):
            yield Difference(Topic.RATE, f"{stage.held} may be accelerated too hard", stage.when)


def yaws_agree(handling: Handling, claim: c.Claim) -> Iterator[Difference]:
    """The yaw of the tool point is outside of each forbidden range, widened by what lag turns the tool."""
    path, lag = handling.plan.trajectory, handling.scene.execution.lag
    late = lag[0] + lag[1] + lag[3] if len(lag) > 3 else 0.0
    when, tool = (float(path.time[0]), float(path.time[-1])), handling.tcp[3]
    for each in handling.scene.forbidden_yaw:
        width = (each.last - each.first) % math.tau
        middle, half = each.first + width / 2.0, min(width / 2.0 + late, math.pi)
        axis, direction = (math.cos(tool), math.sin(tool), 0.0), (math.cos(middle), math.sin(middle), 0.0)
        if not is_axis_stated(handling.scene, claim, axis, direction, (-math.inf, math.cos(half)), when):
            yield Difference(Topic.YAW, f"the yaw of the tool may be from {each.first:g} to {each.last:g} rad", when)

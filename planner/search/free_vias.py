"""Random joint positions between others: ways around what is in the direct way."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.robots.robot import Robot
from assur.planner.search import tuning


def free_vias(rng: np.random.Generator, robot: Robot, start: FloatArray, goal: FloatArray, count: int) -> FloatArray:
    """`count` vias (N, count, n), within limits, on each of N ways from `start` (n,) to `goal` (N, n)."""
    limits, shape = robot.limits, (len(goal), count)
    span, joints = limits.upper - limits.lower, clearing(robot)
    share = np.sort(rng.uniform(0.1, 0.9, shape), axis=1)[..., None]
    goal = goal[:, None]
    on_way = start + share * (goal - start)
    near = on_way + rng.normal(0.0, tuning.SPREAD, (*shape, len(span))) * span
    anywhere = rng.uniform(limits.lower, limits.upper, (*shape, len(span)))
    kind = rng.choice(len(tuning.VIA_KINDS), size=shape, p=tuning.VIA_KINDS)[..., None]
    q = np.where(kind == 1, anywhere, near)
    # one joint near an end of its range: a folded arm passes where a stretched one does not
    folding = np.flatnonzero(joints)[1:]
    if len(folding):
        joint = rng.choice(folding, shape)
        up, inward = rng.random(shape) < 0.5, tuning.FOLDED * rng.random(shape) * span[joint]
        folded = np.where(up, limits.upper[joint] - inward, limits.lower[joint] + inward)
        q = np.where((kind == 2) & (np.arange(len(span)) == joint[..., None]), folded[..., None], q)
    q = np.where(joints, q, on_way)
    if robot.lift is not None:
        z = robot.lift
        above = np.minimum(np.maximum(start[z], goal[..., z]), limits.upper[z])
        low = np.where(rng.random(shape) < tuning.ABOVE, above, limits.lower[z])
        between = rng.uniform(low, limits.upper[z], shape)
        q[..., z] = np.where(rng.random(shape) < tuning.BELOW_TOP, between, limits.upper[z])
    return np.asarray(np.clip(q, limits.lower, limits.upper))


def clearing(robot: Robot) -> BoolArray:
    """Joints (n,) that clear something: the wrist only turns with the way, and the lift has a rule of its own."""
    found = np.array([number != robot.lift for number in range(len(robot.joints))])
    found[3:] = False
    return found

"""JOINT_LIMIT: which joint would be where, and which end of its range that is beyond."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.refusal import BeyondRange
from assur.planner.model.scene import Scene
from assur.planner.robots.turns import nearest_turns


def beyond(scene: Scene, joint: int, value: float) -> BeyondRange:
    """The facts of joint number `joint` at `value`, rad or m, as the planner counts it: the nearer end of its range is
    that which it is beyond."""
    lower, upper = (float(end[joint]) for end in (scene.robot.limits.lower, scene.robot.limits.upper))
    limit = lower if lower - value > value - upper else upper
    return BeyondRange(value=scene.counted(joint, value), limit=scene.counted(joint, limit))


def beyond_at_nearest_turn(scene: Scene, joint: int, q: FloatArray) -> BeyondRange:
    """The facts of joint number `joint` at q (n,), turned to where it is nearest to being within its range."""
    return beyond(scene, joint, float(np.asarray(nearest_turns(scene.robot, q))[joint]))

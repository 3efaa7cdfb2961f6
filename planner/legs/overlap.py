"""Corners that overlap: where the straight part of an approach or depart ends, the tool moves on along the vertical.

The straight part is then the first part of a fastest motion of the lift from rest at the point to a stop far above it
(of an approach: the last part of such a motion downwards). What the joint leg behind it begins with is the state in
which that motion is cut. So no state is handed over from which the lift could not stop within its range.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.legs.control_point import ControlPoint, MovingEnd
from assur.planner.legs.tool_motion import lift_most
from assur.planner.model.scene import Scene
from assur.planner.timing import RawProfile, Solver, TimingRefusal, trajectory_of

FARTHER, FARTHER_M = 3.0, 0.02
"""The motion of which a straight part is cut goes so many times as far, but at most so much farther, m, unless an arch
says how far it goes, ..."""
LEAST_FARTHER = 1.2
"""... and at least so many times as far: with less room the tool stops where the straight part ends."""
RANGE_M = 1e-3
"""From the end of the lift's range such a motion stays this far away, m."""
CUTS = 100
"""Halvings of the time in which the height of a cut is looked for: more than a double has digits."""


def entering(scene: Scene, point: ControlPoint, q: FloatArray) -> MovingEnd | None:
    """How the tool comes into the straight part of an approach without a stop; None: it stops there.

    `q` (n,): any joint position; the lift moves the flange one to one, so it tells what heights the lift reaches.
    """
    step = point.facts
    if not point.approach > 0.0 or step.approach_stop or not (point.matched or point.still):
        return None
    z = float(point.flange(np.array(scene.start.time)).p[2])
    top = None if step.arch is None else step.arch.top_m
    return _moving_end(scene, point, z, top, q, up=False)


def may_stop(scene: Scene, number: int) -> bool:
    """Whether behind the depart of step `number` the tool may move on, so that a stop there is a choice."""
    step, behind = scene.task[number], scene.task[number + 1 : number + 2]
    departs = step.depart_m > 0.0 and not step.depart_stop
    return departs and scene.robot.lift is not None and bool(behind) and behind[0].leg != "cartesian"


def leaving(scene: Scene, point: ControlPoint, q: FloatArray) -> MovingEnd | None:
    """How the tool goes on behind the straight part of a depart without a stop; None: it stops there, as it does at
    the end of the task and before a straight leg. `q` (n,): joints where the tool leaves the point."""
    if not may_stop(scene, point.step):
        return None
    after = scene.task[point.step + 1]
    z, top = float(scene.robot.forward(q)[0][2]), None if after.arch is None else after.arch.top_m
    return _moving_end(scene, point, z, top, q, up=True)


def _moving_end(
    scene: Scene, point: ControlPoint, z: float, top: float | None, q: FloatArray, *, up: bool
) -> MovingEnd | None:
    """`z`: height of the flange at the point, m; `top`: of the tool point where an arch is highest; `up`: of a depart.

    Before a place and behind a pick a part is in the gripper.
    """
    lift, limits = scene.robot.lift, point.limits_after if up else point.limits
    height = point.depart if up else point.approach
    if lift is None or not height > 0.0 or not np.isfinite(z):
        return None
    flange = float(scene.robot.forward(q)[0][2])
    room = float(limits.upper[lift]) - RANGE_M - (float(q[lift]) + z - flange)
    far = min(FARTHER * height, height + FARTHER_M) if top is None else top - scene.tool.tcp.z - z
    far = min(far, room)
    if not far >= LEAST_FARTHER * height:
        return None
    v, a, j = (float(rate[lift]) for rate in (limits.velocity, limits.acceleration, limits.jerk))
    return _cut(v, min(a, lift_most(scene, carried=point.carries(up=up))), j, height, far, up=up)


@lru_cache(maxsize=256)
def _cut(v: float, a: float, j: float, height: float, far: float, *, up: bool) -> MovingEnd | None:
    """The part up to `height` of the fastest motion up to `far`, m, at these limits; or its reverse, downwards."""
    whole = Solver([v], [a], [j]).raw_profile(([0.0], [0.0], [0.0]), ([far], [0.0], [0.0]))
    if isinstance(whole, TimingRefusal):
        return None
    kept, state = list[tuple[float, float]](), (0.0, 0.0, 0.0)
    for duration, jerk in whole.phases[0].T.tolist():
        after = _later(state, jerk, duration)
        if after[0] < height:
            kept.append((duration, jerk))
            state = after
            continue
        low, high = 0.0, duration
        for _ in range(CUTS):
            middle = (low + high) / 2
            low, high = (middle, high) if _later(state, jerk, middle)[0] < height else (low, middle)
        kept.append((high, jerk))
        state = _later(state, jerk, high)
        break
    if not state[1] > 0.0:
        return None
    speed, acceleration = state[1], state[2]
    rest, moving = ([0.0], [0.0], [0.0]), ([height], [speed if up else -speed], [acceleration])
    phases = kept if up else [(duration, -jerk) for duration, jerk in reversed(kept)]
    total = sum(duration for duration, _ in phases)
    begin, goal = (rest, moving) if up else (moving, rest)
    profile = RawProfile(total, begin, goal, np.array([list(zip(*phases, strict=True))]))
    return MovingEnd(height, moving[1][0], acceleration, far, trajectory_of([profile], [0.0, total]))


def _later(state: tuple[float, float, float], jerk: float, t: float) -> tuple[float, float, float]:
    """A state of constant jerk, t seconds on."""
    x, v, a = state
    return x + t * (v + t * (a / 2 + t * jerk / 6)), v + t * (a + t * jerk / 2), a + t * jerk

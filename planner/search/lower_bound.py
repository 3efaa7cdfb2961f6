"""A duration that no plan of any budget beats: the joints' velocity and acceleration limits alone."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.tilt import pitch_free, roll_free, tilts
from assur.planner.model.attachments import at_start
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Pick, Place, Scene, Step, Trace
from assur.planner.robots.turns import equivalents
from assur.planner.search.meeting_options import Option


def lower_bound(scene: Scene, first: tuple[Option, ...]) -> float:
    """Seconds from the start to the end of the task: the way to the first control point, then ways and dwells.

    `first`: the ways to the first control point, whose lower bounds hold for every mode, turn and meeting time if the
    point stands still; if it moves, its way counts as nothing. Later ways are bounded by velocity alone, and only
    between points that stand still and have one yaw.
    """
    attached = at_start(scene)
    free = yaw_offsets(scene, scene.task[0]) is None or _tilt_free(scene, scene.task[0], moving=scene.start.moving)
    total = min((_first(scene, option, free=free) for option in first), default=0.0)
    before: list[FloatArray] = []
    turned = False
    for number, step in enumerate(scene.task):
        offsets = yaw_offsets(scene, step)
        total += step.dwell_s
        here: list[FloatArray] = []
        between = bool(before) or number + 1 < len(scene.task)
        for offset in (offsets or ()) if between else ():
            point = control_point(scene, number, attached, offset, tilts(scene, step, scene.start.q)[0])
            known = not _tilt_free(scene, step, moving=True)
            if point.still and known and not (isinstance(step, Place) and turned):
                here += _positions(scene, point)
        if before and here:
            total += min(_velocity_time(scene, a, b) for a in before for b in here)
        before = [] if isinstance(step, Trace) else here
        if isinstance(step, Pick):
            # in which of several turns the part is held is not known: nor where it is put down from
            turned = len(offsets or ()) != 1
        attached = attached.after(scene, step, (offsets or (0.0,))[0])
    return total


def _first(scene: Scene, option: Option, *, free: bool) -> float:
    """The lower bound of one way to the first control point; none for a via, which may be passed at any speed, where
    the yaw or the pitch is `free`, for not all were looked at, and for a point that moves: it may be met between two
    times that were looked at, sooner than at either."""
    point = option.meeting.point
    if point.via or free or not point.still or not np.isfinite(option.least):
        return 0.0
    if point.tracks and point.approach > 0.0:
        # the arm need not stop above the point, where the option is met
        return min((_velocity_time(scene, scene.start.q, q) for q in _positions(scene, point)), default=0.0)
    return max(0.0, option.least - option.grain)


def _velocity_time(scene: Scene, one: FloatArray, other: FloatArray) -> float:
    """Seconds from one joint position to another by the velocity limits alone."""
    return float(np.max(np.abs(one - other) / scene.robot.limits.velocity))


def _tilt_free(scene: Scene, step: Step, *, moving: bool) -> bool:
    """Whether another pitch or roll than those looked at could be met sooner; not a roll that an arm at rest keeps."""
    return pitch_free(scene, step) or (moving and roll_free(scene, step))


def _positions(scene: Scene, point: ControlPoint) -> list[FloatArray]:
    """All joint positions (n,) within limits that put the flange at a point that stands still."""
    robot, found = scene.robot, []
    motion = point.flange(np.array([scene.start.time]), 0.0)
    for mode in range(len(robot.modes)):
        q = robot.inverse(motion, mode, 0).q[0]
        found += list(equivalents(robot, q, robot.limits.lower, robot.limits.upper))
    return found

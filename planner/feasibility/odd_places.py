"""What is probably not meant about where things are: parts released in the air, tools that grip beside their part,
parts that are inside other bodies.

Where a part is put down, and how it is gripped, is what the request says; nothing else would tell that there is air
between. FCL decides, on the true shapes; how far a tool is from its part is measured on convex pieces.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.fcl_door import Posed
from assur.planner.collision.proof import Prover
from assur.planner.collision.touching import Nearest, grip
from assur.planner.feasibility.posed_bodies import AtStart, moved, touch
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import AT_START, Attachments, at_start
from assur.planner.model.deadline import look
from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Pick, Place, Scene

DROP_M = 0.002
"""A part that has nothing within this below it is released in the air, m: so far some grippers drop it on purpose."""
GRIP_M = 0.01
"""A tool that is farther than this from its part does not grip it, m: jaws that are open leave a few millimetres."""
OVERLAP_M = 0.001
"""By so much a body may be inside another, m: it was placed by hand."""
MOST_OVERLAPS = 5
"""So many overlaps are told: more are a model that is made so."""
AXES = np.concatenate([np.eye(3), -np.eye(3)])


def odd_places(scene: Scene, at: AtStart) -> tuple[InputWarning, ...]:
    """The warnings about picks and places, in the order of the task, and then about bodies that overlap.

    Raises `OutOfTimeError` where the deadline in force passes."""
    attached, found = at_start(scene), dict[InputWarning, None]()
    for step in scene.task:
        look()
        off = _off_part(scene, at.prover, step, attached) if isinstance(step, Pick) else None
        if off is not None:
            found[InputWarning(Odd.TOOL_OFF_PART, off.bodies, off.distance_m)] = None
        if isinstance(step, Place):
            below = _air_below(scene, at, step, attached)
            if below is not None:
                found[InputWarning(Odd.RELEASED_IN_AIR, (step.part, below[0]), below[1])] = None
        attached = attached.after(scene, step)
    return (*found, *_overlaps(scene, at))


def _off_part(scene: Scene, prover: Prover, step: Pick, attached: Attachments) -> Nearest | None:
    """The body of the tool that is nearest to a part, in the turn in which it is nearest, if that is too far to grip
    it."""
    turns = yaw_offsets(scene, step) or (0.0,)
    found = [grip(prover, step, attached, turn) for turn in turns]
    nearest = min((each for each in found if each is not None), key=lambda each: each.distance_m, default=None)
    return nearest if nearest is not None and nearest.distance_m > GRIP_M else None


def _air_below(scene: Scene, at: AtStart, step: Place, attached: Attachments) -> tuple[str, float] | None:
    """The highest body below a part that is released in the air, and how far below it is, m; None: the part is put down
    on something, or it is not known what is there when it is.

    Not looked at: places that name what the part rests on, or on frames that move, or beside bodies that move."""
    if step.contact_with is not None or not scene.frames[step.target.frame].law.is_fixed:
        return None
    others = [body.name for body in scene.bodies if body.name != step.part]
    if not all(scene.frames[attached.pose_of(scene, name)[0]].law.is_fixed for name in others):
        return None
    here, there = at.pose(step.part), at.pose(step.part, (step.target.frame, step.target.pose))
    if here is None or there is None:
        return None
    part = _carried(at.shapes(step.part), _matrix(there) @ np.linalg.inv(_matrix(here)))
    sunk, body = moved(part, np.array([0.0, 0.0, -DROP_M])), scene.index[step.part].body
    bottom, highest = there.z + body.heights[0], None
    for name in others:
        old, now = at.pose(name), at.pose(name, attached.pose_of(scene, name))
        if old is None or now is None or name not in at.prover.arrangement(AT_START).number:
            return None
        other = scene.index[name].body
        if math.hypot(now.x - there.x, now.y - there.y) > body.radius + other.radius:
            continue
        if touch(at.prover, sunk, _carried(at.shapes(name), _matrix(now) @ np.linalg.inv(_matrix(old)))):
            return None
        gap = bottom - (now.z + other.heights[1])
        if gap > 0.0 and (highest is None or gap < highest[1]):
            highest = name, gap
    return highest


def _overlaps(scene: Scene, at: AtStart) -> list[InputWarning]:
    """Parts that stand, and are inside a body that stands, or inside another such part: the first `MOST_OVERLAPS`."""
    found, parts = list[InputWarning](), dict[str, None]()
    held = at_start(scene).held
    for step in scene.task:
        if isinstance(step, Pick) and (held is None or held.part != step.part):
            parts[step.part] = None
    if not parts:
        return []
    numbers = at.prover.arrangement(AT_START).number
    standing = [body for body in scene.bodies if scene.frames[body.frame].law.is_fixed]
    standing = [body for body in standing if body.name in numbers and (held is None or held.part != body.name)]
    order = {body.name: i for i, body in enumerate(standing)}
    pairs = set[tuple[int, int]]()
    for name in parts:
        here = at.pose(name)
        if name in order and here is not None:
            low, high = (here.z + height for height in scene.index[name].body.heights)
            others = [order[other] for other in at.near(name, low, high) if other in order]
            pairs |= {(min(order[name], other), max(order[name], other)) for other in others}
    # fixtures, which are no parts, are often made of shapes that overlap
    for i, j in sorted(pairs):
        one, other = standing[i].name, standing[j].name
        ones, theirs = at.shapes(one), at.shapes(other)
        if all(touch(at.prover, moved(ones, OVERLAP_M * axis), theirs) for axis in AXES):
            found.append(InputWarning(Odd.BODIES_OVERLAP, (one, other), OVERLAP_M))
            if len(found) == MOST_OVERLAPS:
                break
    return found


def _carried(posed: list[Posed], by: FloatArray) -> list[Posed]:
    """Shapes after a rigid motion `by` (4, 4) in the world."""
    turn, shift = by[:3, :3], by[:3, 3]
    return [replace(each, position=turn @ each.position + shift, axes=turn @ each.axes) for each in posed]


def _matrix(pose: Pose) -> FloatArray:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return np.array([[c, -s, 0, pose.x], [s, c, 0, pose.y], [0, 0, 1, pose.z], [0, 0, 0, 1.0]])

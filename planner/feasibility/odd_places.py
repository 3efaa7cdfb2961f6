"""What is probably not meant about where things are: parts released in the air, tools that grip beside their part,
parts that are inside other bodies.

Where a part is put down, and how it is gripped, is what the request says; nothing else would tell that there is air
between. FCL decides, on the true shapes.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.fcl_door import Posed
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.posed_bodies import moved, posed_body, touch, world_pose
from assur.planner.frames import Fixed
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import AT_START, Attachments, at_start
from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.scene import Pick, Place, Scene

DROP_M = 0.002
"""A part that has nothing within this below it is released in the air, m: so far some grippers drop it on purpose."""
GRIP_M = 0.01
"""A tool that touches its part nowhere, nor moved by up to this along an axis, m, does not grip it."""
GRIP_STEPS = 10
"""Of `GRIP_M`, at which it is looked."""
OVERLAP_M = 0.001
"""By so much a body may be inside another, m: it was placed by hand."""
MOST_OVERLAPS = 5
"""So many overlaps are told: more are a model that is made so."""
AXES = np.concatenate([np.eye(3), -np.eye(3)])


def odd_places(scene: Scene, prover: Prover) -> tuple[InputWarning, ...]:
    """The warnings about picks and places, in the order of the task, and then about bodies that overlap."""
    attached, found = at_start(scene), dict[InputWarning, None]()
    for step in scene.task:
        if isinstance(step, Pick) and _grips_beside(scene, prover, step, attached):
            found[InputWarning(Odd.TOOL_OFF_PART, (scene.tool.bodies[0].name, step.part), GRIP_M)] = None
        if isinstance(step, Place):
            below = _air_below(scene, prover, step, attached)
            if below is not None:
                found[InputWarning(Odd.RELEASED_IN_AIR, (step.part, below[0]), below[1])] = None
        attached = attached.after(scene, step)
    return (*found, *_overlaps(scene, prover))


def _grips_beside(scene: Scene, prover: Prover, step: Pick, attached: Attachments) -> bool:
    """Whether the tool touches the part in none of the turns in which it may grip it, nor near."""
    here = world_pose(scene, step.part, scene.start.time)
    if not scene.tool.bodies or scene.robot.tilting or here is None:
        return False
    q, t, arrangement = scene.start.q, scene.start.time, prover.arrangement(AT_START)
    flange = prover.carriers(q, t)[scene.robot.links.index("flange")]
    at_flange = np.eye(4)
    at_flange[:3, :3], at_flange[:3, 3] = flange[3:].reshape(3, 3), flange[:3]
    units = [unit for body in scene.tool.bodies for unit in arrangement.pieces(arrangement.number[body.name])]
    tool = prover.posed(arrangement, q, t, np.array(units))
    part = posed_body(scene, prover, step.part)
    ways = [np.zeros(3), *(GRIP_M * k / GRIP_STEPS * axis for k in range(1, GRIP_STEPS + 1) for axis in AXES)]
    for turn in yaw_offsets(scene, step) or (0.0,):
        held = attached.after(scene, step, turn).held
        if held is None:
            return False
        gripped = _carried(part, at_flange @ _matrix(held.in_flange) @ np.linalg.inv(_matrix(here)))
        if any(touch(prover, moved(gripped, by), tool) for by in ways):
            return False
    return True


def _air_below(scene: Scene, prover: Prover, step: Place, attached: Attachments) -> tuple[str, float] | None:
    """The highest body below a part that is released in the air, and how far below it is, m; None: the part is put down
    on something, or it is not known what is there when it is.

    Not looked at: places that name what the part rests on, or on frames that move, or beside bodies that move."""
    if step.contact_with is not None or not isinstance(scene.frames[step.target.frame].law, Fixed):
        return None
    t = scene.start.time
    others = [body.name for body in scene.bodies if body.name != step.part]
    if not all(isinstance(scene.frames[attached.pose_of(scene, name)[0]].law, Fixed) for name in others):
        return None
    here = world_pose(scene, step.part, t)
    there = world_pose(scene, step.part, t, (step.target.frame, step.target.pose))
    if here is None or there is None:
        return None
    part = _carried(posed_body(scene, prover, step.part), _matrix(there) @ np.linalg.inv(_matrix(here)))
    sunk, body = moved(part, np.array([0.0, 0.0, -DROP_M])), scene.index[step.part].body
    bottom, highest = there.z + body.heights[0], None
    for name in others:
        old, now = world_pose(scene, name, t), world_pose(scene, name, t, attached.pose_of(scene, name))
        if old is None or now is None or name not in prover.arrangement(AT_START).number:
            return None
        other = scene.index[name].body
        if math.hypot(now.x - there.x, now.y - there.y) > body.radius + other.radius:
            continue
        if touch(prover, sunk, _carried(posed_body(scene, prover, name), _matrix(now) @ np.linalg.inv(_matrix(old)))):
            return None
        gap = bottom - (now.z + other.heights[1])
        if gap > 0.0 and (highest is None or gap < highest[1]):
            highest = name, gap
    return highest


def _overlaps(scene: Scene, prover: Prover) -> list[InputWarning]:
    """Parts that stand, and are inside a body that stands, or inside another such part."""
    t, found, parts = scene.start.time, list[InputWarning](), dict[str, None]()
    held = at_start(scene).held
    for step in scene.task:
        if isinstance(step, Pick) and (held is None or held.part != step.part):
            parts[step.part] = None
    if not parts:
        return []
    numbers = prover.arrangement(AT_START).number
    standing = [body for body in scene.bodies if isinstance(scene.frames[body.frame].law, Fixed)]
    standing = [body for body in standing if body.name in numbers and (held is None or held.part != body.name)]
    for i, one in enumerate(standing):
        for other in standing[i + 1 :]:
            if one.name not in parts and other.name not in parts:
                continue  # fixtures are often made of shapes that overlap
            here, there = world_pose(scene, one.name, t), world_pose(scene, other.name, t)
            if here is None or there is None:
                continue
            if math.hypot(here.x - there.x, here.y - there.y) > one.body.radius + other.body.radius:
                continue
            ones, others = posed_body(scene, prover, one.name), posed_body(scene, prover, other.name)
            if all(touch(prover, moved(ones, OVERLAP_M * axis), others) for axis in AXES):
                found.append(InputWarning(Odd.BODIES_OVERLAP, (one.name, other.name), OVERLAP_M))
    return found[:MOST_OVERLAPS]


def _carried(posed: list[Posed], by: FloatArray) -> list[Posed]:
    """Shapes after a rigid motion `by` (4, 4) in the world."""
    turn, shift = by[:3, :3], by[:3, 3]
    return [replace(each, position=turn @ each.position + shift, axes=turn @ each.axes) for each in posed]


def _matrix(pose: Pose) -> FloatArray:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    return np.array([[c, -s, 0, pose.x], [s, c, 0, pose.y], [0, 0, 1, pose.z], [0, 0, 0, 1.0]])

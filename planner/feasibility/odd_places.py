"""What is probably not meant about where things are: parts released in the air, tools that grip beside their part,
parts that are inside other bodies.

Where a part is put down, and how it is gripped, is what the request says; nothing else would tell that there is air
between. FCL decides, on the true shapes; how far a tool is from its part is measured on convex pieces.
"""

from __future__ import annotations

import math
from operator import itemgetter

import numpy as np

from assur.planner.collision.proof import Prover
from assur.planner.collision.touching import grip
from assur.planner.feasibility.posed_bodies import AtStart, touch
from assur.planner.model.attachments import Attachments, at_start
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
        before, attached = attached, attached.after(scene, step)
        if isinstance(step, Pick):
            found |= dict.fromkeys(_off_part(scene, at.prover, step, before))
        elif isinstance(step, Place):
            found |= dict.fromkeys(_air_below(scene, at, step, attached))
    return (*found, *_overlaps(scene, at))


def _off_part(scene: Scene, prover: Prover, step: Pick, attached: Attachments) -> list[InputWarning]:
    """The body of the tool that is nearest to a part, in the turn in which it is nearest, if that is too far to grip
    it."""
    grips = [grip(prover, step, attached, turn) for turn in yaw_offsets(scene, step) or (0.0,)]
    nearest = min((each for each in grips if each is not None), key=lambda each: each.distance_m, default=None)
    if nearest is None or not nearest.distance_m > GRIP_M:
        return []
    return [InputWarning(Odd.TOOL_OFF_PART, nearest.bodies, nearest.distance_m)]


def _air_below(scene: Scene, at: AtStart, step: Place, attached: Attachments) -> list[InputWarning]:
    """The highest body below a part that is released in the air, `attached` being so then; nothing: the part is put
    down on something, or it is not known what is there when it is.

    Not evaluated: places that name what the part rests on, or on frames that move, or among bodies that move."""
    frames = {attached.pose_of(scene, body.name)[0] for body in scene.bodies}
    if step.contact_with is not None or not all(scene.frames[name].law.is_fixed for name in frames):
        return []
    part, body, there = at.shapes(step.part, attached), scene.index[step.part].body, at.place(step.part, attached)
    below = list[tuple[float, str]]()
    for name in (name for name in scene.index if name != step.part):
        other, now = scene.index[name].body, at.place(name, attached)
        if not math.dist(now[:2], there[:2]) <= body.radius + other.radius:
            continue
        if touch(at.prover, part, at.shapes(name, attached), np.array([0.0, 0.0, -DROP_M])):
            return []
        below.append((float(there[2] + body.heights[0] - now[2] - other.heights[1]), name))
    under = sorted((each for each in below if each[0] > 0.0), key=itemgetter(0))[:1]
    return [InputWarning(Odd.RELEASED_IN_AIR, (step.part, name), gap) for gap, name in under]


def _overlaps(scene: Scene, at: AtStart) -> list[InputWarning]:
    """Parts that never move by themselves, and are inside a body that never does, or inside another such part: the
    first `MOST_OVERLAPS`."""
    held, found = at_start(scene).held, list[InputWarning]()
    still = [body.name for body in scene.bodies if scene.frames[body.frame].law.is_fixed]
    order = {name: i for i, name in enumerate(name for name in still if held is None or held.part != name)}
    pairs = dict[tuple[str, str], tuple[int, int]]()
    for name in {step.part: None for step in scene.task if isinstance(step, Pick) and step.part in order}:
        z, heights = float(at.place(name)[2]), scene.index[name].body.heights
        for other in at.near(name, z + heights[0], z + heights[1]):
            if other in order:
                one, two = sorted((name, other), key=order.__getitem__)
                pairs[one, two] = order[one], order[two]
    # fixtures, which are no parts, are often made of shapes that overlap
    for one, two in sorted(pairs, key=pairs.__getitem__):
        if len(found) < MOST_OVERLAPS and touch(at.prover, at.shapes(one), at.shapes(two), *(OVERLAP_M * AXES)):
            found.append(InputWarning(Odd.BODIES_OVERLAP, (one, two), OVERLAP_M))
    return found

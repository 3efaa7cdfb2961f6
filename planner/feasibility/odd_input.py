"""What is probably not meant: tools that intersect the arm, parts that float above what they should rest on.

Nothing else would tell: links that are no pair of the robot's are not kept apart, and a part that rests on nothing may
touch nothing. FCL decides, on the true shapes, where everything is at the start.
"""

from __future__ import annotations

import numpy as np

from assur.planner.collision.fcl_door import Posed
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.posed_bodies import AtStart, posed, touch
from assur.planner.model.attachments import at_start
from assur.planner.model.input_warning import InputWarning, Odd
from assur.planner.model.phases import CONTACT_M, resting_on
from assur.planner.model.scene import Pick, Scene

MOUNT_M = 0.03
"""By so much along the flange's axis a tool may overlap what it is mounted on, m: a collar round the shaft."""
FLOAT_M = 0.01
"""A part no higher than this above a body, m, is meant to rest on it."""
HALVINGS = 20
"""Of `FLOAT_M`, until the height of a part above what is below it is known: to less than 0.1 µm."""


def odd_input(scene: Scene, at: AtStart) -> tuple[InputWarning, ...]:
    """The warnings of a request: tools first, then parts in the order of the task. Raises `OutOfTimeError` where the
    deadline in force passes."""
    return (*_tools_in_the_arm(scene, at.prover), *_floating_parts(scene, at))


def _tools_in_the_arm(scene: Scene, prover: Prover) -> list[InputWarning]:
    """Bodies of the tool that overlap a link which is no pair with the flange; the flange and the link that bears it
    are what the tool is mounted on."""
    if not scene.tool.bodies:
        return []
    robot, q, t = scene.robot, scene.start.q, scene.start.time
    flange = robot.links.index("flange")
    mounts = {flange, flange - 1}
    apart = {frozenset(map(robot.links.index, links)) for links in robot.self_pairs}
    axis = prover.carriers(q, t)[flange, 3:].reshape(3, 3)[:, 2]
    links = [each for each in robot.bodies if frozenset((each.link, flange)) not in apart]
    shapes = [(each, MOUNT_M if each.link in mounts else 0.0, posed(prover, each.body.name)) for each in links]
    found = []
    for body in scene.tool.bodies:
        own = posed(prover, body.name)
        for each, allowed, others in shapes:
            if touch(prover, own, others, allowed * axis, -allowed * axis):
                found.append(InputWarning(Odd.TOOL_IN_ARM, (body.name, each.body.name), allowed))
    return found


def _floating_parts(scene: Scene, at: AtStart) -> list[InputWarning]:
    """Parts to be picked that rest on nothing at the start, with the body just below them."""
    attached, found, picks = at_start(scene), list[InputWarning](), dict[str, Pick]()
    for step in scene.task:
        if isinstance(step, Pick) and (attached.held is None or attached.held.part != step.part):
            picks.setdefault(step.part, step)
    for part, step in picks.items():
        if not resting_on(scene, part, *attached.point(scene, step), step.contact_with, attached):
            found += [InputWarning(Odd.PART_FLOATS, (part, name), by) for name, by in _just_below(scene, at, part)]
    return found


def _just_below(scene: Scene, at: AtStart, part: str) -> list[tuple[str, float]]:
    """The first body that a part would touch if it sank, and how far it would sink, m; nothing: it touches one already,
    or none within `FLOAT_M`."""
    bottom, own = float(at.place(part)[2]) + scene.index[part].body.heights[0], at.shapes(part)
    found = []
    for other in at.near(part, bottom - FLOAT_M, bottom):
        below = at.shapes(other)

        def sunk(by: float, below: list[Posed] = below) -> bool:
            return touch(at.prover, own, below, np.array([0.0, 0.0, -by]))

        if sunk(CONTACT_M):
            return []
        if sunk(FLOAT_M):
            free, hit = CONTACT_M, FLOAT_M
            for _ in range(HALVINGS):
                middle = (free + hit) / 2
                free, hit = (free, middle) if sunk(middle) else (middle, hit)
            found.append((hit, other))
    return [(name, by) for by, name in sorted(found)[:1]]

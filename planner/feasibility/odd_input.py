"""What is probably not meant: tools that intersect the arm, parts that float above what they should rest on.

Nothing else would tell: links that are no pair of the robot's are not kept apart, and a part that rests on nothing may
touch nothing. FCL decides, on the true shapes, where everything is at the start.
"""

from __future__ import annotations

import numpy as np

from assur.planner.collision.fcl_door import Posed
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.posed_bodies import AtStart, moved, touch
from assur.planner.model.attachments import AT_START, at_start
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
    arrangement = prover.arrangement(AT_START)
    links = [each for each in robot.bodies if frozenset((each.link, flange)) not in apart]
    axis = prover.carriers(q, t)[flange, 3:].reshape(3, 3)[:, 2]
    names = [body.name for body in (*scene.tool.bodies, *(each.body for each in links))]
    units = [unit for name in names for unit in arrangement.pieces(arrangement.number[name])]
    posed: dict[str, list[Posed]] = {name: [] for name in names}
    for piece in prover.posed(arrangement, q, t, np.array(units)):
        posed[piece.name].append(piece)
    found = []
    for body in scene.tool.bodies:
        for each in links:
            allowed = MOUNT_M if each.link in mounts else 0.0
            moves = (allowed * axis, -allowed * axis) if allowed else (np.zeros(3),)
            if all(touch(prover, moved(posed[body.name], by), posed[each.body.name]) for by in moves):
                found.append(InputWarning(Odd.TOOL_IN_ARM, (body.name, each.body.name), allowed))
    return found


def _floating_parts(scene: Scene, at: AtStart) -> list[InputWarning]:
    """Parts to be picked that rest on nothing at the start, with the body just below them."""
    attached, found = at_start(scene), []
    taken = {attached.held.part} if attached.held is not None else set()
    for step in scene.task:
        if not isinstance(step, Pick) or step.part in taken:
            continue
        taken.add(step.part)
        frame, pose = attached.point(scene, step)
        if resting_on(scene, step.part, frame, pose, step.contact_with, attached):
            continue
        below = _just_below(scene, at, step.part)
        if below is not None:
            found.append(InputWarning(Odd.PART_FLOATS, (step.part, below[0]), below[1]))
    return found


def _just_below(scene: Scene, at: AtStart, part: str) -> tuple[str, float] | None:
    """The first body that a part would touch if it sank, and how far it would sink, m; None: it touches one already,
    or none within `FLOAT_M`."""
    here = at.pose(part)
    if here is None:
        return None
    bottom = here.z + scene.index[part].body.heights[0]
    posed = at.shapes(part)
    nearest: tuple[float, str] | None = None
    for other in at.near(part, bottom - FLOAT_M, bottom):
        below = at.shapes(other)

        def sunk(by: float, below: list[Posed] = below) -> bool:
            return touch(at.prover, moved(posed, np.array([0.0, 0.0, -by])), below)

        if sunk(CONTACT_M):
            return None
        if sunk(FLOAT_M):
            free, hit = CONTACT_M, FLOAT_M
            for _ in range(HALVINGS):
                middle = (free + hit) / 2
                free, hit = (free, middle) if sunk(middle) else (middle, hit)
            nearest = min(nearest or (hit, other), (hit, other))
    return None if nearest is None else (nearest[1], nearest[0])

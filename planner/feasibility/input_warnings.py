"""What is probably not meant: tools that intersect the arm, parts that float above what they should rest on.

Nothing else would tell: links that are no pair of the robot's are not kept apart, and a part that rests on nothing may
touch nothing. FCL decides, on the true shapes, where everything is at the start.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from assur.planner.checker.refusals.ways import ways
from assur.planner.collision.fcl_entry import PlacedShape
from assur.planner.collision.proof import Prover
from assur.planner.collision.touching import apart, grip
from assur.planner.feasibility.hits import AtStart, always, posed, touch
from assur.planner.geometry.shapes import Body, support
from assur.planner.model.arrival_error import Cause
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.input_warning import InputWarning, WarningKind
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import CONTACT_M, resting_on, yaw_offsets
from assur.planner.model.scene import Pick, Place, Scene

MOUNT_M = 0.03
"""By so much along the flange's axis a tool may overlap what it is mounted on, m: a collar round the shaft."""
FLOAT_M = 0.01
"""A part no higher than this above a body, m, is meant to rest on it."""
HALVINGS = 20
"""Of `FLOAT_M`, until the height of a part above what is below it is known: to less than 0.1 µm."""


def unusual_bodies(scene: Scene, at: AtStart) -> tuple[InputWarning, ...]:
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
                found.append(InputWarning(WarningKind.TOOL_IN_ARM, (body.name, each.body.name), allowed))
    return found


def _floating_parts(scene: Scene, at: AtStart) -> list[InputWarning]:
    """Parts to be picked that rest on nothing at the start, with the body just below them."""
    attached, found, picks = at_start(scene), list[InputWarning](), dict[str, Pick]()
    for step in scene.task:
        if isinstance(step, Pick) and (attached.held is None or attached.held.part != step.part):
            picks.setdefault(step.part, step)
    for part, step in picks.items():
        if not resting_on(scene, part, *attached.point(scene, step), step.contact_with, attached):
            found += [
                InputWarning(WarningKind.PART_FLOATS, (part, name), by) for name, by in _just_below(scene, at, part)
            ]
    return found


def _just_below(scene: Scene, at: AtStart, part: str) -> list[tuple[str, float]]:
    """The first body that a part would touch if it sank, and how far it would sink, m; nothing: it touches one already,
    or none within `FLOAT_M`."""
    bottom, own = float(at.place(part)[2]) + scene.index[part].body.heights[0], at.shapes(part)
    found = []
    for other in at.near(part, bottom - FLOAT_M, bottom):
        below = at.shapes(other)

        def sunk(by: float, below: list[PlacedShape] = below) -> bool:
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


# What is probably not meant about how exactly parts are met: picks that may miss their part.

DIRECTIONS = 180
"""Horizontal directions in which the extent of a part is taken, 1° apart, its own axes among them."""


def unusual_arrivals(scene: Scene, arrivals: Sequence[Arrival]) -> tuple[InputWarning, ...]:
    """A warning for each pick without a tolerance of its position where the tool may be farther from the part than half
    of the part's smallest horizontal extent. Raises `OutOfTimeError` where the deadline in force passes."""
    found = []
    for arrival in arrivals:
        step, error = scene.task[arrival.step], arrival.error
        if not isinstance(step, Pick) or error is None or not math.isinf(step.tolerance.position_m):
            continue
        if error.position_m > smallest_extent(scene.index[step.part].body) / 2.0:
            most = max(error.shares, key=lambda share: share.position_m, default=None)
            cause = "" if most is None else str(most.cause)
            if most is not None and most.cause is Cause.FRAME:
                cause = f"frame {ways(scene, arrival.step)[0].frame}"
            bodies = scene.tool.bodies[0].name if scene.tool.bodies else scene.robot.links[-1], step.part
            found.append(InputWarning(WarningKind.MAY_MISS, bodies, error.position_m, step.name, cause))
    return tuple(found)


def smallest_extent(body: Body) -> float:
    """The smallest width of a body between two parallel vertical planes, m; up to 1 % too large for shapes that lie
    askew in their body's frame, as it is looked for in steps of 1°."""
    widths = []
    for angle in np.pi * np.arange(DIRECTIONS) / DIRECTIONS:
        raise_if_late()
        n = np.array([np.cos(angle), np.sin(angle), 0.0])
        widths.append(
            max(support(piece, n) for piece in body.pieces) + max(support(piece, -n) for piece in body.pieces)
        )
    return float(min(widths))


# What is probably not meant about where things are: parts released in the air, tools that grip beside their part, parts
# that are inside other bodies.
#
# Where a part is put down, and how it is gripped, is what the request says; nothing else would tell that there is air
# between. FCL decides, on the true shapes; how far a tool is from its part is measured on convex pieces.

DROP_M = 0.002
"""A part that has nothing within this below it is released in the air, m: so far some grippers drop it on purpose."""
GRIP_M = 0.01
"""A tool that is farther than this from its part does not grip it, m: jaws that are open leave a few millimetres."""
OVERLAP_M = 0.001
"""By so much a body may be inside another, m: it was placed by hand."""
MOST_OVERLAPS = 5
"""Maximum number of overlap warnings: more come from a model that is made so."""
AXES = np.concatenate([np.eye(3), -np.eye(3)])


def unusual_places(scene: Scene, at: AtStart) -> tuple[InputWarning, ...]:
    """The warnings about picks and places, in the order of the task, and then about bodies that overlap.

    Raises `OutOfTimeError` where the deadline in force passes."""
    attached, found = at_start(scene), dict[InputWarning, None]()
    for step in scene.task:
        raise_if_late()
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
    tcp = scene.tool.tcp.z
    beyond = all(tcp * body.spread.centroid[2] < 0.0 for body in scene.tool.bodies)
    cause = f"tcp is at z {1e3 * tcp:.4g} mm, and all bodies of the tool are on the other side of the flange"
    return [InputWarning(WarningKind.TOOL_OFF_PART, nearest.bodies, nearest.distance_m, cause=cause if beyond else "")]


def _air_below(scene: Scene, at: AtStart, step: Place, attached: Attachments) -> list[InputWarning]:
    """The highest body below a part that is released in the air, `attached` being so then, of those onto which it would
    sink, if there are any; nothing: the part is put down on something, or it is not known what is there when it is.

    Not evaluated: places that name what the part rests on, or on frames that move, or among bodies that move."""
    frames = {attached.pose_of(scene, body.name)[0] for body in scene.bodies}
    if step.contact_with is not None or not all(scene.frames[name].law.is_fixed for name in frames):
        return []
    part, body, there = at.shapes(step.part, attached), scene.index[step.part].body, at.place(step.part, attached)
    below = list[tuple[bool, float, str]]()
    for name in (name for name in scene.index if name != step.part):
        other, now = scene.index[name].body, at.place(name, attached)
        if not math.dist(now[:2], there[:2]) <= body.radius + other.radius:
            continue
        if touch(at.prover, part, at.shapes(name, attached), np.array([0.0, 0.0, -DROP_M])):
            return []
        gap = float(there[2] + body.heights[0] - now[2] - other.heights[1])
        if gap > 0.0:
            sunk = np.array([0.0, 0.0, -gap - DROP_M])
            below.append((not touch(at.prover, part, at.shapes(name, attached), sunk), gap, name))
    return [InputWarning(WarningKind.RELEASED_IN_AIR, (step.part, name), gap) for _, gap, name in sorted(below)[:1]]


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
            found.append(InputWarning(WarningKind.BODIES_OVERLAP, (one, two), OVERLAP_M))
    return found


# What is probably not meant about what a part rests on: bodies that `contact_with` names and it does not touch.

OFF_M = 0.002
"""A part that is no farther than this from its stated support is dropped on purpose, as some grippers do, or
measured so, m."""


def unusual_supports(scene: Scene, prover: Prover, arrivals: Sequence[Arrival]) -> tuple[InputWarning, ...]:
    """A warning for each body that a pick or place names as touched by its part and that is farther than `OFF_M` from
    it, in the order of the task. What moves against the part is checked where there is an arrival. Raises
    `OutOfTimeError` where the deadline in force passes."""
    attached, found = at_start(scene), list[InputWarning]()
    until = {arrival.step: arrival.until for arrival in arrivals}
    for number, step in enumerate(scene.task):
        raise_if_late()
        before, attached = attached, attached.after(scene, step)
        if not isinstance(step, Pick | Place) or not step.contact_with:
            continue
        time = scene.start.time if always(scene, step, before) else until.get(number)
        if time is None:
            continue
        # a part that is picked is still where it is, one that is placed is there already
        here = before if isinstance(step, Pick) else attached
        for name in step.contact_with:
            distance = apart(prover, here, time, step.part, name)
            if distance > OFF_M:
                found.append(InputWarning(WarningKind.SUPPORT_OFF_PART, (step.part, name), distance, step.name))
    return tuple(found)

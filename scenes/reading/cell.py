"""A request becomes a scene: robot, frames, neighbours, bodies, task, in this order, each at its own door."""

from __future__ import annotations

from dataclasses import dataclass

from assur.planner.model.deadline import look
from assur.planner.model.scene import (
    Clearance,
    ClearanceException,
    Execution,
    Options,
    Pick,
    Scene,
    check_tool_point,
)
from assur.planner.robots.robot import Robot
from assur.scenes.conventions import Conventions, signs, zeros
from assur.scenes.faults import Refused, choices, located, within
from assur.scenes.reading import bodies, frames, loads, neighbours, robots, task
from assur.scenes.reading.start import check_loaded, moved_to_limits, start_of
from assur.scenes.schema.request import ExecutionDocument, OptionsDocument, RequestDocument


@dataclass(frozen=True, eq=False)
class Cell:
    """A scene, what it was made of (the robot, its frames, where its bodies sit), and the request as it was written."""

    scene: Scene
    given: robots.Equipped
    frames: frames.Frames
    places: bodies.Places
    document: object

    @property
    def conventions(self) -> Conventions:
        """How the maker counts the joints, for the answer."""
        return self.given.conventions


def cell_of(document: object, request: RequestDocument) -> Cell:
    """The cell of a request; `document` is the request as it was written, for the fields that errors name.

    Raises `DocumentError` for what has no meaning: unknown names, wider limits, joints left out, a mesh that is open.
    Not checked here: whether anything can be planned. Raises `OutOfTimeError` where the deadline in force has passed
    before all bodies are made.
    """
    with located(document):
        return _cell_of(document, request)


def _cell_of(document: object, request: RequestDocument) -> Cell:
    with within("robot"):
        given = robots.equipped(request.robot)
    robot, tool = given.robot, given.tool
    check_tool_point(robot, tool)
    with within("frames"):
        known = frames.frames_of(request.frames)
    places: bodies.Places = {}
    own = [body.body.name for body in robot.bodies] + [body.name for body in tool.bodies]
    for i, body in enumerate(request.robot.tool.bodies):
        if own.count(body.name) > 1:
            raise Refused("a name that no other body has", "robot", "tool", "bodies", i, "name")
    held = None if request.start.holding is None else request.start.holding.part
    surroundings = []
    for i, item in enumerate(request.neighbours):
        look()
        with within("neighbours", i):
            if item.name in {other.name for other in request.neighbours[:i]}:
                raise Refused("a name that no other neighbour has", "name")
            surroundings += neighbours.add_neighbour(item, known.laws, places)
    taken = set(own)
    for i, named in enumerate(request.bodies):
        look()
        with within("bodies", i):
            if named.name in taken:
                raise Refused("a name that no body of the robot or its tool has", "name")
            surroundings.append(bodies.world_body(named, known, places, held))
    if held is not None and held not in places:
        raise Refused(f"the name of a body: {choices(places, held)}", "start", "holding", "part")
    with within("start"):
        start = start_of(request.start, given, known, places)
    steps = task.steps_of(request.task, known, places, robot.coordinates, held, solid_tool=bool(tool.bodies))
    taken_up = {step.part for step in steps if isinstance(step, Pick)} | ({held} if held else set())
    _check_riders(request, taken_up)
    carry = None if request.carry is None else request.carry.acceleration_m_s2
    scene = Scene(
        robot=robot,
        tool=tool,
        start=start,
        frames=known.laws,
        bodies=tuple(surroundings),
        task=steps,
        options=_options(request.options, robot.modes, [*own, *(body.name for body in surroundings)]),
        execution=_execution(request.execution, given.conventions),
        carry_acceleration=carry,
        load_limits=given.load,
        forbidden_yaw=given.forbidden_yaw,
        assumptions=(
            *robots.assumptions_of(document, request.robot),
            *moved_to_limits(request.start.joints, start, given.conventions),
            *frames.assumptions_of(request.frames),
            *_left_out(robot, request),
            *loads.assumptions_of(robot, given.load, tool, [body for body in surroundings if body.name in taken_up]),
        ),
        digest=request.digest,
        signs=signs(given.conventions),
        zeros=zeros(given.conventions),
    )
    check_loaded(scene, given.conventions)
    return Cell(scene, given, known, places, document)


NO_SOLIDS = "the tool has no bodies: nothing is kept clear of it between flange and tool point"
"""What an answer says where a tool has a length alone."""
NO_PAIRS = "no pair of self_pairs names the flange: nothing keeps tool and part clear of the robot's own arm"
"""What an answer says of an arm that may reach into itself."""
NO_LAG = "{}: its links count as exactly where its trajectory has them, at its time; no lag of its servos can be stated"
"""What an answer says of another robot."""
NO_BODIES = "the arm has no bodies: nothing is kept clear of its links"
"""What an answer says of an arm that is lengths alone, as a file without collision shapes is imported."""


def _left_out(robot: Robot, request: RequestDocument) -> tuple[str, ...]:
    """What the request leaves out and no plan knows."""
    tool = request.robot.tool
    found = [] if robot.bodies else [NO_BODIES]
    if any(tool.tcp_m) and not tool.bodies:
        found.append(NO_SOLIDS)
    if tool.bodies and robot.bodies and not any("flange" in links for links in robot.self_pairs):
        found.append(NO_PAIRS)
    return (*found, *(NO_LAG.format(other.name) for other in request.neighbours))


def _check_riders(request: RequestDocument, picked: set[str]) -> None:
    """A body whose place is told by a part would stay behind when that part is picked up."""
    for i, body in enumerate(request.bodies):
        if body.pose is not None and body.pose.body in picked:
            raise Refused("a body that no step picks", "bodies", i, "pose", "body")


def _execution(item: ExecutionDocument, conventions: Conventions) -> Execution:
    with within("execution", "lag"):
        lag = robots.lag(item.lag, conventions)
    return Execution(lag, item.start_tolerance_s, item.belt_correction)


def _options(item: OptionsDocument, modes: tuple[str, ...], names: list[str]) -> Options:
    if item.elbow not in ("keep", "auto", *modes):
        raise Refused(f"one of keep, auto, {', '.join(modes)}", "options", "elbow")
    exceptions = []
    for i, each in enumerate(item.clearance_exceptions):
        for key, given in (("between", each.between), ("and", each.and_ or ())):
            for k, name in enumerate(given):
                if name not in names:
                    there = choices(names, name)
                    raise Refused(f"the name of a body: {there}", "options", "clearance_exceptions", i, key, k)
        both = frozenset(each.between), frozenset(each.and_ or ())
        exceptions.append(ClearanceException(*both, each.clearance_m.travel, each.clearance_m.near))
    return Options(
        seed=item.seed,
        budget_s=item.budget_s,
        max_candidates=item.max_candidates,
        stop=item.stop,
        explain_budget_s=item.explain_budget_s,
        clearance=Clearance(item.clearance_m.travel, item.clearance_m.near, tuple(exceptions)),
        singularity_margin=item.singularity_margin,
        elbow=item.elbow,
        end=item.end,
        stay_safe_s=item.stay_safe_s,
        latest_end_s=item.latest_end_s,
        timing=item.timing,
        acceleration_time_s=item.acceleration_time_s,
    )

"""A request becomes a scene: robot, frames, neighbours, bodies, task, in this order, each in a module of its own."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from threading import Lock

from assur.planner.errors import FaultError, InputError
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.kept import NOTHING_KEPT, KeptCell
from assur.planner.model.scene import (
    Clearance,
    ClearanceException,
    Execution,
    Options,
    Pick,
    Scene,
    Start,
    Step,
    WorldBody,
    check_tool_point,
)
from assur.planner.robots.robot import Robot
from assur.scenes.conventions import Conventions
from assur.scenes.faults import FAULTS, FollowsError, Gathered, Refused, choices, located
from assur.scenes.reading import bodies, frames, loads, neighbours, robots, task
from assur.scenes.reading.bodies import Places
from assur.scenes.reading.frames import Frames
from assur.scenes.reading.partly import PartlyRead
from assur.scenes.reading.start import check_loaded, start_of
from assur.scenes.schema.in_parts import Unread
from assur.scenes.schema.request import OptionsDocument, RequestDocument
from assur.scenes.schema.robots import RobotDocument
from assur.scenes.schema.shapes import BodyDocument, PlaceInCell

Depends = tuple[str | None, float | None]
"""On what surroundings depend besides their documents: the part that the gripper holds at the start; and the time of
the start, s, where a pose has a time and how far its frame has gone since then is uncertain."""
MOST_CELLS, MOST_TRIANGLES = 16, 200_000
"""Cells that are kept, those that were read last, and triangles of meshes in all of them together, with the knots of
neighbours: with rings of 40,000 triangles they took about 50 MB. A cell with more triangles is not kept."""
_kept: OrderedDict[tuple[str, Depends], Surroundings] = OrderedDict()
_lock = Lock()


@dataclass(eq=False)
class Surroundings:
    """A robot (None where it could not be read) and what is around it: its `frames`, bodies, and where these are.
    `kept`: what the planner made of the cell."""

    given: robots.RobotWithTool | None
    frames: Frames
    bodies: tuple[WorldBody, ...]
    places: Places
    kept: KeptCell = NOTHING_KEPT

    @cached_property
    def triangles(self) -> int:
        """Triangles of the meshes, and knots of the neighbours."""
        found = 0
        for frame in self.frames.laws.values():
            found += 0 if frame.law.link is None else len(frame.law.link.trajectory.time)
        solids = [each.body for each in self.bodies]
        if self.given is not None:
            solids += [*(each.body for each in self.given.robot.bodies), *self.given.tool.bodies]
        for body in solids:
            found += 0 if body.surface is None else len(body.surface[1])
        return found

    def with_parts(self, parts: Sequence[BodyDocument], depends: Depends) -> Surroundings:
        """The same with further bodies, and what the planner made of the cell. Raises `Refused` at the fields of a
        part."""
        if self.given is None:
            raise FaultError("parts are added to a cell that could be read")
        (held, start_s), places, found = depends, Places(self.places), list[WorldBody]()
        for item in parts:
            raise_if_late()
            if item.name in self.given.names:
                raise Refused("a name that no body of the robot or its tool has", "name")
            found.append(bodies.world_body(item, self.frames, places, held, start_s))
        if held is not None and held not in places:
            raise Refused("the name of a body")
        kept = self.kept
        if kept is NOTHING_KEPT:
            kept = self.kept = KeptCell(self.given.robot, self.given.tool, self.frames.laws, self.bodies)
        return Surroundings(self.given, self.frames, (*self.bodies, *found), places, kept)


Kept = dict[Depends, Surroundings]
"""Robot and surroundings of the requests of one cell."""


@dataclass(frozen=True, eq=False)
class Cell:
    """A scene, what it was made of (the robot, its frames, where its bodies sit), and the request: as it was written,
    and in SI."""

    scene: Scene
    given: robots.RobotWithTool
    frames: Frames
    places: Places
    document: object
    request: RequestDocument

    @property
    def conventions(self) -> Conventions:
        """How the maker counts the joints, for the answer."""
        return self.given.conventions


def cell_of(document: object, request: RequestDocument, own: Kept | None = None) -> Cell:
    """The cell of a request; `document` is the request as it was written, for the fields that errors name. `own`: what
    was made of requests with the same robot and surroundings.

    Raises `DocumentError` for what has no meaning: unknown names, wider limits, joints left out, a mesh that is open.
    Not checked here: whether anything can be planned. Raises `OutOfTimeError` where the deadline in force has passed
    before all bodies are made.
    """
    with located(document):
        return _cell_of(document, request, {} if own is None else own)


def look_up(document: object, request: PartlyRead) -> None:
    """Raises `DocumentError` for what has no meaning in a request with parts that could not be read."""
    faults = Gathered()
    with located(document):
        _task_of(request, _surroundings(request, request.depends, faults), request.depends[0], faults)
        if faults.faults:
            faults.settle()


def _cell_of(document: object, request: RequestDocument, own: Kept) -> Cell:
    faults = Gathered()
    held = None if request.start.holding is None else request.start.holding.part
    depends = depends_of(request)
    surroundings = own.get(depends)
    if surroundings is None:
        surroundings = around(request, depends, faults)
        if not faults.faults:
            if len(own) >= MOST_CELLS:
                own.clear()
            own[depends] = surroundings
    start, moved, steps, options, lag = _task_of(request, surroundings, held, faults)
    faults.settle()
    given, known, places = surroundings.given, surroundings.frames, surroundings.places
    if given is None or start is None or options is None:
        raise FaultError("a robot, a start or options that could not be read have no fault")
    robot, tool = given.robot, given.tool
    taken_up = {step.part for step in steps if isinstance(step, Pick)} | ({held} if held else set())
    if taken_up:
        _check_picked(request, taken_up)
    carry = None if request.carry is None else request.carry.acceleration_m_s2
    scene = Scene(
        robot=robot,
        tool=tool,
        start=start,
        frames=known.laws,
        bodies=surroundings.bodies,
        task=steps,
        options=options,
        execution=Execution(lag, request.execution.start_tolerance_s, request.execution.belt_correction),
        carry_acceleration=carry,
        load_limits=given.load,
        forbidden_yaw=given.forbidden_yaw,
        assumptions=(
            *robots.assumptions_of(document, request.robot),
            *moved,
            *frames.assumptions_of(request.frames),
            *task.assumptions_of(steps),
            *_left_out(robot, request),
            *loads.assumptions_of(
                robot, given.load, tool, [body for body in surroundings.bodies if body.body.name in taken_up]
            ),
        ),
        digest=request.digest,
        signs=tuple(given.conventions.signs.tolist()),
        zeros=tuple(given.conventions.zeros.tolist()),
        kept=surroundings.kept,
    )
    surroundings.kept = scene.kept
    check_loaded(scene, given.conventions)
    return Cell(scene, given, known, places, document, request)


def _task_of(
    request: RequestDocument | PartlyRead, around: Surroundings, held: str | None, faults: Gathered
) -> tuple[Start | None, tuple[str, ...], tuple[Step, ...], Options | None, tuple[float, ...]]:
    """Start, what is assumed of it, steps, options and lag of a request; those that take a robot are None, and the lag
    is empty, where there is none."""
    given, known, places = around.given, around.frames, around.places
    start, moved, options, lag = None, tuple[str, ...](), None, tuple[float, ...]()
    if given is not None and not isinstance(request.start, Unread):
        with faults.part("start"):
            start, moved = start_of(request.start, given, known, places)
    solid_tool = isinstance(request.robot, Unread) or bool(request.robot.tool.bodies)
    coordinates = None if given is None else given.robot.coordinates
    steps = task.steps_of(request.task, known, places, coordinates, held, faults, solid_tool=solid_tool)
    if given is not None:
        options = _options(request.options, given, places, faults)
        if not isinstance(request.execution, Unread) and request.execution.lag is not None:
            with faults.part("execution", "lag"):
                lag = robots.lag(request.execution.lag, given.conventions)
    return start, moved, steps, options, lag


def _robot(item: RobotDocument, faults: Gathered) -> robots.RobotWithTool | None:
    """The robot with its tool; None where it cannot be read, which `faults` have."""
    try:
        given = robots.equipped(item)
        for i, body in enumerate(item.tool.bodies):
            if given.names.count(body.name) > 1:
                raise Refused("a name that no other body has", "tool", "bodies", i, "name")
    except FAULTS as error:
        faults.add(error, "robot")
        return None
    try:
        check_tool_point(given.robot, given.tool)
    except InputError as error:
        faults.add(error)
    return given


def depends_of(request: RequestDocument) -> Depends:
    """On what the surroundings of a request depend besides their documents."""
    held = None if request.start.holding is None else request.start.holding.part
    return held, start_of_drift(request, request.start.at_s)


def start_of_drift(request: RequestDocument, start_s: float) -> float | None:
    """The time of the start, if a pose has a time and the speed of a frame is uncertain."""
    uncertain = any(frame.uncertainty.speed_m_s > 0.0 for frame in request.frames.values())
    if uncertain and any(body.pose is not None and body.pose.at_s is not None for body in request.bodies):
        return start_s
    return None


def around(request: RequestDocument, depends: Depends, faults: Gathered) -> Surroundings:
    """The robot and what is around it, kept from an earlier request if that has the same there."""
    key = request.cell, depends
    with _lock:
        if key in _kept:
            _kept.move_to_end(key)
            return _kept[key]
    made = _surroundings(request, depends, faults)
    if not faults.faults:
        with _lock:
            _kept[key] = made
            while len(_kept) > MOST_CELLS or sum([each.triangles for each in _kept.values()]) > MOST_TRIANGLES:
                _kept.popitem(last=False)
    return made


def _surroundings(request: RequestDocument | PartlyRead, depends: Depends, faults: Gathered) -> Surroundings:
    """The robot, the frames, and the bodies of neighbours and of the cell."""
    held, start_s = depends
    given = None if isinstance(request.robot, Unread) else _robot(request.robot, faults)
    own = () if given is None else given.names
    known, places, found, names = frames.frames_of(request.frames, faults), Places(), list[WorldBody](), set[str]()
    for i, item in enumerate(request.neighbours):
        raise_if_late()
        if isinstance(item, Unread):
            places.unread.add(item.text("name"))
            continue
        try:
            if item.name in names:
                raise Refused("a name that no other neighbour has", "name")
            names.add(item.name)
            found += neighbours.add_neighbour(item, known.laws, places)
        except FAULTS as error:
            places.unread.add(item.name)
            faults.add(error, "neighbours", i)
    known.unread.update(places.unread)
    lost = set[str]()
    if held not in (None, *(each.text("name") if isinstance(each, Unread) else each.name for each in request.bodies)):
        # one of these is the part that is held, under a name that is misspelt
        lost = {each.name for each in request.bodies if not isinstance(each, Unread) and each.pose is None}
    for i, named in enumerate(request.bodies):
        raise_if_late()
        if isinstance(named, Unread):
            if (pose := named.part(PlaceInCell, "pose")) is not None:
                with faults.part("bodies", i, "pose"):
                    bodies.named(pose, known, places)
            places.unread.add(named.text("name"))
            continue
        try:
            if named.name in own:
                raise Refused("a name that no body of the robot or its tool has", "name")
            if named.name in lost:
                raise FollowsError
            found.append(bodies.world_body(named, known, places, held, start_s))
        except FAULTS as error:
            places.unread.add(named.name)
            faults.add(error, "bodies", i)
    if held is not None and held not in places:
        with faults.part("start", "holding"):
            places.hold(held)
            raise Refused(f"the name of a body: {choices({*places, *lost}, held)}", "part")
    return Surroundings(given, known, tuple(found), places)


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


def _check_picked(request: RequestDocument, picked: set[str]) -> None:
    """A body whose pose is relative to a part would stay behind when that part is picked up; and the gripper holds
    parts upright."""
    for i, body in enumerate(request.bodies):
        if body.pose is None:
            continue
        if body.pose.body in picked:
            raise Refused("a body that no step picks", "bodies", i, "pose", "body")
        if body.name in picked and (tilt := bodies.tilts(body.pose)):
            raise Refused(f"0: a step picks {body.name}, and parts stay upright", "bodies", i, "pose", tilt[0])


def _options(item: OptionsDocument, of: robots.RobotWithTool, places: Places, faults: Gathered) -> Options:
    if item.elbow not in ("keep", "auto", *of.robot.modes):
        faults.add(Refused(f"one of keep, auto, {', '.join(of.robot.modes)}", "options", "elbow"))
    exceptions, names = [], [*of.names, *places]
    for i, each in enumerate(item.clearance_exceptions):
        for key, given in (("between", each.between), ("and", each.and_ or ())):
            for k, name in enumerate(given):
                if name not in names:
                    with faults.part("options", "clearance_exceptions", i, key, k):
                        places.hold(name)
                        raise Refused(f"the name of a body: {choices(names, name)}")
        both = frozenset(each.between), frozenset(each.and_ or ())
        exceptions.append(ClearanceException(*both, each.clearance_m.travel, each.clearance_m.near))
    same = {**vars(item)}
    del same["clearance_m"], same["clearance_exceptions"]
    return Options(clearance=Clearance(item.clearance_m.travel, item.clearance_m.near, tuple(exceptions)), **same)

"""What comes after a plan: a task, or a request, that begins in the state in which the plan ends.

State of the robot, clock, what the gripper holds, and where each part lies now are of the plan. How well a part is
known that was handled is what the plan proves of it. A body on a frame whose speed is not known well is known less well
when the next task begins: the frame may have been off for all of the plan.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_SLOTS
from assur.scenes.conventions import Conventions, as_maker, rates_as_maker
from assur.scenes.faults import NOTHING, DocumentError, Refused, fault, raised_as, written_key
from assur.scenes.schema.cell_file import TASK, CellDocument, TaskDocument
from assur.scenes.schema.differences import difference, stated_at
from assur.scenes.schema.normal import normal
from assur.scenes.schema.read import read
from assur.scenes.schema.request import RequestDocument
from assur.scenes.schema.shapes import PlaceInCell
from assur.scenes.set_values import GIVEN, with_values
from assur.scenes.tasks.grids import counts, slot_poses
from assur.scenes.tasks.joining import CellFile, joined, shared
from assur.scenes.tasks.origins import OF_CELL, OF_TASK, Carried, Joined, Origins, within_document
from assur.scenes.tasks.parts_of_plan import PLACES, check_kinds_of_picked, check_same_bodies, check_there
from assur.scenes.units import si_key

if TYPE_CHECKING:
    from assur.planner.frames.motion import Pose
    from assur.planner.model.outcome import Arrival, Leg
    from assur.planner.model.phases import LegPhases
    from assur.planner.trajectory import Trajectory
    from assur.scenes.reading.cell import Cell

Document = dict[str, Any]
BEYOND_SLOTS = ("at_s", "pitch_deg", "pitch_rad", "roll_deg", "roll_rad")
"""Fields of a pose that no slot has: a part with one of them keeps its pose."""
SAME = ("robot", "frames", "neighbours")
"""Fields of the request of a plan that the request of the next task has as well: the state of the plan is one of
them."""


@dataclass(frozen=True, eq=False)
class EndState:
    """The state in which the plan for `request` ends, in the `cell` of that; `document`: the request as written.

    `start`: the state as the start of what comes next. `uncertainty`: of each body that was handled, or is known less
    well than at the start of the plan. `handled`: bodies that were gripped. `gone`: parts that were taken away.
    `places`: frame and pose of every other body; of the part that is `held` those from which it was taken.
    """

    document: Document
    request: RequestDocument
    start: Document
    uncertainty: Mapping[str, Document]
    handled: frozenset[str]
    gone: frozenset[str]
    gone_at_s: Mapping[str, float]
    places: Mapping[str, tuple[str, Pose]]
    held: str | None
    cell: Cell

    def taken(self, name: str) -> str:
        """That one of the parts that are `gone` was taken away, and when, in words."""
        return f"the plan has placed {name}, and it was taken away at {self.gone_at_s[name]:.3f} s"

    def body(self, written: Document, slots: Mapping[tuple[object, ...], Document]) -> Document:
        """A body or a part at the end of the plan. `written`: at its start, or without a place. `slots`: that in which
        a part is at a frame and a pose."""
        name = written["name"]
        placed = {key: value for key, value in written.items() if key not in PLACES}
        if name in self.uncertainty:
            placed["uncertainty"] = self.uncertainty[name]
        if name == self.held:
            return placed
        frame, pose = self.places[name]
        slot = slots.get(_key(frame, pose))
        own = None if name in self.handled else written.get("pose")
        if slot is not None and (own is None or not own.keys() & {*BEYOND_SLOTS}):
            return {**placed, "slot": slot}
        if own is not None:
            return {**placed, "pose": own}
        return {**placed, "pose": {"frame": frame, "at_m": [pose.x, pose.y, pose.z], "yaw_rad": pose.yaw}}


def end_state(request: Document, answer: object) -> EndState:
    """The state in which the plan in an answer to a request ends. The plan is not checked here. Raises `InputError`
    naming the field of the request, or one below `plan`."""
    return state_at(request, answer, None)


def state_at(request: Document, answer: object, at_s: float | None) -> EndState:
    """As `end_state`, and as `state_of`."""
    from assur.planner.model.phases import leg_phases
    from assur.scenes.reading.plan import PLAN, motion_of
    from assur.scenes.requests import cell_of, refused

    if refused(answer) or not isinstance(answer, dict):
        raise DocumentError(PLAN, answer, "an answer with a plan: nothing comes after one that has none")
    cell = cell_of(request)
    digest = cell.request.digest
    if answer.get("request_digest", digest) != digest:
        raise DocumentError(f"{PLAN}.request_digest", answer["request_digest"], f"{digest}, that of the request")
    motion, legs, arrivals = motion_of(answer, cell.conventions)
    if not legs:
        raise DocumentError(f"{PLAN}.legs", [], "the parts of the motion: at least one")
    for i, leg in enumerate(legs):
        if leg.step >= len(cell.scene.task):
            raise DocumentError(
                f"{PLAN}.legs[{i}].step", leg.step, f"a step of the request, 0 to {len(cell.scene.task) - 1}"
            )
    for i, each in enumerate(answer["arrivals"]):
        if "error" not in each:
            raise DocumentError(f"{PLAN}.arrivals[{i}].error", NOTHING, "how far the tool may be off, or null")
    return state_of(cell, motion, legs, arrivals, leg_phases(cell.scene, legs, arrivals), at_s)


def state_of(
    cell: Cell,
    trajectory: Trajectory,
    legs: tuple[Leg, ...],
    arrivals: tuple[Arrival, ...],
    of_legs: LegPhases,
    at_s: float | None,
) -> EndState:
    """The state of a plan in a cell at an instant, s, at which it is left: as if it ended there (None: where it ends).
    `of_legs`: the phases of its legs (`leg_phases`). Raises `InputError` for an instant at which it may not be left
    (`left_at`), naming `at_s`."""
    from assur.planner.laws.law import PoseUncertainty
    from assur.planner.model.phases import gone_from, on_way, parts_gone
    from assur.planner.model.task import is_taken_away
    from assur.scenes.reading.bodies import drifted
    from assur.scenes.reading.plan import PLAN
    from assur.scenes.tasks.instants import left_at

    scene, stated = cell.scene, cell.request
    if at_s is None:
        end_s = trajectory.end
        _, attached, known = of_legs
        if belts := on_way(scene, len(scene.task)):
            allowed = (
                f"one whose last pick, place or follow is not corrected: behind a point on {' and '.join(belts)}, "
                f"belt_correction may have shifted the arm, and nobody knows by how much"
            )
            raise DocumentError(PLAN, "this plan", allowed)
    else:
        end_s = at_s
        attached, known = left_at(scene, trajectory, legs, arrivals, of_legs, at_s)
    gone = parts_gone(scene, arrivals, end_s)
    met = [(each.until, scene.task[each.step]) for each in arrivals if each.until <= end_s]
    gone_at_s = {str(step.part): gone_from(scene, step, until) for until, step in met if is_taken_away(step)}
    uncertainty = {name: asdict(each) for name, each in known.within if name not in gone}
    handled = gone.union(uncertainty)
    start = _start(trajectory, end_s, cell.conventions)
    held = attached.held
    if held is not None:
        grasp = held.in_flange.inverse().then(scene.tool.tcp)
        at = {"grasp_m": [grasp.x, grasp.y, grasp.z], "grasp_yaw_rad": grasp.yaw}
        start["holding"] = {"part": held.part, **at, "within": uncertainty.pop(held.part)}
    places = {body.name: attached.pose_of(scene, body.name) for body in scene.bodies if body.name not in gone}
    for body in [body for body in stated.bodies if body.name not in gone]:
        if uncertainty.get(body.name) == vars(body.uncertainty):
            del uncertainty[body.name]
        has_time = body.pose is not None and body.pose.at_s is not None
        if (held is not None and body.name == held.part) or (has_time and body.name not in handled):
            continue  # how well the one is known the grip says, and the other the time of its pose
        frame = scene.frames[places[body.name][0]]
        off_m = frame.uncertainty.speed_m_s * (end_s - trajectory.start)
        if off_m > 0.0:
            before = PoseUncertainty(**uncertainty.get(body.name, vars(body.uncertainty)))
            uncertainty[body.name] = asdict(drifted(before, off_m, frame.law))
    request: Any = cell.document
    return EndState(
        request, stated, start, uncertainty, handled, gone, gone_at_s, places, None if held is None else held.part, cell
    )


def checked_end(request: Document, answer: object) -> EndState:
    """As `end_state`, of a plan that the checker accepts: its certificate must be in full. Raises `InputError`."""
    from assur.scenes.requests import check_cell

    end = end_state(request, answer)
    verdict = check_cell(end.cell, answer)
    if not verdict["ok"]:
        first = verdict["findings"][0]["what"]
        raise DocumentError("plan", "this plan", f"one that `assur check` accepts; its first finding: {first}")
    return end


def _start(motion: Trajectory, at_s: float, conventions: Conventions) -> Document:
    """The state at an instant as the start of a request, in the maker's words: at a knot the numbers that the answer
    has there, and those of the last one from then on."""
    knot = -1 if at_s >= motion.end else int(motion.time.searchsorted(at_s))
    if motion.time[knot] <= at_s:
        q, qd, qdd = motion.q[knot], motion.qd[knot], motion.qdd[knot]
    else:
        q, qd, qdd = motion.state(at_s)
    states = as_maker(q, conventions), rates_as_maker(qd, conventions), rates_as_maker(qdd, conventions)
    start: Document = {"at_s": at_s}
    for key, rate, values in zip(("joints", "velocity", "acceleration"), ("", "_s", "_s2"), states, strict=True):
        if key == "joints" or values.any():
            names = zip(conventions.keys, values.tolist(), strict=True)
            start[key] = {f"{name}{rate}": value for name, value in names}
    return start


def next_request(end: EndState, steps: Sequence[Document]) -> Document:
    """The request with these steps that begins where the plan ends. Raises `DocumentError` for a pick of a part that
    was taken away."""
    check_there(steps, {name: end.taken(name) for name in end.gone})
    bodies = [end.body(body, {}) for body in end.document.get("bodies", ()) if body["name"] not in end.gone]
    return {**end.document, "start": end.start, "bodies": bodies, "task": list(steps)}


def next_task(
    cell: Document | CellFile,
    task: Document,
    end: EndState,
    parts: Sequence[Document] | None = None,
    given: Mapping[str, object] = MappingProxyType({}),
) -> Document:
    """A task of a cell, a document or a `CellFile`, that begins where a plan ends. `task` has no start; what else it
    has counts. `parts`: those of the plan, as they were written (None: the bodies of its request that the cell has
    not). One that `task` has as well, with a place, is there; all others are where the plan left them. `given`: values
    that will be set last, as `joined` takes them.

    Raises `DocumentError` whose field begins with `cell` or `task`.
    """
    written = cell.written if isinstance(cell, CellFile) else cell
    of_cell, of_task = shared(given, written)
    with within_document(OF_TASK):
        read(TaskDocument, task)
        if "start" in task:
            raise fault(task, ("start",), "none: the task begins where the plan ends")
    with within_document(OF_CELL):
        if written is cell:
            read(CellDocument, written)
        shapes = {body["name"]: normal(body["shape"]) for body in end.document.get("bodies", ())}
        for i, body in enumerate(written.get("bodies", ())):
            if body["name"] in end.handled:
                allowed = "a body that no step of the plan handles: what steps handle is one of the parts of a task"
                raise fault(written, ("bodies", i, "name"), allowed)
            before = shapes.get(body["name"])
            if before is not None and before != normal(body["shape"]):
                raise fault(written, ("bodies", i, "name"), "a name that no body of another shape has in the plan")
        seen = {part["name"] for part in task.get("parts", ()) if part.keys() & {*PLACES}}
        changed = _with_values(written, {**task.get("set", {}), **of_cell})
        slots = _slots(changed, end, seen)
    if parts is None:
        own = {body["name"] for body in written.get("bodies", ())}
        parts = [body for body in end.document.get("bodies", ()) if body["name"] not in own]
    known = {part["name"]: part for part in parts if part["name"] not in end.gone}
    listed, kinds = [], changed.get("kinds", {})
    for i, part in enumerate(task.get("parts", ())):
        before = known.pop(part["name"], {})
        if before and not part.keys() & {*PLACES}:
            if "uncertainty" in part:
                allowed = "none without a place: the part is known as well as the plan leaves it; `set` changes that"
                with within_document(OF_TASK):
                    raise fault(task, ("parts", i, "uncertainty"), allowed)
            part = end.body({key: before[key] for key in (*PLACES, "uncertainty") if key in before} | part, slots)
        elif part["name"] in end.gone and not part.keys() & {*PLACES}:
            with within_document(OF_TASK):
                raise fault(
                    task, ("parts", i, "name"), f"a part with a place, where it is seen: {end.taken(part['name'])}"
                )
        listed.append(part)
    values = Origins()
    with values.located(), within_document(OF_TASK):
        steps = values.changed(OF_TASK, task, of_task, GIVEN)["steps"] if of_task else task["steps"]
        check_kinds_of_picked(kinds, steps, known)
        away = end.gone - {part["name"] for part in listed}
        check_there(steps, {name: end.taken(name) for name in away})
    listed += [end.body(part, slots) for part in known.values()]
    names = {part["name"] for part in listed}
    worse = {f"bodies.{name}.uncertainty": each for name, each in end.uncertainty.items() if name not in names}
    return {**task, "start": end.start, "parts": listed, "set": {**worse, **task.get("set", {})}}


def next_fields(cell: Document, made: Document, end: EndState, task: Document | None = None) -> Document:
    """The fields of a task with these `steps` and `parts` in a cell file that begins where a plan ends, as
    `assur.Cell.plan` takes them. `task`: that of the plan, whose parts, options and `set` stay; None: the bodies of its
    request that the cell has not are its parts, and the options that the cell does not state stay. Raises
    `DocumentError`, as `next_task` and `joined_after`."""
    if task is None:
        own = cell.get("options", {})
        options = end.document.get("options", {})
        task = {"options": {key: options[key] for key in options if written_key(own, _in_si(key)) is None}}
        task = {key: value for key, value in task.items() if value}
    kept = {"schema": TASK, **({"options": task["options"]} if "options" in task else {})}
    fields = next_task(cell, {**kept, **made}, end, task.get("parts"), task.get("set", {}))
    worse = fields["set"]
    fields["set"] = {path: value for path, value in task.get("set", {}).items() if path not in worse} | worse
    joined_after(cell, fields, end, made)
    return {key: value for key, value in fields.items() if key != "schema" and (key != "set" or value)}


def next_values(request: Document, follows: Document, end: EndState) -> Document:
    """The request that follows a plan as start, task and values that are set in another `request`, as `assur.Cell.plan`
    takes them. Raises `DocumentError`, as `hold_same`."""
    hold_same(request, end)
    options = {f"options.{key}": value for key, value in follows.get("options", {}).items()}
    return {"start": follows["start"], "task": follows["task"], "set": {"bodies": follows["bodies"], **options}}


def _in_si(key: str) -> str:
    return (si_key(key) or (key,))[0]


def joined_after(
    cell: Document, task: Document, end: EndState, stated: Document, given: Mapping[str, object] = MappingProxyType({})
) -> Joined:
    """The request of a task that `next_task` made of the one that is `stated`, with values that are `given` last
    (`joined`). Raises `DocumentError`, also for a cell that is not that of the plan (`hold_same`), and for a body that
    is not that of the plan (`check_same_bodies`)."""
    own = len(stated.get("parts", ()))
    carried = Carried({i: part["name"] for i, part in enumerate(task["parts"]) if i >= own}, end.gone_at_s)
    made = joined(cell, task, given, carried)
    with raised_as(made.relocated):
        hold_same(made.request, end)
        before = {body["name"]: body for body in end.document.get("bodies", ()) if body["name"] not in end.gone}
        check_same_bodies(made.request, before, stated, given)
    return made


def hold_same(document: Document, end: EndState) -> None:
    """Raises `DocumentError` for a request whose robot, frames or neighbours are not those of the plan, at the first
    value that differs: the state of the plan is one of them."""
    path = difference(read(RequestDocument, document), end.request, SAME)
    if path is not None:
        there = stated_at(end.document, path)
        raise fault(document, path, f"what the request of the plan has there{there and f': {there}'}")


def _with_values(cell: Document, values: Document) -> Document:
    """The cell with values that will be set in it. Without those that are refused: they are then, at their paths."""
    if not values:
        return cell
    try:
        changed = with_values(cell, values)
        read(CellDocument, changed)
    except InputError:
        return cell
    return changed


def _slots(cell: Document, end: EndState, seen: Collection[str]) -> dict[tuple[object, ...], Document]:
    """The slots of a cell by their frame, which has a law, and their pose in it, but for those relative to a body that
    may be elsewhere now, such as a part that was `seen`. What names no frame or body is refused where it is used."""
    from assur.scenes.reading.bodies import Places, resolve

    places = Places(end.cell.places)
    places.update(end.places)
    own = {body["name"]: body for body in cell.get("bodies", ())}
    before = {body["name"]: body for body in end.document.get("bodies", ())}

    def stays(name: str) -> bool:
        if name in own and (name not in before or _pose(own[name]) != _pose(before[name])):
            return False
        pose = {} if name in end.handled else before.get(name, {}).get("pose", {})
        return name not in seen and ("body" not in pose or stays(pose["body"]))

    found: dict[tuple[object, ...], Document] = {}
    every = cell.get("slots", {}).items()
    grids = {name: grid for name, grid in every if "kind" not in grid and math.prod(counts(grid)) <= MAX_SLOTS}
    for grid, number, written in slot_poses(
        {name: grid for name, grid in grids.items() if "body" not in grid or stays(grid["body"])}
    ):
        place: PlaceInCell = read(PlaceInCell, written)
        try:
            frame, pose = resolve(place, place.yaw_rad, end.cell.frames, places)
        except Refused:
            continue
        found[_key(frame, pose)] = {grid: number}
    return found


def _pose(body: Document) -> object:
    """Where a body is, in SI."""
    return normal(body.get("pose", {}))


def _key(frame: str, pose: Pose) -> tuple[object, ...]:
    """What two poses have in common that are the same: a part lies in a slot in its place and with its yaw."""
    return frame, pose.x, pose.y, pose.z, pose.yaw

"""The task of a document as steps of the planner."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from assur.planner.frames.motion import Pose
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.path import LONGEST_S, ArcTo, LineTo, Path, PathError, PathPart, Point, SplineThrough, never
from assur.planner.model.scene import Arch, Follow, Move, Pick, Place, Step, Target, Trace, Window
from assur.planner.model.task import Tolerance, lead_length
from assur.scenes.faults import FAULTS, Gathered, Refused, choices
from assur.scenes.reading.bodies import Places, named, resolve
from assur.scenes.reading.frames import Frames, placed, pose_uncertainty
from assur.scenes.schema.in_parts import Unread
from assur.scenes.schema.task import (
    TAKEN_AWAY,
    FollowDocument,
    MoveDocument,
    PathPartDocument,
    PickDocument,
    PlaceDocument,
    StepDocument,
    TargetDocument,
    TraceDocument,
    WindowedStep,
)

NO_YAW = "no yaw: the robot has no wrist"
SHORTEST_S = 1e-4
"""A point is followed for no time, or for this at least, s."""
ANY_YAW = (
    "yaw_deg (or yaw_rad) with a number, yaw_free: true (any yaw) or yaw_keep: true (the yaw that the tool has when "
    "the step begins); one of them must be given"
)
PART_YAW = "yaw_deg (or yaw_rad) with a number, which must be given: a part is placed as it has to lie"
NO_HEADING = "no yaw: the tool's heading follows from the position"
NO_TILT = "no {}: only arms with five axes have one"


KINDS = ("move", "follow", "trace", "pick", "place")


class _Task:
    """Reads the steps in order, and keeps track of the part in the gripper."""

    def __init__(
        self,
        frames: Frames,
        places: Places,
        coordinates: tuple[str, ...] | None,
        held: str | None,
        faults: Gathered,
        *,
        solid_tool: bool,
    ) -> None:
        self.frames, self.places, self.solid_tool, self.faults = frames, places, solid_tool, faults
        self.known = coordinates is not None
        self.has_yaw = coordinates is None or "yaw" in coordinates
        self.has_tilt = coordinates is None or "pitch" in coordinates
        self.no_yaw = NO_HEADING if self.has_tilt else NO_YAW
        self.held = held
        self.lost = False
        """A pick has a fault, so that the held part is not known."""
        self.names: set[str] = set()
        self.at: tuple[str, Point] | None = None
        """Frame, and the tool point in it, where the last step ends, if the request says it."""

    def read(self, number: int, item: StepDocument | Unread) -> list[Step]:
        """The step; none where it has a fault."""
        if isinstance(item, Unread):
            self._pass(number, item)
            return []
        key = next(key for key in KINDS if getattr(item, key) is not None)
        try:
            spelt = getattr(item, key)
            name = spelt.name or f"{key}-{number + 1}"
            if name in self.names:
                raise Refused("a name that no other step has", "name")
            self.names.add(name)
            made: Step = getattr(self, f"_{key}")(name, spelt)
            self.at = _where(made)
            return [made]
        except FAULTS as error:
            self.faults.add(error, "task", number, key)
        part = item.place or item.pick
        self._lose(key, "" if part is None else part.part)
        return []

    def _pass(self, number: int, step: Unread) -> None:
        """Passes a step that could not be read; the names in it that can be are looked up."""
        written = step.written if isinstance(step.written, dict) else {}
        key = next((key for key in KINDS if key in written), "")
        part, contacts = step.text(key, "part"), step.items(key, "contact_with")
        for end in ("to", "start"):
            if (target := step.part(TargetDocument, key, end)) is not None:
                with self.faults.part("task", number, key, end):
                    named(target, self.frames, self.places)
        with self.faults.part("task", number, key):
            self._contacts(part, [name if isinstance(name, str) else "" for name in contacts])
        with self.faults.part("task", number, key, "part"):
            self.places.hold(part)
            if part and part not in self.places:
                raise Refused(f"the name of a body: {choices(self.places, part)}")
        self.names.add(step.text(key, "name"))
        self._lose(key, part)
        self.lost = self.lost or not key

    def _lose(self, key: str, part: str) -> None:
        """Later steps are read as if a step that has a fault had taken or put down its part."""
        self.at = None
        if key == "pick":
            self.held, self.lost = None, True
        if key == "place":
            self.held, self.lost = None, False
            self.places.unread.add(part)

    def _move(self, name: str, item: MoveDocument) -> Step:
        target = self._target(item.to, free=True)
        arch = None if item.arch is None else Arch(item.arch.top_m)
        window, path = self._window(item, target.frame), tuple[PathPart, ...]()
        if item.path is None:
            if item.blend_m > 0.0:
                raise Refused("none: only a leg along a path has corners", "blend_m")
        elif item.leg != "cartesian" or item.via or item.arch is not None:
            raise Refused("none: only a move with leg: cartesian, without via and arch, goes along a path", "path")
        else:
            path = self._parts(item.path, item.to, target.pose)
            with _at_part(path, ends=("to", "at_m")):
                never(path)
                if self.at is not None and self.at[0] == target.frame:
                    Path(self.at[1], path, item.blend_m)
        return Move(name, target, item.match, item.via, arch, window, item.leg, path, item.blend_m)

    def _follow(self, name: str, item: FollowDocument) -> Step:
        target = self._target(item.to)
        if 0.0 < item.duration_s < SHORTEST_S:
            raise Refused(
                f"0, or {1e3 * SHORTEST_S:g} ms and more: a shorter motion is no longer than rounding", "duration_s"
            )
        return Follow(name, target, item.duration_s, self._window(item, target.frame), _tolerance(item))

    def _trace(self, name: str, item: TraceDocument) -> Step:
        target = self._target(item.start, "start")
        pose = target.pose
        parts = self._parts(item.path, item.start)
        with _at_part(parts):
            path = Path((pose.x, pose.y, pose.z), parts, item.blend_m)
        longest = max(path.length, 2.0 * (item.lead_in_m or 0.0), 2.0 * (item.lead_out_m or 0.0))
        if longest > LONGEST_S * item.speed_m_s:
            least = f"at least {1e3 * longest / LONGEST_S:.12g} mm/s"
            raise Refused(f"{least}: path, lead-in and lead-out may each last {LONGEST_S:g} s", "speed_m_s")
        leads = [lead_length(item.speed_m_s) if lead is None else lead for lead in (item.lead_in_m, item.lead_out_m)]
        return Trace(name, target, path, item.speed_m_s, leads[0], leads[1], self._window(item, target.frame))

    def _parts(
        self, items: Sequence[PathPartDocument], place: TargetDocument, to: Pose | None = None
    ) -> tuple[PathPart, ...]:
        """The parts of a path whose points are in the frame, or relative to the body, of `place`; the last part, which
        then has no end of its own, ends at the pose `to`."""

        def there(at: list[float] | None, *keys: str | int) -> Point:
            ends = to is not None and bool(keys) and keys[0] == len(items) - 1
            if ends and to is not None:
                if at is not None:
                    raise Refused("none: the last part ends at the move's `to`", "path", *keys)
                return to.x, to.y, to.z
            if at is None:
                raise Refused("to_m or to_mm, which must be given", "path", *keys)
            _, pose = resolve(place.model_copy(update={"at_m": at}), 0.0, self.frames, self.places)
            return pose.x, pose.y, pose.z

        parts = list[PathPart]()
        for k, item in enumerate(items):
            raise_if_late()
            if item.line is not None:
                parts.append(LineTo(there(item.line.to_m, k, "line", "to_m")))
            elif item.arc is not None:
                parts.append(ArcTo(there(item.arc.via_m), there(item.arc.to_m, k, "arc", "to_m")))
            elif item.spline is not None:
                points = [there(point) for point in item.spline.through_m]
                if to is not None and k == len(items) - 1:
                    points.append((to.x, to.y, to.z))
                parts.append(SplineThrough(tuple(points)))
        return tuple(parts)

    def _pick(self, name: str, item: PickDocument) -> Step:
        faults = Gathered()
        with faults.part("part"):
            self.places.hold(item.part)
            if item.part not in self.places:
                raise Refused(f"the name of a body: {choices(self.places, item.part)}")
            if self.held is not None:
                raise Refused(f"a pick after {self.held} is placed")
        if not self.has_yaw and item.grasp_yaw_rad != 0.0:
            faults.add(Refused(self.no_yaw, "grasp_yaw_rad"))
        if item.grip_within_m is not None and not self.solid_tool:
            faults.add(Refused("none: the tool has no bodies from which it could be measured", "grip_within_m"))
        with faults.part():
            contacts = self._contacts(item.part, item.contact_with)
        faults.settle()
        self.held, self.lost = item.part, False
        return Pick(
            name,
            item.part,
            placed(item.grasp_m, item.grasp_yaw_rad),
            **self._handling(item, self.places[item.part][0], contacts),
            held_within=None if item.held_within is None else pose_uncertainty(item.held_within),
            grip_within_m=math.inf if item.grip_within_m is None else item.grip_within_m,
        )

    def _place(self, name: str, item: PlaceDocument) -> Step:
        faults = Gathered()
        with faults.part("part"):
            self.places.hold(item.part)
            if item.part != self.held and not self.lost:
                raise Refused(f"the part that is held then: {self.held or 'none'}")
            if item.part not in self.places:
                raise Refused(f"the name of a body: {choices(self.places, item.part)}")
        if item.support_within_m is not None and not item.contact_with:
            faults.add(Refused("none without contact_with, which names what the part rests on", "support_within_m"))
        with faults.part():
            target = self._target(item.to, part=True)
        with faults.part():
            contacts = self._contacts(item.part, item.contact_with)
        faults.settle()
        self.held, self.lost = None, False
        self.places[item.part] = (target.frame, target.pose)
        self.places.drifting.discard(item.part)
        if item.gone_after_s is not None:
            del self.places[item.part]
            self.places.gone.add(item.part)
        within_m = math.inf if item.support_within_m is None else item.support_within_m
        handling = self._handling(item, target.frame, contacts)
        return Place(name, item.part, target, **handling, support_within_m=within_m, gone_after_s=item.gone_after_s)

    def _handling(
        self, item: PickDocument | PlaceDocument, frame: str, contacts: tuple[str, ...] | None
    ) -> dict[str, Any]:
        """What a pick and a place have in common, of a control point in a frame."""
        return {
            "approach_m": item.approach.m,
            "dwell_s": item.dwell_s,
            "depart_m": item.depart.m,
            "match": item.match,
            "window": self._window(item, frame),
            "contact_with": contacts,
            "tolerance": _tolerance(item),
            "contact_tolerance_m": item.contact_tolerance_m,
            "approach_stop": item.approach.stop,
            "depart_stop": item.depart.stop,
            "arch": None if item.arch is None else Arch(item.arch.top_m),
        }

    def _target(self, item: TargetDocument, key: str = "to", free: bool = False, part: bool = False) -> Target:
        """The target under the `key` of a step. `free`: whether one that says nothing of the yaw leaves it free;
        `part`: whether a part is put there."""
        faults = Gathered()
        try:
            yaw_free = self._yaw_free(item, free, part)
        except Refused as error:
            faults.add(error, key)
        try:
            if item.body is not None and item.body == self.held:
                raise Refused("a body that is not in the gripper", "body")
            frame, pose = resolve(item, item.yaw_rad or 0.0, self.frames, self.places)
        except FAULTS as error:
            faults.add(error, key)
        faults.settle()
        pitch, roll = [None if angle == "free" else angle for angle in (item.pitch_rad, item.roll_rad)]
        return Target(frame, pose, yaw_free, pitch, roll, item.yaw_keep)

    def _yaw_free(self, item: TargetDocument, free: bool, part: bool) -> bool:
        """Whether the tool may have any yaw at the target. Raises `Refused` for an angle that it has
        not, or needs."""
        if item.yaw_rad is not None and not self.has_yaw:
            raise Refused(self.no_yaw, "yaw_rad")
        stated = item.model_fields_set
        for key in ("pitch_rad", "roll_rad"):
            if key in stated and not self.has_tilt:
                raise Refused(NO_TILT.format(key.removesuffix("_rad")), key)
        for key in ("yaw_free", "yaw_keep"):
            if getattr(item, key) and not self.has_yaw:
                raise Refused(self.no_yaw, key)
            if getattr(item, key) and part:
                raise Refused(PART_YAW, key)
        silent = item.yaw_rad is None and not item.yaw_free and not item.yaw_keep
        if silent and self.known and self.has_yaw and not free:
            given_keys: list[str] = [key for key in ("yaw_free", "yaw_keep") if key in stated]
            raise Refused(PART_YAW if part else ANY_YAW, *(given_keys or ["yaw_rad"])[:1])
        return item.yaw_free or item.yaw_keep or (silent and (free or not self.has_yaw))

    def _window(self, item: WindowedStep, frame: str) -> Window:
        for key, ends in (("window_s", item.window_s), ("window_m", item.window_m)):
            if ends is not None and not ends[0] < ends[1]:
                raise Refused(_reversed, key)
        if item.window_m is not None and self.frames.laws[frame].law.way is None:
            raise Refused(f"window_s: {frame} is no conveyor to measure along", "window_m")
        time = None if item.window_s is None else (item.window_s[0], item.window_s[1])
        along = None if item.window_m is None else (item.window_m[0], item.window_m[1])
        return Window(time, along)

    def _contacts(self, part: str, names: Sequence[str] | None) -> tuple[str, ...] | None:
        if names is None:
            return None
        faults = Gathered()
        for i, name in enumerate(names):
            if name not in self.places or name == part:
                with faults.part("contact_with", i):
                    self.places.hold(name)
                    there = choices([place for place in self.places if place != part], name)
                    raise Refused(f"the name of a body that is not the part: {there}")
        faults.settle()
        return tuple(names)


def _where(step: Step) -> tuple[str, Point] | None:
    """Frame, and the tool point in it, where a step ends; None where that takes more than the request."""
    if isinstance(step, Follow) or (isinstance(step, Move) and not step.via):
        pose = step.target.pose
        return step.target.frame, (pose.x, pose.y, pose.z)
    return None


@contextmanager
def _at_part(parts: Sequence[PathPart], ends: tuple[str, ...] = ()) -> Iterator[None]:
    """What is wrong with a part of a path is refused at that part. `ends`: the keys of the end of the last part, if it
    is not in that part."""
    try:
        yield
    except PathError as error:
        part = parts[error.number]
        if ends and error.key == "to" and error.number == len(parts) - 1:
            raise Refused(error.allowed, *ends) from error
        kind = "line" if isinstance(part, LineTo) else "arc" if isinstance(part, ArcTo) else "spline"
        keys = {"to": "to_m", "via": "via_m", "points": "through_m"}
        where = (kind, keys[error.key]) if error.key else ()
        raise Refused(error.allowed, "path", error.number, *where) from error


def _tolerance(item: FollowDocument | PickDocument | PlaceDocument) -> Tolerance:
    """The largest error that a step allows."""
    m, rad = item.tolerance_m, item.tolerance_rad
    return Tolerance(math.inf if m is None else m, math.inf if rad is None else rad)


def _reversed(_: str, ends: object) -> str:
    """What is allowed in place of two ends as they were written."""
    order = f"; {ends[0]} is not below {ends[1]}" if isinstance(ends, list) and len(ends) == 2 else ""
    return "two ends, the first below the second" + order


def assumptions_of(steps: Sequence[Step]) -> tuple[str, ...]:
    """What an answer says of parts that are taken away."""
    return tuple(
        f"{step.part}: {TAKEN_AWAY} {1e3 * step.gone_after_s:g} ms after {step.name} put it down"
        for step in steps
        if isinstance(step, Place) and step.gone_after_s is not None
    )


def steps_of(
    task: Sequence[StepDocument | Unread],
    frames: Frames,
    places: Places,
    coordinates: tuple[str, ...] | None,
    held: str | None,
    faults: Gathered,
    *,
    solid_tool: bool,
) -> tuple[Step, ...]:
    """The steps, in order, for a robot with these coordinates (None: not known) whose gripper holds the part `held` at
    the start. `solid_tool`: whether its tool has bodies.

    `faults` gets the steps that name something that does not exist, or is not in the gripper; these are left out.
    """
    reader = _Task(frames, Places(places), coordinates, held, faults, solid_tool=solid_tool)
    return tuple([step for i, item in enumerate(task) for step in reader.read(i, item)])

"""Who holds what, where each part is, what may touch, and what is uncertain of parts: derived from the task alone.

A pick attaches its part to the flange at the end of its FOLLOW leg, and a place puts it down then. So where a part is
follows from the last step that handled it; no state is carried from step to step. Poses are (x, y, z, yaw).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import arms, laws
from assur.planner.checker.statement.differences import SAME, Four, Interval, Requirements, inverse_pose, numbers, then
from assur.planner.checker.statement.solids import bodies_of
from assur.planner.claim import columns as c
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Body, Hull, Piece
from assur.planner.laws.law import EXACT, PoseUncertainty, Uncertainty
from assur.planner.model.outcome import TRACKING, Leg, LegKind, Plan
from assur.planner.model.scene import WORLD, Pick, Place, Scene

CONTACT_M = 1e-4
"""How deep bodies that may touch may overlap, m, besides what the step allows; and how far apart in height what a part
rests on may be from its bottom."""
FAR_M = 100.0
"""How far below the origin of the world, or above it for a robot that is below, what was taken away is stated to be,
m."""
CERTAIN = Uncertainty()
Where = tuple[str | None, Four]
"""The frame to which a body is fixed (None: the flange), and its pose there."""


@dataclass
class Stage:
    """A leg, or what comes behind the last one: what has to hold in it.

    `near`: whether the distance near a control point counts. `robot`: whether the robot has to keep clear. `handed`:
    the steps whose part has changed hands; `held`: the part in the gripper; `gone`: parts that were taken away since
    they were put down. `touching`, `depth`: the pairs that may
    touch, and how deep, m. `supports`: by the parts that were put down, what they may touch. `shares`: those of the
    tool in errors of frames.
    """

    when: Interval
    handed: list[int]
    held: str | None
    gone: frozenset[str] = frozenset()
    near: bool = False
    robot: bool = True
    touching: set[frozenset[str]] = field(default_factory=set)
    depth: float = 0.0
    supports: dict[str, set[str]] = field(default_factory=dict)
    shares: dict[str, tuple[float, float]] = field(default_factory=dict)


class Given:
    """What follows from a cell alone, which all plans for it share. `scene`: any of that cell."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.tcp, self.flange = numbers(scene.tool.tcp), float(scene.robot.links.index("flange"))
        self.frames = {name: number for number, name in enumerate(scene.frames)}
        self.bodies = {body.name: number for number, body in enumerate(bodies_of(scene))}
        self.motions: dict[str, laws.Formula] = {}

    def motion(self, frame: str) -> laws.Formula:
        """The formula of a frame that is no link of an arm; the times at which its pieces end are left out."""
        if frame not in self.motions:
            self.motions[frame] = laws.formula_of(self.scene.frames[frame].law, 0.0, 0.0)
        return self.motions[frame]

    @cached_property
    def seats(self) -> tuple[FloatArray, FloatArray]:
        """Of all bodies before any is gripped: seats (1, B, 7), and how far each may be off it (1, 2 B), m."""
        scene, off = self.scene, np.zeros((1, 2, len(self.bodies)))
        links = [item.link for item in scene.robot.bodies] + [self.flange] * len(scene.tool.bodies)
        seats: list[tuple[float, ...]] = [(k, link, -1.0, 0.0, 0.0, 0.0, 0.0) for k, link in enumerate(links)]
        for k, body in enumerate(scene.bodies, start=len(links)):
            seats.append((k, -1.0, self.frames[body.frame], *numbers(body.pose)))
            off[0, :, k] = displaced(body.uncertainty, body.body)
        return np.array(seats).reshape(1, -1, c.SEAT), off.reshape(1, -1)

    @cached_property
    def is_exact(self) -> bool:
        """Whether nothing is uncertain of frames and bodies."""
        within = [body.uncertainty for body in self.scene.bodies]
        exact = all(not (each.position_m or each.vertical_m or each.yaw_rad) for each in within)
        return exact and all(frame.uncertainty == CERTAIN for frame in self.scene.frames.values())


class Handling(Requirements):
    """What the steps of a task do with parts, in a plan. `steps` are numbers of steps in the task; steps whose part
    has changed hands before some time are the `handed` ones, in their order."""

    def __init__(self, scene: Scene, plan: Plan, given: Given | None = None) -> None:
        """`given`: that of the scene, if it is kept."""
        super().__init__()
        self.scene, self.plan = scene, plan
        self.arrivals = {arrival.step: arrival for arrival in plan.arrivals}
        self.given = given = given or Given(scene)
        self.tcp, self.flange, self.frames, self.bodies = given.tcp, given.flange, given.frames, given.bodies
        self.whole = (plan.trajectory.start, plan.trajectory.end)
        self._places: dict[tuple[str, float], Four] = {}
        self._tools: dict[float, Four] = {}
        self._supports: dict[int, set[str]] = {}

    @cached_property
    def stages(self) -> list[Stage]:
        """What has to hold in each leg, while the arm is at rest behind the last one for as long as the request
        requires, and then until a robot that starts late may be through, if a part was put down."""
        legs, options, late = self.plan.legs, self.scene.options, self.scene.execution.start_tolerance_s
        found = [self._stage(k, (leg.t0, leg.t1)) for k, leg in enumerate(legs)]
        end = legs[-1].t1
        if options.end == "rest" and options.stay_safe_s > 0.0:
            found.append(self._stage(len(legs), (end, end + options.stay_safe_s)))
            end += options.stay_safe_s
        if late > 0.0:
            last = self._stage(len(legs), (end, end + late))
            if last.supports:
                last.robot, last.shares = False, {}
                found.append(last)
        return found

    def _stage(self, number: int, when: Interval) -> Stage:
        """The stage of a leg, or of what comes behind the last one."""
        task, legs = self.scene.task, self.plan.legs
        handed = [leg.step for leg in legs[:number] if leg.kind is LegKind.FOLLOW and task[leg.step].part is not None]
        of_step = legs[number].step if number < len(legs) else len(task)
        stage = Stage(when, handed, self.held(handed), self.gone(of_step, when[0]), shares=self._shares(number))
        for k, own in enumerate(handed):
            part = task[own].part
            if part is not None and part != stage.held and part not in stage.gone:
                # the last step that handled it counts; parts that were taken since do not support it
                stage.supports[part] = self.supports(own) - {task[k].part or "" for k in handed[k + 1 :]}
        if number < len(legs) and legs[number].kind in TRACKING:
            step = task[legs[number].step]
            stage.near, stage.depth = True, CONTACT_M + step.contact_tolerance_m
            if step.part is not None:
                # while the part is held it may touch what it rests on; before it is taken, and after it was put down,
                # the bodies of the tool
                tool = {body.name for body in self.scene.tool.bodies}
                others = self.supports(legs[number].step) if stage.held == step.part else tool
                stage.touching = {frozenset((other, step.part)) for other in others}
        return stage

    def legs(self, number: int, *, tracked: bool = False) -> list[Leg]:
        """The legs of a step; those that track its control point."""
        return [leg for leg in self.plan.legs if leg.step == number and (not tracked or leg.kind in TRACKING)]

    @cached_property
    def is_exact(self) -> bool:
        """Whether nothing is uncertain: frames, bodies, grips, joints and the start."""
        execution, holding = self.scene.execution, self.scene.start.holding
        poses = [] if holding is None else [holding.within]
        poses += [step.held_within or EXACT for step in self.scene.task if isinstance(step, Pick)]
        certain = self.given.is_exact and poses.count(EXACT) == len(poses)
        return certain and not any((*execution.lag, execution.start_tolerance_s))

    def handed_before(self, number: int) -> list[int]:
        """The steps before a step whose part has changed hands: all that have a part."""
        return [k for k, step in enumerate(self.scene.task[:number]) if step.part is not None]

    def held(self, handed: Sequence[int]) -> str | None:
        """The part in the gripper after some steps."""
        if not handed:
            holding = self.scene.start.holding
            return None if holding is None else holding.part
        last = self.scene.task[handed[-1]]
        return last.part if isinstance(last, Pick) else None

    def gone(self, number: int, time: float) -> frozenset[str]:
        """The parts that steps before a step put down, and that are taken away by a time. Of a robot that is late they
        are put down so much later."""
        found, late = set(), self.scene.execution.start_tolerance_s
        for k, step in enumerate(self.scene.task[:number]) if self.scene.clears else ():
            after = step.gone_after_s if isinstance(step, Place) else None
            if after is not None and self.arrivals[k].until + after + late <= time:
                found.add(step.part or "")
        return frozenset(found)

    def place(self, name: str, handed: Sequence[int], gone: frozenset[str] = frozenset()) -> Where:
        """Where a body of the surroundings is after some steps; what is gone is far from the robot."""
        if name in gone:
            return WORLD, (0.0, 0.0, -FAR_M if self.scene.robot.base.z >= 0.0 else FAR_M, 0.0)
        for number in reversed(handed):
            step = self.scene.task[number]
            if step.part == name and isinstance(step, Pick):
                return None, then(self.tcp, inverse_pose(self.grasp(number)))
            if step.part == name and isinstance(step, Place):
                return step.to.frame, numbers(step.to.pose)
        holding = self.scene.start.holding
        if holding is not None and holding.part == name:
            return None, then(self.tcp, inverse_pose(numbers(holding.grasp)))
        return self.scene.index[name].frame, numbers(self.scene.index[name].pose)

    def grasp(self, number: int) -> Four:
        """The tool point in the part's frame at a pick, turned about the part's axis as the arrival states."""
        step = self.scene.task[number]
        if not isinstance(step, Pick):
            raise FaultError(f"{step.name} is no pick")
        return then((0.0, 0.0, 0.0, self.arrivals[number].yaw_offset), numbers(step.grasp))

    def point(self, number: int) -> tuple[str, Four]:
        """Frame and pose of the part that a step takes, or of its target."""
        step = self.scene.task[number]
        if not isinstance(step, Pick):
            return step.target.frame, numbers(step.target.pose)
        frame, pose = self.place(step.part, self.handed_before(number))
        if frame is None:
            raise FaultError(f"{step.name} takes a part that the gripper holds")
        return frame, pose

    def tool_point(self, number: int) -> tuple[str, Four]:
        """Frame and pose that the tool point has when a step meets its control point."""
        step, (frame, at) = self.scene.task[number], self.point(number)
        if isinstance(step, Pick):
            return frame, then(at, self.grasp(number))
        if isinstance(step, Place):
            _, in_flange = self.place(step.part, self.handed_before(number))
            return frame, then(at, then(inverse_pose(in_flange), self.tcp))
        return frame, (at[0], at[1], at[2], at[3] + self.arrivals[number].yaw_offset)

    def supports(self, number: int) -> set[str]:
        """What the part of a pick or a place rests on: the bodies that are named, or those whose top is where the
        part's bottom is, and which are so near that circles about both overlap."""
        if number not in self._supports:
            self._supports[number] = self._find_supports(number)
        return self._supports[number]

    def _find_supports(self, number: int) -> set[str]:
        step = self.scene.task[number]
        if not isinstance(step, Pick | Place):
            return set()
        if step.contact_with is not None:
            return set(step.contact_with)
        time, handed = self.arrivals[number].until, self.handed_before(number)
        gone = self.gone(number, self.legs(number)[0].t0)
        # nothing is put on what will be taken away
        leaving = self.gone(number, math.inf)
        there = self.in_world(self.point(number), time)
        bottom = there[2] - _reach(self.scene.index[step.part].body, -1.0)
        found = set()
        for body in self.scene.bodies:
            if body.name == step.part or body.name in leaving:
                continue
            here = self.in_world(self.place(body.name, handed, gone), time)
            near = math.dist(here[:2], there[:2]) <= self.radius(body.name) + self.radius(step.part) + SAME
            if near and abs(here[2] + _reach(body.body, 1.0) - bottom) <= CONTACT_M + SAME:
                found.add(body.name)
        return found

    def along(self, number: int, times: Sequence[float]) -> FloatArray | None:
        """How far, m, the control point of a step is along its belt at times (T,), from the pose that the request has
        for the belt; None: it is on no belt."""
        frame, (x, y, z, _) = self.point(number)
        measured = laws.measured_along(self.scene.frames[frame].law)
        if measured is None:
            return None
        (ahead, aside, up), zero = measured
        places = self.given.motion(frame).place(np.array(times)) - (*zero[:3], 0.0)
        cosine, sine = np.cos(places[:, 3]), np.sin(places[:, 3])
        there = (cosine * x - sine * y + places[:, 0], sine * x + cosine * y + places[:, 1], z + places[:, 2])
        return np.asarray(ahead * there[0] + aside * there[1] + up * there[2])

    def in_world(self, where: Where, time: float) -> Four:
        """The pose in the world of what is fixed to a frame, at a time."""
        frame, pose = where
        if frame is None:
            raise FaultError("a part that the gripper holds is in no frame")
        if (frame, time) not in self._places:
            law = self.scene.frames[frame].law
            link = laws.link_of(law)
            x, y, z, yaw = self.given.motion(frame).place_at(time) if link is None else arms.place_at(*link, time)
            self._places[frame, time] = (x, y, z, yaw)
        return then(self._places[frame, time], pose)

    def way(self, number: int) -> Interval:
        """The time of all legs in which the arm moves to the control point of a step."""
        last = self.arrivals[number].time + SAME
        legs = [leg for leg in self.legs(number) if leg.kind is not LegKind.WAIT and leg.t1 <= last]
        return (legs[0].t0, legs[-1].t1)

    def state_at(self, time: float) -> FloatArray:
        """Position, velocity and acceleration (3, n) of the joints at a time."""
        return arms.states_at(self.plan.trajectory, time)

    def tool_at(self, time: float) -> Four:
        """Place and yaw of the tool point in the world at a time; of a flange that tilts the heading of the arm."""
        if time not in self._tools:
            flange = arms.link_at(self.scene.robot, self.state_at(time)[0].tolist(), int(self.flange))
            self._tools[time] = then(flange, self.tcp)
        return self._tools[time]

    def uncertainty(self, name: str, handed: Sequence[int], gone: frozenset[str] = frozenset()) -> PoseUncertainty:
        """How uncertain the pose of a body of the surroundings is after some steps.

        Of a part that a step has handled it is the error of the arrival, or what the step states of the grip. What is
        gone has that of its body.
        """
        for number in () if name in gone else reversed(handed):
            step, error = self.scene.task[number], self.arrivals[number].error
            if step.part == name:
                stated = step.held_within if isinstance(step, Pick) else None
                return stated or (EXACT if error is None else error.within)
        holding = self.scene.start.holding
        if holding is not None and holding.part == name and name not in gone:
            return holding.within
        return self.scene.index[name].uncertainty

    def _shares(self, leg: int) -> dict[str, tuple[float, float]]:
        """By frame, the least and the greatest share that the tool has in the frame's error along its line in a leg (or
        behind the last one); frames in whose error it has none are left out.

        With belt correction it has all of it in legs that track a frame which an encoder counts, and any share on the
        way from and to such legs.
        """
        if not self.scene.execution.belt_correction:
            return {}
        tracks = [k for k, each in enumerate(self.plan.legs) if each.kind in TRACKING]
        behind, ahead = [k for k in tracks if k < leg][-1:], [k for k in tracks if k >= leg][:1]
        found = {}
        for k in [leg] if leg in tracks else behind + ahead:
            frame, _ = self.point(self.plan.legs[k].step)
            law = self.scene.frames[frame].law
            if laws.line_of(law) is not None:
                found[frame] = (1.0 if leg in tracks and laws.encoder_counts(law) else 0.0, 1.0)
        return found

    def radius(self, name: str) -> float:
        """Horizontal distance of the points of a body of the surroundings from its origin at most, m."""
        return _radius(self.scene.index[name].body)


def displaced(within: PoseUncertainty, body: Body) -> tuple[float, float]:
    """How far a point of a body whose pose is so uncertain may be off horizontally, and up or down, m."""
    turned = within.yaw_rad * _radius(body) if within.yaw_rad else 0.0
    return within.position_m + turned, within.vertical_m


@lru_cache(maxsize=1024)
def _radius(body: Body) -> float:
    """Horizontal distance of the points of a body from its origin at most, m."""
    return max(float(np.hypot(*_corners(piece)[:, :2].T).max()) + _rounding(piece, 1.0) for piece in body.pieces)


@lru_cache(maxsize=1024)
def _reach(body: Body, up: float) -> float:
    """How far a body reaches upwards (1) or downwards (-1) from its origin, m (S1)."""
    tilted = (math.hypot(piece.rotation[2, 0], piece.rotation[2, 1]) for piece in body.pieces)
    highest = (float((up * _corners(piece)[:, 2]).max()) for piece in body.pieces)
    return max(high + _rounding(piece, flat) for high, piece, flat in zip(highest, body.pieces, tilted, strict=True))


def _corners(piece: Piece) -> FloatArray:
    """The corners of a piece (m, 3), less its disc and its ball, in the axes of its body."""
    shape = piece.shape
    local = shape.vertices if isinstance(shape, Hull) else CUBE * np.array(shape.half)
    return np.asarray(local @ piece.rotation.T + piece.position)


def _rounding(piece: Piece, flat: float) -> float:
    """How far a piece reaches beyond its corners, m; `flat`: the share of its disc that does."""
    shape = piece.shape
    return 0.0 if isinstance(shape, Hull) else shape.disc * flat + shape.ball


CUBE = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
"""The corners of a box whose half lengths are 1."""

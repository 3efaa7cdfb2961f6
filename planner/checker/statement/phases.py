"""Is each leg a phase of the claim, with the bodies where they are, and no contact that is not allowed?

A phase may state more than is required: fewer contacts, more uncertainty, the distance of travel in place of `near`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.arms import flange_row, link_row
from assur.planner.checker.statement.differences import SAME, Difference, Interval, Topic
from assur.planner.checker.statement.holding import CONTACT_M, Handling, Where
from assur.planner.checker.statement.poses import IDENTITY
from assur.planner.checker.statement.solids import bodies_of
from assur.planner.claim import columns as c


@dataclass
class Stage:
    """A leg, or what comes behind the last one: what has to hold in it.

    `near`: whether the distance near a control point counts. `robot`: whether the robot has to keep clear. `handed`:
    the steps whose part has changed hands; `held`: the part in the gripper. `touching`, `depth`: the pairs that may
    touch, and how deep, m. `supports`: by the parts that were put down, what they may touch. `shares`: those of the
    tool in errors of frames.
    """

    when: Interval
    handed: list[int]
    held: str | None
    near: bool = False
    robot: bool = True
    touching: set[frozenset[str]] = field(default_factory=set)
    depth: float = 0.0
    supports: dict[str, set[str]] = field(default_factory=dict)
    shares: dict[str, tuple[float, float]] = field(default_factory=dict)


def stages_of(handling: Handling) -> list[Stage]:
    """What has to hold in each leg, while the arm is at rest behind the last one for as long as the request asks, and
    then until a robot that starts late may be through, if a part was put down."""
    plan, scene = handling.plan, handling.scene
    found = [_stage(handling, k, (leg.t0, leg.t1)) for k, leg in enumerate(plan.legs)]
    end, stay, late = plan.legs[-1].t1, scene.options.stay_safe_s, scene.execution.start_tolerance_s
    if scene.options.end == "rest" and stay > 0.0:
        found.append(_stage(handling, len(plan.legs), (end, end + stay)))
        end += stay
    if late > 0.0:
        last = _stage(handling, len(plan.legs), (end, end + late))
        if last.supports:
            last.robot, last.shares = False, {}
            found.append(last)
    return found


def _stage(handling: Handling, leg: int, when: Interval) -> Stage:
    handed, legs = handling.handed_before_leg(leg), handling.plan.legs
    stage = Stage(when, handed, handling.held(handed), shares=handling.shares(leg))
    for part in {handling.scene.task[number].part for number in handed}:
        if part is not None and part != stage.held:
            stage.supports[part] = handling.kept_supports(part, handed)
    if leg < len(legs) and handling.tracks[leg]:
        stage.near = True
        stage.depth = CONTACT_M + handling.scene.task[legs[leg].step].contact_tolerance_m
        stage.touching = handling.touching(leg)
    return stage


def phases_agree(handling: Handling, stages: list[Stage], claim: c.Claim) -> Iterator[Difference]:
    """Differences of the phases; first of their number and times, without which nothing else can be compared."""
    times = claim.phases[:, c.PHASE_T0 : c.PHASE_T1 + 1].tolist()
    if times != [list(stage.when) for stage in stages]:
        yield Difference(Topic.PHASE, "the phases are not the legs of the plan and what comes behind them")
        return
    names = [body.name for body in bodies_of(handling.scene)]
    flags = zip(stages, claim.phases[:, [c.PHASE_NEAR, c.PHASE_ROBOT]].tolist(), strict=True)
    for stage, (near, robot) in flags:
        if not (near == 0.0 or (near == 1.0 and stage.near)):
            yield Difference(Topic.DISTANCE, "the smaller distance, near a control point, is stated", stage.when)
        if not (robot == 1.0 or not stage.robot):
            yield Difference(Topic.DISTANCE, "the robot need not keep clear in the claim", stage.when)
    yield from _seats_agree(handling, stages, claim, names)
    yield from _contacts_agree(stages, claim, names)
    yield from _shares_agree(handling, stages, claim)


def _seats_agree(handling: Handling, stages: list[Stage], claim: c.Claim, names: list[str]) -> Iterator[Difference]:
    """Each body is fixed to its link or frame, at its pose, and as much of it is uncertain as is required."""
    seats, off = _required_seats(handling, stages, names)
    stated = claim.seats[claim.seated.astype(int)]
    yaw = np.remainder(stated[:, :, -1] - seats[:, :, -1] + math.pi, math.tau) - math.pi
    apart = np.maximum(np.abs(stated[:, :, c.SEAT_POSE : -1] - seats[:, :, c.SEAT_POSE : -1]).max(2), np.abs(yaw))
    same = (stated[:, :, : c.SEAT_POSE] == seats[:, :, : c.SEAT_POSE]).all(2) & (apart <= SAME)
    for phase, body in np.argwhere(~same).tolist():
        what = f"{names[body]} is fixed to something else, or at another pose"
        yield Difference(Topic.SEAT, what, stages[phase].when)
    for phase, column in np.argwhere(~(claim.off >= off - SAME)).tolist():
        name = names[column % len(names)]
        yield Difference(Topic.UNCERTAINTY, f"{name} may be farther off than the claim states", stages[phase].when)


def _required_seats(handling: Handling, stages: list[Stage], names: list[str]) -> tuple[FloatArray, FloatArray]:
    """The seat of each body in each stage, (P, B, 7), and by how much each may be off it: (P, 2 B), horizontally, and
    then up or down, m."""
    scene = handling.scene
    frames, flange = {name: float(k) for k, name in enumerate(scene.frames)}, float(flange_row(scene.robot))

    def seat(body: int, where: Where) -> tuple[float, ...]:
        frame, pose = where
        return (body, flange, -1.0, *pose) if frame is None else (body, -1.0, frames[frame], *pose)

    links = [link_row(scene.robot, item.link) for item in scene.robot.bodies]
    links += [flange_row(scene.robot)] * len(scene.tool.bodies)
    seats: list[tuple[float, ...]] = [(k, link, -1.0, *IDENTITY) for k, link in enumerate(links)]
    off = [(0.0, 0.0)] * len(links)
    for k, body in enumerate(scene.bodies, start=len(links)):
        seats.append(seat(k, handling.place(body.name, ())))
        off.append(handling.displaced(body.name, ()))
    # parts that are handled have others, phase by phase
    many = len(stages), len(seats)
    all_seats = np.array([seats] * len(stages), dtype=float).reshape(*many, c.SEAT)
    all_off = np.array([off] * len(stages), dtype=float).reshape(*many, 2)
    for k, part in [(names.index(part), part) for part in handling.parts]:
        for p, stage in enumerate(stages):
            all_seats[p, k] = seat(k, handling.place(part, stage.handed))
            all_off[p, k] = handling.displaced(part, stage.handed)
    return all_seats, all_off.transpose(0, 2, 1).reshape(len(stages), 2 * len(seats))


def _contacts_agree(stages: list[Stage], claim: c.Claim, names: list[str]) -> Iterator[Difference]:
    """No pair may touch, or overlap by more, than is allowed; and parts that were put down are kept clear."""
    for phase, one, other, depth in claim.contacts.tolist():
        stage, pair = stages[int(phase)], (names[int(one)], names[int(other)])
        if frozenset(pair) not in stage.touching:
            yield Difference(Topic.CONTACT, f"{' and '.join(pair)} may not touch", stage.when)
        elif not depth <= stage.depth + SAME:
            yield Difference(Topic.CONTACT, f"{' and '.join(pair)} may not overlap by {depth:g} m", stage.when)
    stated: list[dict[str, set[str]]] = [{} for _ in stages]
    for (phase, body), row in zip(claim.put_down.tolist(), claim.supports, strict=True):
        kept = stated[int(phase)].setdefault(names[int(body)], set())
        kept.update(names[k] for k in np.flatnonzero(row))
    for stage, own in zip(stages, stated, strict=True):
        for part in set(stage.supports) - set(own):
            yield Difference(Topic.CONTACT, f"{part} was put down, and is not kept clear", stage.when)
        for part, supports in own.items():
            for other in supports - stage.supports.get(part, set()):
                yield Difference(Topic.CONTACT, f"{part} does not rest on {other}", stage.when)


def _shares_agree(handling: Handling, stages: list[Stage], claim: c.Claim) -> Iterator[Difference]:
    """The tool may have any share in the error of a frame that belt correction may give it."""
    count, frames = len(handling.scene.frames), list(handling.scene.frames)
    required = np.zeros((len(stages), 2 * count))
    for k, stage in enumerate(stages):
        for frame, share in stage.shares.items():
            required[k, [frames.index(frame), count + frames.index(frame)]] = share
    wide = (claim.shares[:, :count] <= required[:, :count]) & (claim.shares[:, count:] >= required[:, count:])
    for phase, number in np.argwhere(~wide).tolist():
        what = f"the tool may have another share in the error of {frames[number]}"
        yield Difference(Topic.UNCERTAINTY, what, stages[phase].when)

"""Is each leg a phase of the claim, with the bodies where they are, and no contact that is not allowed?

A phase may state more than is required: fewer contacts, more uncertainty, the distance of travel in place of `near`.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import SAME
from assur.planner.checker.statement.holding import Where
from assur.planner.checker.statement.poses import IDENTITY
from assur.planner.checker.statement.statement import Statement
from assur.planner.checker.verdict import Code
from assur.planner.claim import columns as c


def require_phases(statement: Statement) -> None:
    """The phases are the stages of the plan; first their number and times, without which nothing else is compared."""
    stages, phases = statement.stages, statement.claim.phases
    if phases[:, c.PHASE_T0 : c.PHASE_T1 + 1].tolist() != [list(stage.when) for stage in stages]:
        statement.require(False, Code.PHASE, "the phases are not the legs of the plan and what comes behind them")
        return
    names = list(statement.bodies)
    _require_seats(statement, names)
    _require_contacts(statement, names)
    count = len(statement.frames)
    shares = np.zeros((len(stages), 2, count))
    for phase, (stage, (near, robot)) in enumerate(
        zip(stages, phases[:, [c.PHASE_NEAR, c.PHASE_ROBOT]].tolist(), strict=True)
    ):
        what = "the smaller distance, near a control point, is stated"
        statement.require(near == 0.0 or (near == 1.0 and stage.near), Code.DISTANCE, what, stage.when)
        what = "the robot need not keep clear in the claim"
        statement.require(robot == 1.0 or not stage.robot, Code.DISTANCE, what, stage.when)
        for frame, share in stage.shares.items():
            shares[phase, :, statement.frames[frame]] = share
    # the tool may have any share in the error of a frame that belt correction may give it
    least, most = statement.claim.shares[:, :count], statement.claim.shares[:, count:]
    for phase, number in np.argwhere(~((least <= shares[:, 0]) & (most >= shares[:, 1]))).tolist():
        what = f"the tool may have another share in the error of {list(statement.frames)[number]}"
        statement.require(False, Code.UNCERTAINTY, what, stages[phase].when)


def _require_seats(statement: Statement, names: list[str]) -> None:
    """Each body is fixed to its link or frame, at its pose, and as much of it is uncertain as is required."""
    seats, off = _required_seats(statement)
    stages, stated = statement.stages, statement.claim.seats[statement.claim.seated.astype(int)]
    apart = np.abs(stated - seats)
    apart[:, :, -1] = np.abs(np.remainder(apart[:, :, -1] + math.pi, math.tau) - math.pi)
    for phase, body in np.argwhere(~(apart.max(2) <= SAME)).tolist():
        what = f"{names[body]} is fixed to something else, or at another pose"
        statement.require(False, Code.SEAT, what, stages[phase].when)
    for phase, column in np.argwhere(~(statement.claim.off >= off - SAME)).tolist():
        what = f"{names[column % len(names)]} may be farther off than the claim states"
        statement.require(False, Code.UNCERTAINTY, what, stages[phase].when)


def _required_seats(statement: Statement) -> tuple[FloatArray, FloatArray]:
    """The seat of each body in each stage, (P, B, 7), and by how much each may be off it: (P, 2 B), horizontally, and
    then up or down, m."""
    scene, stages, flange = statement.scene, statement.stages, statement.flange

    def seat(body: int, where: Where) -> tuple[float, ...]:
        frame, pose = where
        return (body, flange, -1.0, *pose) if frame is None else (body, -1.0, statement.frames[frame], *pose)

    links = [item.link for item in scene.robot.bodies] + [flange] * len(scene.tool.bodies)
    seats: list[tuple[float, ...]] = [(k, link, -1.0, *IDENTITY) for k, link in enumerate(links)]
    seats += [seat(k, statement.place(body.name, ())) for k, body in enumerate(scene.bodies, start=len(links))]
    off = [(0.0, 0.0)] * len(links) + [statement.displaced(body.name, ()) for body in scene.bodies]
    # parts that are handled have others, phase by phase
    all_seats = np.array(seats, dtype=float).reshape(1, -1, c.SEAT).repeat(len(stages), 0)
    all_off = np.array(off, dtype=float).reshape(1, -1, 2).repeat(len(stages), 0)
    for part in statement.parts:
        k = statement.bodies[part]
        for p, stage in enumerate(stages):
            all_seats[p, k] = seat(k, statement.place(part, stage.handed))
            all_off[p, k] = statement.displaced(part, stage.handed)
    return all_seats, all_off.transpose(0, 2, 1).reshape(len(stages), 2 * len(seats))


def _require_contacts(statement: Statement, names: list[str]) -> None:
    """No pair may touch, or overlap by more, than is allowed; and parts that were put down are kept clear."""
    stages, claim = statement.stages, statement.claim
    for phase, one, other, depth in claim.contacts.tolist():
        stage, pair = stages[int(phase)], (names[int(one)], names[int(other)])
        may, words = frozenset(pair) in stage.touching, " and ".join(pair)
        statement.require(may, Code.CONTACT, f"{words} may not touch", stage.when)
        deep = not may or depth <= stage.depth + SAME
        statement.require(deep, Code.CONTACT, f"{words} may not overlap by {depth:g} m", stage.when)
    stated: list[dict[str, set[str]]] = [{} for _ in stages]
    for (phase, body), row in zip(claim.put_down.tolist(), claim.supports, strict=True):
        kept = stated[int(phase)].setdefault(names[int(body)], set())
        kept.update(names[k] for k in np.flatnonzero(row))
    for stage, own in zip(stages, stated, strict=True):
        for part in stage.supports:
            statement.require(part in own, Code.CONTACT, f"{part} was put down, and is not kept clear", stage.when)
        for part, supports in own.items():
            for other in supports - stage.supports.get(part, set()):
                statement.require(False, Code.CONTACT, f"{part} does not rest on {other}", stage.when)

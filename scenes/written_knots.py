"""The motion of an answer: its knots in the maker's convention, which are read back bit by bit, and its arrivals."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import Arrival, Plan
from assur.planner.trajectory import Trajectory
from assur.scenes.answer_facts import document_of, written
from assur.scenes.conventions import Conventions, as_counted, as_maker, converted, rates_as_maker
from assur.scenes.numbers import number
from assur.scenes.reading.cell import Cell
from assur.scenes.schema import answer as document

BRIEF = ("pitch_rad", "roll_rad", "grip_m", "support_m")
"""Fields of an arrival that are left out where there is nothing to state."""


def with_rounded_knots(cell: Cell, plan: Plan) -> Plan:
    """The plan with rounded knots: its document is read back as the same knots, bit by bit.

    Where a joint has a zero of its own, positions are rounded on the way to the maker's count and back, by some 1e-16.
    They are rounded so once, here: x ↦ (x ⊖ y) ⊕ y leaves what it gave before as it is (Knuth, The Art of Computer
    Programming 4.2.2, theorem D). The proof keeps 1 µm, and the checker checks what is written.
    """
    from assur.planner.model.digest import digest

    if not cell.conventions.zeros.any():
        return plan
    knots = plan.trajectory
    q = converted(as_maker(knots.q, cell.conventions), cell.conventions)
    trajectory = Trajectory(knots.time, q, knots.qd, knots.qdd, jumps=knots.jumps)
    certificate = replace(
        plan.certificate, digest=digest(cell.scene.digest, trajectory, plan.legs, plan.arrivals, plan.certificate)
    )
    return replace(plan, trajectory=trajectory, certificate=certificate)


def trajectory_document(cell: Cell, trajectory: Trajectory) -> document.Trajectory:
    """The knots of a settled plan in the maker's convention. Reading them back gives the planner's, bit by bit."""
    conventions = cell.conventions
    columns = np.array((trajectory.q - conventions.zeros, trajectory.qd, trajectory.qdd))
    written = rates_as_maker(columns, conventions)  # positions without their zeros, too
    if not np.isfinite(written).all():
        raise FaultError("a trajectory is not finite")
    rows: list[list[list[float]]] = written.tolist()
    return {
        "joint_names": [joint.name for joint in conventions],
        "joint_units": ["rad" if joint.kind == "revolute" else "m" for joint in conventions],
        "time_s": trajectory.time.tolist(),
        "position": rows[0],
        "velocity": rows[1],
        "acceleration": rows[2],
        "acceleration_jumps": bool(trajectory.jumps),
    }


def arrival_document(cell: Cell, trajectory: Trajectory, arrival: Arrival) -> document.Arrival:
    """An arrival of a motion."""
    missed, error, conventions = arrival.missed_by, arrival.error, cell.conventions
    q = trajectory.evaluate(arrival.time)
    mode = int(cell.scene.robot.mode_of(q))
    found = document_of(
        arrival,
        at_m=[number(x) for x in (arrival.pose.x, arrival.pose.y, arrival.pose.z)],
        yaw_rad=number(arrival.pose.yaw),
        missed_by=None
        if missed is None
        else document_of(missed, joints=tuple(rates_as_maker(np.array(missed.joints), conventions).tolist())),
        error=None if error is None else _error(error, conventions),
        joints=tuple(as_maker(q, conventions).tolist()),
        mode=cell.scene.robot.modes[mode] if mode >= 0 else None,
    )
    return cast(document.Arrival, {key: value for key, value in found.items() if value is not None or key not in BRIEF})


def _error(error: ArrivalError, conventions: Conventions) -> document.ArrivalError:
    within, counted = error.within, as_counted(error.worst, conventions)
    return {
        "position_m": number(error.position_m),
        "horizontal_m": number(within.position_m),
        "vertical_m": number(within.vertical_m),
        "yaw_rad": number(within.yaw_rad),
        "causes": written(error.shares),
        "worst": [{"what": what, "value": number(value)} for what, value in counted],
    }

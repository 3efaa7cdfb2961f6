"""The motion of an answer: its knots as they are written, in the maker's convention, and read back bit by bit, and its
arrivals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import Arrival, Plan, Traced
from assur.planner.trajectory import Trajectory
from assur.scenes.conventions import Conventions, as_counted, as_maker, converted, rates_as_maker, zeros
from assur.scenes.numbers import number
from assur.scenes.reading.cell import Cell
from assur.scenes.schema import answer as document


def settled(cell: Cell, plan: Plan) -> Plan:
    """The plan whose knots are read back bit by bit from what is written of them.

    Where a joint has a zero of its own, positions are rounded on the way to the maker's count and back, by some 1e-16.
    They are rounded so once, here: x ↦ (x ⊖ y) ⊕ y leaves what it gave before as it is (Knuth, The Art of Computer
    Programming 4.2.2, theorem D). The proof keeps 1 µm, and the checker checks what is written.
    """
    from assur.planner.model.digest import digest

    if not any(zeros(cell.conventions)):
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
    rates = rates_as_maker(np.stack([trajectory.qd, trajectory.qdd]), cell.conventions)
    written = np.concatenate([as_maker(trajectory.q, cell.conventions)[None], rates])
    if not np.isfinite(written).all():
        raise FaultError("a trajectory is not finite")
    rows: list[list[list[float]]] = written.tolist()
    return {
        "joint_names": [joint.name for joint in cell.conventions],
        "joint_units": ["rad" if joint.kind == "revolute" else "m" for joint in cell.conventions],
        "time_s": trajectory.time.tolist(),
        "position": rows[0],
        "velocity": rows[1],
        "acceleration": rows[2],
        "acceleration_jumps": bool(trajectory.jumps),
    }


def arrival_document(cell: Cell, trajectory: Trajectory, arrival: Arrival) -> document.Arrival:
    """An arrival of a motion."""
    missed, robot = arrival.missed_by, cell.scene.robot
    q = trajectory.evaluate(arrival.time)
    mode = int(robot.mode_of(q))
    written: document.Arrival = {
        "control_point": arrival.control_point,
        "step": int(arrival.step),
        "time_s": number(arrival.time),
        "until_s": number(arrival.until),
        "at_m": [number(x) for x in (arrival.pose.x, arrival.pose.y, arrival.pose.z)],
        "yaw_rad": number(arrival.pose.yaw),
        "yaw_offset_rad": number(arrival.yaw_offset),
        "matched": bool(arrival.matched),
        "along_m": None if arrival.along_m is None else number(arrival.along_m),
        "window_left_s": None if arrival.window_left_s is None else number(arrival.window_left_s),
        "missed_by": None
        if missed is None
        else {
            "joints": [number(x) for x in rates_as_maker(np.array(missed.joints), cell.conventions).tolist()],
            "distance_m": number(missed.distance_m),
        },
        "error": None if arrival.error is None else _error(arrival.error, cell.conventions),
        "joints": [number(x) for x in as_maker(q, cell.conventions).tolist()],
        "mode": robot.modes[mode] if mode >= 0 else None,
        "trace": None if arrival.trace is None else _traced(arrival.trace),
    }
    if arrival.pitch is not None:
        written["pitch_rad"] = number(arrival.pitch)
    if arrival.roll is not None:
        written["roll_rad"] = number(arrival.roll)
    if arrival.grip_m is not None:
        written["grip_m"] = number(arrival.grip_m)
    if arrival.support_m is not None:
        written["support_m"] = number(arrival.support_m)
    return written


def _traced(trace: Traced) -> document.Traced:
    return {
        "length_m": number(trace.length_m),
        "slowest_m_s": number(trace.slowest_m_s),
        "fastest_m_s": number(trace.fastest_m_s),
        "error_m": number(trace.error_m),
    }


def _error(error: ArrivalError, conventions: Conventions) -> document.ArrivalError:
    within, counted = error.within, as_counted(error.worst, conventions)
    return {
        "position_m": number(error.position_m),
        "horizontal_m": number(within.position_m),
        "vertical_m": number(within.vertical_m),
        "yaw_rad": number(within.yaw_rad),
        "causes": [
            {"cause": share.cause, "position_m": number(share.position_m), "yaw_rad": number(share.yaw_rad)}
            for share in error.shares
        ],
        "worst": [{"what": what, "value": number(value)} for what, value in counted],
    }

"""The arrivals of a motion as an answer writes them."""

from __future__ import annotations

import numpy as np

from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import Arrival, Traced
from assur.planner.trajectory import Trajectory
from assur.scenes.conventions import Conventions, as_counted, as_maker, rates_as_maker
from assur.scenes.numbers import number
from assur.scenes.reading.cell import Cell
from assur.scenes.schema import answer as document


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

"""One number for a request and its plan: to change either afterwards changes the number.

It guards against mistakes (a certificate of another plan, a file cut short), not against malice: anyone can compute it
again, so the checker trusts nothing because of it.

What is hashed: the length of a text, the text, and the numbers of the knots and of the certificate. The text is what
`ascii` writes for nested lists of texts, numbers, truth values and None. It says all that is no column, and how long
the columns are, so no two plans have the same bytes. Columns are float64 or int64, little-endian; −0 counts as 0.
"""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import Arrival, Certificate, Leg
from assur.planner.trajectory import Trajectory

FORMAT = "assur-plan-7"
"""Changes whenever the meaning of a column, or the order of what follows, does."""


def digest(
    scene_digest: str,
    trajectory: Trajectory,
    legs: tuple[Leg, ...],
    arrivals: tuple[Arrival, ...],
    certificate: Certificate,
) -> str:
    """SHA-256, in hexadecimal, of the request's digest, the knots, legs, arrivals and all columns of the certificate.

    The certificate's own `digest` does not count. Not checked: whether any of it is true.
    """
    columns = [certificate.t0[:, None], certificate.t1[:, None], certificate.normal]
    if certificate.shift0 is not None and certificate.shift1 is not None:
        columns += [certificate.shift0[:, None], certificate.shift1[:, None]]
    knots, rows = trajectory.knots + 0.0, np.concatenate(columns, 1) + 0.0  # −0 as 0
    text = ascii(
        [
            FORMAT,
            str(scene_digest),
            bool(trajectory.jumps),
            list(map(str, certificate.covers)),
            list(map(str, certificate.names)),
            list(map(_leg, legs)),
            list(map(_arrival, arrivals)),
            knots.shape,
            rows.shape,
        ]
    ).encode()
    indices = np.array(
        [certificate.first, certificate.first_piece, certificate.second, certificate.second_piece], "<i8"
    )
    numbers = np.asarray(knots, "<f8").tobytes(), np.asarray(rows, "<f8").tobytes(), indices.T.tobytes()
    return hashlib.sha256(b"".join([len(text).to_bytes(8, "little"), text, *numbers])).hexdigest()


def _leg(leg: Leg) -> list[Any]:
    route = leg.route
    way = None if route is None else [str(route.course), int(route.vias), bool(route.after_wait), bool(route.later)]
    return [str(leg.kind), int(leg.step), float(leg.t0) + 0.0, float(leg.t1) + 0.0, way]


def _arrival(arrival: Arrival) -> list[Any]:
    pose, missed, trace = arrival.pose, arrival.missed_by, arrival.trace
    known = [arrival.along_m, arrival.window_left_s, arrival.pitch, arrival.roll]
    touching = [arrival.grip_m, arrival.support_m]  # nothing where neither is stated, as in old plans
    return [
        int(arrival.step),
        str(arrival.control_point),
        bool(arrival.matched),
        *_numbers(arrival.time, arrival.until, pose.x, pose.y, pose.z, pose.yaw, arrival.yaw_offset),
        *[None if value is None else float(value) + 0.0 for value in known],
        None if missed is None else _numbers(*missed.joints, missed.distance_m),
        None if arrival.error is None else _error(arrival.error),
        None if trace is None else _numbers(trace.length_m, trace.slowest_m_s, trace.fastest_m_s, trace.error_m),
        *([] if touching == [None, None] else [None if value is None else float(value) + 0.0 for value in touching]),
    ]


def _error(error: ArrivalError) -> list[Any]:
    within = error.within
    return [
        *_numbers(error.position_m, within.position_m, within.vertical_m, within.yaw_rad),
        [[str(share.cause), *_numbers(share.position_m, share.yaw_rad)] for share in error.shares],
        [[str(name), float(value) + 0.0] for name, value in error.worst],
    ]


def _numbers(*values: float) -> list[float]:
    """Python's own floats, −0 as 0: their shortest texts are different if the numbers are."""
    return [float(value) + 0.0 for value in values]

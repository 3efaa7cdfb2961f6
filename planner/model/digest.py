"""One number for a request and its plan: whoever changes either afterwards changes the number.

It guards against mistakes (a certificate of another plan, a file cut short), not against malice: anyone can compute it
again, so the checker trusts nothing because of it.

Canonical form: every item is its tag and its length before its bytes, so no two lists of items have the same bytes.
Numbers are float64 or int64, little-endian, −0 as 0; text is UTF-8; what is absent is a tag of its own.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from assur.planner.model.outcome import Arrival, Certificate, Leg, Route
from assur.planner.trajectory import Trajectory

FORMAT = "assur-plan-4"
"""Changes whenever the meaning of a column, or the order of the items below, does."""

REALS = ("t0", "t1", "normal")
INDICES = ("first", "first_piece", "second", "second_piece")


_WHOLE, _REAL = struct.Struct("<q").pack, struct.Struct("<d").pack


def digest(
    scene_digest: str,
    trajectory: Trajectory,
    legs: tuple[Leg, ...],
    arrivals: tuple[Arrival, ...],
    certificate: Certificate,
) -> str:
    """SHA-256, in hexadecimal, of the request's digest, the knots, legs, arrivals and all columns of the certificate.

    The certificate's own `digest` does not count. Not looked at: whether any of it is true.
    """
    items = _items(scene_digest, trajectory, legs, arrivals, certificate)
    return hashlib.sha256(b"".join(map(_canonical, items))).hexdigest()


def _items(
    scene_digest: str,
    trajectory: Trajectory,
    legs: tuple[Leg, ...],
    arrivals: tuple[Arrival, ...],
    certificate: Certificate,
) -> Iterator[Any]:
    yield from (FORMAT, scene_digest, len(legs), len(arrivals), len(certificate.names))
    yield from (np.asarray(getattr(trajectory, name), dtype="<f8") for name in ("time", "q", "qd", "qdd"))
    yield from (bool(trajectory.jumps), len(certificate.covers), *certificate.covers)
    for leg in legs:
        yield from (str(leg.kind), int(leg.step), float(leg.t0), float(leg.t1), *_route(leg.route))
    for arrival in arrivals:
        yield from (int(arrival.step), arrival.control_point, float(arrival.time), float(arrival.until))
        yield from (float(value) for value in (arrival.pose.x, arrival.pose.y, arrival.pose.z, arrival.pose.yaw))
        yield from (bool(arrival.matched), float(arrival.yaw_offset), arrival.along_m, arrival.window_left_s)
        yield from (arrival.pitch, arrival.roll)
        missed = arrival.missed_by
        yield None if missed is None else np.array([*missed.joints, missed.distance_m], dtype="<f8")
    yield from certificate.names
    yield from (np.asarray(getattr(certificate, name), dtype="<f8") for name in REALS)
    yield from (np.asarray(getattr(certificate, name), dtype="<i8") for name in INDICES)


def _route(route: Route | None) -> tuple[Any, ...]:
    return (None,) if route is None else (str(route.course), int(route.vias), route.after_wait, route.later)


def _canonical(item: Any) -> bytes:
    if isinstance(item, float):
        return b"f" + _REAL(item + 0.0)
    if item is None:
        return b"-"
    if isinstance(item, str):
        text = item.encode(errors="surrogatepass")
        return b"s" + _WHOLE(len(text)) + text
    if isinstance(item, int):
        return b"i" + _WHOLE(item)
    if isinstance(item, np.ndarray):
        shape = struct.pack(f"<{item.ndim + 1}q", item.ndim, *item.shape)
        kind, numbers = str(item.dtype.kind), bytes((item + 0).astype(item.dtype, copy=False).tobytes())
        return kind.encode() + shape + numbers
    return b"f" + _REAL(float(item) + 0.0)

"""One number for a request and its plan: whoever changes either afterwards changes the number.

It guards against mistakes (a certificate of another plan, a file cut short), not against malice: anyone can compute it
again, so the checker trusts nothing because of it.

What is hashed: the length of a text, the text, and the numbers of the knots and of the certificate. The text is what
`ascii` writes for nested lists of texts, numbers, truth values and None. It says all that is no column, and how long
the columns are, so no two plans have the same bytes. Columns are float64 or int64, little-endian; −0 counts as 0.
"""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from assur.planner.model.outcome import INDICES, Arrival, Certificate, Leg
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

    The certificate's own `digest` does not count. Not looked at: whether any of it is true.
    """
    knots = np.column_stack([trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd])
    columns = [certificate.t0, certificate.t1, certificate.normal]
    if certificate.shift0 is not None and certificate.shift1 is not None:
        columns += [certificate.shift0, certificate.shift1]
    rows = np.column_stack(columns)
    indices = np.column_stack([getattr(certificate, name) for name in INDICES])
    text = ascii(
        [
            FORMAT,
            str(scene_digest),
            bool(trajectory.jumps),
            list(map(str, certificate.covers)),
            list(map(str, certificate.names)),
            [_plain(leg) for leg in legs],
            [_arrival(arrival) for arrival in arrivals],
            knots.shape,
            rows.shape,
        ]
    ).encode()
    found = hashlib.sha256(len(text).to_bytes(8, "little") + text)
    for table, kind in ((knots, "<f8"), (rows, "<f8"), (indices, "<i8")):
        found.update(np.ascontiguousarray(table + 0, dtype=kind).tobytes())
    return found.hexdigest()


FLAT = ("pose", "within", "joints")
"""Fields whose numbers are in the list of what has them, and not in one of their own."""


def _arrival(arrival: Arrival) -> list[Any]:
    """The fields of an arrival, whether it is matched before its times. How far tool or support are from the part only
    where one of both is stated: plans from before it was have neither."""
    found: list[Any] = _plain(arrival)
    found.insert(2, found.pop(8))
    return found if found[-2:] != [None, None] else found[:-2]


def _plain(value: object, kind: str = "") -> Any:
    """A value as nested lists of texts, truth values, None and Python's own numbers, −0 as 0: their shortest texts are
    different if the numbers are. `kind`: how its field is declared."""
    if is_dataclass(value):
        found = list[Any]()
        for each in fields(value):
            plain = _plain(getattr(value, each.name), str(each.type))
            found += plain if each.name in FLAT else [plain]
        return found
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    if value is None or isinstance(value, str):
        return None if value is None else str(value)
    numbers = {"bool": bool, "int": int}
    return numbers[kind](value) if kind in numbers else float(value) + 0.0  # type: ignore[arg-type]

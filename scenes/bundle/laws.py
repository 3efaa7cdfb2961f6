"""Motions of frames, by their accelerations: polynomials on pieces of time, and sines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames import Conveyor, Fixed, Indexer, Keyframes, Law, Linear, Oscillation, Swing, Turntable
from assur.planner.frames.motion import Pose
from assur.planner.frames.profile import Profile
from assur.scenes.bundle.unstated import unstated

Document = dict[str, Any]
Piece = tuple[float, Sequence[Sequence[float]]]
"""When a piece begins, and the acceleration of x, y, z and yaw: coefficients of the powers of the time since then."""
MOVE = (420.0, -1680.0, 2100.0, -840.0)
"""Coefficients of u², u³, u⁴, u⁵ of the second derivative of a step (F3)."""


def law_of(law: Law, begin: float, until: float) -> Document:
    """A law over [begin, until], as far as it is known. Raises `InputError` for a law that cannot be stated."""
    begin, until = max(begin, law.valid[0]), min(until, law.valid[1])
    if isinstance(law, Fixed) and law.valid == (-math.inf, math.inf):
        return _still(law.pose)
    if isinstance(law, Swing | Oscillation) and law.valid == (-math.inf, math.inf):
        return {**_still(law.pose), "waves": _waves(law)}
    if not begin < until:
        raise unstated("a frame whose motion is not known during the plan")
    found = [piece for piece in _pieces(law, begin, until) if piece[0] < until]
    ends = [*(time for time, _ in found[1:]), until]
    pieces = [piece for piece, end in zip(found, ends, strict=True) if piece[0] < end]  # some last no time
    first = max((k for k, piece in enumerate(pieces) if piece[0] <= begin), default=0)
    pieces = pieces[first:]
    at = law.motion(np.array(pieces[0][0]))
    if not np.isfinite(at.p).all():
        raise unstated("a frame whose motion begins within the plan")
    return {
        "pose": [*at.p.tolist(), float(at.yaw)],
        "rate": [*at.v.tolist(), float(at.yaw_d)],
        "edges": [*(time for time, _ in pieces), until],
        "acceleration": [[list(powers) for powers in accelerations] for _, accelerations in pieces],
        "waves": [],
    }


def _still(pose: Pose) -> Document:
    place = [pose.x, pose.y, pose.z, pose.yaw]
    return {"pose": place, "rate": [0.0] * 4, "edges": [], "acceleration": [], "waves": []}


def _waves(law: Swing | Oscillation) -> list[Document]:
    sine = {"rate": 2.0 * math.pi / law.period, "phase": law.phase}
    if isinstance(law, Swing):
        return [{"coordinate": 3, "amplitude": law.amplitude, **sine}]
    along = law.along.tolist()
    return [{"coordinate": k, "amplitude": law.amplitude * u, **sine} for k, u in enumerate(along) if u != 0.0]


def _pieces(law: Law, begin: float, until: float) -> list[Piece]:
    nothing: Sequence[float] = ()
    if isinstance(law, Fixed | Linear):
        return [(begin, (nothing,) * 4)]
    if isinstance(law, Conveyor):
        c, s = math.cos(law.pose.yaw), math.sin(law.pose.yaw)
        return [(t, ([c * a for a in way], [s * a for a in way], (), ())) for t, way in _ramps(law.drive, begin)]
    if isinstance(law, Turntable):
        return [(t, ((), (), (), way)) for t, way in _ramps(law.drive, begin)]
    if isinstance(law, Indexer):
        return _steps(law, begin, until)
    if isinstance(law, Keyframes):
        return _spline(law, begin, until)
    raise unstated(f"the motion {type(law).__name__} of a frame")


def _ramps(drive: Profile, begin: float) -> list[tuple[float, list[float]]]:
    """Acceleration along the way on each piece of a drive, the first from `begin` on."""
    anchors = [drive.first, *drive.switches.tolist()]
    starts = [begin, *drive.switches.tolist()]
    found = []
    for anchor, start, row in zip(anchors, starts, drive.coefficients, strict=True):
        powers = _second(row)
        if start != anchor and any(powers):
            raise unstated("a drive that accelerates for ever")  # its first piece is linear in time
        found.append((start, powers))
    if len(found) > 1 and begin > found[1][0]:
        return found[1:]
    return found


def _second(row: FloatArray) -> list[float]:
    """Coefficients of the second derivative of a polynomial, without zeros behind the last that is none."""
    powers = [k * (k - 1) * float(a) for k, a in enumerate(row.tolist())][2:]
    while powers and powers[-1] == 0.0:
        powers.pop()
    return powers


def _steps(law: Indexer, begin: float, until: float) -> list[Piece]:
    moved = [0.0, 0.0, *(law.step * c / law.move_s ** (k + 4) for k, c in enumerate(MOVE))]
    c, s = math.cos(law.pose.yaw), math.sin(law.pose.yaw)
    move: Sequence[Sequence[float]] = ((), (), (), moved)
    if law.kind == "travel":
        move = ([c * a for a in moved], [s * a for a in moved], (), ())
    found: list[Piece] = []
    for k in _whole(law.start, law.period, begin, until):
        found.append((law.start + k * law.period, move))
        if law.dwell_s > 0.0:
            found.append((law.start + k * law.period + law.move_s, ((), (), (), ())))
    return found


def _spline(law: Keyframes, begin: float, until: float) -> list[Piece]:
    found: list[Piece] = []
    first = float(law.times[0])
    for k in _whole(first, law.period, begin, until) if law.period else range(1):
        for time, rows in zip(law.knots.tolist(), law.coefficients, strict=False):
            since = first + k * law.period + time if law.period else time
            found.append((since, [_second(rows[:, i]) for i in range(4)]))
    return found


def _whole(start: float, period: float, begin: float, until: float) -> range:
    """Numbers of the periods that reach into [begin, until], and of one before and behind."""
    return range(math.floor((begin - start) / period) - 1, math.ceil((until - start) / period) + 2)

"""Whether a Cartesian leg goes along the path that is asked, by whatever law of time.

The path begins where the tool is when the leg begins. At instants t_k the place on the path that is nearest to the
tool, s_k, is looked for. Between two of them the tool leaves its chord by at most |ẅ| h²/8, the path its own chord by
at most κ Δs²/8 and, where its parts meet at a small angle, that angle times Δs/4; the chords are no farther apart than
their ends. So with e_k the distances at the instants

    every point of the way is near the path, and every point of the path near the way, to within
    max(e_k, e_k+1) + |ẅ| h²/8 + κ Δs²/8 + angle Δs/4                                                       (V6)

if s_0 = 0, the last s is the length, and no s is smaller than the one before.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import along
from assur.planner.checker.along import TRACKED_M
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.paths.curves import SMOOTH_RAD, Cut, curves_of
from assur.planner.checker.targets import Target
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.errors import InputError
from assur.planner.model.outcome import Arrival, Leg, LegKind
from assur.planner.model.scene import Move

STEP_S, DOUBLINGS, ROUNDS = 1e-3, 7, 4
"""Length of the first intervals, s; how often they are halved; and steps to the nearest place on a path."""


def along_path(world: World, legs: tuple[Leg, ...], arrival: Arrival, target: Target) -> list[Finding]:
    """Findings about the leg to a point along its path."""
    step = target.step
    if not isinstance(step, Move):
        return []
    own = [leg for leg in legs if leg.step == target.number and leg.kind is not LegKind.WAIT]
    own = [leg for leg in own if leg.t1 <= arrival.time + TIME_S]
    if not own:
        return [Finding(Code.LEGS, f"there is no leg along the path to {step.name}")]
    t0, t1, frame = own[0].t0, own[-1].t1, world.frame[target.frame]
    begin = _seen(world, frame, np.array([t0]))[0, along.PLACE : along.PLACE + 3]
    try:
        path = step.path_from((float(begin[0]), float(begin[1]), float(begin[2])))
        parts = curves_of(path)
    except InputError as error:
        return [Finding(Code.TRACKING, f"from where the leg begins there is no path to {step.name}: {error}")]
    length, bend = sum(part.length for part in parts), max(part.part.bend for part in parts)
    most, when = math.inf, t0
    for doubling in range(DOUBLINGS):
        t = np.linspace(t0, t1, math.ceil((t1 - t0) / STEP_S * 2**doubling) + 1)
        found, h = _seen(world, frame, t), (t1 - t0) / (len(t) - 1)
        s, off = _places(parts, length, found)
        gone = np.diff(s)
        bound = np.maximum(off[:-1], off[1:]) + found[:-1, along.BEND] * h**2 / 8.0
        bound = bound + bend * gone**2 / 8.0 + SMOOTH_RAD * np.abs(gone) / 4.0
        bound[~(gone >= 0.0)] = np.inf
        row = int(np.argmax(np.where(np.isnan(bound), np.inf, bound)))
        most, when = float(bound[row]), float(t[row])
        if most <= TRACKED_M:
            return []
        if not off.max() <= TRACKED_M:
            row = int(np.argmax(np.where(np.isnan(off), np.inf, off)))
            what = f"the tool leaves the path to {step.name}"
            return [Finding(Code.TRACKING, what, float(off[row]) - TRACKED_M, "m", f"{t[row]:.6g} s")]
    what = f"the tool could not be shown to keep to the path to {step.name}"
    return [Finding(Code.TRACKING, what, most - TRACKED_M, "m", f"{when:.6g} s")]


def _seen(world: World, frame: int, t: FloatArray) -> FloatArray:
    """The tool point as it is seen from a frame at times (T,), each with bounds up to the next."""
    return world.relative(frame, np.stack([t, np.append(t[1:], t[-1])], 1))


def _places(parts: tuple[Cut, ...], length: float, found: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places on the path, m, near the tool (T,), 0 at first and `length` at last; and how far it is from them, m."""
    w, v = found[:, along.PLACE : along.PLACE + 3], found[:, along.RATE : along.RATE + 3]
    chords = np.sqrt((np.diff(w, axis=0) ** 2).sum(1))
    s = np.append(0.0, np.cumsum(chords))
    s = np.clip(s * (length / s[-1]) if s[-1] > 0.0 else s, 0.0, length)
    speed = np.sqrt((v**2).sum(1))
    way = v / np.maximum(speed, 1e-12)[:, None]
    for _ in range(ROUNDS):
        # towards the foot of the perpendicular; where the tool all but rests its way is not known
        step = ((w - _at(parts, s)) * way).sum(1)
        s = np.clip(s + np.where(speed > 1e-6, step, 0.0), 0.0, length)
    s[0], s[-1] = 0.0, length
    # rounding must not turn two places about
    s = np.minimum(np.maximum.accumulate(s), length)
    return s, np.sqrt(((w - _at(parts, s)) ** 2).sum(1))


def _at(parts: tuple[Cut, ...], s: FloatArray) -> FloatArray:
    edges = np.append(0.0, np.cumsum([part.length for part in parts]))
    number = np.clip(np.searchsorted(edges, s, side="right") - 1, 0, len(parts) - 1)
    found = np.empty((len(s), 3))
    for k, part in enumerate(parts):
        rows = number == k
        if rows.any():
            found[rows] = part.place(s[rows] - edges[k])
    return found

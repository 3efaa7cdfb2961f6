"""How far apart two bodies must stay, phase by phase (equation C5 in docs/guarantees.md)."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.phases import CONTACT_M, Phase
from assur.planner.model.scene import Scene

SLACK_M = 1e-6
"""The reserve of a proof, taken off every gap, m: the checker has bounds of its own and asks for less (1 nm)."""


def clearance(scene: Scene, phase: Phase) -> float:
    """The distance asked for in this phase, m, before uncertainties."""
    asked = scene.options.clearance
    return asked.near_m if phase.near else asked.travel_m


def uncertainty(scene: Scene, phase: Phase, frame: str, t: FloatArray) -> FloatArray:
    """How far, m, bodies in `frame` may be from where the arm expects them at times t (last two terms of C5)."""
    own = _drift(scene, frame, t)
    if not scene.execution.belt_correction:
        return own
    if phase.glued is not None:
        return np.zeros_like(own) if frame == phase.glued else own + _drift(scene, phase.glued, t)
    total = own
    for beside in phase.beside:
        shift = _drift(scene, beside, t)
        total = np.maximum(total, shift) if frame == beside else total + shift
    return total


def _drift(scene: Scene, frame: str, t: FloatArray) -> FloatArray:
    known = scene.frames[frame].uncertainty
    return known.position_m + known.speed_m_s * np.maximum(np.asarray(t) - scene.start.time, 0.0)


def is_certain(scene: Scene) -> bool:
    """Whether no frame is uncertain, so that clearances do not grow with time."""
    return all(f.uncertainty.position_m == 0 and f.uncertainty.speed_m_s == 0 for f in scene.frames.values())


CONTACT_GAP = -CONTACT_M
"""Required gap of a pair that may touch, m."""


def worst(scene: Scene, phase: Phase, frame: str) -> float:
    """An upper bound of what is required of bodies in `frame` over the phase, without the term of a late start, m."""
    latest = np.array(phase.t1 + scene.execution.start_tolerance_s)
    found = clearance(scene, phase) + scene.execution.tracking_m + float(uncertainty(scene, phase, frame, latest))
    return found if math.isfinite(found) else math.inf

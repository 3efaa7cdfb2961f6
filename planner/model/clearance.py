"""How far apart two bodies must stay, phase by phase (equation C5 in docs/guarantees.md)."""

from __future__ import annotations

from assur.planner.model.phases import CONTACT_M, Phase
from assur.planner.model.scene import Scene


def clearance(scene: Scene, phase: Phase) -> float:
    """The distance asked for in this phase, m, before uncertainties."""
    asked = scene.options.clearance
    return asked.near_m if phase.near else asked.travel_m


def drift(scene: Scene, phase: Phase, frame: str) -> tuple[float, float]:
    """How far, m, bodies in `frame` may be from where the arm expects them at the start, and how fast that grows, m/s
    (last term of C5)."""
    own = _uncertain(scene, frame)
    if not scene.execution.belt_correction:
        return own
    if phase.tracked is not None:
        own = (0.0, 0.0) if frame == phase.tracked else own
    shifts = phase.corrected if phase.tracked is None else (phase.tracked,)
    for shift in shifts:
        # what shifts the arm with a frame does not part it from that frame
        if shift != frame:
            known = _uncertain(scene, shift)
            own = own[0] + known[0], own[1] + known[1]
    return own


def _uncertain(scene: Scene, frame: str) -> tuple[float, float]:
    known = scene.frames[frame].uncertainty
    return known.position_m, known.speed_m_s


CONTACT_GAP = -CONTACT_M
"""Required gap of a pair that may touch, m."""

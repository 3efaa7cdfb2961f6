"""How far apart two bodies must stay in a phase, before what is not known of them (equation N8 in
docs/bundle.md)."""

from __future__ import annotations

from assur.planner.model.phases import CONTACT_M, Phase, pair
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import Scene


def rule_of(scene: Scene, phase: Phase, first: str, second: str) -> tuple[Rule, float]:
    """Which rule says how far two bodies must stay apart in a phase, before what is not known of them, and how far, m:
    less than 0 for a pair that may touch."""
    if pair(first, second) in phase.contacts:
        return "contact", contact_gap(phase)
    required = scene.options.clearance
    distance = required.distances(first, second)[phase.near]
    if required.exception(first, second) is not None:
        return "exception", distance
    return "near" if phase.near else "travel", distance


def contact_gap(phase: Phase) -> float:
    """The gap, m, that a pair which may touch must keep: less than 0, it is how deep it may overlap."""
    return -CONTACT_M - phase.contact_tolerance_m

"""How far apart two bodies must stay in a phase, before what is not known of them (equation N8 in
docs/bundle.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.phases import CONTACT_M, Phase, pair
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import ClearanceException, Scene


def clearances(scene: Scene, near: bool, ones: Sequence[str], others: Sequence[str]) -> FloatArray:
    """The distance asked of each body of `ones` from each of `others`, (A, B) m, in approach, follow and depart
    (`near`) or elsewhere. Of the exceptions that name a pair the last one counts."""
    asked = scene.options.clearance
    found = np.full((len(ones), len(others)), asked.near_m if near else asked.travel_m)
    for rule in asked.exceptions:
        distance = rule.near_m if near else rule.travel_m
        for first, second in ((rule.first, rule.second), (rule.second, rule.first)):
            one = np.array([not first or name in first for name in ones], dtype=bool)
            other = np.array([not second or name in second for name in others], dtype=bool)
            found[np.ix_(one, other)] = distance
    return found


def rule_of(scene: Scene, phase: Phase, first: str, second: str) -> tuple[Rule, float]:
    """Which rule says how far two bodies must stay apart in a phase, before what is not known of them, and how far, m:
    less than 0 for a pair that may touch."""
    if pair(first, second) in phase.contacts:
        return "contact", contact_gap(phase)
    asked = scene.options.clearance
    for rule in reversed(asked.exceptions):
        for one, other in ((rule.first, rule.second), (rule.second, rule.first)):
            if (not one or first in one) and (not other or second in other):
                return "exception", rule.near_m if phase.near else rule.travel_m
    return ("near", asked.near_m) if phase.near else ("travel", asked.travel_m)


def distances_of(scene: Scene, bodies: tuple[str, ...]) -> tuple[float, float]:
    """What is required in travel and near a point, m, of two bodies; of none: of all that no exception names."""
    if not bodies:
        return scene.options.clearance.travel_m, scene.options.clearance.near_m
    travel, near = (float(clearances(scene, near, bodies[:1], bodies[1:])[0, 0]) for near in (False, True))
    return travel, near


def with_distances(scene: Scene, bodies: tuple[str, ...], travel: float, near: float) -> Scene:
    """The scene with other distances, m, of two bodies, or of all that no exception names."""
    clearance = replace(scene.options.clearance, travel_m=travel, near_m=near)
    if bodies:
        first, second = (frozenset((name,)) for name in bodies)
        rule, asked = ClearanceException(first, second, travel, near), scene.options.clearance
        clearance = replace(asked, exceptions=(*asked.exceptions, rule))
    return replace(scene, options=replace(scene.options, clearance=clearance))


def contact_gap(phase: Phase) -> float:
    """The gap, m, that a pair which may touch must keep: less than 0, it is how deep it may overlap."""
    return -CONTACT_M - phase.contact_tolerance_m

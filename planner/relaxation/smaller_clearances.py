"""Smaller required distances: of the pair that a refusal is about, then of all."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from assur.planner.model.refusal import Refusal, Separation
from assur.planner.model.scene import Scene
from assur.planner.relaxation.change import Change
from assur.planner.relaxation.rounded import SHOWN_M, down


def smaller_clearances(scene: Scene, refusal: Refusal | None) -> Iterator[Change]:
    """Smaller distances of the pair that the refusal is about, by what is missing, by half and none; then of all pairs
    for which no exception is made."""
    if refusal is not None and isinstance(refusal.facts, Separation) and len(refusal.bodies) == 2:
        gap, required = refusal.facts.gap_m, refusal.facts.required_m
        short = None if gap is None or required is None else required - gap
        first, second = refusal.bodies
        for text, changed in _changed(scene, short, first, second):
            yield "pair clearance", f"{first} and {second}: {text}", changed
    for text, changed in _changed(scene, None):
        yield "clearance", text, changed


def _changed(scene: Scene, short: float | None, *names: str) -> Iterator[tuple[str, Scene]]:
    """The scene with smaller distances of two bodies, or of all, in words and as a scene. `short`: by how much they are
    missed, m."""
    options = scene.options
    for travel, near in _smaller(*options.clearance.distances(*names), short):
        clearance = options.clearance.lowered(travel, near, names)
        yield _distances(travel, near), replace(scene, options=replace(options, clearance=clearance))


def _smaller(travel: float, near: float, short: float | None) -> Iterator[tuple[float, float]]:
    """Smaller distances of travel and near, from the greatest to none; one of both alone before both. `short`: by how
    much they are missed."""
    sizes = [(0.5 * travel, 0.5 * near), (0.0, 0.0)]
    if short is not None and short > 0.0:
        sizes.insert(0, (_less(travel, short), _less(near, short)))
    seen = {(travel, near)}
    for less_travel, less_near in sizes:
        for pair in ((travel, less_near), (less_travel, near), (less_travel, less_near)):
            if pair not in seen:
                seen.add(pair)
                yield pair


def _less(distance: float, short: float) -> float:
    """What is left, a hundredth of a millimetre less at least: the proof keeps a reserve."""
    return max(0.0, down(distance - short - 0.1 * SHOWN_M, SHOWN_M))


def _distances(travel: float, near: float) -> str:
    return f"travel {1e3 * travel:g} mm, near {1e3 * near:g} mm"

"""Smaller required distances: of the pair that a refusal is about, then of all."""

from __future__ import annotations

from collections.abc import Iterator

from assur.planner.model.clearance import distances_of, with_distances
from assur.planner.model.refusal import Refusal, Separation
from assur.planner.model.scene import Scene
from assur.planner.relaxation.change import Change
from assur.planner.relaxation.rounded import SHOWN_M, down


def smaller_clearances(scene: Scene, refusal: Refusal | None) -> Iterator[Change]:
    """Smaller distances of the pair that the refusal is about, by what is missing, by half and none; then of all pairs
    for which no exception is made."""
    pairs: list[tuple[str, ...]] = [()]
    short = None
    if refusal is not None and isinstance(refusal.facts, Separation) and len(refusal.bodies) == 2:
        gap, required = refusal.facts.gap_m, refusal.facts.required_m
        short = None if gap is None or required is None else required - gap
        pairs = [refusal.bodies, ()]
    for bodies in pairs:
        kind, named = ("pair clearance", f"{' and '.join(bodies)}: ") if bodies else ("clearance", "")
        for travel, near in _smaller(*distances_of(scene, bodies), short if bodies else None):
            value = f"{named}travel {1e3 * travel:g} mm, near {1e3 * near:g} mm"
            yield kind, value, with_distances(scene, bodies, travel, near)


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

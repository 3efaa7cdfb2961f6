"""Steps along a path that ask less of the joints: a lower process speed, corners that are rounded more."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from assur.planner.model.task import Move, Step, Trace

SPEEDS = (0.8, 0.5, 0.2, 0.1)
"""Shares of a process speed, from the weakest change to the strongest."""
BLENDS = (1.5, 2.0, 4.0)
"""Multiples of a blend, likewise."""


def slower(step: Step) -> Iterator[tuple[str, Step]]:
    """A trace at lower process speeds, each with the speed in words; nothing for other steps."""
    if isinstance(step, Trace):
        for share in SPEEDS:
            speed = share * step.speed_m_s
            yield f"{1e3 * speed:g} mm/s", replace(step, speed_m_s=speed)


def rounder(step: Step) -> Iterator[tuple[str, Step]]:
    """A path with larger blends, each with the blend in words; nothing where a larger blend changes no corner."""
    for factor in BLENDS:
        if isinstance(step, Trace):
            path = replace(step.path, blend_m=factor * step.path.blend_m)
            if path.length != step.path.length:
                yield f"{1e3 * path.blend_m:g} mm", replace(step, path=path)
        elif isinstance(step, Move) and len(step.path) > 1 and step.blend_m > 0.0:
            blend = factor * step.blend_m
            yield f"{1e3 * blend:g} mm", replace(step, blend_m=blend)

"""Approaches and departs that are longer than the request states."""

from __future__ import annotations

from assur.planner.model.scene import STRAIGHT, Scene
from assur.planner.report.number_format import amount


def assumed(scene: Scene) -> tuple[str, ...]:
    """What an answer states as its assumptions: those of the robot and the cell, and what is lengthened."""
    return (*scene.assumptions, *lengthened(scene))


def lengthened(scene: Scene) -> tuple[str, ...]:
    """A sentence for each straight part that is lengthened so that it clears the clearance of travel."""
    found = []
    for step in scene.task:
        stated = (("approach", step.approach_m), ("depart", step.depart_m))
        for (name, wanted), length in zip(stated, scene.straight(step), strict=True):
            if length > wanted:
                travel, made = amount(length / STRAIGHT, "m"), amount(length, "m")
                found.append(
                    f"{step.name}: the straight part of {name} is {made} long, not {amount(wanted, 'm')}: "
                    f"at least {STRAIGHT:g} times the clearance of travel, {travel}, unless it has stop: true"
                )
    return tuple(found)

"""A change of a request, and what all changes of a step share."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from assur.planner.model.scene import Pick, Place, Scene, Step

Change = tuple[str, str, Scene]
"""Kind, value for people, and the request with the change."""


def frame_of(scene: Scene, what: Step) -> str:
    """The frame in which a step's control point is."""
    if isinstance(what, Pick):
        return scene.index[what.part].frame
    return what.to.frame if isinstance(what, Place) else what.target.frame


def with_step(scene: Scene, number: int, step: Step) -> Scene:
    return replace(scene, task=(*scene.task[:number], step, *scene.task[number + 1 :]))


def of_step(scene: Scene, number: int, kind: str, value: str, **changed: Any) -> Change:
    """A change of these fields of a step."""
    return kind, value, with_step(scene, number, replace(scene.task[number], **changed))


def of_options(scene: Scene, kind: str, value: str, **changed: Any) -> Change:
    """A change of these options."""
    return kind, value, replace(scene, options=replace(scene.options, **changed))

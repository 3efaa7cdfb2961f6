"""Motions that end too late: after the latest end, or after what is known of the motion of a frame."""

from __future__ import annotations

from collections.abc import Sequence

from assur.planner.legs.control_point import WINDOW_S
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Quantity, Refusal, Stage, law_ends, window_missed
from assur.planner.model.scene import Scene
from assur.planner.model.window_missed import Miss, WindowMissed


def ends_too_late(scene: Scene, step: int, end: float) -> Refusal | None:
    """Whether the motion ends after the latest end, or after the law of a frame that bears a body."""
    latest = scene.options.latest_end_s
    if latest is not None and not end <= latest + WINDOW_S:
        facts = WindowMissed(miss=Miss.ENDS_TOO_LATE)
        return window_missed(Stage.TIMING, step, facts, amount=Quantity.of(end - latest, "s"))
    return laws_over(scene, step, end)


def laws_over(scene: Scene, step: int, end: float) -> Refusal | None:
    """Whether the law of a frame that bears a body, or will, ends before the arm, started late, has stood still for as
    long as is required."""
    stay = scene.options.stay_safe_s if scene.options.end == "rest" else 0.0
    needed = end + stay + scene.execution.start_tolerance_s
    for name, valid in scene.ending:
        if not needed <= valid[1]:
            return law_ends(Stage.TIMING, step, name, valid, needed)
    return None


def tracked_too_long(scene: Scene, step: int, phases: Sequence[Phase]) -> Refusal | None:
    """Whether the law of a frame that is tracked ends before an arm that started late has left it."""
    for phase in phases:
        if phase.tracked is not None:
            valid, needed = scene.frames[phase.tracked].law.valid, phase.t1 + scene.execution.start_tolerance_s
            if not needed <= valid[1]:
                return law_ends(Stage.TIMING, step, phase.tracked, valid, needed)
    return None

"""What can be timed with parabolic blends: moves of the joints alone, from rest to rest.

A blend misses its pose, and its acceleration jumps: nothing that has to be met with a velocity, kept to a line, or held
in a gripper goes with that. Said before anything is planned, field by field.
"""

from __future__ import annotations

from collections.abc import Mapping

from assur.planner.errors import InputError
from assur.planner.laws.law import Frame
from assur.planner.model.task import Move, Step

LEAST_ACCELERATION_TIME_S = 2e-3
"""s. Shorter blends cannot be written: over 2 ms, rounding of positions costs 1e-8 rad/s² of acceleration."""
BLENDED = "with timing parabolic_blend"


def refuse_unblendable(task: tuple[Step, ...], frames: Mapping[str, Frame], *, moving: bool, end: str) -> None:
    """Accept a task that parabolic blends can do; `moving`: whether the start is in motion.

    Raises `InputError` naming the field, its value and what is allowed.
    """
    if moving:
        raise InputError("start.velocity", "a start in motion", f"a start at rest {BLENDED}")
    if end != "rest":
        raise InputError("options.end", end, f"rest {BLENDED}")
    for i, step in enumerate(task):
        kind = type(step).__name__.lower()
        field = f"task[{i}].{kind}"
        if not isinstance(step, Move):
            raise InputError(field, step.name, f"moves only {BLENDED}: poses are missed, accelerations jump")
        if step.leg != "joint":
            raise InputError(f"{field}.leg", step.leg, f"joint {BLENDED}")
        if step.target.yaw_keep:
            raise InputError(f"{field}.to.yaw_keep", True, f"false {BLENDED}: yaws between blends are missed")
        if step.arch is not None:
            raise InputError(f"{field}.arch", step.arch.top_m, f"no arch {BLENDED}")
        frame = frames[step.target.frame]
        if step.match == "velocity" and not frame.law.is_fixed:
            raise InputError(f"{field}.match", step.match, f"position {BLENDED}, for {frame.name} moves")
        if step.via and i == len(task) - 1:
            raise InputError(f"{field}.via", True, f"false {BLENDED}: the motion ends at rest in the last pose")


def refuse_acceleration_time(timing: str, acceleration_time: float | None) -> None:
    """Accept an acceleration time, s, or none. Raises `InputError`."""
    if acceleration_time is None:
        return
    if timing != "parabolic_blend":
        raise InputError("options.acceleration_time", acceleration_time, "none: only timing parabolic_blend has one")
    if not LEAST_ACCELERATION_TIME_S <= acceleration_time < float("inf"):
        allowed = f"{1e3 * LEAST_ACCELERATION_TIME_S:g} ms or more"
        raise InputError("options.acceleration_time", acceleration_time, allowed)

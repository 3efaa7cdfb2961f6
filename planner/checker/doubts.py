"""What a request does not know, as tables for the checker's kernels (`checker.uncertainty`)."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.solids import BODY, Solids
from assur.planner.checker.uncertainty import (
    ALONG,
    AMOUNT,
    ANY,
    BODY_COLUMNS,
    CLOCK,
    FIRST_TOOL,
    FLAT,
    FRAME_COLUMNS,
    GROWTH,
    HEIGHT,
    LATE,
    LATERAL,
    LINE,
    SINCE,
    UPRIGHT,
    YAW,
    Doubt,
)
from assur.planner.laws import ALWAYS, Law
from assur.planner.laws.law import EXACT
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene


def stands(law: Law) -> bool:
    """Whether a frame stands still for ever."""
    return law.kind == "fixed" and law.valid == ALWAYS


def line_of(law: Law) -> tuple[float, float, float] | None:
    """The direction in which a frame travels, whatever its speed; None: it has none."""
    if law.kind == "conveyor":
        return math.cos(law.numbers.pose.yaw), math.sin(law.numbers.pose.yaw), 0.0
    if law.kind == "linear" and any(law.numbers.velocity):
        x, y, z = law.numbers.velocity
        length = math.sqrt(x * x + y * y + z * z)
        return x / length, y / length, z / length
    return None


def counted(law: Law) -> bool:
    """Whether a frame travels along its line at any time, so that an encoder is sure to tell of its error there."""
    if law.kind == "conveyor":
        return law.numbers.speed != 0.0 or any(change.speed != 0.0 for change in law.numbers.changes)
    return line_of(law) is not None


def reaches(table: Solids, doubt: Doubt) -> FloatArray:
    """How far the body of each seat reaches from the axis of its carrier (S,), m: zeros where nothing is uncertain, and
    none is asked for."""
    if doubt[4][ANY] == 0.0:
        return np.zeros(len(table.seats))
    radius = np.array([table.bodies[body].radius for body in table.seats[:, BODY].tolist()])
    return np.asarray(np.hypot(table.offset[:, 0], table.offset[:, 1]) + radius)


def ahead(scene: Scene, links: int) -> FloatArray:
    """Between which times, s, carriers may be ahead of the clock, where the robot is on time and where it is late, and
    whether they move (`cover.Cell`)."""
    found, late = np.zeros((links + len(scene.frames), 4)), scene.execution.start_tolerance_s
    for row, frame in zip(found[links:], scene.frames.values(), strict=True):
        if not stands(frame.law):
            least, most = frame.uncertainty.shift_s
            row[:] = -most, -least, late - least, 1.0
    return found + 0.0


def doubt_of(scene: Scene, phases: tuple[Phase, ...], table: Solids) -> Doubt:
    """The tables of a scene in the phases of a plan."""
    execution, number = scene.execution, {name: k for k, name in enumerate(scene.frames)}
    frames = np.zeros((len(scene.frames), FRAME_COLUMNS))
    for row, frame in zip(frames, scene.frames.values(), strict=True):
        known, line = frame.uncertainty, line_of(frame.law)
        row[AMOUNT], row[GROWTH] = known.position_m, known.speed_m_s
        row[LATERAL], row[UPRIGHT], row[YAW] = known.lateral_m, known.vertical_m, known.yaw_rad
        if line is not None:
            row[LINE], row[ALONG : ALONG + 3] = 1.0, line
    bodies = np.zeros((len(phases), len(table.bodies), BODY_COLUMNS))
    shares = np.zeros((len(phases), len(frames), 2))
    for item in scene.bodies:
        own, k = item.uncertainty, table.number[item.name]
        if own == EXACT:
            continue
        bodies[:, k, FLAT], bodies[:, k, HEIGHT] = own.position_m + own.yaw_rad * item.body.radius, own.vertical_m
    for i, phase in enumerate(phases):
        for part, within in phase.handled.within:
            k = table.number[part]
            bodies[i, k, FLAT] = within.position_m + within.yaw_rad * table.bodies[k].radius
            bodies[i, k, HEIGHT] = within.vertical_m
        if execution.belt_correction:
            followed = phase.corrected if phase.tracked is None else (phase.tracked,)
            for name in followed:
                if line_of(scene.frames[name].law) is None:
                    continue  # no encoder tells where it is
                whole = phase.tracked is not None and counted(scene.frames[name].law)
                shares[i, number[name]] = 1.0 if whole else 0.0, 1.0
    lag = np.zeros(max(len(scene.robot.joints), 4))
    lag[: len(execution.lag)] = execution.lag
    clock = np.zeros(CLOCK)
    clock[SINCE], clock[LATE] = scene.start.time, execution.start_tolerance_s
    clock[ANY] = float(bool(lag.any() or bodies.any() or frames[:, [AMOUNT, GROWTH, LATERAL, UPRIGHT, YAW]].any()))
    links = scene.robot.links
    clock[FIRST_TOOL] = links.index("quill") if "quill" in links else links.index("flange")
    return frames, bodies, shares, lag, clock

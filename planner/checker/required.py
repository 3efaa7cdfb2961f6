"""The distance that each row must prove (equation C5 in docs/guarantees.md), from request and phases alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.stage import Stage
from assur.planner.model.phases import CONTACT_M, Phase
from assur.planner.robots.protocol import Sweep

if TYPE_CHECKING:
    from assur.planner.checker.rows import Rows


def required(stage: Stage, phases: tuple[Phase, ...], rows: Rows, n: FloatArray) -> FloatArray:
    """(N,) m. Rows between bodies of the surroundings, which nobody asks for, get −inf."""
    scene = stage.scene
    clearance, execution = scene.options.clearance, scene.execution
    of_phase = [clearance.near_m if phase.near else clearance.travel_m for phase in phases]
    found: FloatArray = np.array(of_phase, dtype=np.float64)[rows.phase]
    robot = stage.of_robot
    mine = [robot[rows.phase, body] for body in (rows.first, rows.second)]
    found[~mine[0] & ~mine[1]] = -np.inf
    for k, (body, piece) in enumerate(((rows.first, rows.first_piece), (rows.second, rows.second_piece))):
        world = np.flatnonzero(~mine[k] & mine[1 - k])
        if not len(world):
            continue
        seat = stage.seat[rows.phase[world], body[world]]
        late = rows.t1[world] + execution.start_tolerance_s
        found[world] += execution.tracking_m
        found[world] += _uncertainty(stage, phases, rows.phase[world], stage.carrier[seat], late)
        if execution.start_tolerance_s > 0:
            still = np.zeros((len(world), 0))
            nobody = Sweep(still, still, still, still)
            speed, _ = stage.bounds(seat, piece[world], n[world], rows.t0[world], late, nobody)
            found[world] += execution.start_tolerance_s * speed
    found[exempt(stage, phases)[rows.phase, rows.first, rows.second]] = -CONTACT_M
    return found


def exempt(stage: Stage, phases: tuple[Phase, ...]) -> BoolArray:
    """(P, B, B): which bodies may touch in which phase."""
    number = stage.solids.number
    found = np.zeros((len(phases), len(number), len(number)), dtype=bool)
    for i, phase in enumerate(phases):
        for first, second in phase.exempt:
            if first in number and second in number:
                found[i, number[first], number[second]] = found[i, number[second], number[first]] = True
    return found


def _uncertainty(
    stage: Stage, phases: tuple[Phase, ...], phase: IntArray, carrier: IntArray, t: FloatArray
) -> FloatArray:
    """How far (N,) m bodies on frames `carrier` may be from where the arm of each `phase` expects them, at times t.

    Whom the controller corrects for counts: a frame that a corrected leg follows takes the arm with it.
    """
    scene = stage.scene
    frames = list(scene.frames.values())
    place = np.array([frame.uncertainty.position_m for frame in frames])
    drift = np.array([frame.uncertainty.speed_m_s for frame in frames])
    if not (place.any() or drift.any()):
        return np.zeros(len(t))
    number = {frame.name: k for k, frame in enumerate(frames)}
    # counts[p, f, g]: whether the uncertainty of frame g counts towards bodies on frame f in phase p.
    counts = np.tile(np.eye(len(frames)), (len(phases), 1, 1))
    if scene.execution.belt_correction:
        for i, of_phase in enumerate(phases):
            if of_phase.glued is not None:
                k = number[of_phase.glued]
                counts[i, :, k] = 1.0
                counts[i, k, k] = 0.0
            else:
                counts[i][:, [number[name] for name in of_phase.beside]] = 1.0
    share = counts[phase, carrier - stage.links]
    elapsed = np.maximum(t - scene.start.time, 0.0)
    return np.asarray((share * (place + drift * elapsed[:, None])).sum(1))

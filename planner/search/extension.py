"""Continues a chain by one step: the way to its control point, the glued block there, and rest at the end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.glued import glue
from assur.planner.legs.joint import JointMotion
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.state import Knots, Stretch
from assur.planner.legs.straight import mode_changes, straight
from assur.planner.legs.tilt import tilt_of
from assur.planner.model.outcome import Course, LegKind, Route
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import (
    Carrying,
    Miss,
    Obstacle,
    Quantity,
    Refusal,
    Stage,
    WindowMissed,
    unmoved,
    window_missed,
)
from assur.planner.model.scene import Scene
from assur.planner.search.build import assembled, laws_over
from assur.planner.search.partial_plan import Chain, Draft, Outline, Sample, paced


def outline(
    scene: Scene, chain: Chain, meeting: Meetings, sample: Sample, ahead: FloatArray | None
) -> Outline | Refusal:
    """The way to the control point that `sample` describes, or why Ruckig has none."""
    pace = paced(scene, chain, sample.shape.effort)
    reached = JointMotion(scene, chain.step, chain.state, sample.shape, sample.branch, ahead, pace).meet()
    if isinstance(reached, Refusal):
        return reached
    if not meeting.point.tracks:
        missed = _window_refusal(meeting.point, reached.end, chain.step)
        if missed is not None:
            return missed
    unknown = laws_over(scene, chain.step, reached.end)
    if unknown is not None:
        return unknown
    times = chain.state.time, reached.end
    way = Phase(*times, LegKind.MOVE, chain.step, chain.attached)
    return Outline(chain, meeting, sample, reached, (way,), ahead)


SLOWED = 4
"""Times that a way which pulls too hard at the part is timed again."""
SLOWER = 0.93
"""... with this share of what would be just enough if accelerations scaled with the limits."""


def carried_gently(scene: Scene, way: Outline) -> Draft | Refusal:
    """`finished`, timed again, slower, where it pulls too hard at the part in the gripper."""
    made, limit = finished(scene, way), scene.carry_acceleration
    for _ in range(SLOWED):
        if limit is None or not (isinstance(made, Refusal) and isinstance(made.facts, Carrying)):
            break
        share = SLOWER * limit / made.facts.acceleration
        shape = replace(way.sample.shape, effort=share * way.sample.shape.effort)
        sample = replace(way.sample, shape=shape, glue_effort=share * way.sample.glue_effort)
        again = outline(scene, way.chain, way.meeting, sample, way.ahead)
        if isinstance(again, Refusal):
            return made  # the carry limit is why: at its own pace there was a way
        way, made = again, finished(scene, again)
    return made


def is_straight(scene: Scene, chain: Chain) -> bool:
    """Whether the next step asks for a Cartesian leg."""
    return scene.task[chain.step].leg == "cartesian"


def finished(scene: Scene, way: Outline) -> Draft | Refusal:
    """The whole continuation: the way there, the glued block at the point, and rest where the task ends."""
    shape = way.sample.shape
    return _continued(
        scene,
        way.chain,
        way.meeting.point,
        way.sample,
        Stretch(LegKind.ARCH if shape.hop else LegKind.MOVE, Knots.of(way.reached.trajectory), shape.route),
    )


def straight_draft(scene: Scene, chain: Chain, meeting: Meetings, sample: Sample) -> Draft | Refusal:
    """The whole continuation by a Cartesian leg."""
    point, wait, mode = meeting.point, sample.shape.wait, sample.branch.mode
    key = point.yaw_offset, point.tilt, wait, mode
    if key not in chain.lines:
        chain.lines[key] = _line(scene, chain, point, wait, mode)
    line = chain.lines[key]
    if isinstance(line, Refusal):
        return line
    return _continued(scene, chain, meeting.point, sample, line)


def _continued(scene: Scene, chain: Chain, point: ControlPoint, sample: Sample, way: Stretch) -> Draft | Refusal:
    stretches = [way]
    if sample.shape.wait > 0:
        if not chain.state.resting:
            raise FaultError("an arm in motion cannot wait")
        waits = Knots.standing(chain.state, chain.state.time + sample.shape.wait)
        stretches.insert(0, Stretch(LegKind.WAIT, waits, Route(Course.FOR_BODIES)))
    begin = end = way.knots.last.time
    if point.tracks:
        block = glue(scene, point, way.knots.last, sample.branch.mode, sample.glue_effort)
        if isinstance(block, Refusal):
            return block
        begin, end = block.begin, block.end
        stretches += block.stretches
    missed = _window_refusal(point, begin, chain.step)
    if missed is not None:
        return missed
    return assembled(scene, chain, point, sample, stretches, begin, end)


def _line(scene: Scene, chain: Chain, point: ControlPoint, wait: float, mode: int) -> Stretch | Refusal:
    """A Cartesian leg to the control point, from rest or from the frame that the arm is glued to."""
    state = chain.state if wait <= 0 else Knots.standing(chain.state, chain.state.time + wait).last
    if chain.tracked is not None:
        before = chain.tracked

        def left(t: FloatArray) -> Motion:
            return before.flange(t, before.depart)
    elif state.resting:
        p, yaw = scene.robot.forward(state.q)
        pose, tilt = Pose(float(p[0]), float(p[1]), float(p[2]), float(yaw)), tilt_of(scene.robot, state.q)

        def left(t: FloatArray) -> Motion:
            still = Motion.still(pose, np.shape(t))
            return still if tilt is None else TiltedMotion.of(still, np.array(tilt))
    else:
        return unmoved(Stage.STRAIGHT, chain.step, Obstacle.STRAIGHT_FROM_MOTION)

    def met(t: FloatArray) -> Motion:
        return point.flange(t, point.approach)

    if mode != chain.mode:
        return mode_changes(scene, chain.step, state, (chain.mode, mode), left, met)
    return straight(scene, chain.step, state, mode, left, met)


def _window_refusal(point: ControlPoint, begin: float, step: int) -> Refusal | None:
    """Whether the arm may begin to track the point at `begin`."""
    spans = point.intervals
    if any(low - 1e-12 <= begin <= high + 1e-12 for low, high in spans):
        return None
    if not spans:
        facts = WindowMissed(miss=Miss.OUTSIDE, needed_s=point.dwell)
        return window_missed(Stage.WINDOW, step, facts, amount=Quantity.of(point.dwell, "s"))
    off = min(max(low - begin, begin - high) for low, high in spans)
    facts = WindowMissed(miss=Miss.OUTSIDE)
    return window_missed(Stage.WINDOW, step, facts, amount=Quantity.of(off, "s"), interval=spans[0])

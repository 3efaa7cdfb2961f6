"""All joint positions at a pose of the tool, with their margins, and the pose of the tool at joints."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase, pair
from assur.planner.model.refusal import Bodies, Enclosed, Reason, Refusal, Separation, Stage
from assur.planner.model.scene import Scene, check_tool_point
from assur.planner.robots.facts import Code
from assur.planner.robots.turns import ModeSolutions, solutions
from assur.scenes.answer_facts import refused_document
from assur.scenes.conventions import as_maker
from assur.scenes.faults import NOTHING, Gathered, Refused, located, within
from assur.scenes.numbers import number, optional
from assur.scenes.reading import frames, robots
from assur.scenes.reading.bodies import Places
from assur.scenes.reading.frames import known_from, knows
from assur.scenes.reading.start import position
from assur.scenes.reading.tool_pose import flange_of, lacks, wrist_turns
from assur.scenes.schema import ik as written
from assur.scenes.schema.read import read

if TYPE_CHECKING:
    from assur.planner.collision.proof import Prover
    from assur.scenes.reading.cell import Cell

MOST_COLLISIONS = 16
"""Number of pairs in collision at rest that are reported for a joint position."""
NOTICE = (
    "Kinematics and collisions of the model, at rest. The way there is not checked. Not a safety function under "
    "ISO 10218 or ISO 13849; persons are not in the model."
)
REASONS = {
    Code.ASSEMBLED: Reason.JOINT_LIMIT,
    Code.OUT_OF_REACH: Reason.OUT_OF_REACH,
    Code.PARALLEL: Reason.NEAR_PARALLEL_SINGULARITY,
}
"""Why a mode has no solution, by its code; all others are singular."""


@dataclass(frozen=True, eq=False)
class _Query:
    """A question with its robot, frames, places of bodies, time in s, and the bodies to collide with, if known."""

    question: written.IkDocument
    given: robots.RobotWithTool
    frames: frames.Frames
    places: Places
    t: float
    prover: Prover | None = None


def ik(cell: Cell | None, question: object) -> written.IkAnswer:
    """The answer to a question about the robot of `cell`, or about one that it brings along (None).

    Raises `InputError` naming the field of the question.
    """
    if isinstance(question, dict) and not {"pose", "joints"} & question.keys():
        raise InputError("pose", NOTHING, "a pose of the tool, or joints, which must be given")
    document: written.IkDocument = read(written.IkDocument, question)
    with located(question):
        if cell is not None and document.robot is not None:
            raise Refused("no robot beside a request, which has one", "robot")
        if cell is not None:
            t = cell.scene.start.time if document.at_s is None else document.at_s
            return _answer(_Query(document, cell.given, cell.frames, cell.places, t, _prover(cell.scene, t)))
        if document.robot is None:
            raise Refused("a request, or a robot, which must be given", "request")
        with within("robot"):
            given = robots.equipped(document.robot)
        check_tool_point(given.robot, given.tool)
        return _answer(_Query(document, given, frames.frames_of({}, Gathered()), Places(), document.at_s or 0.0))


def _prover(scene: Scene, t: float) -> Prover:
    from assur.planner.collision.proof import Prover

    for name in {body.frame: None for body in scene.bodies}:
        law = scene.frames[name].law
        if not knows(law, t):
            raise Refused(f"a time at which {name} is known, which bears a body; it is {known_from(law)}", "at_s")
    return Prover(scene)


def _answer(query: _Query) -> written.IkAnswer:
    robot, question = query.given.robot, query.question
    unreached: list[ModeSolutions] = []
    if question.joints is not None:
        with within("joints"):
            q = position(robots.joint_values(question.joints, query.given.conventions, ""), query.given)
        still = np.zeros_like(q)
        flange = robot.link_motion(robot.links.index("flange"), q, still, still, still)
        found = [(int(robot.mode_of(q)), q)]
        if found[0][0] < 0:
            raise Refused("joints with which the chain closes", "joints")
    elif question.pose is not None:
        with within("pose"):
            flange = flange_of(question.pose, query.given, query.frames, query.places, query.t)
        modes = solutions(robot, flange)
        found = [(mode.mode, q) for mode in modes for q in mode.found]
        unreached = [mode for mode in modes if not len(mode.found)]
    else:
        raise FaultError("a question without a pose and without joints passed its model")
    return {
        "schema": "assur/1",
        "status": "reached" if found else "not_reached",
        "robot": robot.name,
        "at_s": number(query.t),
        "tool": dict(_tool(query, flange)),
        "solutions": [_solution(query, flange, mode, q) for mode, q in found],
        "unreached": [_unreached(mode, query.given) for mode in unreached],
        "notice": NOTICE,
    }


def _tool(query: _Query, flange: Motion) -> Iterator[tuple[str, written.ToolPose]]:
    """The pose of the tool in each frame whose motion is known at the time."""
    tool = flange.at(query.given.tool.tcp)
    here = _pose(tool)
    # the heading of an arm that has no yaw of its own follows from joints only
    has_yaw = query.question.joints is not None or "yaw" in query.given.robot.coordinates
    for name in query.frames:
        carrier, mounted = query.frames.placed(name, Pose())
        law = query.frames.laws[carrier].law
        if not knows(law, query.t):
            continue
        local = _pose(law.motion(np.array(query.t))).then(mounted).inverse().then(here)
        pose: written.ToolPose = {"at_m": [local.x, local.y, local.z]}
        if has_yaw:
            pose["yaw_rad"] = local.yaw
        if tool.tilted:
            pose["pitch_rad"], pose["roll_rad"] = (number(angle) for angle in tool.tilt.tolist())
        yield name, pose


def _pose(motion: Motion) -> Pose:
    """The one pose of a motion of shape ()."""
    x, y, z = (number(value) for value in motion.p.tolist())
    return Pose(x, y, z, number(float(motion.yaw)))


def _named(q: FloatArray, given: robots.RobotWithTool) -> dict[str, float]:
    """The maker's values of a joint vector (n,), by joint and unit."""
    values = as_maker(q, given.conventions).tolist()
    pairs = zip(given.conventions, values, strict=True)
    return {f"{joint.name}_{joint.unit}": number(value) for joint, value in pairs}


def _solution(query: _Query, flange: Motion, mode: int, q: FloatArray) -> written.Solution:
    robot, given = query.given.robot, query.given
    turns = wrist_turns(q[None], given)
    values, ends = _named(q, given), [_named(end, given) for end in (robot.limits.lower, robot.limits.upper)]
    spans = {key: sorted((ends[0][key], ends[1][key])) for key in values}
    found: written.Solution = {
        "mode": robot.modes[mode],
        "turn": None if turns is None else turns[0],
        "joints": values,
        "to_limits": {key: [values[key] - low, high - values[key]] for key, (low, high) in spans.items()},
        "singularity_margin": number(float(robot.margin(q))),
        "parallel_margin": float(robot.parallel_margin(q)) if robot.parallel_least > 0.0 else None,
        "reach_m": number(float(robot.reach_margin(flange, mode))),
    }
    if query.prover is not None:
        found["collisions"] = list(_collisions(query.prover, q, query.t))
    return found


def _unreached(mode: ModeSolutions, given: robots.RobotWithTool) -> written.Unreached:
    beyond = _named(mode.beyond, given) if mode.code is Code.ASSEMBLED else {}
    return {
        "mode": given.robot.modes[mode.mode],
        "reason": REASONS.get(mode.code, Reason.NEAR_SINGULARITY),
        "short_m": optional(mode.short_m) if mode.code is Code.OUT_OF_REACH else None,
        "beyond": {key: abs(over) for key, over in beyond.items() if over},
        "detail": lacks(mode, given),
    }


def _collisions(prover: Prover, q: FloatArray, t: float) -> Iterator[written.Collision]:
    """The pairs of bodies that are nearer than travel allows, for the joint position q (n,) at time t, s."""
    from assur.planner.collision.nearest import closest, enclosed

    scene, phase = prover.scene, Phase(t, t, LegKind.WAIT, 0)
    pairs: set[tuple[str, str]] = set()
    while len(pairs) < MOST_COLLISIONS:
        known = frozenset(pairs)
        facts: Separation | Enclosed = Enclosed()
        within = enclosed(scene, prover, AT_START, q, t, known)
        if within is not None:
            names = within.names
        else:
            near = closest(scene, prover, phase, q, known)
            if near is None:
                return
            names, facts = near.names, near.facts
        pairs.add(pair(*names))
        refusal = Refusal(stage=Stage.START, reason=Reason.BODY_COLLISION, step=0, subject=Bodies(names), facts=facts)
        found = refused_document(scene, refusal)
        yield {"bodies": found["bodies"], "facts": found["facts"], "detail": found["detail"]}

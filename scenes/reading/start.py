"""The state at the start: joint values in the maker's words, or a pose of the tool."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.model.scene import Holding, Scene, Start
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.turns import solutions
from assur.scenes.conventions import Conventions, as_maker
from assur.scenes.faults import FAULTS, Gathered, Refused, within
from assur.scenes.reading.bodies import Places
from assur.scenes.reading.frames import Frames, placed, pose_uncertainty
from assur.scenes.reading.robots import RobotWithTool, hold, joint_values
from assur.scenes.reading.tool_pose import (
    flange_of,
    in_words,
    joints_in_words,
    lack,
    nearest_to_zero,
    wrist_turns,
)
from assur.scenes.schema.robots import StartDocument, ToolPoseDocument

READ_BACK = 1e-6
"""By this share of its range a joint may start outside of it: a controller prints its state with a few digits, and
homes at a stop. The joint is then moved to the end of its range, and the answer says so under `assumptions`."""
START_RATIO = 1e-9
"""A start velocity or acceleration may exceed its limit by this share, as the planner has it: rounding of units."""


def start_of(
    item: StartDocument, given: RobotWithTool, frames: Frames, places: Places
) -> tuple[Start, tuple[str, ...]]:
    """The state at the start, and a sentence for each joint that was moved to the end of its range. Raises `Refused`
    unless each joint has its value, within the (narrowed) limits, or the pose of the tool is met by one joint position,
    within them and not singular."""
    limits, faults = given.robot.limits, Gathered()
    stated = q = rest = np.zeros(len(given.conventions))
    try:
        if item.tool is not None:
            stated = q = _with_tool_at(item.tool, item, given, frames, places)
        elif item.joints is not None:
            stated = joint_values(item.joints, given.conventions, "")
            q = position(stated, given, READ_BACK)
        else:
            raise FaultError("a start without joints and without a pose passed its model")
    except FAULTS as error:
        faults.add(error, *([] if item.joints is None else ["joints"]))
    rates = []
    for key, values, limit, rate in (
        ("velocity", item.velocity, limits.velocity, "_s"),
        ("acceleration", item.acceleration, limits.acceleration, "_s2"),
    ):
        rates.append(rest)
        if values is not None:
            most = limit * (1 + START_RATIO)
            with faults.part(key):
                rates[-1] = joint_values(values, given.conventions, rate)
                hold(rates[-1], (-most, most), given.conventions, rate)
    faults.settle()
    holding = None
    if item.holding is not None:
        grasp = placed(item.holding.grasp_m, item.holding.grasp_yaw_rad)
        holding = Holding(item.holding.part, grasp, pose_uncertainty(item.holding.within))
    moved = () if q is stated else _moved(stated, q, given.conventions)
    return Start(item.at_s, q, rates[0], rates[1], holding), moved


def check_loaded(scene: Scene, conventions: Conventions) -> None:
    """Raises `Refused` where the start accelerates harder than the load leaves it. A load that is too heavy for the
    robot is refused by the planner, whatever the acceleration."""
    held = None if scene.start.holding is None else scene.start.holding.part
    load = scene.loads[0 if held is None else 1]
    if not load.share < 1.0:
        return
    heaviest = scene.load_limits.most_kg
    if heaviest is None or load.mass_kg <= heaviest:
        most = scene.limits_with(held).acceleration * (1 + START_RATIO)
        left = f"{100 * load.share:.4g} % of their acceleration"
        why = f" (with {load.mass_kg:.6g} kg at the flange the joints have {left})"
        with within("start", "acceleration"):
            hold(scene.start.qdd, (-most, most), conventions, "_s2", why)


def _moved(stated: FloatArray, q: FloatArray, conventions: Conventions) -> tuple[str, ...]:
    """A sentence for each joint that is not where it was stated to be."""
    given, taken = as_maker(stated, conventions), as_maker(q, conventions)
    return tuple(
        f"start: {joint.name} is given at {was!r} {joint.unit}, which is outside of its range by {abs(was - now):.2g}; "
        f"it is taken at the end of the range, {now!r} {joint.unit}"
        for joint, was, now in zip(conventions, given.tolist(), taken.tolist(), strict=True)
        if was != now
    )


def position(stated: FloatArray, given: RobotWithTool, share: float = 0.0) -> FloatArray:
    """The joint vector (n,), the same object or one with values that are outside of their range by up to `share` of it
    moved to its end. Raises `Refused` unless all are within limits, and a five-bar's couplers meet."""
    robot, limits, q = given.robot, given.robot.limits, stated
    nearest = np.minimum(np.maximum(q, limits.lower), limits.upper)
    if not all((nearest == q).tolist()):
        q = np.where(np.abs(q - nearest) <= share * (limits.upper - limits.lower), nearest, q)
        hold(q, (limits.lower, limits.upper), given.conventions, "")
    if robot.parallel_least > 0.0 and isinstance(robot, FiveBar):
        _refuse_open_chain(robot, q)
    return q


def _refuse_open_chain(robot: FiveBar, q: FloatArray) -> None:
    apart, (left, right) = 1e3 * float(np.hypot(*robot.span(q))), (1e3 * length for length in robot.distal)
    if abs(left - right) <= apart <= left + right:
        return
    couplers = f"{left + right:.1f} mm long together" if apart > left + right else f"{left:g} mm and {right:g} mm long"
    raise Refused(f"joints with which the chain closes; the elbows are {apart:.1f} mm apart, the couplers {couplers}")


def _with_tool_at(
    tool: ToolPoseDocument, item: StartDocument, given: RobotWithTool, frames: Frames, places: Places
) -> FloatArray:
    """The joint vector (n,) of the only working mode, and the only turn of the wrist, that the request allows."""
    names = given.robot.modes
    if item.elbow is not None and item.elbow not in names:
        raise Refused(f"one of {', '.join(names)}", "elbow")
    with within("tool"):
        flange = flange_of(tool, given, frames, places, item.at_s)
        modes = {names[mode.mode]: mode for mode in solutions(given.robot, flange)}
        met = {name: mode.found for name, mode in modes.items() if len(mode.found)}
        if not met:
            raise Refused(f"a pose that the arm can take ({lack(modes.values(), given)})", "at_m")
    if item.elbow is None and len(met) > 1:
        near = {name: joints_in_words(nearest_to_zero(found, given), given) for name, found in met.items()}
        choices = " or ".join(f"{name} ({joints})" for name, joints in near.items())
        raise Refused(f"{choices}, which must be given", "elbow")
    if item.elbow is not None and item.elbow not in met:
        raise Refused(f"{' or '.join(met)} ({item.elbow}: {lack([modes[item.elbow]], given)})", "elbow")
    found = met[item.elbow or next(iter(met))]
    if item.turn is None:
        return nearest_to_zero(found, given)
    turns = wrist_turns(found, given)
    if turns is None:
        raise Refused("no turn: the robot has no wrist", "turn")
    if item.turn not in turns:
        wrist = int(given.conventions.order[-1])
        joint, last = given.conventions[wrist], as_maker(found, given.conventions)[:, wrist].tolist()
        at = dict(sorted(zip(turns, last, strict=True)))
        raise Refused(" or ".join(f"{turn} ({joint.name} at {in_words(joint, at[turn])})" for turn in at), "turn")
    return nearest_to_zero(found[np.array(turns) == item.turn], given)

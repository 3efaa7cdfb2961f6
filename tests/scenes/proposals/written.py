"""Scenes of the planner's own tests as requests, in millimetres, degrees and milliseconds."""

from __future__ import annotations

import math
from typing import Any

from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body
from assur.planner.model.options import Clearance, ClearanceException
from assur.planner.model.path import LineTo
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step, Target, Trace, Window
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import BASE, LINK1, LINK2, QUILL, Scara

LINKS = {BASE: "base", LINK1: "link1", LINK2: "link2", QUILL: "quill"}


def milli(*values: float) -> list[float]:
    return [round(1e3 * value, 9) for value in values]


def degrees(value: float) -> float:
    return round(math.degrees(value), 10)


def request_of(scene: Scene) -> dict[str, Any]:
    """The request of a scene."""
    robot = scene.robot
    tool = {
        "tcp_mm": milli(scene.tool.tcp.x, scene.tool.tcp.y, scene.tool.tcp.z),
        "mass_kg": scene.tool.mass_kg,
        "bodies": [{"name": body.name, **_solid(body)} for body in scene.tool.bodies],
    }
    keys = [f"{joint.name}_{'rad' if joint.kind == 'revolute' else 'm'}" for joint in robot.joints]
    return {
        "schema": "assur/1",
        "robot": {**_arm(robot), "tool": {key: value for key, value in tool.items() if value is not None}},
        "start": {"at_s": scene.start.time, "joints": dict(zip(keys, scene.start.q.tolist(), strict=True))},
        "frames": {name: _frame(frame.law) for name, frame in scene.frames.items() if name != "world"},
        "bodies": [
            {
                "name": each.name,
                "shape": _solid(each.body)["shape"],
                "pose": {**_at(each.frame, each.pose), "yaw_deg": degrees(each.pose.yaw)},
                "yaw_symmetry": each.yaw_symmetry,
                **({} if each.mass_kg is None else {"mass_kg": each.mass_kg}),
                "uncertainty": {"vertical_mm": 1e3 * each.uncertainty.vertical_m},
            }
            for each in scene.bodies
        ],
        "task": [{type(step).__name__.lower(): {"name": step.name, **_step(scene, step)}} for step in scene.task],
        "options": _options(scene),
        "execution": {"lag": dict(zip(keys, scene.execution.lag, strict=bool(scene.execution.lag)))},
    }


def _arm(robot: Robot) -> dict[str, Any]:
    joints = [
        {
            "name": joint.name,
            f"range_{unit}": [float(low), float(high)],
            f"velocity_{unit}_s": float(velocity),
            f"acceleration_{unit}_s2": float(acceleration),
            f"jerk_{unit}_s3": float(jerk),
        }
        for joint, low, high, velocity, acceleration, jerk in zip(
            robot.joints,
            robot.limits.lower,
            robot.limits.upper,
            robot.limits.velocity,
            robot.limits.acceleration,
            robot.limits.jerk,
            strict=True,
        )
        for unit in ("rad" if joint.kind == "revolute" else "m",)
    ]
    if isinstance(robot, FiveAxisArm):
        sizes = {"height_m": robot.height, "l1_m": robot.l1, "l2_m": robot.l2, "l3_m": robot.l3}
        return {"five_axis_arm": {**sizes, "joints": joints, "bodies": [], "self_pairs": []}}
    assert isinstance(robot, Scara)
    bodies = [{"name": each.body.name, "link": LINKS[each.link], **_solid(each.body)} for each in robot.bodies]
    pairs = [list(pair) for pair in robot.self_pairs]
    return {"scara": {"l1_m": robot.l1, "l2_m": robot.l2, "joints": joints, "bodies": bodies, "self_pairs": pairs}}


def _solid(body: Body) -> dict[str, Any]:
    (piece,) = body.pieces
    shape: Any = piece.shape
    made: dict[str, Any] = {"box": {"size_mm": milli(*(2 * half for half in shape.half))}}
    if shape.kind == "cylinder":
        made = {"cylinder": {"radius_mm": 1e3 * shape.disc, "height_mm": 2e3 * shape.half[2]}}
    return {"shape": made, "at_mm": milli(*piece.position.tolist())}


def _frame(law: Any) -> dict[str, Any]:
    own = {**_at("world", law.numbers.pose), "yaw_deg": degrees(law.numbers.pose.yaw)}
    rates = {
        "conveyor": {"speed_mm_s": 1e3 * law.numbers.speed},
        "turntable": {"rate_rad_s": law.numbers.rate},
        "fixed": {},
    }
    valid = {} if math.isinf(law.valid[0]) else {"valid_s": list(law.valid)}
    return {law.kind: {**own, **rates[law.kind]}, **valid}


def _at(frame: str, pose: Pose) -> dict[str, Any]:
    return {**({} if frame == "world" else {"frame": frame}), "at_mm": milli(pose.x, pose.y, pose.z)}


def _to(scene: Scene, target: Target) -> dict[str, Any]:
    made = _at(target.frame, target.pose)
    if "pitch" in scene.robot.coordinates:
        angles = {"pitch_deg": target.pitch, "roll_deg": target.roll}
        return {**made, **{key: "free" if angle is None else degrees(angle) for key, angle in angles.items()}}
    return {**made, "yaw_deg": degrees(target.pose.yaw)}


def _step(scene: Scene, step: Step) -> dict[str, Any]:
    made = _window(step.window)
    if isinstance(step, Pick | Place):
        made |= {
            "part": step.part,
            "approach": {"mm": 1e3 * step.approach_m},
            "dwell_ms": 1e3 * step.dwell_s,
            "depart": {"mm": 1e3 * step.depart_m},
            **({} if step.contact_with is None else {"contact_with": list(step.contact_with)}),
            **({"contact_tolerance_mm": 1e3 * step.contact_tolerance_m} if step.contact_tolerance_m else {}),
        }
    if isinstance(step, Pick):
        grasp = {"grasp_mm": milli(step.grasp.x, step.grasp.y, step.grasp.z), "grasp_yaw_deg": degrees(step.grasp.yaw)}
        return {**made, **grasp}
    if isinstance(step, Place):
        return {**made, "to": _to(scene, step.to)}
    if isinstance(step, Follow):
        return {**made, "to": _to(scene, step.target), "duration_ms": 1e3 * step.duration_s}
    if isinstance(step, Move):
        return {**made, "to": _to(scene, step.target), "match": step.match}
    assert isinstance(step, Trace)
    parts = [{"line": {"to_mm": milli(*part.to)}} for part in step.path.parts if isinstance(part, LineTo)]
    lengths = {"blend_mm": 1e3 * step.path.blend_m, "speed_mm_s": 1e3 * step.speed_m_s}
    leads = {"lead_in_mm": 1e3 * step.lead_in_m, "lead_out_mm": 1e3 * step.lead_out_m}
    return {**made, "start": _to(scene, step.target), "path": parts, **lengths, **leads}


def _window(window: Window) -> dict[str, Any]:
    time = {} if window.time is None else {"window_ms": milli(*window.time)}
    return time if window.along is None else {**time, "window_mm": milli(*window.along)}


def _options(scene: Scene) -> dict[str, Any]:
    options = scene.options
    made: dict[str, Any] = {
        name: getattr(options, name)
        for name in ("seed", "budget_s", "max_candidates", "stop", "explain_budget_s", "singularity_margin", "elbow")
    }
    made |= {"timing": options.timing, "clearance_mm": _distances(options.clearance)}
    if options.clearance.exceptions:
        made["clearance_exceptions"] = [
            {"between": sorted(rule.first), "and": sorted(rule.second), "clearance_mm": _distances(rule)}
            for rule in options.clearance.exceptions
        ]
    times = {"latest_end_ms": options.latest_end_s, "acceleration_time_ms": options.acceleration_time_s}
    return {**made, **{key: 1e3 * value for key, value in times.items() if value is not None}}


def _distances(of: Clearance | ClearanceException) -> dict[str, float]:
    return {"travel": 1e3 * of.travel_m, "near": 1e3 * of.near_m}

"""Requests for which a right plan of another request is shown, with a digest that was made to fit."""

from __future__ import annotations

import copy
from functools import cache
from typing import Any, NamedTuple

from assur.planner.checker.verdict import Code
from assur.scenes.requests import cell_of, read_plan
from tests.forgeries.changes import Change, Document, append, both, drop, plus, put, update
from tests.planner.checker.statement.cases import Case, case_of, claim_of, sealed
from tests.scenes.forged_cells import SMALL, answered, request_of


class Other(NamedTuple):
    """The case whose plan is shown, what both checkers find in the plan (None: it is a plan of the other request, too),
    what the statement checker finds where the claim is the old one, and the change of the request."""

    name: str
    case: str
    found: Code | None
    of_claim: Code
    change: Change


@cache
def asked(name: str) -> Case:
    """A case with a right plan."""
    if name not in SMALL:
        return case_of(name)
    cell, answer = answered(name)
    plan, _, claims = read_plan(cell, answer)
    return Case(request_of(name)[0], cell.scene, plan, claim_of(cell.scene, plan), claims)


def shown_for(other: Other) -> Case:
    """The plan and the claim of a case, with another request."""
    case = asked(other.case)
    request = copy.deepcopy(case.request)
    other.change(request)
    scene = cell_of(request).scene
    assert scene.digest != case.scene.digest, "the request is the same"
    return Case(request, scene, sealed(scene, case.plan), case.claim, case.claims)


def option(name: str, value: Any) -> Change:
    """Another option, in place of one in another unit."""
    return lambda request: request.update(options={**request.get("options", {}), name: value})


def heavier(request: Document) -> None:
    """A part that leaves a smaller share of the accelerations."""
    next(body for body in request["bodies"] if "mass_kg" in body).update(mass_kg=5.0)


DEMO, FLOW = "demo, more uncertain", "dense-flow, more uncertain"
TRACE, BLENDS, ARM = "bead-on-belt", "parabolic-blend", "elbow-arm"
T = Code
PICK, PLACE, HOME, FIRST = "task.0.pick", "task.1.place", "task.2.move", "task.0.move"
AGAIN = {"move": {"to": {"at_mm": [350, 0, 121]}}}
POST = {"name": "post", "shape": {"sphere": {"radius_mm": 10}}, "pose": {"at_mm": [0, -900, 0]}}
GUARD = {"name": "guard", "shape": {"box": {"size_m": [0.02] * 3}}, "pose": {"at_m": [0.35, 0.0, 0.15]}}
AT_REST = {"to": {"at_m": [0.2, 0.35, 0.08], "yaw_free": True}, "duration_ms": 100}

REQUESTS: tuple[Other, ...] = (
    # the task
    Other("a window along the belt", DEMO, T.WINDOW, T.WINDOW, put(f"{PICK}.window_mm", [-300, -290])),
    Other("a window in time", DEMO, T.WINDOW, T.WINDOW, update(PLACE, window_s=[0.0, 0.1])),
    Other("a longer dwell", DEMO, T.ARRIVAL, T.ARRIVAL, put(f"{PICK}.dwell_ms", 90)),
    Other("another grasp", DEMO, T.POINT, T.SEAT, put(f"{PICK}.grasp_mm", [0, 0, 11])),
    Other("another place", DEMO, T.POINT, T.SEAT, put(f"{PLACE}.to.at_mm", [150.1, 0, 10])),
    Other("another yaw", DEMO, T.POINT, T.POINT, put(f"{PLACE}.to.yaw_deg", 1)),
    Other("no approach", DEMO, T.LEGS, T.LEGS, put(f"{PLACE}.approach", {"mm": 0})),
    Other("a lower approach", DEMO, T.POINT, T.POINT, put(f"{PICK}.approach", {"mm": 29})),
    Other("a higher approach", DEMO, T.POINT, T.POINT, put(f"{PICK}.approach", {"mm": 30.1})),
    Other("a higher depart", DEMO, T.POINT, T.POINT, put(f"{PICK}.depart", {"mm": 40.1})),
    Other("a stop above", DEMO, None, T.POINT, update(f"{PICK}.approach", stop=True)),
    Other("a depart with a stop", DEMO, T.POINT, T.POINT, put(f"{PICK}.depart", {"mm": 40, "stop": True})),
    Other("a smaller contact tolerance", DEMO, None, T.CONTACT, put(f"{PICK}.contact_tolerance_mm", 0.5)),
    Other("another support", DEMO, T.ROW, T.CONTACT, put(f"{PLACE}.contact_with", ["belt-bed"])),
    Other("a tolerance", DEMO, T.ARRIVAL, T.ARRIVAL, update(PICK, tolerance_mm=0.5)),
    Other("a smaller tolerance", FLOW, T.ARRIVAL, T.ARRIVAL, update(PICK, tolerance_mm=0.01)),
    Other("a step more", DEMO, T.ARRIVAL, T.ARRIVAL, append("task", AGAIN)),
    Other("a step less", DEMO, T.FORM, T.ARRIVAL, drop("task.-1")),
    Other("a straight way", DEMO, T.GUIDE, T.GUIDE, update(HOME, leg="cartesian")),
    Other("a straight way of an elbow arm", "bent-elbow", T.GUIDE, T.GUIDE, update(FIRST, leg="cartesian")),
    Other("a straight way from a belt", "off-belt", T.GUIDE, T.GUIDE, update("task.1.move", leg="cartesian")),
    Other("a straight way of the hand", "rv-m1", T.GUIDE, T.JOINTS, update("task.1.move", leg="cartesian")),
    Other("an arch", DEMO, T.LEGS, T.LEGS, update(HOME, arch={"top_mm": 150})),
    Other("a higher arch", "standard-cycle", T.DIRECTION, T.ARCH, put("task.0.*.arch.top_mm", plus(1))),
    Other("another path", "circular-legs", T.GUIDE, T.GUIDE, put("task.1.*.path.0.arc.via_mm.0", plus(0.1))),
    Other("sharper corners", "circular-legs", T.GUIDE, T.GUIDE, put("task.2.move.blend_mm", 4.95)),
    Other("a faster trace", TRACE, T.ARRIVAL, T.ARRIVAL, put("task.0.*.speed_mm_s", 153)),
    Other("another trace", TRACE, T.ARRIVAL, T.ARRIVAL, put("task.0.*.path.1.arc.via_mm.0", 50.02)),
    Other("a longer lead-in", TRACE, T.LEGS, T.LEGS, put("task.0.*.lead_in_mm", 9)),
    Other("a rest at the point", DEMO, None, T.JOINTS, update(HOME, match="position")),
    Other("a kept yaw", "stopped", T.DIRECTION, T.DIRECTION,
          put(f"{FIRST}.to", {"at_mm": [250, 250, 150], "yaw_keep": True})),
    Other("a yaw that is kept", "round-the-base", T.DIRECTION, T.DIRECTION,
          both(drop("task.0.*.to.yaw_free"), update("task.0.*.to", yaw_keep=True))),
    Other("a via", "stopped", T.JOINTS, T.JOINTS, update(FIRST, via=True)),
    Other("a point at rest", "belt", T.POINT, T.POINT, put("task.0.follow", AT_REST)),
    Other("a point 45.1 mm above another", "rv-m1", T.POINT, T.POINT, put("task.0.*.to.at_mm", [0, 0, 45.1])),
    Other("another pitch", "rv-m1", T.ARRIVAL, T.ARRIVAL, put("task.0.*.to.pitch_deg", -89.99)),
    Other("blends that last longer", BLENDS, T.BLEND, T.BLEND, option("acceleration_time_ms", 239)),
    Other("a via elsewhere", BLENDS, T.BLEND, T.BLEND, put("task.0.*.to.at_mm", [200.002, 199.998, -200])),
    # options and execution
    Other("an earlier end", DEMO, T.END, T.END, option("latest_end_s", 0.5)),
    Other("the end at rest", "moving", T.END, T.END, option("end", "rest")),
    Other("a longer standstill", DEMO, T.COVER, T.PHASE, option("stay_safe_s", 0.4)),
    Other("a larger distance", DEMO, T.ROW, T.DISTANCE, put("options.clearance_mm.travel", 30)),
    Other("a larger distance near points", DEMO, T.ROW, T.DISTANCE, put("options.clearance_mm.near", 10)),
    Other("a singularity margin", DEMO, T.DIRECTION, T.SINGULARITY, option("singularity_margin", 0.99)),
    Other("that of an elbow arm", ARM, T.DIRECTION, T.SINGULARITY, option("singularity_margin", 0.95)),
    Other("that of a straight leg", "line", T.DIRECTION, T.SINGULARITY, option("singularity_margin", 0.99)),
    Other("that of a five-bar", "five-bar", T.DIRECTION, T.SINGULARITY, option("singularity_margin", 0.99)),
    Other("another elbow", DEMO, T.DIRECTION, T.ELBOW, option("elbow", "left")),
    Other("another elbow of an elbow arm", ARM, T.DIRECTION, T.ELBOW, option("elbow", "down")),
    Other("another elbow of a five-bar", "five-bar", T.DIRECTION, T.ELBOW, option("elbow", "right-left")),
    Other("the elbow of the start", BLENDS, T.ELBOW, T.ELBOW, option("elbow", "keep")),
    Other("a late dispatch", DEMO, T.ERROR, T.UNCERTAINTY, update("execution", start_tolerance_ms=3)),
    Other("servo lag", DEMO, T.ERROR, T.UNCERTAINTY, update("execution", lag={"j1_rad": 0.02, "j2_rad": 0.02})),
    Other(
        "a correction for the belt", "fast-belt", T.ROW, T.UNCERTAINTY,
        lambda r: r.update(execution={"belt_correction": True}),
    ),
    Other("no correction for the belt", FLOW, T.ERROR, T.UNCERTAINTY, update("execution", belt_correction=False)),
    Other("a limit of the acceleration", DEMO, T.RATE, T.RATE, lambda r: r.update(carry={"acceleration_m_s2": 5.0})),
    # robot, frames and bodies
    Other("another start", DEMO, T.START, T.START, put("start.joints.j1_deg", 17.3)),
    Other("a later start", DEMO, T.START, T.START, put("start.at_s", 1e-6)),
    Other("smaller limits", DEMO, T.LIMIT, T.LIMIT, put("robot.limits.acceleration", 0.59)),
    Other("forbidden yaws", DEMO, T.DIRECTION, T.YAW, update("robot.limits", forbidden_yaw_deg=[[200, 260]])),
    Other("a longer tool", DEMO, T.ARRIVAL, T.SEAT, put("robot.tool.tcp_mm", [0, 0, -101])),
    Other("a heavier part", "heavy-casting", T.LIMIT, T.LIMIT, heavier),
    Other("a faster belt", DEMO, T.ARRIVAL, T.LAW, put("frames.belt.conveyor.speed_mm_s", 250.1)),
    Other("a faster gate", DEMO, T.NEAREST, T.LAW, put("frames.gate.swing.period_s", 1.2)),
    Other("a gate that is known for less long", DEMO, T.LAW, T.LAW, update("frames.gate", valid_s=[-1, 1])),
    Other("a body more", DEMO, T.COVER, T.SOLID, append("bodies", POST)),
    Other("a body more that is near", DEMO, T.COVER, T.SOLID, append("bodies", GUARD)),
    Other("a body less", "demo", T.ROW, T.SOLID, drop("bodies.bar")),
    Other("a body 0.1 mm aside", DEMO, None, T.SEAT, put("bodies.0.pose.at_mm", [0.1, 350, 25])),
    Other("a part 10 mm aside", DEMO, T.ARRIVAL, T.SEAT, put("bodies.part.pose.at_mm", [-440, 0, 10])),
)  # fmt: skip

"""Small requests that no plan fulfils, one of each kind of proof; and one beside each that a plan fulfils."""

from __future__ import annotations

import copy
from typing import Any

from assur.scenes.scenarios import shipped

Document = dict[str, Any]

CUP = {"name": "cup", "shape": {"cylinder": {"radius_mm": 12, "height_mm": 100}}, "at_mm": [0, 0, -50]}
START = {"j1_deg": 20, "j2_deg": 70, "j3_mm": 250, "j4_deg": 0}
OPTIONS = {"stop": "first", "budget_s": 60, "max_candidates": 200, "explain_budget_s": 0}
BELT = {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 100}}
BLOCK = {"name": "block", "shape": {"box": {"size_mm": [60, 60, 60]}}}


def cell(*task: Document, **more: Any) -> Document:
    """A request to a SCARA, with these steps; fields in `more` replace those that it has."""
    request: Document = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100], "bodies": [CUP]}},
        "start": {"joints": dict(START)},
        "bodies": [],
        "task": list(task),
        "options": dict(OPTIONS),
    }
    return copy.deepcopy({**request, **more})


def go(x: float, y: float, z: float, yaw: float | None = 0.0, **more: Any) -> Document:
    """A move to a point in mm, with a yaw in degrees (None: free)."""
    turned = {"yaw_free": True} if yaw is None else {"yaw_deg": yaw}
    return {"move": {"to": {"at_mm": [x, y, z], **turned, **({"frame": more.pop("frame")} if "frame" in more else {})},
                     **more}}  # fmt: skip


def follow(x: float, y: float, z: float, frame: str, **more: Any) -> Document:
    return {"follow": {"to": {"frame": frame, "at_mm": [x, y, z], "yaw_deg": 0}, **more}}


def _block(x: float, y: float, z: float, **frame: str) -> Document:
    """A cube of 60 mm with its middle at a point."""
    return {**BLOCK, "pose": {"at_mm": [x, y, z], **frame}}


def options(**more: Any) -> Document:
    return {**OPTIONS, **more}


def _five_bar(x: float) -> Document:
    request = _shipped("five-bar-type-2")
    request["task"] = [{"move": {"to": {"at_mm": [x, 0, 70], "yaw_deg": 0}}}]
    return request


def _shipped(name: str) -> Document:
    request = copy.deepcopy(shipped(name).request)
    request["options"] = {**request.get("options", {}), **OPTIONS}
    return request


def _behind(elbow: str) -> Document:
    request = _shipped("behind-the-base-keep")
    request["options"]["elbow"] = elbow
    return request


def _hand(x: float, **pitch: float) -> Document:
    start = {"j1_deg": 0, "j2_deg": 60, "j3_deg": -90, "j4_deg": -60, "j5_deg": 0}
    return cell(
        {"move": {"to": {"at_mm": [x, 0, 350], **pitch}}},
        robot={"model": "mitsubishi-rv-m1", "tool": {"tcp_mm": [0, 0, 0], "bodies": []}},
        start={"joints": start},
    )


def _picked(part_z: float, symmetry: int = 1, **lid: float) -> Document:
    """A part on a table; perhaps a lid over it."""
    bodies = [
        {"name": "table", "shape": {"box": {"size_mm": [200, 200, 20]}}, "pose": {"at_mm": [350, -150, 40]}},
        {"name": "part", "shape": {"box": {"size_mm": [30, 30, 30]}}, "pose": {"at_mm": [350, -150, part_z]},
         **({"yaw_symmetry": symmetry} if symmetry != 1 else {})},
    ]  # fmt: skip
    if lid:
        bodies.append(
            {"name": "lid", "shape": {"box": {"size_mm": [200, 200, 4]}}, "pose": {"at_mm": [350, -150, lid["lid"]]}}
        )
    pick = {"pick": {"part": "part", "grasp_mm": [0, 0, 15], "approach": {"mm": 40}, "dwell_ms": 50,
                     "depart": {"mm": 40}}}  # fmt: skip
    return cell(pick, go(350, 0, 200), bodies=bodies)


def _gripped(grasp: float, within: float, symmetry: int = 1) -> Document:
    """A part that is taken with the tool point so far above its middle, mm, where the tool must be so near."""
    request = _picked(65, symmetry)
    request["task"][0]["pick"] |= {"grasp_mm": [0, 0, grasp], "grip_within_mm": within}
    return request


def _put(height: float, within: float) -> Document:
    """A part that is put down so high above the table, mm, where the table must be so near."""
    request = _picked(65)
    place = {"part": "part", "to": {"at_mm": [350, -90, 65 + height], "yaw_deg": 0}, "contact_with": ["table"]}
    request["task"][1] = {"place": {**place, "approach": {"mm": 40}, "dwell_ms": 50, "depart": {"mm": 40},
                                    "support_within_mm": within}}  # fmt: skip
    return request


def _yawed(ranges: list[list[float]], *task: Document) -> Document:
    request = cell(*task)
    request["robot"]["limits"] = {"forbidden_yaw_deg": ranges, "j4_deg": [-270, 270]}
    return request


def _loaded(kg: float) -> Document:
    request = cell(go(350, 0, 200))
    request["robot"]["tool"]["mass_kg"] = kg
    return request


def moving(q: dict[str, float], v: dict[str, float], a: dict[str, float], *task: Document, **more: Any) -> Document:
    """A SCARA of round numbers whose joints start with these positions, velocities and accelerations, deg or mm and
    rad/s or m/s and per s; of what is not stated, positions are as below and rates 0."""
    joints = [
        {"name": name, "range_deg": [-turn, turn], "velocity_rad_s": 7, "acceleration_rad_s2": 70, "jerk_rad_s3": 1000}
        for name, turn in (("j1", 170), ("j2", 145), ("j4", 360))
    ]
    lift = {"name": "j3", "range_mm": [100, 300], "velocity_m_s": 2, "acceleration_m_s2": 20, "jerk_m_s3": 400}
    arm = {"l1_mm": 325, "l2_mm": 225, "joints": [*joints[:2], lift, joints[2]], "bodies": [], "self_pairs": []}
    robot = {"scara": arm, "tool": {"tcp_mm": [0, 0, 0]}, **more.pop("robot", {})}
    state = {"j1_deg": 0.0, "j2_deg": 60.0, "j3_mm": 250.0, "j4_deg": 0.0}
    rates = {"j1_rad_s": 0.0, "j2_rad_s": 0.0, "j3_m_s": 0.0, "j4_rad_s": 0.0}
    start = {
        "joints": state | q,
        "velocity": rates | v,
        "acceleration": {f"{name}2": 0.0 for name in rates} | {f"{name}2": value for name, value in a.items()},
        **more.pop("start", {}),
    }
    return cell(*(task or (go(300, 250, 200, 90),)), robot=robot, start=start, **more)


def _dial(x: float) -> Document:
    frames = {"dial": {"turntable": {"at_mm": [x, 0, 60], "rate_deg_s": 60}}}
    return cell(go(50, 0, 100, frame="dial", match="position"), frames=frames)


def _on_belt(x: float, **block: Any) -> Document:
    """A point on a belt, with a block on the belt at `block`."""
    bodies = [{**BLOCK, "pose": {"frame": "belt", "at_mm": block["at"]}}]
    return cell(follow(x, 0, 60, "belt", duration_ms=100, window_mm=[-200, 200]), frames={"belt": BELT}, bodies=bodies)


def _window(step: Document, belt: Document = BELT, **option: Any) -> Document:
    return cell(step, frames={"belt": belt}, options=options(**option))


def _stopping(valid: float) -> Document:
    return {"conveyor": BELT["conveyor"], "valid_s": [-5, valid]}


NEAR = {"duration_ms": 200, "window_mm": [-200, 200]}
PROVED: dict[str, tuple[Document, Document, str, str | None]] = {
    "out of reach": (cell(go(700, 0, 200)), cell(go(500, 0, 200)), "OUT_OF_REACH", "hindered"),
    "out of reach with any yaw": (cell(go(700, 0, 200, None)), cell(go(500, 0, 200, None)), "OUT_OF_REACH", "hindered"),
    "a lift that is too short": (cell(go(350, 0, 500)), cell(go(350, 0, 200)), "JOINT_LIMIT", "hindered"),
    "the elbow that is kept": (_behind("keep"), _behind("auto"), "JOINT_LIMIT", "hindered"),
    "a singular point that is tracked": (
        cell(
            {"follow": {"to": {"at_mm": [540, 0, 200], "yaw_deg": 0}, "duration_ms": 100}},
            options=options(singularity_margin=0.5),
        ),
        cell(
            {"follow": {"to": {"at_mm": [350, 0, 200], "yaw_deg": 0}, "duration_ms": 100}},
            options=options(singularity_margin=0.5),
        ),
        "NEAR_SINGULARITY",
        "hindered",
    ),
    "a part that can be taken in no turn": (_picked(700, 2), _picked(65, 2), "JOINT_LIMIT", "hindered"),
    "type 2": (_five_bar(120), _five_bar(250), "NEAR_PARALLEL_SINGULARITY", "hindered"),
    "a yaw on the way": (
        _yawed([[100, 170], [0, 20]], go(350, 0, 200, -90)),
        _yawed([[100, 170]], go(350, 0, 200, -90)),
        "FORBIDDEN_YAW",
        "hindered",
    ),
    "a yaw at a point": (
        _yawed([[-100, -80]], go(350, 0, 200, -90)),
        _yawed([[-70, -60]], go(350, 0, 200, 80)),
        "FORBIDDEN_YAW",
        None,
    ),
    "a yaw at the start": (
        _yawed([[80, 95]], go(350, 0, 200, 0)),
        _yawed([[120, 130]], go(350, 0, 200, 80)),
        "FORBIDDEN_YAW",
        None,
    ),
    "a pitch": (_hand(460, pitch_deg=-90), _hand(300, pitch_deg=-90), "OUT_OF_REACH", "hindered"),
    "every pitch": (_hand(700), _hand(300), "OUT_OF_REACH", None),
    "a dial out of reach": (_dial(900), _dial(350), "OUT_OF_REACH", "orbit"),
    "an arch": (
        cell(go(350, -100, 200, arch={"top_mm": 900})),
        cell(go(350, -100, 200, arch={"top_mm": 220})),
        "JOINT_LIMIT",
        None,
    ),
    "a tool that is too far from its part": (_gripped(20, 1), _gripped(15, 1), "TOLERANCE", None),
    "a tool that is too far in both turns": (_gripped(20, 1, 2), _gripped(15, 1, 2), "TOLERANCE", None),
    "a table that is too far below a part": (_put(3, 1), _put(0, 1), "TOLERANCE", None),
    "a load": (_loaded(9), _loaded(2), "LOAD_LIMIT", None),
    "a block at the start": (
        cell(go(350, 0, 200), bodies=[_block(305, 336, 170)]),
        cell(go(350, 0, 200), bodies=[_block(-305, 336, 170)]),
        "START_IN_COLLISION",
        "met",
    ),
    "a block at a point": (
        cell(go(350, 0, 200), bodies=[_block(350, 0, 190)]),
        cell(go(350, 0, 200), bodies=[_block(350, 0, 90)]),
        "CONTROL_POINT_IN_COLLISION",
        "met",
    ),
    "a block too near a point": (
        cell(
            go(350, 0, 200),
            bodies=[_block(350, 0, 167)],
            options=options(clearance_mm={"travel": 5, "near": 5}),
        ),
        cell(
            go(350, 0, 200),
            bodies=[_block(350, 0, 160)],
            options=options(clearance_mm={"travel": 5, "near": 5}),
        ),
        "CONTROL_POINT_IN_COLLISION",
        "met",
    ),
    "a block at a point with any yaw": (
        cell(go(350, 0, 200, None), bodies=[_block(350, 0, 190)]),
        cell(go(350, 0, 200, None), bodies=[_block(350, 0, 90)]),
        "CONTROL_POINT_IN_COLLISION",
        "met",
    ),
    "a block on the belt of the point": (
        _on_belt(0, at=[0, 0, 60]),
        _on_belt(0, at=[300, 0, 60]),
        "CONTROL_POINT_IN_COLLISION",
        "met",
    ),
    "a lid over a part": (_picked(65, lid=160), _picked(65), "CONTROL_POINT_IN_COLLISION", "met"),
    "a part that can be taken in two turns under a lid": (
        _picked(65, 2, lid=160),
        _picked(65, 2),
        "CONTROL_POINT_IN_COLLISION",
        "met",
    ),
    "a window that is too short": (
        _window(follow(-300, 0, 60, "belt", duration_ms=800, window_mm=[-50, 0])),
        _window(follow(-300, 0, 60, "belt", duration_ms=300, window_mm=[-50, 50])),
        "WINDOW_MISSED",
        "openings",
    ),
    "a window that was over": (
        _window(follow(0, 0, 60, "belt", duration_ms=200, window_s=[-3, -1])),
        _window(follow(0, 0, 60, "belt", **NEAR)),
        "WINDOW_MISSED",
        "openings",
    ),
    "a window after the latest end": (
        _window(follow(-200, 0, 60, "belt", duration_ms=200, window_s=[2, 3]), latest_end_s=1),
        _window(follow(-200, 0, 60, "belt", duration_ms=200, window_s=[2, 3]), latest_end_s=9),
        "WINDOW_MISSED",
        "openings",
    ),
    "a window that is never reached": (
        _window(follow(0, 0, 60, "belt", duration_ms=200, window_mm=[-200, -100])),
        _window(follow(0, 0, 60, "belt", **NEAR)),
        "WINDOW_MISSED",
        "openings",
    ),
    "windows without a common instant": (
        _window(follow(-300, 0, 60, "belt", duration_ms=200, window_mm=[-100, 100], window_s=[0, 1])),
        _window(follow(-300, 0, 60, "belt", duration_ms=200, window_mm=[-100, 100], window_s=[0, 4])),
        "WINDOW_MISSED",
        "openings",
    ),
    "a belt that brings a point too late": (
        _window(follow(-300, 0, 60, "belt", duration_ms=200, window_mm=[-100, 100]), latest_end_s=1),
        _window(follow(-300, 0, 60, "belt", duration_ms=200, window_mm=[-100, 100]), latest_end_s=9),
        "WINDOW_MISSED",
        "openings",
    ),
    "a law that ends before the point comes": (
        _window(follow(-300, 0, 60, "belt", duration_ms=200, window_mm=[-100, 100]), _stopping(2.1)),
        _window(follow(-300, 0, 60, "belt", duration_ms=200, window_mm=[-100, 100]), _stopping(9)),
        "LAW_ENDS",
        "openings",
    ),
    "a velocity that an acceleration must exceed": (
        moving({}, {"j1_rad_s": 6.99}, {"j1_rad_s": 50}),
        moving({}, {"j1_rad_s": 5.7}, {"j1_rad_s": 50}),
        "MOTION_LIMIT",
        None,
    ),
    "a velocity in the other direction": (
        moving({}, {"j2_rad_s": -6.9}, {"j2_rad_s": -20}),
        moving({}, {"j2_rad_s": -6.7}, {"j2_rad_s": -20}),
        "MOTION_LIMIT",
        None,
    ),
    "a start that cannot stop before the end of a range": (
        moving({"j1_deg": 169}, {"j1_rad_s": 3}, {}),
        moving({"j1_deg": 160}, {"j1_rad_s": 3}, {}),
        "JOINT_LIMIT",
        None,
    ),
    "a lift that cannot stop before the lower end": (
        moving({"j3_mm": 105}, {"j3_m_s": -1}, {}),
        moving({"j3_mm": 150}, {"j3_m_s": -1}, {}),
        "JOINT_LIMIT",
        None,
    ),
    "a law that is over at the start": (
        cell(
            go(350, 0, 200),
            frames={"belt": _stopping(-1)},
            bodies=[{**BLOCK, "pose": {"frame": "belt", "at_mm": [0, 0, 0]}}],
        ),
        cell(
            go(350, 0, 200),
            frames={"belt": _stopping(99)},
            bodies=[{**BLOCK, "pose": {"frame": "belt", "at_mm": [0, 0, 0]}}],
        ),
        "LAW_ENDS",
        None,
    ),
}
"""By name: a request without a plan, one with a plan, the reason of the first and the kind of its witness."""

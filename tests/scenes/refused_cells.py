"""Small requests that no plan fulfils, one of each kind of proof; and one beside each that a plan fulfils."""

from __future__ import annotations

import copy
from collections.abc import Callable
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
    request["execution"] = {"lag": {"j1_deg": 0.1, "j4_deg": 0.2}}
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


def _tracked(x: float) -> Document:
    step = {"follow": {"to": {"at_mm": [x, 0, 200], "yaw_deg": 0}, "duration_ms": 100}}
    return cell(step, options=options(singularity_margin=0.5))


def _with_a_block(at: tuple[float, float, float], yaw: float | None = 0.0, **option: Any) -> Document:
    """A move to a point, with a block somewhere."""
    return cell(go(350, 0, 200, yaw), bodies=[_block(*at)], options=options(**option))


def _on_belt(x: float) -> Document:
    """A point on a belt, and a block that rides on it."""
    bodies = [{**BLOCK, "pose": {"frame": "belt", "at_mm": [x, 0, 60]}}]
    return cell(follow(0, 0, 60, "belt", duration_ms=100, window_mm=[-200, 200]), frames={"belt": BELT}, bodies=bodies)


def _window(x: float, belt: Document = BELT, latest_end_s: float | None = None, **window: Any) -> Document:
    """A point on a belt that is followed in a window."""
    step = follow(x, 0, 60, "belt", **{"duration_ms": 200, **window})
    late = {} if latest_end_s is None else {"latest_end_s": latest_end_s}
    return cell(step, frames={"belt": belt}, options=options(**late))


def _stopping(valid: float) -> Document:
    return {"conveyor": BELT["conveyor"], "valid_s": [-5, valid]}


def _over(valid: float) -> Document:
    """A block on a belt whose law is known until a time."""
    bodies = [{**BLOCK, "pose": {"frame": "belt", "at_mm": [0, 0, 0]}}]
    return cell(go(350, 0, 200), frames={"belt": _stopping(valid)}, bodies=bodies)


ROUND = [-100, 100]
PAIRS: dict[tuple[str, str | None], dict[str, tuple[Callable[[Any], Document], Any, Any]]] = {
    ("OUT_OF_REACH", "hindered"): {
        "out of reach": (lambda x: cell(go(x, 0, 200)), 700, 500),
        "out of reach with any yaw": (lambda x: cell(go(x, 0, 200, None)), 700, 500),
        "a pitch": (lambda x: _hand(x, pitch_deg=-90), 460, 300),
    },
    ("JOINT_LIMIT", "hindered"): {
        "a lift that is too short": (lambda z: cell(go(350, 0, z)), 500, 200),
        "the elbow that is kept": (_behind, "keep", "auto"),
        "a part that can be taken in no turn": (lambda z: _picked(z, 2), 700, 65),
    },
    ("NEAR_SINGULARITY", "hindered"): {"a singular point that is tracked": (_tracked, 540, 350)},
    ("NEAR_PARALLEL_SINGULARITY", "hindered"): {"type 2": (_five_bar, 120, 250)},
    ("FORBIDDEN_YAW", "hindered"): {
        "a yaw on the way": (lambda ranges: _yawed(ranges, go(350, 0, 200, -90)), [[100, 170], [0, 20]], [[100, 170]])
    },
    ("FORBIDDEN_YAW", None): {
        "a yaw at a point": (lambda of: _yawed([of[:2]], go(350, 0, 200, of[2])), [-100, -80, -90], [-70, -60, 80]),
        "a yaw at the start": (lambda of: _yawed([of[:2]], go(350, 0, 200, of[2])), [80, 95, 0], [120, 130, 80]),
    },
    ("OUT_OF_REACH", None): {"every pitch": (_hand, 700, 300)},
    ("OUT_OF_REACH", "orbit"): {"a dial out of reach": (_dial, 900, 350)},
    ("JOINT_LIMIT", None): {
        "an arch": (lambda top: cell(go(350, -100, 200, arch={"top_mm": top})), 900, 220),
        "a start that cannot stop before the end of a range": (
            lambda q: moving({"j1_deg": q}, {"j1_rad_s": 3}, {}),
            169,
            160,
        ),
        "a lift that cannot stop before the lower end": (lambda q: moving({"j3_mm": q}, {"j3_m_s": -1}, {}), 105, 150),
    },
    ("TOLERANCE", None): {
        "a tool that is too far from its part": (lambda z: _gripped(z, 1), 20, 15),
        "a tool that is too far in both turns": (lambda z: _gripped(z, 1, 2), 20, 15),
        "a table that is too far below a part": (lambda z: _put(z, 1), 3, 0),
    },
    ("LOAD_LIMIT", None): {"a load": (_loaded, 9, 2)},
    ("START_IN_COLLISION", "met"): {"a block at the start": (_with_a_block, (305, 336, 170), (-305, 336, 170))},
    ("CONTROL_POINT_IN_COLLISION", "met"): {
        "a block at a point": (_with_a_block, (350, 0, 190), (350, 0, 90)),
        "a block too near a point": (
            lambda z: _with_a_block((350, 0, z), clearance_mm={"travel": 5, "near": 5}),
            167,
            160,
        ),
        "a block at a point with any yaw": (lambda z: _with_a_block((350, 0, z), None), 190, 90),
        "a block on the belt of the point": (_on_belt, 0, 300),
        "a lid over a part": (lambda lid: _picked(65, **lid), {"lid": 160}, {}),
        "a part that can be taken in two turns under a lid": (lambda lid: _picked(65, 2, **lid), {"lid": 160}, {}),
    },
    ("WINDOW_MISSED", "openings"): {
        "a window that is too short": (
            lambda of: _window(-300, duration_ms=of[0], window_mm=[-50, of[1]]),
            (800, 0),
            (300, 50),
        ),
        "a window that was over": (
            lambda window: _window(0, **window),
            {"window_s": [-3, -1]},
            {"window_mm": [-200, 200]},
        ),
        "a window after the latest end": (lambda end: _window(-200, window_s=[2, 3], latest_end_s=end), 1, 9),
        "a window that is never reached": (lambda x: _window(0, window_mm=[-200, x]), -100, 200),
        "windows without a common instant": (lambda end: _window(-300, window_mm=ROUND, window_s=[0, end]), 1, 4),
        "a belt that brings a point too late": (lambda end: _window(-300, window_mm=ROUND, latest_end_s=end), 1, 9),
    },
    ("LAW_ENDS", "openings"): {
        "a law that ends before the point comes": (lambda end: _window(-300, _stopping(end), window_mm=ROUND), 2.1, 9)
    },
    ("MOTION_LIMIT", None): {
        "a velocity that an acceleration must exceed": (
            lambda v: moving({}, {"j1_rad_s": v}, {"j1_rad_s": 50}),
            6.99,
            5.7,
        ),
        "a velocity in the other direction": (lambda v: moving({}, {"j2_rad_s": v}, {"j2_rad_s": -20}), -6.9, -6.7),
    },
    ("LAW_ENDS", None): {"a law that is over at the start": (_over, -1, 99)},
}
"""By reason and kind of witness, and by name: what makes a request, of what it has no plan, and of what it has one."""
PROVED: dict[str, tuple[Document, Document, str, str | None]] = {
    name: (make(impossible), make(possible), reason, kind)
    for (reason, kind), pairs in PAIRS.items()
    for name, (make, impossible, possible) in pairs.items()
}
"""By name: a request without a plan, one with a plan, the reason of the first and the kind of its witness."""

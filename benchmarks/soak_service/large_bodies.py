"""Requests that are legal and ask for much, or are refused only after much reading: seconds, meshes, megabytes."""

from __future__ import annotations

import base64
import copy
import json
import math
import random
import struct
from typing import Any

Document = dict[str, Any]
PLENTY = 1e5
"""The longest time that a request may state, s."""
SMALL: Document = {
    "schema": "assur/1",
    "robot": {
        "model": "mitsubishi-rh-6frh5520",
        "tool": {
            "tcp_m": [0, 0, 0],
            "bodies": [{"name": "cup", "shape": {"sphere": {"radius_m": 0.01}}, "at_m": [0, 0, 0]}],
        },
    },
    "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
    "bodies": [
        {"name": "post", "shape": {"box": {"size_m": [0.05, 0.05, 0.2]}}, "pose": {"at_m": [0.3, 0.25, 0.1]}},
        {"name": "part", "shape": {"mesh": {"asset": "bracket", "unit": "mm"}}, "pose": {"at_m": [0.4, -0.2, 0.02]}},
    ],
    "task": [{"move": {"to": {"at_m": [0.4, 0.0, 0.25]}}}],
    "options": {},
}
"""A request that is planned in milliseconds."""


def small(**changes: Any) -> bytes:
    """The small request with some of its members replaced."""
    return json.dumps({**copy.deepcopy(SMALL), **changes}).encode()


def of_seconds(scenes: dict[str, Document], longer_s: float) -> dict[str, bytes]:
    """Requests that state 100,000 s somewhere, by what they are; some with the default budget and with a longer one."""
    fixed = {"t": {"fixed": {"at_m": [0.4, 0, 0.2]}}}
    follow = {"follow": {"to": {"frame": "t", "at_m": [0.02, 0, 0.03], "yaw_rad": 0}, "duration_s": PLENTY}}
    bodies = copy.deepcopy(SMALL["bodies"])
    near = {"approach": {"m": 0.03}, "depart": {"m": 0.03}}
    pick = {"pick": {"part": "part", "grasp_m": [0, 0, 0.03], "dwell_s": PLENTY, **near}}
    window = {"move": {"to": {"at_m": [0.4, 0, 0.25]}, "window_s": [PLENTY - 1, PLENTY]}}
    blend = copy.deepcopy(scenes["parabolic-blend"])
    blend["options"] = {
        **{key: value for key, value in blend["options"].items() if "acceleration_time" not in key},
        "acceleration_time_s": PLENTY,
    }
    return {
        "follow of 1e5 s": small(frames=fixed, task=[follow]),
        "follow of 1e5 s, longer budget": small(frames=fixed, task=[follow], options={"budget_s": longer_s}),
        "window 1e5 s ahead": small(task=[window]),
        "window 1e5 s ahead, longer budget": small(task=[window], options={"budget_s": longer_s}),
        "dwell of 1e5 s": small(bodies=bodies, task=[pick]),
        "stay safe for 1e5 s": small(options={"stay_safe_s": PLENTY, "elbow": "auto"}),
        "acceleration time 1e5 s": json.dumps(blend).encode(),
    }


def of_meshes(scenes: dict[str, Document], longer_s: float) -> dict[str, bytes]:
    """Requests with meshes that are dear to cover, and others that are dear before the search, by what they are."""
    z_down = copy.deepcopy(scenes["z-down"])
    z_down["options"]["budget_s"] = 0.05
    for body in z_down["bodies"]:
        body["yaw_symmetry"] = 360
    crowded = copy.deepcopy(scenes["crowded"])
    crowded["options"]["budget_s"] = 0.05
    hundred = [_body(f"t{i}", torus(8, 4, radius=0.05 + 0.0005 * i), i) for i in range(100)]
    return {
        "torus of 400 triangles": small(bodies=[_body("t", torus(20, 10))]),
        "noisy torus of 2,000": small(bodies=[_body("t", torus(50, 20, noise=0.002))]),
        "noisy torus of 2,000, longer budget": small(
            bodies=[_body("t", torus(50, 20, noise=0.002, seed=1))], options={"budget_s": longer_s}
        ),
        "torus of 15,600 triangles": small(bodies=[_body("t", torus(130, 60))]),
        "100 different tori": small(bodies=hundred),
        "crowded within 0.05 s": json.dumps(crowded).encode(),
        "360 yaws within 0.05 s": json.dumps(z_down).encode(),
    }


def of_counts() -> dict[str, bytes]:
    """Requests with many bodies in one place, many corners and points of paths, long motions on moving frames, and many
    steps, by what they are. Each is legal, or refused for where it is."""
    box = {"box": {"size_m": [0.06, 0.04, 0.02]}}
    at = {"at_m": [0.4, 0.0, 0.01]}
    crowd = [{"name": f"b{i}", "shape": box, "pose": at} for i in range(900)]
    grip = {"grasp_m": [0, 0, 0.01], "approach": {"m": 0.03}, "depart": {"m": 0.04}}
    handled: list[Document] = []
    for i in range(32):
        handled.append({"pick": {"part": f"b{i}", "dwell_s": 0.01, **grip}})
        place = {"at_m": [0.3, 0.2, 0.01], "yaw_rad": 0}
        handled.append({"place": {"part": f"b{i}", "to": place, "dwell_s": 0.01, **_without(grip, "grasp_m")}})
    flange = {"mesh": {"asset": "flange", "unit": "mm"}}
    flanges = [
        {"name": f"b{i}", "shape": flange, "pose": {"at_m": [0.38 + 0.001 * (i % 40), 0.002 * (i // 40), 0.05]}}
        for i in range(600)
    ]
    zigzag = [{"line": {"to_m": [0.4 + 0.0005 * (i % 2), 0.0005 * i + 0.0003, 0.12]}} for i in range(200)]
    points = [{"spline": {"through_m": [[0.4, round(-0.05 + 0.0005 * (i + 1), 6), 0.12] for i in range(200)]}}]
    start = {"at_m": [0.4, 0, 0.12], "yaw_rad": 0}
    blended = {"trace": {"start": start, "speed_m_s": 0.1, "blend_m": 0.0001, "path": zigzag}}
    splined = {"trace": {"start": {**start, "at_m": [0.4, -0.05, 0.12]}, "speed_m_s": 0.05, "path": points}}
    turning = {"turntable": {"at_m": [0.4, 0, 0.1], "rate_rad_s": 0.002}}
    shaking = {"oscillation": {"at_m": [0.4, 0, 0.1], "direction": [1, 0, 0], "amplitude_m": 0.005, "period_s": 1}}
    stepping = {"indexer": {"at_m": [0.4, 0, 0.05], "step_rad": 0.02, "move_s": 0.001, "dwell_s": 0}}
    on_frame = {"frame": "s", "at_m": [0, 0, 0.05], "yaw_rad": 0}
    move = {"move": {"to": {"frame": "s", "at_m": [0.05, 0, 0.05]}}}
    return {
        "32 parts among 900 boxes": small(bodies=crowd, task=handled),
        "600 flanges": small(bodies=flanges),
        "4 traces of 200 corners": small(task=[blended] * 4),
        "a trace through 200 points": small(task=[splined]),
        "60 traces through 200 points": small(task=[splined] * 60),
        "a follow of 1,500 s on a turntable": small(
            frames={"s": turning}, task=[{"follow": {"to": on_frame, "duration_s": 1500}}]
        ),
        "a follow of 300 s on a shaker": small(
            frames={"s": shaking}, task=[{"follow": {"to": on_frame, "duration_s": 300}}]
        ),
        "64 moves to an indexer": small(frames={"s": stepping}, task=[move] * 64),
    }


def of_checks() -> dict[str, bytes]:
    """Bodies of a check, of up to 16 MiB, that are dear to read, by what they are."""
    head, tail = b'{"request": {}, "plan": [', b"0]}"
    most = (16 << 20) - len(head) - len(tail)
    texts = b",".join(b'"%d"' % i for i in range(1_700_000))
    return {
        "a check of 16 MiB of objects": head + b'{"":0},' * (most // 7) + tail,
        "a check of 349,000 objects": head + b'{"":0},' * 349_000 + tail,
        "a check of 1,700,000 texts": head + texts + b"," + tail,
    }


def _without(document: Document, name: str) -> Document:
    return {key: value for key, value in document.items() if key != name}


def of_megabytes() -> dict[str, bytes]:
    """Bodies of up to 1 MiB that are dear to read, by what they are."""
    rows = [[0.01 * i, 0, 0, 0, 0] for i in range(30_000)]
    robot = {**SMALL["robot"], "limits": {f"j{i}": 1 for i in range(58_839)}}
    return {
        "44,000 unknown fields": unknown_fields(),
        "frames of {}": small(frames={f"f{i}": {} for i in range(60_000)}),
        "26,200 nested lists": small(task=[_nested(12) for _ in range(26_200)]),
        "349,000 empty bodies": b'{"schema": "assur/1", "bodies": [' + b"{}," * 340_000 + b"{}]}",
        "limits of 58,839 joints": small(robot=robot),
        "list of 30,000 rows": small(task=rows),
    }


def unknown_fields() -> bytes:
    """1 MB of frames, each with a field that is no field."""
    return small(frames={f"f{i}": {"fixe": 0} for i in range(44_000)})


def _nested(levels: int) -> Any:
    found: Any = 1
    for _ in range(levels):
        found = [found]
    return found


def _body(name: str, stl: bytes, at: int = 0) -> Document:
    mesh = {"data": base64.b64encode(stl).decode(), "format": "stl", "unit": "m"}
    place = [0.3 + 0.01 * (at % 10), 0.3 + 0.01 * (at // 10), 0.1]
    return {"name": name, "pose": {"at_m": place}, "shape": {"mesh": mesh}}


def torus(around: int, across: int, radius: float = 0.1, noise: float = 0.0, seed: int = 0) -> bytes:
    """A torus of 2 × around × across triangles as binary STL, in metres; its tube is 30 mm thick, its vertices are off
    by up to `noise`."""
    rng = random.Random(seed)
    tube = 0.3 * radius

    def vertex(i: int, j: int) -> tuple[float, float, float]:
        u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
        out, off = radius + tube * math.cos(v), rng.uniform(-noise, noise)
        return ((out + off) * math.cos(u), (out + off) * math.sin(u), tube * math.sin(v) + off)

    grid = [[vertex(i, j) for j in range(across)] for i in range(around)]
    triangles = []
    for i in range(around):
        for j in range(across):
            corner = [grid[(i + x) % around][(j + y) % across] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
            triangles += [(corner[0], corner[1], corner[2]), (corner[0], corner[2], corner[3])]
    packed = [struct.pack("<12fH", 0, 0, 0, *(x for point in each for x in point), 0) for each in triangles]
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + b"".join(packed)

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

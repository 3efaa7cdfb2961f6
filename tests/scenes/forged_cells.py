"""The cells whose answers are forged, by name: shipped ones, and small ones for what these have not."""

from __future__ import annotations

import copy
from functools import cache
from pathlib import Path
from typing import Any

from assur.scenes.reading.cell import Cell
from assur.scenes.requests import cell_of, plan_cell
from assur.scenes.scenarios import shipped

Document = dict[str, Any]
ARM: Document = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -60]}}
START: Document = {"joints": {"j1_deg": 17, "j2_deg": 68, "j3_mm": 250, "j4_deg": 0}}
FIRST: Document = {"stop": "first", "max_candidates": 200, "budget_s": 60}
TABLE: Document = {"name": "table", "shape": {"box": {"size_mm": [300, 300, 100]}}, "pose": {"at_mm": [300, -150, 50]}}
PART: Document = {"name": "part", "shape": {"box": {"size_mm": [30, 30, 20]}}, "pose": {"at_mm": [250, -100, 110]}}
PICK: Document = {"part": "part", "grasp_mm": [0, 0, 10], "approach": {"mm": 20}, "dwell_ms": 50, "depart": {"mm": 20}}
BELT: Document = {"conveyor": {"at_mm": [-300, 350, 50], "speed_mm_s": 250}}
ONTO_BELT: Document = {"to": {"frame": "belt", "at_mm": [0, 0, 80], "yaw_free": True}, "duration_ms": 100}
"""A follow of a point of the belt."""


def task(*steps: Document, **keys: Any) -> Document:
    """A request with these steps."""
    request = {"schema": "assur/1", "robot": ARM, "start": START, "bodies": [], "task": list(steps), "options": FIRST}
    return copy.deepcopy(request | keys)


AWAY: Document = {"move": {"to": {"at_mm": [250, 250, 150], "yaw_deg": 60}}}
BACK: Document = {"move": {"to": {"at_mm": [350, -100, 120], "yaw_deg": 0}}}
ELBOW: Document = shipped("elbow-arm").request
BLENDS = shipped("parabolic-blend").request
UNKNOWN: Document = {
    "position_mm": 0.5, "speed_mm_s": 2, "lateral_mm": 0.3, "vertical_mm": 0.2, "yaw_deg": 0.2
}  # fmt: skip
LAG: Document = {"lag": {"j1_deg": 0.02, "j2_deg": 0.02, "j3_mm": 0.02, "j4_deg": 0.05}, "start_tolerance_ms": 2}
LID: Document = {"part": "lid", "approach": {"mm": 20}, "dwell_ms": 50, "depart": {"mm": 20}}
THIN: Document = {
    "name": "floor",
    "shape": {"box": {"size_mm": [200, 80, 4]}},
    "pose": {"frame": "out", "at_mm": [0, 0, 2]},
}
SMALL: dict[str, Document] = {
    "known": task({"pick": PICK}, bodies=[TABLE, PART]),
    "stopped": task(AWAY, BACK),
    "line": task({"move": {"to": {"at_mm": [350, 150, 150], "yaw_deg": 60}, "leg": "cartesian"}}),
    "belt": task({"follow": ONTO_BELT | {"window_mm": [300, 700]}}, frames={"belt": BELT}),
    "off-belt": task(
        {"follow": ONTO_BELT | {"window_mm": [300, 700]}},
        {"move": {"to": {"at_mm": [350, -100, 120]}}},
        frames={"belt": BELT},
    ),
    "timed": task({"follow": ONTO_BELT | {"window_s": [0, 1.5]}}, frames={"belt": BELT}),
    "moving": task({"follow": ONTO_BELT | {"window_mm": [300, 700]}}, frames={"belt": BELT},
                   options=FIRST | {"end": "moving"}),
    "uncertain": task(
        {"pick": PICK | {"contact_tolerance_mm": 5, "window_mm": [200, 700]}},
        frames={"belt": BELT | {"uncertainty": UNKNOWN}},
        bodies=[PART | {"pose": {"frame": "belt", "at_mm": [0, 0, 40]}, "uncertainty": {"position_mm": 0.4}}],
        execution=LAG,
    ),
    "floating": task({"pick": PICK}, bodies=[TABLE, PART | {"pose": {"at_mm": [250, -100, 113]}}]),
    "bent-elbow": ELBOW | {"task": [{"move": {"to": {"at_m": [0.1, 0.35, 0.3]}}}], "bodies": [], "frames": {},
                           "options": FIRST},
    # a lid is put on a thin floor that rides over a bed that stands
    "put-down": task(
        {"pick": LID | {"grasp_mm": [0, 0, 10]}},
        {"place": LID | {"to": {"frame": "out", "at_mm": [0, 0, 14], "yaw_deg": 0}}},
        {"move": {"to": {"at_mm": [350, 0, 150]}}},
        robot=ARM | {"tool": {"tcp_mm": [0, 0, -100]}},
        start={"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
        frames={"out": {"conveyor": {"at_mm": [100, -350, 40], "speed_mm_s": 30}}},
        bodies=[
            {"name": "bed", "shape": {"box": {"size_mm": [900, 160, 40]}}, "pose": {"at_mm": [0, -350, 20]}},
            THIN,
            {"name": "table", "shape": {"box": {"size_mm": [200, 200, 50]}}, "pose": {"at_mm": [350, 100, 25]}},
            {"name": "lid", "shape": {"box": {"size_mm": [40, 40, 20]}}, "pose": {"at_mm": [350, 80, 60]}},
        ],
        options=FIRST | {"clearance_mm": {"travel": 8, "near": 2}},
    ),
    "blended-stop": task(AWAY, BACK, options=FIRST | {"timing": "parabolic_blend"}),
}  # fmt: skip
SHIPPED = {
    "demo": "demo",
    "traced": "bead-on-belt",
    "five-bar": "five-bar",
    "blended": "parabolic-blend",
    "heavy": "heavy-casting",
    "rv-m1": "rv-m1",
    "elbow-arm": "elbow-arm",
    "waiting": "shutter",
    "late": "two-robots-late",
    "transfer": "transfer",
    "dense-flow": "dense-flow",
}


def request_of(name: str) -> tuple[Document, Path | None]:
    """The request of a cell, and below which folder it names files."""
    if name in SMALL:
        return copy.deepcopy(SMALL[name]), None
    scenario = shipped(SHIPPED[name])
    return copy.deepcopy(scenario.request), scenario.folder


@cache
def answered(name: str) -> tuple[Cell, Document]:
    """The cell, and its answer with the pairs that come nearest; not to be changed."""
    request, folder = request_of(name)
    cell = cell_of(request, folder=folder)
    return cell, plan_cell(cell, unstated={"report": "full"})

"""Draws the cell of docs/first-belt-cell.yaml from above: `python -m docs.drawings.first_belt_cell`.

x of the world goes to the right, y up; all numbers are millimetres of the cell. Every number in the drawing is one of
the cell or of its robot, so the drawing and the file cannot differ.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from assur.scenes.requests import load_scenario, scene_of
from docs.drawings.top_view import GO, TopView

HERE = Path(__file__).parent
CELL = HERE.parent / "first-belt-cell.yaml"
DRAWING = HERE / "first-belt-cell.svg"
VIEW = TopView(-730.0, 760.0, 640.0, -470.0)
TITLE = "The first belt cell from above: robot, belt, box, tray and fence with their dimensions"


def draw(request: dict[str, Any]) -> str:
    """The drawing of the cell as SVG; `request` in mm, as the tutorial writes it."""
    bodies = {body["name"]: body for body in request["bodies"]}
    size = {name: body["shape"]["box"]["size_mm"] for name, body in bodies.items()}
    at = {name: body["pose"]["at_mm"] for name, body in bodies.items()}
    belt = request["frames"]["belt"]["conveyor"]
    steps = {kind: step for entry in request["task"] for kind, step in entry.items()}
    window, place, home = steps["pick"]["window_mm"], steps["place"]["to"]["at_mm"], steps["move"]["to"]["at_mm"]
    y, joints = belt["at_mm"][1], request["start"]["joints"]
    start = (belt["at_mm"][0] + at["box"][0], y + at["box"][1])
    bed, wall, floor, fence = at["belt-bed"], at["tray-wall"], at["tray-floor"], at["fence"]
    inner = fence[0] - size["fence"][0] / 2
    width = size["belt-bed"][1]
    shapes = [
        VIEW.box("solid", bed, size["belt-bed"]),
        VIEW.box("window", [sum(window) / 2, y], [window[1] - window[0], width]),
        *(VIEW.box("solid", at[name], size[name]) for name in ("tray-floor", "tray-wall", "fence")),
        VIEW.box("part", [*start], size["box"]),
        VIEW.box("part", place, size["box"]),
        VIEW.line((start[0] + 50, y), (start[0] + 130, y), "move", GO),
        *VIEW.arm(scene_of(request).robot, joints["j1_deg"], joints["j2_deg"]),
        VIEW.disc("tip", (home[0], home[1]), 6),
        VIEW.text((home[0] - 4, home[1] - 30), "home"),
    ]
    dimensions = [
        *VIEW.along_x(start[0], 0.0, y + width / 2 + 40, y),
        *VIEW.along_x(window[0], window[1], y + width / 2 + 84, y + width / 2),
        *VIEW.along_y(0.0, y, -680, 0.0),
        *VIEW.along_y(y - width / 2, y + width / 2, 650, bed[0] + size["belt-bed"][0] / 2),
        *VIEW.along_x(0.0, inner, fence[1] - size["fence"][1] / 2 + 20, 0.0),
        *VIEW.along_y(floor[1], 0.0, 640, floor[0]),
        *VIEW.along_x(0.0, floor[0], floor[1] - size["tray-floor"][1] / 2 - 60, floor[1]),
    ]
    top = bed[2] + size["belt-bed"][2] / 2
    words = [
        VIEW.text((-590, y + 70), f"belt, top at z = {top:g}, {belt['speed_mm_s']:g} mm/s", "start"),
        VIEW.text((start[0], y - 46), f"box {' × '.join(f'{x:g}' for x in size['box'])}, at t = 0"),
        VIEW.text((sum(window) / 2 + 60, y - 10), "the box may be taken here"),
        VIEW.text(
            (floor[0] - 110, floor[1] - 30), f"tray, floor at z = {floor[2] + size['tray-floor'][2] / 2:g},", "end"
        ),
        VIEW.text((floor[0] - 110, floor[1] - 52), f"wall to z = {wall[2] + size['tray-wall'][2] / 2:g}", "end"),
        VIEW.text((fence[0] + 20, 20.0), f"fence, {fence[2] + size['fence'][2] / 2:g} high", "start"),
        *VIEW.axes(),
    ]
    return VIEW.page(TITLE, [*shapes, *dimensions, *words])


def main() -> int:
    """Writes the drawing."""
    DRAWING.write_text(draw(load_scenario(CELL).request), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

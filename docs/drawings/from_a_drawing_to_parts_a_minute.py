"""Draws the cell of docs/from-a-drawing-to-parts-a-minute.yaml from above:
`python -m docs.drawings.from_a_drawing_to_parts_a_minute`.

Every number in the drawing is one of the cell or of its robot, so the drawing and the file cannot differ.
"""

from __future__ import annotations

import sys
from math import acos, atan2, cos, degrees, sin
from pathlib import Path
from typing import Any

import assur
from assur.scenes.simulation.cell import simulated
from docs.drawings.top_view import GO, TopView

HERE = Path(__file__).parent
CELL = HERE.parent / "from-a-drawing-to-parts-a-minute.yaml"
DRAWING = HERE / "from-a-drawing-to-parts-a-minute.svg"
VIEW = TopView(-780.0, 640.0, 520.0, -470.0)
TITLE = "A cell from above: robot, belt with pots, line of the camera, window and tray with their dimensions"


def draw(cell: dict[str, Any]) -> str:
    """The drawing of the cell as SVG; `cell` in mm, as the tutorial writes it."""
    bed, tray = (body["pose"]["at_mm"] for body in cell["bodies"])
    bed_size, tray_size = (body["shape"]["box"]["size_mm"] for body in cell["bodies"])
    belt, stream, slots = cell["frames"]["belt"]["conveyor"], cell["streams"]["pot"], cell["slots"]["tray"]
    home, pot = cell["positions"]["home"]["at_mm"], cell["kinds"]["pot"]["shape"]["cylinder"]
    radius, (x, y, top) = pot["radius_mm"], belt["at_mm"]
    seen, window = x + stream["seen"]["at_mm"], [x + each for each in stream["window_mm"]]
    edge = y + bed_size[1] / 2
    corner = [tray[k] + slots["at_mm"][k] for k in (0, 1)]
    grid = [
        (corner[0] + i * slots["step_mm"][0], corner[1] + j * slots["step_mm"][1])
        for i in range(slots["count"][0])
        for j in range(slots["count"][1])
    ]
    apart = belt["speed_mm_s"] * stream["every_s"]
    robot = simulated(cell).chooser.robot
    l1, l2 = 1e3 * robot.l1, 1e3 * robot.l2
    bend = -acos((home[0] ** 2 + home[1] ** 2 - l1**2 - l2**2) / (2 * l1 * l2))
    first = atan2(home[1], home[0]) - atan2(l2 * sin(bend), l1 + l2 * cos(bend))
    shapes = [
        VIEW.box("solid", bed, bed_size),
        VIEW.box("window", [sum(window) / 2, y], [window[1] - window[0], bed_size[1]]),
        VIEW.box("solid", tray, tray_size),
        *(VIEW.disc("part", (seen - 60 + k * apart, y + lane), radius) for k, lane in enumerate((8, -14))),
        *(VIEW.disc("part", at, radius) for at in grid),
        VIEW.line((seen, y - 90), (seen, edge + 30), "move"),
        VIEW.line((seen + apart - 5, y), (seen + apart + 75, y), "move", GO),
        *VIEW.arm(robot, degrees(first), degrees(bend)),
        VIEW.disc("tip", home, 6),
    ]
    dimensions = [
        *VIEW.along_x(seen, 0.0, edge + 70, edge),
        *VIEW.along_x(window[0], window[1], edge + 114, edge),
        *VIEW.along_y(0.0, y, 520, 0.0),
        *VIEW.along_y(y - bed_size[1] / 2, edge, 570, window[1]),
        *VIEW.along_y(tray[1], 0.0, 520, tray[0]),
        *VIEW.along_x(0.0, tray[0], tray[1] - tray_size[1] / 2 - 50, tray[1]),
        *VIEW.along_x(corner[0], corner[0] + slots["step_mm"][0], tray[1] + tray_size[1] / 2 + 14, grid[-1][1]),
        *VIEW.along_y(corner[1], corner[1] + slots["step_mm"][1], 400, corner[0] + slots["step_mm"][0]),
    ]
    words = [
        VIEW.text((seen + 14, y - 88), "line of the camera", "start"),
        VIEW.text((-760, y - 120), f"belt, top at z = {top:g}, {belt['speed_mm_s']:g} mm/s;", "start"),
        VIEW.text((-760, y - 142), f"a pot each {stream['every_s']:g} s, ± {stream['jitter_s']:g} s,", "start"),
        VIEW.text((-760, y - 164), f"aside by up to {stream['lane_mm'][1]:g}", "start"),
        VIEW.text((-760, y - 200), f"pot: diameter {2 * radius:g}, {pot['height_mm']:g} high", "start"),
        VIEW.text((sum(window) / 2, y + 26), "pots may be taken here"),
        VIEW.text((home[0] + 6, home[1] - 26), "home", "start"),
        VIEW.text((tray[0] - 95, tray[1] - 60), f"tray for {len(grid)} pots,", "end"),
        VIEW.text((tray[0] - 95, tray[1] - 82), f"{tray_size[0]:g} × {tray_size[1]:g},", "end"),
        VIEW.text((tray[0] - 95, tray[1] - 104), f"floor at z = {tray[2] + tray_size[2] / 2:g}", "end"),
        *VIEW.axes(),
    ]
    return VIEW.page(TITLE, [*shapes, *dimensions, *words])


def main() -> int:
    """Writes the drawing."""
    DRAWING.write_text(draw(dict(assur.load(CELL))), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

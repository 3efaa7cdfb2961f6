"""Draws the cell of docs/first-belt-cell.yaml from above: `python -m docs.drawings.first_belt_cell`.

x of the world goes to the right, y up; all numbers are millimetres of the cell. Every number in the drawing is one of
the cell or of its robot, so the drawing and the file cannot differ.
"""

from __future__ import annotations

import sys
from math import cos, radians, sin
from pathlib import Path
from typing import Any

from assur.scenes.requests import load_scenario, scene_of

HERE = Path(__file__).parent
CELL = HERE.parent / "first-belt-cell.yaml"
DRAWING = HERE / "first-belt-cell.svg"
LEFT, RIGHT, TOP, BOTTOM = -730.0, 760.0, 640.0, -470.0
"""What is shown of the cell, mm."""
STYLE = """
  .paper { fill: #ffffff } text { fill: #1a1a1a; font: 17px 'DejaVu Sans', Verdana, sans-serif }
  .solid { fill: #dfe5ea; stroke: #1a1a1a; stroke-width: 1.5 }
  .arm { fill: #b9c9d6; stroke: #1a1a1a; stroke-width: 1.5 }
  .part { fill: #f0b45a; stroke: #1a1a1a; stroke-width: 1.5 } .window { fill: #1f7a4d; opacity: 0.22 }
  .link { stroke: #8fa9bd; stroke-width: 40; stroke-linecap: round; opacity: 0.85 }
  .thin { stroke: #44607a; stroke-width: 1.2; fill: none } .dash { stroke-dasharray: 7 5 }
  .move { stroke: #1f7a4d; stroke-width: 3; fill: none } .tip { fill: #44607a } .go { fill: #1f7a4d }
  @media (prefers-color-scheme: dark) {
    .paper { fill: #15191d } text { fill: #e8ecef } .solid { fill: #333d46; stroke: #c8d0d6 }
    .arm { fill: #4a6072; stroke: #c8d0d6 } .part { fill: #b87a1e; stroke: #e8ecef } .window { fill: #4fc98c }
    .link { stroke: #5d7a90 } .thin { stroke: #9db6cb } .tip { fill: #9db6cb }
    .move { stroke: #4fc98c } .go { fill: #4fc98c }
  }
"""


def _x(x: float) -> str:
    return f"{x - LEFT:.1f}"


def _y(y: float) -> str:
    return f"{TOP - y:.1f}"


def _box(kind: str, at: list[float], size: list[float]) -> str:
    """A box by its middle and its size."""
    corner = f'x="{_x(at[0] - size[0] / 2)}" y="{_y(at[1] + size[1] / 2)}"'
    return f'<rect class="{kind}" {corner} width="{size[0]:.1f}" height="{size[1]:.1f}"/>'


def _disc(kind: str, at: tuple[float, float], radius: float) -> str:
    return f'<circle class="{kind}" cx="{_x(at[0])}" cy="{_y(at[1])}" r="{radius:.1f}"/>'


def _text(at: tuple[float, float], words: str, anchor: str = "middle") -> str:
    return f'<text x="{_x(at[0])}" y="{_y(at[1])}" text-anchor="{anchor}">{words}</text>'


def _line(a: tuple[float, float], b: tuple[float, float], kind: str = "thin", ends: str = "") -> str:
    return f'<path class="{kind}" d="M{_x(a[0])},{_y(a[1])} L{_x(b[0])},{_y(b[1])}"{ends}/>'


BOTH = ' marker-start="url(#tip)" marker-end="url(#tip)"'


def _along_x(x0: float, x1: float, y: float, edge: float) -> list[str]:
    """The dimension x1 - x0, drawn at y, with lines to the edge that is measured."""
    lines = [_line((x, edge), (x, y), "thin dash") for x in (x0, x1)]
    return [*lines, _line((x0, y), (x1, y), ends=BOTH), _text(((x0 + x1) / 2, y + 8), f"{x1 - x0:g}")]


def _along_y(y0: float, y1: float, x: float, edge: float) -> list[str]:
    """The dimension y1 - y0, drawn at x."""
    lines = [_line((edge, y), (x, y), "thin dash") for y in (y0, y1)]
    return [*lines, _line((x, y0), (x, y1), ends=BOTH), _text((x + 8, (y0 + y1) / 2 - 6), f"{y1 - y0:g}", "start")]


def _arm(request: dict[str, Any]) -> list[str]:
    """The arm at its start: links of the model's lengths."""
    robot, joints = scene_of(request).robot, request["start"]["joints"]
    l1, l2 = 1e3 * robot.l1, 1e3 * robot.l2
    first, second = radians(joints["j1_deg"]), radians(joints["j1_deg"] + joints["j2_deg"])
    elbow = (l1 * cos(first), l1 * sin(first))
    wrist = (elbow[0] + l2 * cos(second), elbow[1] + l2 * sin(second))
    return [
        _disc("thin dash", (0.0, 0.0), l1 + l2),
        _text((-(l1 + l2) + 12, -40), f"reach {l1 + l2:g}", "start"),
        _line((0.0, 0.0), elbow, "link"),
        _line(elbow, wrist, "link"),
        *(_disc("arm", at, radius) for at, radius in (((0.0, 0.0), 60), (elbow, 26), (wrist, 15))),
        _text((-8, -90), "robot, base at (0, 0)"),
    ]


def draw(request: dict[str, Any]) -> str:
    """The drawing of the cell as SVG; `request` in mm, as the tutorial writes it."""
    bodies = {body["name"]: body for body in request["bodies"]}
    size = {name: body["shape"]["box"]["size_mm"] for name, body in bodies.items()}
    at = {name: body["pose"]["at_mm"] for name, body in bodies.items()}
    belt = request["frames"]["belt"]["conveyor"]
    steps = {kind: step for entry in request["task"] for kind, step in entry.items()}
    window, place, home = steps["pick"]["window_mm"], steps["place"]["to"]["at_mm"], steps["move"]["to"]["at_mm"]
    y = belt["at_mm"][1]
    start = (belt["at_mm"][0] + at["box"][0], y + at["box"][1])
    bed, wall, floor, fence = at["belt-bed"], at["tray-wall"], at["tray-floor"], at["fence"]
    inner = fence[0] - size["fence"][0] / 2
    width = size["belt-bed"][1]
    shapes = [
        _box("solid", bed, size["belt-bed"]),
        _box("window", [sum(window) / 2, y], [window[1] - window[0], width]),
        *(_box("solid", at[name], size[name]) for name in ("tray-floor", "tray-wall", "fence")),
        _box("part", [*start], size["box"]),
        _box("part", place, size["box"]),
        _line((start[0] + 50, y), (start[0] + 130, y), "move", ' marker-end="url(#go)"'),
        *_arm(request),
        _disc("tip", (home[0], home[1]), 6),
        _text((home[0] - 4, home[1] - 30), "home"),
    ]
    dimensions = [
        *_along_x(start[0], 0.0, y + width / 2 + 40, y),
        *_along_x(window[0], window[1], y + width / 2 + 84, y + width / 2),
        *_along_y(0.0, y, -680, 0.0),
        *_along_y(y - width / 2, y + width / 2, 650, bed[0] + size["belt-bed"][0] / 2),
        *_along_x(0.0, inner, fence[1] - size["fence"][1] / 2 + 20, 0.0),
        *_along_y(floor[1], 0.0, 640, floor[0]),
        *_along_x(0.0, floor[0], floor[1] - size["tray-floor"][1] / 2 - 60, floor[1]),
    ]
    top = bed[2] + size["belt-bed"][2] / 2
    words = [
        _text((-590, y + 70), f"belt, top at z = {top:g}, {belt['speed_mm_s']:g} mm/s", "start"),
        _text((start[0], y - 46), f"box {' × '.join(f'{x:g}' for x in size['box'])}, at t = 0"),
        _text((sum(window) / 2 + 60, y - 10), "the box may be taken here"),
        _text((floor[0] - 110, floor[1] - 30), f"tray, floor at z = {floor[2] + size['tray-floor'][2] / 2:g},", "end"),
        _text((floor[0] - 110, floor[1] - 52), f"wall to z = {wall[2] + size['tray-wall'][2] / 2:g}", "end"),
        _text((fence[0] + 20, 20.0), f"fence, {fence[2] + size['fence'][2] / 2:g} high", "start"),
        _line((LEFT + 60, BOTTOM + 60), (LEFT + 130, BOTTOM + 60), ends=' marker-end="url(#tip)"'),
        _line((LEFT + 60, BOTTOM + 60), (LEFT + 60, BOTTOM + 130), ends=' marker-end="url(#tip)"'),
        _text((LEFT + 146, BOTTOM + 55), "x"),
        _text((LEFT + 60, BOTTOM + 140), "y"),
        _text((LEFT + 200, BOTTOM + 40), "top view, all lengths in mm", "start"),
    ]
    wide, high = RIGHT - LEFT, TOP - BOTTOM
    marker = (
        '<marker id="{0}" viewBox="0 0 10 8" refX="9.5" refY="4" markerWidth="{1}" markerHeight="{1}" '
        'markerUnits="userSpaceOnUse" orient="auto-start-reverse">'
        '<path class="{0}" d="M0,0.5 L10,4 L0,7.5 Z"/></marker>'
    )
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:g} {high:g}" width="{wide * 0.7:g}">'
    return "\n".join(
        [
            head,
            "<title>The first belt cell from above: robot, belt, box, tray and fence with their dimensions</title>",
            f"<style>{STYLE}</style>",
            f"<defs>{marker.format('tip', 12)}{marker.format('go', 22)}</defs>",
            f'<rect class="paper" width="{wide:g}" height="{high:g}"/>',
            *shapes,
            *dimensions,
            *words,
            "</svg>",
            "",
        ]
    )


def main() -> int:
    """Writes the drawing."""
    DRAWING.write_text(draw(load_scenario(CELL).request), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

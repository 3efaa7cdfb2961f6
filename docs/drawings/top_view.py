"""A cell from above, as SVG: x of the world goes to the right, y up; all numbers are millimetres of the cell."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Any

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
BOTH = ' marker-start="url(#tip)" marker-end="url(#tip)"'
GO = ' marker-end="url(#go)"'
MARKER = (
    '<marker id="{0}" viewBox="0 0 10 8" refX="9.5" refY="4" markerWidth="{1}" markerHeight="{1}" '
    'markerUnits="userSpaceOnUse" orient="auto-start-reverse">'
    '<path class="{0}" d="M0,0.5 L10,4 L0,7.5 Z"/></marker>'
)
Place = Sequence[float]
"""x and y, mm; what follows does not count."""


@dataclass(frozen=True)
class TopView:
    """What is shown of a cell, mm; and the shapes, dimensions and words in it."""

    left: float
    right: float
    top: float
    bottom: float

    def x(self, x: float) -> str:
        return f"{x - self.left:.1f}"

    def y(self, y: float) -> str:
        return f"{self.top - y:.1f}"

    def box(self, kind: str, at: Place, size: Place) -> str:
        """A box by its middle and its size."""
        corner = f'x="{self.x(at[0] - size[0] / 2)}" y="{self.y(at[1] + size[1] / 2)}"'
        return f'<rect class="{kind}" {corner} width="{size[0]:.1f}" height="{size[1]:.1f}"/>'

    def disc(self, kind: str, at: Place, radius: float) -> str:
        return f'<circle class="{kind}" cx="{self.x(at[0])}" cy="{self.y(at[1])}" r="{radius:.1f}"/>'

    def text(self, at: Place, words: str, anchor: str = "middle") -> str:
        return f'<text x="{self.x(at[0])}" y="{self.y(at[1])}" text-anchor="{anchor}">{words}</text>'

    def line(self, a: Place, b: Place, kind: str = "thin", ends: str = "") -> str:
        ends_at = f"M{self.x(a[0])},{self.y(a[1])} L{self.x(b[0])},{self.y(b[1])}"
        return f'<path class="{kind}" d="{ends_at}"{ends}/>'

    def along_x(self, x0: float, x1: float, y: float, edge: float) -> list[str]:
        """The dimension x1 - x0, drawn at y, with lines to the edge that is measured."""
        lines = [self.line((x, edge), (x, y), "thin dash") for x in (x0, x1)]
        words = self.text(((x0 + x1) / 2, y + 8), f"{x1 - x0:g}")
        return [*lines, self.line((x0, y), (x1, y), ends=BOTH), words]

    def along_y(self, y0: float, y1: float, x: float, edge: float) -> list[str]:
        """The dimension y1 - y0, drawn at x."""
        lines = [self.line((edge, y), (x, y), "thin dash") for y in (y0, y1)]
        words = self.text((x + 8, (y0 + y1) / 2 - 6), f"{y1 - y0:g}", "start")
        return [*lines, self.line((x, y0), (x, y1), ends=BOTH), words]

    def arm(self, robot: Any, j1_deg: float, j2_deg: float) -> list[str]:
        """A SCARA of the model's lengths, with these joints."""
        l1, l2 = 1e3 * robot.l1, 1e3 * robot.l2
        first, second = radians(j1_deg), radians(j1_deg + j2_deg)
        elbow = (l1 * cos(first), l1 * sin(first))
        wrist = (elbow[0] + l2 * cos(second), elbow[1] + l2 * sin(second))
        return [
            self.disc("thin dash", (0.0, 0.0), l1 + l2),
            self.text((-(l1 + l2) + 12, -40), f"reach {l1 + l2:g}", "start"),
            self.line((0.0, 0.0), elbow, "link"),
            self.line(elbow, wrist, "link"),
            *(self.disc("arm", at, radius) for at, radius in (((0.0, 0.0), 60), (elbow, 26), (wrist, 15))),
            self.text((-8, -90), "robot, base at (0, 0)"),
        ]

    def axes(self) -> list[str]:
        """The axes of the world, and what the drawing shows."""
        left, bottom = self.left, self.bottom
        return [
            self.line((left + 60, bottom + 60), (left + 130, bottom + 60), ends=' marker-end="url(#tip)"'),
            self.line((left + 60, bottom + 60), (left + 60, bottom + 130), ends=' marker-end="url(#tip)"'),
            self.text((left + 146, bottom + 55), "x"),
            self.text((left + 60, bottom + 140), "y"),
            self.text((left + 200, bottom + 40), "top view, all lengths in mm", "start"),
        ]

    def page(self, title: str, parts: Iterable[str]) -> str:
        """The whole drawing."""
        wide, high = self.right - self.left, self.top - self.bottom
        return "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:g} {high:g}" width="{wide * 0.7:g}">',
                f"<title>{title}</title>",
                f"<style>{STYLE}</style>",
                f"<defs>{MARKER.format('tip', 12)}{MARKER.format('go', 22)}</defs>",
                f'<rect class="paper" width="{wide:g}" height="{high:g}"/>',
                *parts,
                "</svg>",
                "",
            ]
        )

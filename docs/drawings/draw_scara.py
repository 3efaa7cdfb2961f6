"""``python docs/drawings/draw_scara.py``: writes scara.svg, the drawing of docs/conventions.md.

Plan view and side view of a SCARA with our symbols, and how a Fanuc SR-3iA counts joint 3 beside them. Plain SVG, no
library, the same bytes on every machine; a test holds the committed file to this program. Angles in degrees counter-
clockwise, lengths in pixels, y up; `Sheet` turns y over, for SVG counts it downwards.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

WIDTH, HEIGHT = 1160, 560
INK, FAINT, OURS, MAKER, METAL = "#1a1a1a", "#9a9a9a", "#1f5f99", "#b4500a", "#e9edf1"
Point = tuple[float, float]

BASE_YAW, THETA1, THETA2, THETA4 = 12.0, 22.0, 50.0, -38.0
L1, L2 = 262.0, 190.0


def along(start: Point, angle: float, length: float) -> Point:
    """The point at `length` from `start` in the direction `angle`."""
    return (start[0] + length * math.cos(math.radians(angle)), start[1] + length * math.sin(math.radians(angle)))


class Sheet:
    """Collects SVG elements on a page of `width` by `height` pixels with a `title`."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self.width, self.height, self.title = width, height, title
        self.parts: list[str] = []

    def _at(self, point: Point) -> str:
        return f"{point[0]:.2f},{self.height - point[1]:.2f}"

    def line(self, a: Point, b: Point, colour: str = INK, width: float = 1.2, dash: str = "", arrow: str = "") -> None:
        """A line from a to b; `arrow`: "end" or "both"."""
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        name = {INK: "ink", FAINT: "faint", OURS: "ours", MAKER: "maker"}[colour]
        heads = f' marker-end="url(#{name})"' if arrow else ""
        heads += f' marker-start="url(#{name}-back)"' if arrow == "both" else ""
        self.parts.append(
            f'<path d="M{self._at(a)} L{self._at(b)}" stroke="{colour}" stroke-width="{width:g}"{dashed}{heads}/>'
        )

    def arc(self, centre: Point, radius: float, start: float, end: float, colour: str = INK) -> None:
        """An arc with an arrowhead at its end."""
        name = {INK: "ink", OURS: "ours", MAKER: "maker"}[colour]
        a, b = along(centre, start, radius), along(centre, end, radius)
        sweep = 0 if end > start else 1
        self.parts.append(
            f'<path d="M{self._at(a)} A{radius:g},{radius:g} 0 0 {sweep} {self._at(b)}" stroke="{colour}" '
            f'stroke-width="1.2" marker-end="url(#{name})"/>'
        )

    def polygon(self, points: list[Point], fill: str = METAL, colour: str = INK, dash: str = "") -> None:
        corners = " ".join(self._at(point) for point in points)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<polygon points="{corners}" fill="{fill}" stroke="{colour}" stroke-width="1.2" '
            f'stroke-linejoin="round"{dashed}/>'
        )

    def dot(self, at: Point, radius: float = 3.2, fill: str = INK, colour: str = INK) -> None:
        x, y = self._at(at).split(",")
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="{radius:g}" fill="{fill}" stroke="{colour}"/>')

    def text(self, at: Point, words: str, colour: str = INK, anchor: str = "middle", size: float = 15) -> None:
        """Words at a point. ``*x*`` is italic, ``_1`` a subscript of one character."""
        x, y = self._at(at).split(",")
        spans, italic, low = "", False, False
        run = ""

        def flush() -> str:
            style = ' font-style="italic"' if italic else ""
            return f"<tspan{style}>{run}</tspan>" if run else ""

        for character in words:
            if low:
                spans += f'<tspan dy="4" font-size="{size * 0.72:g}">{character}</tspan><tspan dy="-4">&#8203;</tspan>'
                low = False
            elif character in "*_":
                spans += flush()
                run = ""
                italic ^= character == "*"
                low = character == "_"
            else:
                run += character
        spans += flush()
        self.parts.append(
            f'<text x="{x}" y="{y}" fill="{colour}" stroke="none" text-anchor="{anchor}" '
            f'font-size="{size:g}">{spans}</text>'
        )

    def bar(self, a: Point, b: Point, half: float, fill: str = METAL, colour: str = INK, dash: str = "") -> None:
        """A link: a bar with round ends between two axes."""
        angle = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
        p, q = along(a, angle + 90, half), along(b, angle + 90, half)
        r, s = along(b, angle - 90, half), along(a, angle - 90, half)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<path d="M{self._at(p)} L{self._at(q)} A{half:g},{half:g} 0 0 1 {self._at(r)} L{self._at(s)} '
            f'A{half:g},{half:g} 0 0 1 {self._at(p)} Z" fill="{fill}" stroke="{colour}" stroke-width="1.2"{dashed}/>'
        )

    def svg(self) -> str:
        heads = ""
        for name, colour in (("ink", INK), ("faint", FAINT), ("ours", OURS), ("maker", MAKER)):
            for suffix, turn in (("", "auto"), ("-back", "auto-start-reverse")):
                heads += (
                    f'<marker id="{name}{suffix}" viewBox="0 0 10 8" refX="9.2" refY="4" markerWidth="10" '
                    f'markerHeight="8" markerUnits="userSpaceOnUse" orient="{turn}">'
                    f'<path d="M0,0.6 L10,4 L0,7.4 Z" fill="{colour}" stroke="none"/></marker>'
                )
        body = "\n".join(self.parts)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" '
            f'width="{self.width}" height="{self.height}" font-family="\'DejaVu Serif\', Georgia, serif" fill="none">\n'
            f"<title>{self.title}</title>\n"
            f'<defs>{heads}</defs>\n<rect width="{self.width}" height="{self.height}" fill="white"/>\n{body}\n</svg>\n'
        )


def plan_view(sheet: Sheet) -> None:
    """The arm from above in mode right, mode left as a ghost."""
    a = (112.0, 104.0)
    phi1 = BASE_YAW + THETA1
    phi2, phi4 = phi1 + THETA2, phi1 + THETA2 + THETA4
    c = along(a, phi1, L1)
    b = along(c, phi2, L2)
    bearing = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
    ghost = along(a, 2 * bearing - phi1, L1)

    sheet.bar(a, ghost, 15, "none", FAINT, "5 4")
    sheet.bar(ghost, b, 12, "none", FAINT, "5 4")
    sheet.text((ghost[0] - 34, ghost[1] + 40), "mode left, *θ*_2 &lt; 0", FAINT, "middle", 14)
    sheet.bar(a, c, 17)
    sheet.bar(c, b, 13)

    # axes and the angles that begin at them
    sheet.line(a, along(a, 0, 300), INK, 1.2, "", "end")
    sheet.text(along(a, 0, 300 + 12), "*x* world", INK, "start")
    sheet.line(a, along(a, 90, 128), INK, 1.2, "", "end")
    sheet.text((a[0] - 10, a[1] + 122), "*y* world", INK, "end")
    sheet.line(a, along(a, BASE_YAW, 300), OURS, 1.2, "9 3 2 3", "end")
    sheet.text(along(a, BASE_YAW, 308), "*x* base", OURS, "start")
    sheet.arc(a, 176, 0, BASE_YAW, OURS)
    sheet.text(along(a, BASE_YAW / 2, 190), "*ψ*", OURS, "start")
    sheet.arc(a, 118, BASE_YAW, phi1, OURS)
    sheet.text((along(a, BASE_YAW + 6, 126)), "*θ*_1", OURS, "start")
    sheet.line(c, along(c, phi1, 92), INK, 1, "9 3 2 3")
    sheet.arc(c, 62, phi1, phi2, OURS)
    sheet.text(along(c, phi1 + THETA2 * 0.45, 80), "*θ*_2", OURS)
    sheet.line(b, along(b, phi2, 82), INK, 1, "9 3 2 3")
    sheet.arc(b, 58, phi2, phi4, OURS)
    sheet.text(along(b, phi2 + THETA4 * 0.52, 72), "*θ*_4", OURS)
    sheet.line(b, along(b, 0, 122), FAINT, 1, "5 4")
    sheet.line(b, along(b, phi4, 118), OURS, 1.8, "", "end")
    sheet.text(along(b, phi4, 124), "*x* flange", OURS, "start")
    sheet.arc(b, 96, 0, phi4, OURS)
    sheet.text(along(b, phi4 * 0.42, 104), "yaw", OURS, "start")

    # the dyad
    foot_length = ((c[0] - a[0]) * (b[0] - a[0]) + (c[1] - a[1]) * (b[1] - a[1])) / math.dist(a, b)
    foot = along(a, bearing, foot_length)
    sheet.line(a, b, INK, 1.1, "5 4", "end")
    sheet.text((along(a, bearing + 3.2, 206)), "*d*", INK)
    sheet.line(foot, c, INK, 1, "2 3")
    sheet.text((foot[0] + 46, foot[1] - 16), "|*h*|", INK, "middle", 14)
    sheet.line(a, along(a, phi1, L1 - 4), INK, 2, "", "end")
    sheet.line(c, along(c, phi2, L2 - 4), INK, 2, "", "end")
    sheet.text((along(a, phi1 - 10.5, 236)), "*u*, *l*_1", INK)
    sheet.text((along(c, phi2 - 15, 128)), "*w*, *l*_2", INK)
    for name, at, shift in (("A", a, (-30, -6)), ("C", c, (14, -24)), ("B", b, (-24, 4))):
        sheet.dot(at, 4, "white")
        sheet.text((at[0] + shift[0], at[1] + shift[1]), f"*{name}*")
    sheet.text((a[0] - 10, a[1] - 30), "shoulder", INK, "middle", 13)
    sheet.text((c[0] + 24, c[1] - 42), "elbow, mode right, *θ*_2 > 0", INK, "start", 13)
    sheet.text((b[0] - 36, b[1] + 16), "wrist", INK, "end", 13)
    sheet.text((300, 28), "(a) plan view: *z* points at the reader, angles counter-clockwise", INK, "middle", 15)


def side_view(sheet: Sheet) -> None:
    """The arm from the side, with our z and a maker's J3."""
    floor, zero, flange, tip = 100.0, 290.0, 196.0, 146.0
    shoulder, elbow, wrist = 716.0, 848.0, 980.0
    sheet.line((620, floor), (1130, floor), INK, 1.2)
    for left in range(628, 1130, 14):
        sheet.line((left, floor), (left - 8, floor - 8), FAINT, 0.8)
    sheet.polygon([(shoulder - 40, floor), (shoulder + 40, floor), (shoulder + 40, 232), (shoulder - 40, 232)])
    sheet.polygon([(shoulder - 42, 232), (elbow + 42, 232), (elbow + 42, 278), (shoulder - 42, 278)])
    sheet.polygon([(elbow - 42, 312), (wrist + 42, 312), (wrist + 42, 420), (elbow - 42, 420)])
    sheet.polygon([(elbow - 16, 278), (elbow + 16, 278), (elbow + 16, 312), (elbow - 16, 312)])
    sheet.polygon([(wrist - 7, flange), (wrist + 7, flange), (wrist + 7, 456), (wrist - 7, 456)], "white")
    sheet.polygon(
        [(wrist - 13, tip), (wrist + 13, tip), (wrist + 13, flange), (wrist - 13, flange)], "none", INK, "4 3"
    )
    for x, name in ((shoulder, "*θ*_1"), (elbow, "*θ*_2"), (wrist, "*z*, *θ*_4")):
        sheet.line(
            (x, 484 if x == wrist else 450),
            (x, {shoulder: floor + 4, elbow: 232, wrist: flange + 2}[x]),
            INK,
            0.8,
            "9 3 2 3",
        )
        sheet.text((x, 492 if x == wrist else 458), name, OURS)
    sheet.text((shoulder + 66, 249), "link1", INK, "middle", 14)
    sheet.text((elbow + 62, 360), "link2", INK, "middle", 14)
    sheet.text((wrist - 14, 258), "quill", INK, "end", 14)
    sheet.text((shoulder + 20, 150), "base", INK, "middle", 13)

    # heights
    sheet.dot((shoulder, floor), 3.6)
    sheet.text((shoulder, floor - 28), "*base.at*: mounting face", INK, "middle", 14)
    sheet.line((626, zero), (1122, zero), MAKER, 1, "6 3")
    sheet.text((622, zero + 8), "J3 = 0", MAKER, "start", 14)
    sheet.line((640, floor), (640, zero), INK, 1.1, "", "both")
    sheet.text((632, 186), "*z*_0", INK, "end")
    sheet.line((wrist + 9, flange), (1122, flange), INK, 0.9)
    sheet.text((wrist - 20, flange - 5), "flange", INK, "end", 14)
    sheet.line((wrist + 15, tip), (1046, tip), INK, 0.9)
    sheet.dot((wrist, tip), 3.6)
    sheet.text((wrist - 20, tip - 5), "tool point", INK, "end", 14)
    sheet.line((1036, flange), (1036, tip), INK, 1.1, "", "both")
    sheet.text((1044, 166), "*tool.tcp*", INK, "start", 14)
    sheet.line((1060, zero), (1060, flange), MAKER, 1.8, "", "end")
    sheet.text((1068, 238), "+J3", MAKER, "start")
    sheet.line((1106, zero), (1106, zero + 86), OURS, 1.8, "", "end")
    sheet.text((1098, zero + 66), "+*z*", OURS, "end")
    sheet.text((1106, zero + 100), "ours: *z* = −J3", OURS, "middle", 14)
    sheet.text((875, 28), "(b) side view: joint 3 as the Fanuc SR-3iA counts it, and as we do", INK, "middle", 15)


def drawing() -> str:
    """The whole SVG."""
    sheet = Sheet(WIDTH, HEIGHT, "Plan view and side view of a SCARA with the symbols of assur")
    plan_view(sheet)
    side_view(sheet)
    return sheet.svg()


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("scara.svg")
    target.write_text(drawing(), encoding="utf-8")

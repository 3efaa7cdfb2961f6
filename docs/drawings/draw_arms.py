"""``python docs/drawings/draw_arms.py``: writes arms.svg, the second drawing of docs/conventions.md.

Five-bar, elbow arm, polar arm and five-axis arm with their joints, the angles and lengths as they are counted, and the
arm at zero as a ghost. On the sheet of `draw_scara`: plain SVG, the same bytes on every machine; a test holds the
committed file to this program. The arms are schematic: their lengths are no machine's.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from draw_scara import FAINT, INK, OURS, Point, Sheet, along

WIDTH, HEIGHT = 1160, 900
GHOST = "5 4"
"""Dashes of the arm at zero."""


def caption(sheet: Sheet, middle: float, y: float, words: str) -> None:
    sheet.text((middle, y), words, INK, "middle", 15)


def meeting(p: Point, q: Point, left: float, right: float, side: int) -> Point:
    """Where circles about p and q meet, to the left (+1) or the right (-1) of the way from p to q."""
    apart = math.dist(p, q)
    foot = (apart**2 + left**2 - right**2) / (2 * apart)
    bearing = math.degrees(math.atan2(q[1] - p[1], q[0] - p[0]))
    return along(along(p, bearing, foot), bearing + 90, side * math.sqrt(left**2 - foot**2))


def bearing(a: Point, b: Point) -> float:
    """Direction from a to b, degrees."""
    return math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))


def joint(sheet: Sheet, *at: Point) -> None:
    """Turning joints."""
    for point in at:
        sheet.dot(point, 4, "white")


def five_bar(sheet: Sheet) -> None:
    """From above: assembled to the front, elbows outwards; the tool axis of the other assembly as a ghost."""
    base, apart, crank, coupler = (140.0, 672.0), 84.0, 132.0, 176.0
    theta1, theta5, theta4 = 62.0, -48.0, 72.0
    left, right = (base[0], base[1] + apart / 2), (base[0], base[1] - apart / 2)
    p1, p2 = along(left, theta1, crank), along(right, theta5, crank)
    tool, back = (meeting(p1, p2, coupler, coupler, side) for side in (1, -1))
    for elbow in (p1, p2):
        sheet.bar(elbow, back, 8, "none", FAINT, GHOST)
    sheet.text((back[0] - 12, back[1] + 16), "back", FAINT, "end", 14)
    sheet.line(p1, p2, FAINT, 1, GHOST)
    for a, b in ((left, p1), (right, p2)):
        sheet.bar(a, b, 11)
    for a, b in ((p1, tool), (p2, tool)):
        sheet.bar(a, b, 9)

    sheet.line(base, (base[0] + 380, base[1]), INK, 1.2, "", "end")
    sheet.text((base[0] + 388, base[1] - 5), "*x* base: front", INK, "start")
    sheet.line(base, (base[0], base[1] + 196), INK, 1.2, "", "end")
    sheet.text((base[0] - 10, base[1] + 188), "*y* base", INK, "end")
    for axis, angle, name, end in ((left, theta1, "*θ*_1", p1), (right, theta5, "*θ*_5", p2)):
        sheet.line(axis, along(axis, 0, 84), FAINT, 1, GHOST)
        sheet.arc(axis, 58, 0, angle, OURS)
        sheet.text((along(axis, angle * 0.5, 76)[0], along(axis, angle * 0.5, 76)[1] - 5), name, OURS)
        sheet.line(axis, along(axis, angle, crank - 4), INK, 2, "", "end")
        joint(sheet, axis, end)
    sheet.line(p1, along(p1, bearing(p1, tool), 96), INK, 2, "", "end")
    sheet.line(p2, along(p2, bearing(p2, tool), 96), INK, 2, "", "end")
    wrist = bearing(p1, tool)
    sheet.line(tool, along(tool, wrist, 76), INK, 1, "9 3 2 3")
    sheet.arc(tool, 50, wrist, wrist + theta4, OURS)
    sheet.text((tool[0] + 62, tool[1] + 2), "*θ*_4", OURS)
    sheet.line(tool, along(tool, wrist + theta4, 96), OURS, 1.8, "", "end")
    sheet.text(along(tool, wrist + theta4, 102), "*x* flange", OURS, "start")
    joint(sheet, tool)
    sheet.dot(base, 3.2)
    sheet.text((base[0] + 8, base[1] + 6), "base", INK, "start", 14)
    sheet.text((left[0] - 12, left[1] + 2), "left axis", INK, "end", 14)
    sheet.text((right[0] - 12, right[1] - 12), "right axis", INK, "end", 14)
    sheet.text((p1[0] - 8, p1[1] + 18), "left elbow", INK, "middle", 14)
    sheet.text((p2[0] - 4, p2[1] - 28), "right elbow", INK, "middle", 14)
    sheet.text((tool[0] - 6, tool[1] + 44), "tool axis, front", INK, "start", 14)
    half = along(left, theta1, crank / 2)
    sheet.polygon(
        [
            (half[0] - 4, half[1] - 4),
            (half[0] + 4, half[1] - 4),
            (half[0] + 4, half[1] + 4),
            (half[0] - 4, half[1] + 4),
        ],
        OURS,
        OURS,
    )
    sheet.line((half[0] - 36, half[1] + 22), (half[0] - 7, half[1] + 4), OURS, 1)
    sheet.text((half[0] - 40, half[1] + 22), "[100, 0, 180]", OURS, "end", 13)
    coupler_name = along(p1, wrist, 70)
    sheet.text((coupler_name[0] + 26, coupler_name[1] + 18), "*x* distal-left", INK, "start", 13)
    crank_name = along(right, theta5, 78)
    sheet.text((crank_name[0] - 22, crank_name[1] - 22), "*x* proximal-right", INK, "end", 13)
    caption(sheet, 290, 464, "(a) five-bar from above: front assembly, *θ*_5 &lt; 0 here")


def stand(sheet: Sheet, floor: Point, height: float) -> Point:
    """Floor, column and base axis; the shoulder."""
    sheet.line((floor[0] - 70, floor[1]), (floor[0] + 420, floor[1]), INK, 1.2)
    for k in range(35):
        x = floor[0] - 64 + 14 * k
        sheet.line((x, floor[1]), (x - 8, floor[1] - 8), FAINT, 0.8)
    shoulder = (floor[0], floor[1] + height)
    sheet.polygon(
        [
            (floor[0] - 26, floor[1]),
            (floor[0] + 26, floor[1]),
            (floor[0] + 26, shoulder[1] - 16),
            (floor[0] - 26, shoulder[1] - 16),
        ]
    )
    sheet.line((floor[0], floor[1] - 4), (floor[0], shoulder[1] + 118), INK, 0.8, "9 3 2 3")
    sheet.line((floor[0] - 46, floor[1]), (floor[0] - 46, shoulder[1]), INK, 1.1, "", "both")
    sheet.text((floor[0] - 54, floor[1] + height / 2 - 6), "height", INK, "end", 14)
    x, y = shoulder[0], shoulder[1] + 100
    sheet.parts.append(
        f'<path d="M{x - 24:.2f},{HEIGHT - y - 4:.2f} A26,9 0 1 0 {x + 24:.2f},{HEIGHT - y - 4:.2f}" '
        f'stroke="{OURS}" stroke-width="1.2" marker-end="url(#ours)"/>'
    )
    sheet.text((x - 34, y + 2), "*θ*_1", OURS, "end")
    return shoulder


def level(sheet: Sheet, at: Point, length: float) -> None:
    """A level line from a joint, from which an angle is counted."""
    sheet.line(at, along(at, 0, length), FAINT, 1, GHOST)


def ghost(sheet: Sheet, shoulder: Point, words: str, *lengths: float) -> None:
    """The arm at zero: level, to the right, one link after the other."""
    at = shoulder
    for length in lengths:
        end = (at[0] + length, at[1])
        sheet.bar(at, end, 9, "none", FAINT, GHOST)
        at = end
    sheet.text((at[0] + 14, at[1] - 5), words, FAINT, "start", 14)


def tip(sheet: Sheet, at: Point, place: Point) -> None:
    sheet.dot(at, 4.2)
    sheet.text((at[0] + place[0], at[1] + place[1]), "tool point", INK, "start", 14)


def elbow_arm(sheet: Sheet) -> None:
    """From the side, in its vertical plane, mode up."""
    shoulder = stand(sheet, (720.0, 520.0), 120)
    theta2, theta3, upper, fore = 58.0, -84.0, 150.0, 130.0
    ghost(sheet, shoulder, "all 0", upper, fore)
    elbow = along(shoulder, theta2, upper)
    end = along(elbow, theta2 + theta3, fore)
    sheet.bar(shoulder, elbow, 13)
    sheet.bar(elbow, end, 10)
    sheet.arc(shoulder, 62, 0, theta2, OURS)
    sheet.text(along(shoulder, theta2 * 0.42, 80), "*θ*_2", OURS)
    sheet.line(elbow, along(elbow, theta2, 76), INK, 1, "9 3 2 3")
    sheet.arc(elbow, 54, theta2, theta2 + theta3, OURS)
    sheet.text(along(elbow, theta2 + 0.45 * theta3, 72), "*θ*_3", OURS)
    joint(sheet, shoulder, elbow)
    tip(sheet, end, (12, -4))
    name = along(shoulder, theta2, upper / 2)
    sheet.text((name[0] - 22, name[1] + 6), "*l*_1", INK, "end")
    name = along(elbow, theta2 + theta3, fore / 2)
    sheet.text((name[0] - 4, name[1] - 32), "*l*_2", INK)
    caption(sheet, 870, 464, "(b) elbow arm from the side: mode up, *θ*_3 &lt; 0")


def polar_arm(sheet: Sheet) -> None:
    """From the side, in its vertical plane, mode front."""
    shoulder = stand(sheet, (140.0, 90.0), 120)
    psi, length = 36.0, 250.0
    ghost(sheet, shoulder, "*ψ* = 0", length)
    end = along(shoulder, psi, length)
    sheet.bar(along(shoulder, psi, -34), along(shoulder, psi, 120), 15)
    sheet.bar(along(shoulder, psi, 96), end, 7, "white")
    sheet.arc(shoulder, 152, 0, psi, OURS)
    sheet.text(along(shoulder, psi / 2 - 2, 166), "*ψ*", OURS, "start")
    a, b = along(shoulder, psi + 90, 28), along(end, psi + 90, 28)
    sheet.line(a, b, OURS, 1.2, "", "both")
    sheet.text((along(a, psi, 128)[0] - 8, along(a, psi, 128)[1] + 12), "*d*_3", OURS, "end")
    joint(sheet, shoulder)
    tip(sheet, end, (12, -2))
    caption(sheet, 290, 26, "(c) polar arm from the side: mode front")


def five_axis_arm(sheet: Sheet) -> None:
    """From the side, in its vertical plane, mode up, hand below the level."""
    shoulder = stand(sheet, (720.0, 90.0), 120)
    theta2, theta3, theta4, upper, fore, hand = 70.0, -64.0, -52.0, 140.0, 112.0, 72.0
    ghost(sheet, shoulder, "all 0", upper, fore, hand)
    elbow = along(shoulder, theta2, upper)
    wrist = along(elbow, theta2 + theta3, fore)
    pitch = theta2 + theta3 + theta4
    end = along(wrist, pitch, hand)
    sheet.bar(shoulder, elbow, 13)
    sheet.bar(elbow, wrist, 10)
    sheet.bar(wrist, end, 7)
    sheet.arc(shoulder, 58, 0, theta2, OURS)
    sheet.text(along(shoulder, theta2 * 0.42, 76), "*θ*_2", OURS)
    sheet.line(elbow, along(elbow, theta2, 70), INK, 1, "9 3 2 3")
    sheet.arc(elbow, 48, theta2, theta2 + theta3, OURS)
    sheet.text(along(elbow, theta2 + 0.45 * theta3, 66), "*θ*_3", OURS)
    sheet.line(wrist, along(wrist, theta2 + theta3, 92), INK, 1, "9 3 2 3")
    sheet.arc(wrist, 80, theta2 + theta3, pitch, OURS)
    sheet.text(along(wrist, theta2 + theta3 + 0.32 * theta4, 96), "*θ*_4", OURS, "start")
    level(sheet, end, 96)
    sheet.line(end, along(end, pitch, 62), INK, 1.4, "", "end")
    sheet.text((end[0] + 36, end[1] - 64), "*x* hand", INK, "end", 14)
    sheet.arc(end, 78, 0, pitch, OURS)
    sheet.text(along(end, pitch * 0.5, 90), "pitch", OURS, "start")
    sheet.text((806, end[1] - 40), "*θ*_5: roll about *x* hand", OURS, "start", 14)
    joint(sheet, shoulder, elbow, wrist)
    sheet.dot(end, 4.2)
    sheet.text((end[0] - 12, end[1] - 14), "tool point", INK, "end", 14)
    caption(sheet, 870, 26, "(d) five-axis arm from the side: pitch = *θ*_2 + *θ*_3 + *θ*_4 &lt; 0")


def drawing() -> str:
    """The whole SVG."""
    sheet = Sheet(WIDTH, HEIGHT, "Five-bar, elbow arm, polar arm and five-axis arm with the symbols of assur")
    for part in (five_bar, elbow_arm, polar_arm, five_axis_arm):
        part(sheet)
    return sheet.svg()


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("arms.svg")
    target.write_text(drawing(), encoding="utf-8")

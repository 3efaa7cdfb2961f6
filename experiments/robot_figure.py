"""A robot drawn from the side and from above: solids in the middle of its ranges, the area of its flange, its joints.

Where the flange comes is found by joint positions at random, so the edge of the area is as fine as a cell of its grid.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from assur.experiments.experiment import Drawing
from assur.experiments.figures import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, RED, SKY, write_to
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Piece, corners
from assur.planner.report.number_format import SHOWN_AS
from assur.planner.robots.robot import Robot
from assur.scenes.reading.arms import BuiltArm

SIZE = 10.0, 5.6
"""Inches."""
COLOURS = (GREY, BLUE, ORANGE, GREEN, PURPLE, RED, SKY)
"""Of the links, from the base on."""
ROOM = 0.04
"""Around what is drawn, as a share of it."""
STATES, SEED = 600_000, 0
"""Joint positions at random by which the area of the flange is found."""
CELLS = 160
"""Cells of its grid along the longer side."""
RING = 32
"""Corners of a circle."""
BENT = 0.35
"""From above the second joint is drawn this share of half its range off the middle, so that the links are seen."""


def draw_robot(arm: BuiltArm, path: Path) -> None:
    """Draws an arm into a .png or .svg file. Raises `InputError` where matplotlib is not installed."""
    write_to(lambda figure: _draw(figure, arm), SIZE, [path])


def _draw(figure: Drawing, arm: BuiltArm) -> None:
    robot = arm.robot(Pose(), arm.limits)
    limits = robot.limits
    middle = (limits.lower + limits.upper) / 2
    bent = middle.copy()
    bent[1] += BENT * (limits.upper[1] - limits.lower[1]) / 2
    side, above, table = figure.subplots(
        1, 3, gridspec_kw={"width_ratios": [1.0, 1.25, 0.55]}, subplot_kw={"adjustable": "datalim"}
    )
    q = np.random.default_rng(SEED).uniform(limits.lower, limits.upper, (STATES, len(limits.lower)))
    flange, _ = robot.forward(q[robot.within(q)])
    flange = flange[np.isfinite(flange).all(-1)]
    base = robot.base
    radius = np.hypot(flange[:, 0] - base.x, flange[:, 1] - base.y)
    heading = _heading(robot, middle)
    _area(side, np.stack([radius, flange[:, 2]], axis=1), f"{arm.name}, from the side")
    _solids(side, robot, middle, np.array([[math.cos(heading), math.sin(heading), 0.0], [0.0, 0.0, 1.0]]))
    _area(above, flange[:, :2], "from above")
    _solids(above, robot, bent, np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
    for axes, across, upwards in ((side, "from the base axis [mm]", "z [mm]"), (above, "x [mm]", "y [mm]")):
        axes.set_xlabel(across)
        axes.set_ylabel(upwards)
        axes.set_aspect("equal")
        axes.use_sticky_edges = False  # the area would reach the frame
        axes.margins(ROOM)
    side.axvline(0.0, color=INK, lw=0.7, ls="-.")
    _table(table, arm, robot)


def _heading(robot: Robot, q: FloatArray) -> float:
    """The direction of the flange from the base axis, rad."""
    place, _ = robot.forward(q)
    return math.atan2(float(place[1]) - robot.base.y, float(place[0]) - robot.base.x)


def _area(axes: Drawing, points: FloatArray, title: str) -> None:
    """The cells of a grid in which points (N, 2) are, m, and their extent in the title."""
    low, high = points.min(0), points.max(0)
    cell = max(float((high - low).max()) / CELLS, 1e-6)
    count = np.maximum(np.ceil((high - low) / cell), 1.0).astype(int)
    index = np.minimum(((points - low) / cell).astype(int), count - 1)
    there = np.zeros(count, dtype=bool)
    there[index[:, 0], index[:, 1]] = True
    shown = np.ma.masked_where(~there.T, np.ones(there.T.shape))
    left, bottom = 1e3 * low
    right, top = 1e3 * (low + cell * count)
    axes.pcolormesh(
        np.linspace(left, right, count[0] + 1),
        np.linspace(bottom, top, count[1] + 1),
        shown,
        cmap="Blues",
        vmin=0.0,
        vmax=4.0,
        rasterized=True,
        label="flange",
    )
    axes.set_title(f"{title}\nflange: {left:.0f} to {1e3 * high[0]:.0f} mm, {bottom:.0f} to {1e3 * high[1]:.0f} mm")


def _solids(axes: Drawing, robot: Robot, q: FloatArray, plane: FloatArray) -> None:
    """Outlines of every body in the plane of two unit vectors (2, 3) through the base axis, with a ring
    at the origin of each link and a cross at the flange."""
    position, rotation = robot.placements(q)
    origin = np.array([robot.base.x, robot.base.y, 0.0]) if plane[1, 2] else np.zeros(3)
    for body in robot.bodies:
        for piece in body.body.pieces:
            points = _points(piece) @ rotation[body.link].T + position[body.link]
            flat = 1e3 * (points - origin) @ plane.T
            try:
                outline = flat[ConvexHull(flat).vertices]
            except QhullError:
                continue
            axes.fill(*outline.T, facecolor=_colour(body.link), alpha=0.3, edgecolor=INK, lw=0.5)
    joints = 1e3 * (position - origin) @ plane.T
    if not plane[1, 2]:
        axes.plot(*joints[1:-1].T, "o", color=INK, mfc="white", ms=4)
    axes.plot(*joints[-1], "x", color=INK, ms=7, mew=1.5)


def _colour(link: int) -> str:
    return COLOURS[link % len(COLOURS)]


def _points(piece: Piece) -> FloatArray:
    """Points (k, 3) of a piece in its body's frame, whose hull is the piece but for the roundness of circles."""
    found = corners(piece.shape)
    turn = np.arange(RING) * math.tau / RING
    disc, ball = getattr(piece.shape, "disc", 0.0), getattr(piece.shape, "ball", 0.0)
    if disc > 0.0:
        ring = np.stack([disc * np.cos(turn), disc * np.sin(turn), 0.0 * turn], axis=1)
        found = (found[:, None] + ring).reshape(-1, 3)
    if ball > 0.0:
        tilt = (np.arange(9) - 4) * math.pi / 8
        sphere = np.stack(
            [
                np.outer(np.cos(tilt), np.cos(turn)),
                np.outer(np.cos(tilt), np.sin(turn)),
                np.outer(np.sin(tilt), np.ones(RING)),
            ],
            axis=-1,
        )
        found = (found[:, None] + ball * sphere.reshape(-1, 3)).reshape(-1, 3)
    moved: FloatArray = found @ piece.rotation.T + piece.position
    return moved


def _table(axes: Drawing, arm: BuiltArm, robot: Robot) -> None:
    """Ranges of the joints as the maker counts them, and what the colours and marks are."""
    axes.axis("off")
    own = arm.conventions.places
    lines = []
    for joint, i in zip(arm.conventions, own, strict=True):
        ends = sorted(joint.sign * (end - joint.zero) for end in (arm.limits.lower[i], arm.limits.upper[i]))
        unit, factor = SHOWN_AS[joint.unit]
        low, high, speed = (factor * value for value in (*ends, arm.limits.velocity[i]))
        lines.append(f"{joint.name}: {low:.6g} to {high:.6g} {unit}\n    {speed:.5g} {unit}/s")
    text = "joint ranges and speeds\n\n" + "\n".join(lines)
    text += "\n\nDrawn in the middle of the\nranges; from above the\nsecond joint is bent."
    axes.text(0.0, 1.0, text, transform=axes.transAxes, va="top", fontsize=8, linespacing=1.5)
    for link in sorted({body.link for body in robot.bodies}):
        axes.fill([], [], facecolor=_colour(link), alpha=0.3, edgecolor=INK, lw=0.5, label=robot.links[link])
    axes.fill([], [], facecolor="#c6dbef", label="where the flange comes")
    axes.plot([], [], "o", color=INK, mfc="white", ms=4, label="origin of a link")
    axes.plot([], [], "x", color=INK, ms=7, mew=1.5, label="flange")
    axes.plot([], [], color=INK, lw=0.7, ls="-.", label="base axis")
    axes.legend(loc="lower left", fontsize=8, frameon=False, borderaxespad=0.0)

"""The figure of `five-bar`: a panel for each working mode and distal length."""

from __future__ import annotations

import numpy as np

from assur.experiments.experiment import Drawing
from assur.experiments.figures import BLUE, GREEN, INK, PURPLE, RED
from assur.experiments.five_bar_places import Paths, elbows, on_curve, standing
from assur.experiments.five_bar_workspace import Workspace
from assur.planner.arrays import FloatArray
from assur.planner.robots.facts import Code
from assur.planner.robots.five_bar import MODES, FiveBar

SIZE = (7.2, 4.6)
"""Inches."""
NEVER, BEYOND, RANGE, FREE = "#ffffff", "#ececec", "#cfe6f5", "#8cc4e8"
"""Not reached by the links; refused; out of the cranks' ranges; free to use."""
PATHS_IN = "left-right"
"""The mode of the request for a line, which is drawn for the last robot."""
HALF_MM = 485
"""Of what is shown, in x and y."""


def draw(figure: Drawing, robots: list[FiveBar], seen: list[Workspace], paths: Paths) -> None:
    """A row for each robot, a column for each working mode."""
    axes = figure.subplots(len(robots), len(MODES), sharex=True, sharey=True)
    for row, (robot, space) in enumerate(zip(robots, seen, strict=True)):
        for mode, name in enumerate(MODES):
            panel = axes[row, mode]
            regions(panel, space, mode)
            curves(panel, robot, space, mode)
            on_way = row == len(robots) - 1 and name == PATHS_IN
            arm(panel, robot, paths.straight[0] if on_way else best(space, mode), mode)
            if on_way:
                panel.plot(*(1e3 * paths.straight.T), color=PURPLE, lw=1.4, ls=(0, (3, 1.5)))
                panel.plot(*(1e3 * paths.around.T), color=GREEN, lw=1.4)
                ends(panel, paths.straight)
            panel.set_title(f"({'abcdefgh'[row * len(MODES) + mode]}) {name}")
            panel.set_aspect("equal")
            panel.set_xlim(-HALF_MM, HALF_MM)
            panel.set_ylim(-HALF_MM, HALF_MM)
            panel.set_xticks([-400, 0, 400])
            panel.set_yticks([-400, 0, 400])
            panel.grid(visible=False)
            if row == len(robots) - 1:
                panel.set_xlabel("x [mm]")
        axes[row, 0].set_ylabel(f"distal links {1e3 * robot.distal[0]:.0f} mm\ny [mm]")
    legend(figure, axes[0, 0])


def regions(panel: Drawing, space: Workspace, mode: int) -> None:
    """What becomes of each place."""
    kind = np.zeros(space.code[mode].shape, dtype=np.int64)
    kind[space.code[mode] == Code.PARALLEL] = 1
    kind[space.code[mode] == Code.ASSEMBLED] = 2
    kind = np.where(space.within[mode], 3, kind)
    colours = np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in (NEVER, BEYOND, RANGE, FREE)])
    step = space.x[1] - space.x[0]
    extent = [1e3 * e for e in (space.x[0] - step / 2, space.x[-1] + step / 2)]
    extent += [1e3 * e for e in (space.y[0] - step / 2, space.y[-1] + step / 2)]
    panel.imshow(colours[kind].astype(np.uint8), origin="lower", extent=extent, interpolation="nearest")


def curves(panel: Drawing, robot: FiveBar, space: Workspace, mode: int) -> None:
    """Both kinds of curve, as far as they are this mode's."""
    for of_type, colour in ((1, BLUE), (2, RED)):
        for curve in space.type_1 if of_type == 1 else space.type_2:
            q = on_curve(robot, curve, mode, of_type)
            mine = np.where(np.isfinite(q).all(axis=1, keepdims=True), curve, np.nan)
            panel.plot(*(1e3 * mine.T), color=colour, lw=1.1)


def best(space: Workspace, mode: int) -> FloatArray:
    """The mode's place (2,), m, where the lesser of both margins is greatest."""
    margin = np.where(space.within[mode], np.minimum(space.serial[mode], space.parallel[mode]), -1.0)
    row, column = np.unravel_index(int(np.argmax(margin)), margin.shape)
    return np.array([space.x[column], space.y[row]])


def arm(panel: Drawing, robot: FiveBar, tool: FloatArray, mode: int) -> None:
    """The arm with its tool at a place (2,), m."""
    chain = links(robot, tool, mode)
    for side in chain:
        panel.plot(*(1e3 * side.T), "o-", color=INK, lw=1.3, ms=2, zorder=4)
    axis = 1e3 * np.stack([chain[0][0], chain[1][0]])
    panel.plot(*axis.T, color=INK, lw=2.6, zorder=4)
    panel.plot(*(1e3 * tool), "o", color=INK, mfc="white", ms=4, zorder=5)


def links(robot: FiveBar, tool: FloatArray, mode: int) -> list[FloatArray]:
    """Crank axis, elbow and tool axis (3, 2) of the left and the right side, m."""
    q = robot.inverse(standing(tool[None]), mode, 0).q
    side = np.array([0.0, robot.separation / 2])
    return [np.stack([axis, elbow[0], tool]) for axis, elbow in zip((side, -side), elbows(robot, q), strict=True)]


def ends(panel: Drawing, straight: FloatArray) -> None:
    """Where the legs begin, at the arm's tool, and end (2, 2), m."""
    start, end = 1e3 * straight
    panel.plot(*end, "s", color=INK, mfc="white", ms=4, zorder=5)
    line = {"arrowstyle": "-", "lw": 0.5, "color": INK, "shrinkB": 3}
    panel.annotate("start", start, (190, 370), arrowprops=line, fontsize=6.5, zorder=6)
    panel.annotate("end", end, (-5, -3), textcoords="offset points", ha="right", fontsize=6.5, zorder=6)


def legend(figure: Drawing, panel: Drawing) -> None:
    """One for all panels, of what is drawn in them."""
    entries = [
        panel.plot([], [], "s", color=FREE, mec="#777777", mew=0.4, ms=7, label="cranks within their ranges")[0],
        panel.plot([], [], "s", color=RANGE, mec="#777777", mew=0.4, ms=7, label="out of the ranges")[0],
        panel.plot([], [], "s", color=BEYOND, mec="#777777", mew=0.4, ms=7, label="beyond or too near type 2")[0],
        panel.plot([], [], color=BLUE, label="type 1 (serial)")[0],
        panel.plot([], [], color=RED, label="type 2 (parallel)")[0],
        panel.plot([], [], "o-", color=INK, lw=1.3, ms=2, label="the arm in this mode")[0],
        panel.plot([], [], color=PURPLE, ls=(0, (3, 1.5)), label="straight leg, refused (f)")[0],
        panel.plot([], [], color=GREEN, label="joint leg, planned (f)")[0],
    ]
    figure.legend(handles=entries, loc="outside lower center", ncols=4)

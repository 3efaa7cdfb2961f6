"""Source 000, conclusions: the group that solves the SCARA solves a parallel arm, too, and finds its singularities.

The Mitsubishi RP-5AH: its workspace in the four working modes, with the curves on which it is singular. Its inverse is
the RRR group twice, from a crank axis over an elbow to the tool axis, its direct problem the same group once, between
the elbows. Both are solved as the source prints the group (`printed_rrr`) and as the planner does. Two values of the
distal length are published, 260 and 160 mm; both are shown, for the type 2 curves are of different kinds.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from assur.experiments import printed_rrr
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREEN, INK, PURPLE, RED
from assur.experiments.five_bar_workspace import Workspace, workspace
from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.facts import Code
from assur.planner.robots.five_bar import FiveBar
from assur.scenes.catalogue import arm_named
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, plan_document, shipped

MODEL = "mitsubishi-rp-5ah"
DISTAL_M = (0.26, 0.16)
"""The distal lengths that are published for it; the first is the catalogue's."""
GRID_M, CURVE_POINTS = 0.0025, 1441
STATES, SEED = 10_000, 5
"""Random places, in any mode, that are compared with the printed group."""
KEPT = 0.1
"""Margins of these places: near a singularity two formulas differ by what both lose to rounding."""


def robot_of(distal: float) -> FiveBar:
    """The arm of the catalogue with another distal length."""
    arm = arm_named(MODEL)
    robot = arm.robot(Pose(), arm.limits)
    if not isinstance(robot, FiveBar):
        raise FaultError(f"{MODEL} is no five-bar")
    return replace(robot, distal=(distal, distal))


def run() -> Result:
    """Areas of the working modes, printed group against planner, determinants at the curves, and what is planned."""
    robots = [robot_of(distal) for distal in DISTAL_M]
    seen = [workspace(robot, GRID_M, CURVE_POINTS) for robot in robots]
    planned, paths = through_type_2()
    numbers = {
        "model": MODEL,
        "separation_mm": 1e3 * robots[0].separation,
        "proximal_mm": 1e3 * robots[0].proximal[0],
        "grid_mm": 1e3 * GRID_M,
        "distal_mm": {
            f"{1e3 * robot.distal[0]:.0f}": {
                "area_cm2": areas(space),
                "type_2_couplers": type_2_kind(robot),
                "at_type_1": determinants(robot, space.type_1, of_type=1),
                "at_type_2": determinants(robot, space.type_2, of_type=2),
                "printed_ratio_near_type_2": printed_indicator(robot, space),
                "printed_group": printed_against_planner(robot, space),
            }
            for robot, space in zip(robots, seen, strict=True)
        },
        "planner": planned,
    }
    return Result(numbers, report(numbers), SIZE, lambda figure: draw(figure, robots, seen, paths))


def areas(space: Workspace) -> dict[str, dict[str, float]]:
    """Per working mode, cm²: `front`, where the assembled machine may be; `within`, its cranks in their ranges, too;
    `refused`, for the other assembly mode or the least parallel margin."""
    cell = 1e4 * GRID_M**2
    return {
        mode: {
            "front": cell * int((space.code[k] == Code.ASSEMBLED).sum()),
            "within": cell * int(space.within[k].sum()),
            "refused": cell * int((space.code[k] == Code.PARALLEL).sum()),
        }
        for k, mode in enumerate(FiveBar.modes)
    }


def type_2_kind(robot: FiveBar) -> dict[str, bool]:
    """Whether the couplers can be in one line: stretched, if the elbows come far enough apart, or one on the other."""
    (a, b), d = robot.proximal, robot.separation
    return {"stretched": d + a + b >= sum(robot.distal), "folded": abs(robot.distal[0] - robot.distal[1]) <= d + a + b}


def determinants(robot: FiveBar, curves: tuple[FloatArray, ...], *, of_type: int) -> dict[str, float]:
    """Along the curves, in every mode that has them: the largest determinant that should vanish, and how many points.

    From the points of the chain alone, and over the lengths' product, so that they are sines: det B of type 1 (the
    sides' cross products), det A of type 2 (the couplers').
    """
    (al, ar), (bl, br) = robot.proximal, robot.distal
    side = np.array([0.0, robot.separation / 2])
    most, count = 0.0, 0
    for curve in curves:
        for mode in range(len(FiveBar.modes)):
            q = on_curve(robot, curve, mode, of_type)
            mine = np.isfinite(q).all(1)
            tool, (p1, p2) = curve[mine], elbows(robot, q[mine])
            if of_type == 1:
                found = cross(p1 - side, tool - p1) * cross(p2 + side, tool - p2) / (al * ar * bl * br)
            else:
                found = cross(tool - p1, p2 - tool) / (bl * br)
            most, count = max(most, float(np.abs(found).max(initial=0.0))), count + len(tool)
    return {"largest_determinant": most, "points": count}


def printed_indicator(robot: FiveBar, space: Workspace) -> dict[str, float]:
    """|A/B| of the printed group between the elbows, which is 1 where it is aligned, over all places with a parallel
    margin of up to KEPT."""
    low, high, count = math.inf, 0.0, 0
    x, y = np.meshgrid(space.x, space.y)
    for mode in range(len(FiveBar.modes)):
        near = np.abs(space.parallel[mode]) <= KEPT
        q = robot.inverse(standing(np.stack([x[near], y[near]], -1)), mode, 0).q
        p1, p2 = elbows(robot, q)
        none = np.zeros(len(q))
        ends = [printed_rrr.Point(p[:, 0], p[:, 1], none, none, none, none) for p in (p1, p2)]
        ratio = np.abs(printed_rrr.dyad(ends[0], ends[1], *robot.distal, 1).ratio)
        ratio = ratio[np.isfinite(ratio)]
        low, high = min(low, float(ratio.min(initial=math.inf))), max(high, float(ratio.max(initial=0.0)))
        count += len(ratio)
    return {"least": low, "most": high, "places": count}


def cross(u: FloatArray, w: FloatArray) -> FloatArray:
    """u × w (N,) of vectors (N, 2)."""
    return np.asarray(u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0])


def printed_against_planner(robot: FiveBar, space: Workspace) -> dict[str, float]:
    """The largest differences over STATES random places with random velocities and accelerations, in any mode."""
    rng = np.random.default_rng(SEED)
    good = (space.code == Code.ASSEMBLED) & (space.serial >= KEPT) & (space.parallel >= KEPT)
    which = rng.choice(np.flatnonzero(good), STATES)
    modes, rows, columns = np.unravel_index(which, good.shape)
    p = np.stack([space.x[columns], space.y[rows]], -1) + rng.uniform(-0.1, 0.1, (STATES, 2)) * GRID_M
    v, a = rng.normal(size=(STATES, 2)), 10 * rng.normal(size=(STATES, 2))
    worst = {"cranks_rad": 0.0, "crank_rates": 0.0, "crank_accelerations": 0.0}
    back = {"direct_m": 0.0, "direct_m_s": 0.0, "direct_m_s2": 0.0}
    for mode in range(len(FiveBar.modes)):
        mine = modes == mode
        tool = printed_rrr.Point(p[mine, 0], p[mine, 1], v[mine, 0], v[mine, 1], a[mine, 0], a[mine, 1])
        zero = np.zeros(int(mine.sum()))
        sides = []
        for k, shift in ((0, robot.separation / 2), (1, -robot.separation / 2)):
            axis = printed_rrr.Point(zero, zero + shift, zero, zero, zero, zero)
            assembly = 2 if (mode // 2, mode % 2)[k] else 1
            sides.append(printed_rrr.dyad(axis, tool, robot.proximal[k], robot.distal[k], assembly))
        motion = standing(p[mine])
        motion.v[:, :2], motion.a[:, :2] = v[mine], a[mine]
        ours = robot.inverse(motion, mode, 2)
        for key, order, mine_q in zip(worst, range(3), (ours.q, ours.qd, ours.qdd), strict=True):
            printed = np.stack([side.phi[order] for side in sides], -1)
            off = printed - mine_q[:, :2]
            off = np.angle(np.exp(1j * off)) if order == 0 else off / (1 + np.abs(mine_q[:, :2]))
            worst[key] = max(worst[key], float(np.abs(off).max(initial=0.0)))
        direct = printed_rrr.dyad(sides[0].c, sides[1].c, *robot.distal, 1 if robot.sigma > 0 else 2).c
        for key, (one, two) in zip(back, (("x", "y"), ("xd", "yd"), ("xdd", "ydd")), strict=True):
            off = np.hypot(getattr(direct, one) - getattr(tool, one), getattr(direct, two) - getattr(tool, two))
            back[key] = max(back[key], float(off.max(initial=0.0)))
    return {"states": STATES, **worst, **back}


def through_type_2() -> tuple[dict[str, Any], Paths]:
    """The shipped request for a line through the type 2 curve, and the same ends by joint legs."""
    request = copy.deepcopy(shipped("five-bar-type-2").request)
    refused = plan_document(request)
    del request["task"][0]["move"]["leg"]
    request["options"] |= {"max_candidates": 300, "report": "full"}
    answer = plan_document(request)
    cell = cell_of(request)
    robot = cell.scene.robot
    made = plan_of(answer, cell.conventions)[0].trajectory
    q = made.evaluate(np.linspace(made.start, made.end, 500))
    way = robot.forward(q)[0][:, :2]
    found = {
        "straight": {
            "answer": refused["reason"],
            "parallel_margin": robot.parallel_least - refused["refusal"]["amount"],
            "parallel_margin_required": robot.parallel_least,
        },
        "joint_legs": {
            "answer": answer["status"],
            "duration_s": answer["duration_s"],
            "parallel_margin": answer["margins"]["parallel"],
            "serial_margin": answer["margins"]["singularity"],
        },
    }
    return found, Paths(way[[0, -1]], way)


def report(numbers: dict[str, Any]) -> str:
    """The paragraphs."""
    wide, short = numbers["distal_mm"].values()
    group = [each["printed_group"] for each in (wide, short)]
    cranks, back = (max(each[key] for each in group) for key in ("cranks_rad", "direct_m"))
    rates = max(each[key] for each in group for key in ("crank_rates", "crank_accelerations"))
    line, legs = numbers["planner"]["straight"], numbers["planner"]["joint_legs"]
    refused_at = f"{line['parallel_margin']:.3f}".replace("-", "−")
    lost = {}
    for name, each in (("wide", wide), ("short", short)):
        area = each["area_cm2"]["left-right"]
        lost[name] = f"{area['refused']:,.0f} of {area['front'] + area['refused']:,.0f} cm²"
    return paragraphs(
        "The source closes with a claim that it does not show: its RRR group has its greatest potential in parallel "
        "manipulators, being flexible, simple and efficient, and it identifies and classifies singular "
        "configurations of their direct problem.",
        f"On a five-bar, the RP-5AH with either of its published distal lengths, 260 mm in panels (a) to "
        f"(d) and 160 mm in (e) to (h): the printed group, used twice, gives the cranks, and once more, between the "
        f"elbows, the tool again. At {STATES:,} random states for each length, in all working modes, it agrees with "
        f"the planner to {cranks:.0e} rad (rates and accelerations to {rates:.0e}, relative) and comes back to the "
        f"tool to {1e9 * back:.0e} nm.\n\n"
        f"In `left-right` 260 mm lose {lost['wide']} to type 2, panel (b), and 160 mm {lost['short']}, inside a "
        f"closed curve about the base, panel (f). A straight line through that curve is refused (parallel margin "
        f"{refused_at} where {line['parallel_margin_required']:g} is required); a joint leg between the same ends goes "
        f"around it in {legs['duration_s']:.2f} s, with {legs['parallel_margin']:.2f} at least.",
        "It holds that nothing but the group is needed, and it classifies: which use of it is aligned tells the "
        "kind. Between crank axis and tool it is type 1, where the tool cannot go on and a joint leg may change the "
        "working mode; between the elbows it is type 2, where the motors do not hold the tool. Efficiency is that "
        "of the group: see `dyad-timing`.",
        f"The printed indicator, |A/B| = 1, sees couplers that are stretched. Equal couplers that fold are the "
        f"group's third, indeterminate case; the source names it, but nothing in A/B tells that it is near: with 260 "
        f"mm, where it is the only type 2 there is, |A/B| is {wide['printed_ratio_near_type_2']['most']:.2f} at most "
        f"wherever |sin| of the couplers' angle is below {KEPT:g}. The planner's margin is that sine.",
    )


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
    axes = figure.subplots(len(robots), len(FiveBar.modes), sharex=True, sharey=True)
    for row, (robot, space) in enumerate(zip(robots, seen, strict=True)):
        for mode, name in enumerate(FiveBar.modes):
            panel = axes[row, mode]
            regions(panel, space, mode)
            curves(panel, robot, space, mode)
            on_way = row == len(robots) - 1 and name == PATHS_IN
            arm(panel, robot, paths.straight[0] if on_way else best(space, mode), mode)
            if on_way:
                panel.plot(*(1e3 * paths.straight.T), color=PURPLE, lw=1.4, ls=(0, (3, 1.5)))
                panel.plot(*(1e3 * paths.around.T), color=GREEN, lw=1.4)
                ends(panel, paths.straight)
            panel.set_title(f"({'abcdefgh'[row * len(FiveBar.modes) + mode]}) {name}")
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


SINGULAR = 1e-5
"""Up to this a margin, no unit, is that of a point on a curve: a place that is off by 1e-12 m has some 1e-6."""


@dataclass(frozen=True, eq=False)
class Paths:
    """Of the tool axis, m: the required straight line, and the planned path between its ends (N, 2)."""

    straight: FloatArray
    around: FloatArray


def standing(p: FloatArray) -> Motion:
    """A standing flange at places (N, 2) in base axes, at the height of the base origin."""
    motion = Motion.still(Pose(), (len(p),))
    motion.p[:, :2] = p
    return motion


def on_curve(robot: FiveBar, curve: FloatArray, mode: int, of_type: int) -> FloatArray:
    """q (N, n) of the curve's points, NaN where the curve is not this mode's."""
    found = robot.inverse(standing(curve), mode, 0)
    parallel = np.full(len(curve), np.nan) if found.parallel is None else found.parallel
    singular = np.abs(found.margin if of_type == 1 else parallel) < SINGULAR
    return np.where((singular & np.isfinite(curve).all(1))[:, None], found.q, np.nan)


def elbows(robot: FiveBar, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places (N, 2) of both elbows in base axes."""
    left, right = (np.stack([np.cos(q[:, k]), np.sin(q[:, k])], -1) for k in (0, 1))
    side = np.array([0.0, robot.separation / 2])
    return side + robot.proximal[0] * left, robot.proximal[1] * right - side

"""Sources 000, 001 and 004: the two assemblies of a dyad are the two solutions of a SCARA, under four names."""

from __future__ import annotations

import numpy as np

from assur.experiments import printed_dh, printed_joint_move, printed_rrr
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREY, INK, ORANGE
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import Limits, principal
from assur.planner.robots.scara import Scara

L1, L2 = 0.325, 0.225
"""m. A usual arm; the arm of source 004, with links of 200 mm, is drawn, too."""
POINTS, SEED = 10_000, 2
CONVENTION = {"left": (1, -1, -1), "right": (2, +1, +1)}
"""Mode → assembly mode of 000, sign of the root of 001, index g of 004."""
PRINTED = {"left": ("1", "−", "−1"), "right": ("2", "+", "+1")}


def targets() -> FloatArray:
    """Points (POINTS, 3) spread evenly over the workspace, from 1 mm beside its edges."""
    random = np.random.default_rng(SEED)
    radius = np.sqrt(random.uniform((L1 - L2 + 1e-3) ** 2, (L1 + L2 - 1e-3) ** 2, POINTS))
    angle = random.uniform(-np.pi, np.pi, POINTS)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), random.uniform(-0.2, 0, POINTS)], -1)


def formulations(p: FloatArray, l1: float, l2: float, mode: str) -> dict[str, FloatArray]:
    """θ1 and θ2 (..., 2), Denavit-Hartenberg, of tool points p (..., 3) by each source, the yaw being 0."""
    assembly, root, g = CONVENTION[mode]
    zero = np.zeros(p.shape[:-1])
    point = printed_rrr.Point(p[..., 0], p[..., 1], zero, zero, zero, zero)
    (first, _, _), (second, _, _) = printed_rrr.scara(point, l1, l2, assembly)
    tool = np.broadcast_to(np.diag([1.0, -1.0, -1.0, 1.0]), (*p.shape[:-1], 4, 4)).copy()
    tool[..., :3, 3] = p
    wide = np.full(4, 10.0)
    robot = Scara(name="modes", l1=l1, l2=l2, axes=4, limits=Limits(-wide, wide, wide, wide, wide))
    still = np.zeros_like(p)
    found = robot.inverse(Motion.of(p, still, still, still, zero, zero, zero, zero), Scara.modes.index(mode), 0)
    return {
        "planner": found.q[..., :2],
        "000": np.stack([first, -second], -1),  # its θ2 has the opposite sign
        "001": printed_dh.inverse(tool, l1, l2, 0.0, root)[..., :2],
        "004": printed_joint_move.inverse(p, zero, l1, l2, g)[..., :2],
    }


def run() -> Result:
    """The largest differences of θ1 and θ2 between the formulations, per mode, over the workspace."""
    p = targets()
    worst: dict[str, dict[str, float]] = {}
    crossed: dict[str, float] = {}
    for mode in Scara.modes:
        found = formulations(p, L1, L2, mode)
        ours = found.pop("planner")
        worst[mode] = {name: float(np.abs(principal(q - ours)).max()) for name, q in found.items()}
        other = formulations(p, L1, L2, Scara.modes[1 - Scara.modes.index(mode)])["planner"]
        crossed[mode] = float(np.abs(other[:, 1] + ours[:, 1]).max())
    numbers = {
        "points": POINTS,
        "largest_difference_from_planner_rad": worst,
        "theta2_left_plus_theta2_right_rad": crossed["left"],
        "convention": {
            mode: {"theta2": "negative" if mode == "left" else "positive", "000": row[0], "001": row[1], "004": row[2]}
            for mode, row in CONVENTION.items()
        },
    }
    most = max(value for row in worst.values() for value in row.values())
    paragraph = paragraphs(
        "Source 000 has two assembly modes, φ = θ ± β; 001 has two signs of a root, 004 an index g = sign(sin θ2). "
        "Source 000 counts θ2 against Denavit-Hartenberg.",
        f"Over {POINTS:,} points spread over the workspace, to 1 mm from its edges, each of the three printed "
        f"solutions gives the planner's θ1 and θ2 in the mode named below, to {most:.0e} rad; θ2 of the two modes "
        f"differs in its sign only. Panel (a) shows the dyad of 000 in both modes, panel (b) the pose of 004; the "
        f"marks of the three sources lie upon each other.",
        "They are the same two solutions. In one convention `right` is θ2 > 0, mode 2, +√ and g = +1; `left` is θ2 "
        "< 0, mode 1, −√ and g = −1.",
    )

    def draw(figure: Drawing) -> None:
        left, right = figure.subplots(1, 2)
        dyad(left)
        arm_of_004(right)
        handles, labels = left.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5, handlelength=3, markerscale=0.7)

    return Result(numbers, paragraph, (7.2, 3.9), draw)


def dyad(axes: Drawing) -> None:
    """Figure 1 of 000: both assemblies of a dyad on the same A and B."""
    d = np.array([0.36, 0.16, 0.0])
    theta = np.arctan2(d[1], d[0])
    for mode, colour in (("left", ORANGE), ("right", BLUE)):
        chains(axes, d, L1, L2, mode, colour)
        first = formulations(d, L1, L2, mode)["planner"][0]
        arc = np.linspace(theta, first, 40)
        axes.plot(90 * np.cos(arc), 90 * np.sin(arc), color=colour, lw=0.9)
        middle = arc[20]
        sign = "+" if mode == "left" else "−"
        axes.annotate(
            rf"{sign}$\beta$",
            (105 * np.cos(middle), 105 * np.sin(middle)),
            color=colour,
            ha="center",
            va="center",
        )
        elbow = 1e3 * L1 * np.array([np.cos(first), np.sin(first)])
        axes.annotate(
            f"C, mode {PRINTED[mode][0]}\n" + rf"$\varphi=\theta{sign}\beta$",
            elbow,
            (0, 8) if mode == "left" else (0, -24),
            textcoords="offset points",
            ha="center",
            color=colour,
        )
    axes.plot([0, 1e3 * d[0]], [0, 1e3 * d[1]], color=GREY, lw=0.9, ls="--")
    axes.plot([0, 190], [0, 0], color=GREY, lw=0.9)
    turned = np.linspace(0, theta, 40)
    axes.plot(150 * np.cos(turned), 150 * np.sin(turned), color=INK, lw=0.9)
    middle = (165 * np.cos(theta / 2), 165 * np.sin(theta / 2))
    axes.annotate(r"$\theta$", middle, color=INK, ha="center", va="center")
    axes.annotate("A", (0, 0), (-10, -3), textcoords="offset points", color=INK)
    axes.annotate("B", (1e3 * d[0], 1e3 * d[1]), (6, 2), textcoords="offset points", color=INK)
    finished(axes, "(a) the two assemblies of the RRR dyad (000)", (-60, 460), (-160, 340))


def arm_of_004(axes: Drawing) -> None:
    """The pose of 004's move in its two configurations."""
    p = np.array([0.2, 0.2, 0.0])
    for mode, colour in (("left", ORANGE), ("right", BLUE)):
        chains(axes, p, 0.2, 0.2, mode, colour)
        theta = np.degrees(formulations(p, 0.2, 0.2, mode)["planner"])
        _, root, g = PRINTED[mode]
        axes.annotate(
            f"{mode}: g = {g}, {root}√\n" + rf"$\theta_1={theta[0]:.0f}°,\ \theta_2={theta[1]:.0f}°$",
            (0, 200) if mode == "left" else (200, 0),
            (0, 9) if mode == "left" else (0, -26),
            textcoords="offset points",
            ha="center",
            color=colour,
        )
    finished(axes, "(b) the two solutions of 004's pose, and 001's root", (-110, 330), (-113, 310))


def chains(axes: Drawing, p: FloatArray, l1: float, l2: float, mode: str, colour: str) -> None:
    """The arm by the planner as a line, and its elbow by each source as a mark of its own."""
    marks = {"planner": ("", 0), "000": ("o", 11), "001": ("s", 7), "004": ("x", 5)}
    for name, q in formulations(p, l1, l2, mode).items():
        elbow = 1e3 * l1 * np.array([np.cos(q[0]), np.sin(q[0])])
        wrist = elbow + 1e3 * l2 * np.array([np.cos(q.sum()), np.sin(q.sum())])
        if name == "planner":
            style = "-" if mode == "right" else "--"
            line = np.stack([np.zeros(2), elbow, wrist], -1)
            axes.plot(*line, color=colour, ls=style, lw=2.5, label=f"planner, {mode}")
            axes.plot(*line[:, [0, 2]], "o", ms=5, color=INK, mfc="w", zorder=3)
        else:
            mark, size = marks[name]
            label = f"elbow by {name}" if mode == "right" else None
            axes.plot(*elbow, mark, ms=size, mfc="none", color=INK, mew=0.9, ls="", label=label)


def finished(axes: Drawing, title: str, x: tuple[float, float], y: tuple[float, float]) -> None:
    """Title, labels and limits; panels whose limits have the same ratio are at the same height."""
    axes.set_title(title)
    axes.set_aspect("equal")
    axes.set_xlim(*x)
    axes.set_ylim(*y)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")

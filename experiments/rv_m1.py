"""Source 003, section 5: the Mitsubishi RV-M1 by tool point, pitch and roll, against the planner's five-axis arm."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.experiments import printed_five_axes as printed
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREEN, GREY, INK, ORANGE, RED
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.facts import Code, principal
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.scenes.catalogue import arm_named

TARGETS, SEED = 20_000, 5
SHOWN = (0.38, 0.20)
"""The tool point whose family of pitches is drawn: distance from the base axis and height, m."""
DRAWN_DEG = (-90, -60, -30, 0, 30, 60)
"""Pitches at which the arm is drawn, °."""
FLAT = 0.1
"""sin A_i below which the source's lower triangle counts as flat (no unit), as in `oblique-triangles`."""
UP, DOWN = 0, 1
"""Modes of the arm: elbow above, below the line from shoulder to wrist."""


def arm() -> FiveAxisArm:
    """The RV-M1 of the catalogue, at the origin."""
    found = arm_named("mitsubishi-rv-m1")
    robot = found.robot(Pose(), found.limits)
    if not isinstance(robot, FiveAxisArm):
        raise TypeError("the RV-M1 is a five-axis arm")
    return robot


def by_planner(robot: FiveAxisArm, p: FloatArray, tilt: FloatArray, mode: int) -> FloatArray:
    """Joints (..., 5) for tool points p (..., 3) with pitch and roll (..., 2); NaN: out of reach."""
    none, turn = np.zeros_like(p), np.zeros(p.shape[:-1])
    found = robot.inverse(Motion.of(p, none, none, none, turn, turn, turn, turn).with_tilt(tilt), mode, 0)
    return np.where((found.code == Code.ASSEMBLED)[..., None], found.q, np.nan)


def targets(robot: FiveAxisArm) -> tuple[FloatArray, FloatArray]:
    """Tool points (TARGETS, 3) and pitch and roll (TARGETS, 2) in reach with the tool point in front of the base, from
    joint angles without regard to their limits; half of them near the stretched or the folded arm."""
    random = np.random.default_rng(SEED)
    found: list[FloatArray] = []
    while sum(len(q) for q in found) < TARGETS:
        q = random.uniform(-np.pi, np.pi, (TARGETS, 5))
        near = -(10 ** random.uniform(-5, 0, TARGETS))
        beside = np.where(random.random(TARGETS) < 0.5, near, -np.pi - near)
        q[:, 2] = np.where(random.random(TARGETS) < 0.5, -np.abs(q[:, 2]), beside)
        found.append(q[robot.mode_of(q) == UP])
    q = np.concatenate(found)[:TARGETS]
    position, _ = robot.forward(q)
    return position, np.stack([principal(q[:, 1] + q[:, 2] + q[:, 3]), q[:, 4]], -1)


def run() -> Result:
    """The source's solution, mended, against the planner's over random targets; and the pitches at one point."""
    robot = arm()
    p, tilt = targets(robot)
    ours = by_planner(robot, p, tilt, UP)
    lengths = (robot.height, robot.l1, robot.l2)
    base, r, z = printed.wrist(p[:, 0], p[:, 1], p[:, 2], tilt[:, 0], robot.l3)
    mended = printed.joints(base, r, z, tilt[:, 0], tilt[:, 1], lengths)
    as_printed = printed.printed_radius(p[:, 0], p[:, 1], tilt[:, 0], robot.l3)
    unsigned = printed.joints(base, as_printed, z, tilt[:, 0], tilt[:, 1], lengths)
    error = np.abs(np.asarray(principal(mended - ours))).max(-1)
    bend = np.abs(np.sin(ours[:, 2]))
    behind, flat = r < 0, np.abs(r) < FLAT * np.hypot(r, z - robot.height)
    wrong = np.abs(np.asarray(principal(unsigned - ours))).max(-1)
    family = Family(robot)
    numbers: dict[str, Any] = {
        "targets": TARGETS,
        "solved_by_both": int(np.isfinite(error).sum()),
        "mended_minus_planner_where_sine_above_0.05_rad": float(error[(bend > 0.05) & ~flat].max()),
        "mended_minus_planner_times_sine_rad": float((error * bend)[~flat].max()),
        "wrist_behind_the_base_axis": int(behind.sum()),
        "as_printed_error_deg_wrist_behind": [float(np.degrees(f(wrong[behind]))) for f in (np.min, np.max)],
        "as_printed_equals_mended_wrist_in_front": bool(np.nanmax(np.abs(unsigned - mended)[~behind & ~flat]) < 1e-6),
        "family_tool_point_m": list(SHOWN),
        "family_pitches_in_reach_deg": family.extent(family.reached[UP]),
        "family_pitches_within_limits_elbow_up_deg": family.extent(family.legal[UP]),
        "family_pitches_within_limits_elbow_down": int(family.legal[DOWN].sum()),
        "family_quickest_turn_of_a_joint_deg_per_deg": family.steepest(),
    }
    low, high = numbers["family_pitches_in_reach_deg"]
    legal_low, legal_high = numbers["family_pitches_within_limits_elbow_up_deg"]
    most = numbers["as_printed_error_deg_wrist_behind"][1]
    paragraph = paragraphs(
        "The source reaches a tool point with a given pitch by stepping back along the hand to the wrist (equation 7) "
        "and solving the two oblique triangles for it; the roll, it says, plays no part. Without a given pitch there "
        "are many solutions, and one of them has to be chosen.",
        f"The planner has its dyad in place of the triangles. Over {TARGETS:,} random targets the mended source and "
        f"the planner's mode `up` agree in all five joints to "
        f"{numbers['mended_minus_planner_where_sine_above_0.05_rad']:.0e} rad where |sin θ3| > 0.05 (and the lower "
        f"triangle is not flat), and to {numbers['mended_minus_planner_times_sine_rad']:.0e} rad divided by |sin θ3| "
        f"elsewhere, panel (c).\n\n"
        f"At a tool point {1e3 * SHOWN[0]:.0f} mm from the base axis and {1e3 * SHOWN[1]:.0f} mm high, panels (a) "
        f"and (b), pitches from {low:.0f}° to {high:.0f}° are in reach, with either elbow; within the joint limits "
        f"assumed for the RV-M1 are those from {legal_low:.0f}° to {legal_high:.0f}° with the elbow up, and "
        f"none with the elbow down.".replace(" -", " −"),
        "It holds, once mended. Of the many solutions the planner samples the pitches every 15°, and takes what can be "
        "met soonest first.",
        f"Beside equations 1 to 6: the sign of the hand's height, which the source leaves to the case; and, for the "
        f"{numbers['wrist_behind_the_base_axis']:,} targets whose wrist lies behind the base axis, the sign of its "
        f"radius and of the angle A_i, without which a joint is wrong by up to {most:.0f}°.",
    )

    def draw(figure: Drawing) -> None:
        left, side = figure.subfigures(1, 2, width_ratios=(1.08, 1))
        family.postures(left.subplots())
        angles, errors = side.subplots(2, 1)
        family.angles(angles)
        guide = np.array([1e-5, 1.0])
        for rows, colour, label in ((~flat, BLUE, "target"), (flat, ORANGE, rf"target, $\sin A_i<{FLAT}$")):
            shown = np.maximum(error[rows], 1e-17)
            errors.loglog(bend[rows], shown, ".", ms=1.2, color=colour, rasterized=True, label=label)
        errors.loglog(guide, 2e-15 / guide, color=INK, ls="--", lw=0.9, label=r"$2\cdot 10^{-15}/|\sin\theta_3|$")
        errors.set_xlabel(r"$|\sin\theta_3|$")
        errors.set_ylabel("mended − planner [rad]")
        errors.legend(loc="lower left", markerscale=4)
        errors.set_title("(c) five joint angles, source against planner")

    return Result(numbers, paragraph, (7.2, 4.6), draw)


class Family:
    """The solutions (modes up and down) for one tool point over the pitch."""

    def __init__(self, robot: FiveAxisArm) -> None:
        self.robot = robot
        self.pitch = np.radians(np.linspace(-180.0, 180.0, 1441))
        tilt = np.stack([self.pitch, np.zeros_like(self.pitch)], -1)
        p = np.tile([SHOWN[0], 0.0, SHOWN[1]], (len(tilt), 1))
        self.q = [by_planner(robot, p, tilt, mode) for mode in (UP, DOWN)]
        self.reached = [np.asarray(np.isfinite(q).all(-1)) for q in self.q]
        self.legal = [robot.within(q) for q in self.q]

    def extent(self, rows: Any) -> list[float]:
        """First and last pitch, °, of rows that are one interval."""
        shown = np.flatnonzero(rows)
        return [float(np.degrees(self.pitch[shown[k]])) for k in (0, -1)]

    def steepest(self) -> float:
        """How far a joint turns for a degree of pitch, at most, within the joint limits (elbow up)."""
        rows = self.legal[UP]
        turned = np.abs(np.diff(self.q[UP][rows], axis=0)).max()
        return float(turned / (self.pitch[1] - self.pitch[0]))

    def postures(self, axes: Drawing) -> None:
        """The arm in its plane at some pitches, elbow up and down."""
        for mode, colour, style, name in ((DOWN, GREY, "--", "elbow down"), (UP, BLUE, "-", "elbow up")):
            label: str | None = name
            for pitch in np.radians(DRAWN_DEG):
                row = int(np.argmin(np.abs(self.pitch - pitch)))
                if not self.reached[mode][row]:
                    continue
                q = self.q[mode][row]
                place = self.robot.placements(q)[0][2:]
                points = 1e3 * place[:, [0, 2]]
                legal = bool(self.legal[mode][row])
                shade = colour if legal or mode == DOWN else GREEN
                axes.plot(*points[:3].T, style, color=shade, lw=1.4 if mode == UP else 0.8, label=label)
                label = None
                axes.plot(*points[2:].T, "-", color=ORANGE, lw=2.0, zorder=3)
                if mode == UP:
                    axes.plot(*points[1:3].T, "o", color=shade, mfc="w", ms=3.5, zorder=4)
                    ahead = np.array([np.cos(pitch), np.sin(pitch)])
                    axes.annotate(
                        f"{np.degrees(pitch):.0f}°".replace("-", "−"),
                        points[3] + 12 * ahead,
                        points[3] + 78 * ahead + (12 if pitch > -np.radians(75) and pitch < 0 else 0, 0),
                        arrowprops={"arrowstyle": "<-", "color": ORANGE, "lw": 0.7, "shrinkA": 1, "shrinkB": 0},
                        fontsize=6,
                        ha="center",
                        va="center",
                    )
        height = 1e3 * self.robot.height
        axes.plot([], [], "-", color=GREEN, lw=1.4, label="elbow up, beyond a joint limit")
        axes.plot([], [], "-", color=ORANGE, lw=2.0, label="hand, with its pitch")
        axes.plot([0, 0], [0, height], color=INK, lw=5, solid_capstyle="butt")
        axes.plot([0], [height], "o", color=INK, mfc="w", ms=5, zorder=4)
        axes.plot(*(1e3 * np.array([[SHOWN[0]], [SHOWN[1]]])), "o", color=RED, ms=5, zorder=6, label="tool point")
        axes.set_aspect("equal")
        axes.set_xlim(-60, 490)
        axes.set_ylim(-10, 560)
        axes.set_xlabel("distance from the base axis [mm]")
        axes.set_ylabel("height [mm]")
        axes.legend(loc="upper left")
        axes.set_title("(a) one tool point, many pitches")

    def angles(self, axes: Drawing) -> None:
        """θ2, θ3, θ4 over the pitch."""
        degrees = np.degrees(self.pitch)
        for joint, colour in ((1, BLUE), (2, GREEN), (3, ORANGE)):
            for mode, style in ((UP, "-"), (DOWN, "--")):
                values = np.degrees(self.q[mode][:, joint])
                values = np.where(np.abs(np.diff(values, prepend=values[0])) > 180, np.nan, values)
                label = rf"$\theta_{joint + 1}$" if mode == UP else None
                axes.plot(degrees, values, style, color=colour, label=label)
        low, high = self.extent(self.legal[UP])
        axes.axvspan(low, high, color=GREY, alpha=0.18, lw=0, label="within limits, up")
        axes.plot([], [], "--", color=INK, lw=0.9, label="elbow down")
        axes.set_xlim(-180, 180)
        axes.set_ylim(-185, 185)
        axes.set_xticks(range(-180, 181, 60))
        axes.set_yticks(range(-180, 181, 60))
        axes.set_xlabel("pitch of the hand [°]")
        axes.set_ylabel("joint angle [°]")
        axes.legend(loc="lower right", ncols=2, fontsize=6)
        axes.set_title("(b) joint angles over the pitch")

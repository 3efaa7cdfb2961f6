"""Source 001: T₀⁴ by multiplying its four matrices against the closed matrix it prints, and the joint angles back."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.experiments import printed_dh as printed
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREEN, GREY, INK, ORANGE, RED
from assur.planner.arrays import FloatArray
from assur.planner.robots.facts import Limits, principal
from assur.planner.robots.scara import Scara

A1, A2, D4 = 0.325, 0.225, 0.06
"""m. The source has no numbers; these are a usual size."""
SHOWN = np.array([0.5, 0.9, -0.16, 0.4])
"""The joint vector whose frames are drawn."""
STATES, SEED = 10_000, 1


def states() -> FloatArray:
    """Random joint vectors (STATES, 4), θ2 of both signs, from 1e-6 rad beside a singular position."""
    random = np.random.default_rng(SEED)
    q = random.uniform([-np.pi, 0, -0.2, -np.pi], [np.pi, 1, 0.2, np.pi], (STATES, 4))
    near = 10 ** random.uniform(-6, np.log10(np.pi / 2), STATES)
    q[:, 1] = np.where(random.random(STATES) < 0.5, near, np.pi - near) * np.where(q[:, 1] < 0.5, -1, 1)
    return q


def arm() -> Scara:
    """The planner's robot of the same lengths; its limits play no part."""
    wide = np.full(4, 10.0)
    return Scara(name="001", l1=A1, l2=A2, axes=4, limits=Limits(-wide, wide, wide, wide, wide))


def turned(a: FloatArray, b: FloatArray) -> FloatArray:
    """|a − b| of angles, up to whole turns."""
    return np.abs(np.asarray(principal(a - b)))


def run() -> Result:
    """Products against closed forms over random states, and what the printed slips would have cost."""
    q = states()
    tool = printed.frames(q, A1, A2, D4)[3]
    closed = printed.printed_tool(q, A1, A2, D4)
    slip = printed.frames(q, A1, A2, D4, as_printed=True)[3]
    entries = np.abs(tool - closed).max((1, 2))
    root = np.where(np.sin(q[:, 1]) > 0, 1, -1)
    back = np.where(
        (root > 0)[:, None], printed.inverse(closed, A1, A2, D4, 1), printed.inverse(closed, A1, A2, D4, -1)
    )
    angles = np.stack([turned(back[:, i], q[:, i]) for i in (0, 1, 3)], -1).max(-1)
    margin = np.abs(np.sin(q[:, 1]))
    theta4 = turned(printed.printed_theta4(closed), q[:, 3])
    dropped = np.abs(np.asarray(principal(q[:, 0] + q[:, 1])))
    position, yaw = arm().forward(np.stack([q[:, 0], q[:, 1], q[:, 2] - D4, -q[:, 3]], -1))
    ours = np.abs(position - closed[:, :3, 3]).max(-1)
    ours_yaw = turned(yaw, np.arctan2(closed[:, 1, 0], closed[:, 0, 0]))
    rotation = np.linalg.det(printed.printed_rotation_z(q[:, 0]))
    again = printed.frames(back, A1, A2, D4)[3]
    numbers: dict[str, Any] = {
        "states": STATES,
        "product_minus_printed_matrix": float(entries.max()),
        "product_minus_planner_position_m": float(ours.max()),
        "product_minus_planner_yaw_rad": float(ours_yaw.max()),
        "round_trip_matrix": float(np.abs(again - closed).max()),
        "round_trip_angle_rad": float(angles.max()),
        "round_trip_angle_times_margin_rad": float((angles * margin).max()),
        "round_trip_angle_where_margin_above_0.05_rad": float(angles[margin > 0.05].max()),
        "d3_back_m": float(np.abs(back[:, 2] - q[:, 2]).max()),
        "printed_rot_z_determinant": [float(rotation.min()), float(rotation.max())],
        "printed_rot_z_matrix_error_median": float(np.median(np.abs(slip - closed).max((1, 2)))),
        "printed_theta4_error_median_rad": float(np.median(theta4)),
        "printed_theta4_error_minus_theta1_plus_theta2_rad": float(np.abs(theta4 - dropped).max()),
    }
    paragraph = paragraphs(
        "The source multiplies four matrices to a closed T₀⁴ (panel (a) shows their frames), and inverts it "
        "geometrically.",
        f"Over {STATES:,} random joint vectors the product of the four factors of 4.1.5 is the closed matrix to "
        f"{numbers['product_minus_printed_matrix']:.0e} in every entry (1 or m), panel (b). The planner's arm stands "
        f"in the same place to {numbers['product_minus_planner_position_m']:.1g} m with θ4 of the opposite sign, for "
        f"this tool frame looks down. The joint angles come back to "
        f"{numbers['round_trip_angle_where_margin_above_0.05_rad']:.0e} rad where |sin θ2| > 0.05, panel (c); nearer "
        f"to a singular position the error grows as 1/|sin θ2|, which is what rounding of the matrix does, while the "
        f"matrix itself is met to {numbers['round_trip_matrix']:.0e} (1 or m).",
        "It holds, with two slips mended.",
        f"As printed, Rot_z has a determinant between {rotation.min():.2f} and {rotation.max():.2f} instead of 1, "
        f"and θ4 is wrong by exactly θ1 + θ2 (median "
        f"{np.degrees(numbers['printed_theta4_error_median_rad']):.0f}°), panel (b).".replace(" -", " −"),
    )

    def draw(figure: Drawing) -> None:
        left, right = figure.subfigures(1, 2, width_ratios=(1.1, 1))
        chain(left.add_subplot(projection="3d"))
        sorted_, trips = right.subplots(2, 1)
        share = np.arange(1, STATES + 1) / STATES
        floor = 1e-17
        for values, colour, style, label in (
            (entries, BLUE, "-", "product, Rot$_z$ mended"),
            (np.abs(slip - closed).max((1, 2)), RED, "-", "product, Rot$_z$ as printed"),
            (theta4, ORANGE, "--", r"$\theta_4$ as printed [rad]"),
        ):
            sorted_.plot(np.sort(np.maximum(values, floor)), share, color=colour, ls=style, label=label)
        sorted_.set_xscale("log")
        sorted_.set_xlim(floor, 1e2)
        sorted_.set_ylim(0, 1.02)
        sorted_.set_xlabel("largest error of an entry [1, m] or angle [rad]")
        sorted_.set_ylabel("share of states")
        sorted_.legend(loc="center")
        sorted_.set_title("(b) the matrix, mended and as printed")
        trips.loglog(
            margin,
            np.maximum(angles, floor),
            ".",
            ms=1.5,
            color=BLUE,
            rasterized=True,
            label="state (0 drawn at $10^{-17}$)",
        )
        guide = np.array([1e-6, 1.0])
        trips.loglog(guide, 2e-15 / guide, color=INK, ls="--", lw=0.9, label=r"$2\cdot 10^{-15}/|\sin\theta_2|$")
        trips.set_ylim(3e-18, 1e-6)
        trips.set_xlabel(r"$|\sin\theta_2|$")
        trips.set_ylabel("error of the angles [rad]")
        trips.legend(loc="upper right", markerscale=4)
        trips.set_title("(c) joint angles back from the matrix")

    return Result(numbers, paragraph, (7.2, 4.2), draw)


def chain(axes: Drawing) -> None:
    """The arm at SHOWN with the frames 0 to 4: x solid, y dashed, z dotted."""
    made = [np.eye(4), *printed.frames(SHOWN, A1, A2, D4)]
    origins = np.array([1e3 * frame[:3, 3] for frame in made])
    axes.plot(*origins.T, color=GREY, lw=5, solid_capstyle="round", alpha=0.4)
    for i, (frame, origin) in enumerate(zip(made, origins, strict=True)):
        for axis, (colour, style) in enumerate(((RED, "-"), (GREEN, "--"), (BLUE, ":"))):
            ends = np.stack([origin, origin + (90 if i < 3 else 50) * frame[:3, axis]], -1)
            axes.plot(*ends, color=colour, ls=style, lw=1.6, label="xyz"[axis] if i == 0 else None)
        place = origin + ((22, 0, -38) if i == 2 else (-35, -35, 12))
        axes.text(*place, str(i), color=INK, fontsize=8, fontweight="bold")
    axes.set_xlim(-50, 450)
    axes.set_ylim(-50, 450)
    axes.set_zlim(-300, 100)
    axes.set_box_aspect((5, 5, 4), zoom=1.02)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_zlabel("z [mm]")
    axes.view_init(elev=22, azim=-70)
    axes.legend(loc="upper left", ncols=3, bbox_to_anchor=(0.0, 0.97))
    axes.set_title("(a) frames 0 to 4, z of 3 and 4 down", loc="left")

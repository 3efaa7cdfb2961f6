"""Source 000, section 4: the SCARA along the spiral of equation 16, and the same spiral as a moving control point.

Equation 16 is the path of a point on a turntable that climbs: radius 20 mm about (100, 0), a quarter turn a second,
10 mm/s upwards. So the planner gets this request: start from rest somewhere else, meet that point when the spiral
begins, and dwell on it for its 8 s.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.experiments import printed_rrr as printed
from assur.experiments.differential import jacobian
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, INK, RED
from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.model.outcome import LegKind, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.planner.robots.facts import Code
from assur.scenes.requests import scene_of

LASTS_S, BEGINS_S = 8.0, 1.0
"""Length of the spiral, and when the planner's point begins it: the arm starts at 0 s, elsewhere and at rest."""
STEP_S = 1e-3
MODE = 1
"""`right`, assembly mode 2: the source does not say which mode it shows."""
REQUEST: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {"model": "oviedo-scara", "tool": {"tcp_mm": [0, 0, 0]}},
    "start": {"joints": {"theta1_deg": -40, "theta2_deg": -100, "l3_mm": 110}},
    "frames": {
        "helix": {
            "turntable": {
                "at_mm": [100, 0, 50],
                "yaw_deg": -90,
                "rate_deg_s": 90,
                "rise_mm_s": 10,
                "at_s": BEGINS_S,
            }
        }
    },
    "task": [
        {
            "follow": {
                "to": {"frame": "helix", "at_mm": [20, 0, 0]},
                "duration_s": LASTS_S,
                "window_s": [BEGINS_S, BEGINS_S + LASTS_S + 1e-3],  # as long as the dwell: met at its beginning
            }
        }
    ],
    "options": {"max_candidates": 40, "budget_s": 60, "stop": "first", "elbow": "right", "seed": 1, "report": "full"},
}


def inverse(scene: Scene, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """θ1, θ2 (as the planner counts), z with two derivatives (3, T, 3) along equation 16, margin and code."""
    p, v, a, j = printed.spiral(t)
    none = np.zeros(len(t))
    found = scene.robot.inverse(Motion.of(p, v, a, j, none, none, none, none), MODE)
    return np.stack([found.q, found.qd, found.qdd]), found.margin, found.code.astype(np.float64)


def as_printed(joints: FloatArray) -> FloatArray:
    """The source's θ1, θ2 = θ1 − θ_BC and l3 (down from the shoulder) of the planner's joints (3, T, 3)."""
    return np.asarray(joints * np.array([1.0, -1.0, -1.0]))


def run() -> Result:
    """The spiral by the planner's dyad, by the printed equations, and by a plan that dwells on the helix."""
    scene = scene_of(REQUEST)
    t = np.linspace(0.0, LASTS_S, round(LASTS_S / STEP_S) + 1)
    joints, margin, code = inverse(scene, t)
    ours = as_printed(joints)
    p, v, a, _ = printed.spiral(t)
    point = printed.Point(p[:, 0], p[:, 1], v[:, 0], v[:, 1], a[:, 0], a[:, 1])
    (first, second), ratio = printed.scara(point, printed.L_AB, printed.L_BC, 2), ratio_of(point)
    printed_joints = np.stack(
        [np.stack([first[k], second[k], (printed.L_OA * (k == 0) - (p, v, a)[k][:, 2])], -1) for k in range(3)]
    )
    outcome = plan(scene)
    if not isinstance(outcome, Planned):
        raise FaultError(f"the spiral is not planned: {outcome.sentence}")
    trajectory = outcome.plan.trajectory
    follow = next(leg for leg in outcome.plan.legs if leg.kind == LegKind.FOLLOW)
    late = np.clip(t + BEGINS_S, follow.t0, follow.t1)
    planned = np.stack([trajectory.evaluate(late, k) for k in range(3)])
    tip, _ = scene.robot.forward(planned[0])
    off = np.linalg.norm(tip - p, axis=-1)
    speed = np.einsum("tij,tj->ti", jacobian(scene.robot, planned[0]), planned[1])
    difference = np.abs(as_printed(planned) - ours).max(1)
    numbers: dict[str, Any] = {
        "samples": len(t),
        "printed_minus_planner_rad_m": np.abs(printed_joints - ours).max((1, 2)).tolist(),
        "range_theta1_deg": [float(np.degrees(f(ours[0, :, 0]))) for f in (np.min, np.max)],
        "range_theta2_deg": [float(np.degrees(f(ours[0, :, 1]))) for f in (np.min, np.max)],
        "range_l3_mm": [float(1e3 * f(ours[0, :, 2])) for f in (np.min, np.max)],
        "peak_theta1_deg_s": float(np.degrees(np.abs(ours[1, :, 0]).max())),
        "peak_theta1_deg_s2": float(np.degrees(np.abs(ours[2, :, 0]).max())),
        "singular_samples": int((code != Code.ASSEMBLED).sum()),
        "margin_least": float(margin.min()),
        "printed_ratio_A_over_B_range": [float(ratio.min()), float(ratio.max())],
        "end_theta1_theta2_deg_l3_mm": [*np.degrees(ours[0, -1, :2]).tolist(), 1e3 * float(ours[0, -1, 2])],
        "plan": {
            "met_at_s": follow.t0,
            "left_at_s": follow.t1,
            "tool_off_the_spiral_m": float(off.max()),
            "velocity_off_the_spiral_m_s": float(np.linalg.norm(speed - v, axis=-1).max()),
            "joints_off_rad_m": difference[0].tolist(),
            "rates_off_rad_s_m_s": difference[1].tolist(),
            "accelerations_off_rad_s2_m_s2": difference[2].tolist(),
            "margin_least": outcome.margins.singularity,
            "certificate_rows": len(outcome.plan.certificate),
        },
    }
    found = numbers["plan"]
    low, high = (f"{end:.1f}".replace("-", "−") for end in numbers["range_theta1_deg"])
    paragraph = paragraphs(
        "The source drives a SCARA (150, 80, 50 mm) along the spiral of its equation 16 for 8 s in one assembly "
        "mode. It shows θ1 with two derivatives, and an indicator that there is no singular configuration; it "
        "prints no values.",
        f"In assembly mode 2, panels (a) to (c): θ1 goes from {low}° to {high}°, at "
        f"{numbers['peak_theta1_deg_s']:.1f}°/s at most, and l3 from 100 mm to 20 mm. No configuration is singular: "
        f"|sin θ2| is never below {numbers['margin_least']:.3f}, panel (e). Panel (d) shows the arm at the end.",
        f"It holds. The printed equations agree with the planner's dyad to "
        f"{max(numbers['printed_minus_planner_rad_m']):.0e} rad and m in every joint, and per s and s² in both "
        f"derivatives. The spiral is an ordinary request, too, dashed in (a) to (c): a control point on a turntable "
        f"that turns 90°/s and climbs 10 mm/s. The arm starts elsewhere at rest, meets the point at "
        f"{found['met_at_s']:.1f} s with its velocity, and dwells on it for 8 s; the proved plan leaves equation 16, "
        f"at {len(t):,} times, by at most {found['tool_off_the_spiral_m']:.0e} m and "
        f"{found['velocity_off_the_spiral_m_s']:.0e} m/s.",
        "The printed group is used with its slips mended: the derivatives of figure 2, and equation 8.",
    )

    def draw(figure: Drawing) -> None:
        left, right = figure.subfigures(1, 2, width_ratios=(2.0, 1))
        curves = left.subplots(3, 3, sharex=True)
        rows = ((r"\theta", "°"), (r"\dot\theta", "°/s"), (r"\ddot\theta", "°/s²"))
        dots, scale = ("", r"\dot ", r"\ddot "), np.array([180 / np.pi, 180 / np.pi, 1e3])
        for k, (symbol, unit) in enumerate(rows):
            for i in range(3):
                axes = curves[k, i]
                axes.plot(t, ours[k, :, i] * scale[i], color=BLUE, lw=2.4)
                axes.plot(t, as_printed(planned)[k, :, i] * scale[i], color=INK, ls="--", lw=0.9)
                name = f"{symbol}_{i + 1}" if i < 2 else dots[k] + "l_3"
                axes.set_ylabel(f"${name}$ [{unit if i < 2 else unit.replace('°', 'mm')}]")
        for axes, title in zip(curves[0], ("(a) base", "(b) elbow, sign of 000", "(c) quill"), strict=True):
            axes.set_title(title)
        for axes in curves[2]:
            axes.set_xticks(range(0, 9, 2))
            axes.set_xlabel("t after the meeting [s]", fontsize=7)
        curves[1, 2].set_ylim(-13, 1)
        curves[2, 2].set_ylim(-1, 1)
        handles = curves[0, 0].get_lines()
        left.legend(
            handles, ["equation 16", "plan that dwells on the moving point"], loc="outside upper center", ncols=2
        )
        left.align_ylabels()
        parts = right.add_gridspec(2, 1, height_ratios=(1.9, 1))
        arm_at_the_end(right.add_subplot(parts[0], projection="3d"), p, joints[0, -1])
        indicator = right.add_subplot(parts[1])
        indicator.plot(t, margin, color=BLUE, label=r"$|\sin\theta_2|$")
        indicator.step(t, (code != Code.ASSEMBLED).astype(float), color=RED, label="singular (1: yes)")
        indicator.set_ylim(-0.05, 1.05)
        indicator.set_xticks(range(0, 9, 2))
        indicator.set_xlabel("t after the meeting [s]", fontsize=7)
        indicator.set_ylabel("indicator [1]")
        indicator.legend(loc="center", bbox_to_anchor=(0.5, 0.33))
        indicator.set_title("(e) never singular")

    return Result(numbers, paragraph, (7.2, 5.2), draw)


def arm_at_the_end(axes: Drawing, p: FloatArray, q: FloatArray) -> None:
    """Column, both links and quill at the joints q (3,), with the spiral p (T, 3), in space."""
    shoulder = np.array([0.0, 0.0, printed.L_OA])
    elbow = shoulder + printed.L_AB * np.array([np.cos(q[0]), np.sin(q[0]), 0.0])
    wrist = np.array([*p[-1, :2], printed.L_OA])
    line = 1e3 * np.stack([np.zeros(3), shoulder, elbow, wrist, p[-1]], -1)
    axes.plot(*(1e3 * p.T), color=RED, lw=1.2, label="spiral")
    axes.plot(*line, color=INK, lw=2.2, label="arm")
    axes.plot(*line[:, 1:4], "o", color=INK, mfc="w", ms=4)
    axes.plot(*line[:, -1:], "v", color=INK, ms=4)
    axes.set_xlim(0, 125)
    axes.set_ylim(-80, 40)
    axes.set_zlim(0, 160)
    axes.set_box_aspect((125, 120, 160), zoom=0.87)
    axes.set_xticks([0, 50, 100])
    axes.set_yticks([-50, 0])
    axes.set_zticks([0, 50, 100, 150])
    axes.tick_params(pad=-2)
    axes.set_xlabel("x [mm]", labelpad=-4)
    axes.set_ylabel("y [mm]", labelpad=-4)
    axes.set_zlabel("z [mm]", labelpad=-5)
    axes.view_init(elev=20, azim=-50)
    axes.set_anchor("W")
    axes.legend(loc="upper left", ncols=2, bbox_to_anchor=(0.0, 1.06))
    axes.set_title("(d) the arm at the end, 8 s", loc="left", pad=12)


def ratio_of(point: printed.Point) -> FloatArray:
    """A/B of equation 1 along the spiral: ±1 is singular."""
    zero = np.zeros_like(point.x)
    shoulder = printed.Point(zero, zero, zero, zero, zero, zero)
    return printed.dyad(shoulder, point, printed.L_AB, printed.L_BC, 2).ratio

"""Source 004, figures 2.1 to 2.7: POSE1 → POSE2 → POSE1 with parabolic blends, and the same move by Ruckig.

The blended move is a plan: the shipped cell `parabolic-blend`, timed by `timing: parabolic_blend`, proved and checked.
The formulas of the reading (`printed_joint_move`) are held against it.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREY, INK, ORANGE, plan_view
from assur.experiments.printed_joint_move import ParabolicBlend, inverse
from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.model.outcome import Planned
from assur.planner.pipeline import plan
from assur.planner.timing import TimingRefusal, fastest_motion
from assur.planner.trajectory import Trajectory
from assur.scenes.requests import scene_of, with_options
from assur.scenes.scenarios import shipped

A = 0.2
"""a1 = a2, m."""
POSE1, POSE2 = (np.array([0.2, 0.2, -0.1]), 1), (np.array([0.2, 0.2, -0.2]), -1)
"""Tool point, m, with yaw 0, and configuration index g."""
TAU_S, SEGMENT_S = 0.1, 0.4
"""Half of the source's t_acc = 200 ms, and the reading of its segments that gives its total of 1 s."""
JERK_RAMP_S = 0.02
"""The source has no jerk. Ruckig is given what the catalogue assumes: the acceleration is built up in 20 ms."""
STEP_S = 1e-3


def forward(q: FloatArray) -> FloatArray:
    """Tool point in the plane, m, (..., 2)."""
    first, second = q[..., 0], q[..., 0] + q[..., 1]
    return A * np.stack([np.cos(first) + np.cos(second), np.sin(first) + np.sin(second)], -1)


def poses() -> FloatArray:
    """Joint vectors (3, 4) of POSE1, POSE2, POSE1."""
    one, two = (inverse(p, np.array(0.0), A, A, g) for p, g in (POSE1, POSE2))
    return np.stack([one, two, one])


def planned() -> Planned:
    """The plan of the cell. Raises `FaultError` where there is none."""
    outcome = plan(scene_of(with_options(shipped("parabolic-blend").request, {"report": "full"})))
    if not isinstance(outcome, Planned):
        raise FaultError(outcome.sentence)
    return outcome


def by_ruckig(through: FloatArray, move: ParabolicBlend) -> list[Trajectory]:
    """The same poses, each met and stopped at, with the speeds and accelerations of the blended move as limits."""
    velocity = np.abs(move.velocities).max(0)
    acceleration = np.abs(np.diff(move.velocities, axis=0)[[0, -1]]).max(0) / (2 * move.tau)
    found = []
    for q0, q1 in pairwise(through):
        start, goal = ((q.tolist(), [0.0] * len(q), [0.0] * len(q)) for q in (q0, q1))
        limits = velocity.tolist(), acceleration.tolist(), (acceleration / JERK_RAMP_S).tolist()
        profile = fastest_motion(start, goal, limits)
        if isinstance(profile, TimingRefusal):
            raise FaultError(profile.detail)
        found.append(profile)
    return found


def sampled(profiles: list[Trajectory]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times (T,), q and q̇ (T, n) of profiles run one after the other."""
    begins = np.cumsum([0.0, *(profile.duration for profile in profiles)])
    parts = [np.append(np.arange(0.0, p.duration, STEP_S), p.duration) for p in profiles]
    t = np.concatenate([begin + part for begin, part in zip(begins, parts, strict=False)])
    q, qd = (np.concatenate([p.evaluate(part, k) for p, part in zip(profiles, parts, strict=True)]) for k in (0, 1))
    return t, q, qd


def run() -> Result:
    """Numbers of both moves; angles in degrees where the source has degrees."""
    through = poses()
    move = ParabolicBlend(through, SEGMENT_S, TAU_S)
    outcome = planned()
    path, past = outcome.plan.trajectory, outcome.plan.arrivals[0]
    if past.missed_by is None:
        raise FaultError("the plan does not say by how much it misses POSE2")
    t = np.linspace(0.0, path.end, round(path.end / STEP_S) + 1)
    q, qd = path.evaluate(t), path.evaluate(t, 1)
    xy = forward(q)
    middle = path.evaluate(past.time)
    timed = by_ruckig(through, move)
    ruckig_t, ruckig_q, ruckig_qd = sampled(timed)
    ruckig_xy = forward(ruckig_q)
    units = np.array([180 / np.pi, 180 / np.pi, 1e3, 180 / np.pi])
    missed, point = np.array(past.missed_by.joints) * units, forward(middle) * 1e3
    pull = np.maximum(*map(np.abs, path.extrema(2)))
    numbers = {
        "pose1_deg_mm": (through[0] * units).tolist(),
        "pose2_deg_mm": (through[1] * units).tolist(),
        "duration_s": path.duration,
        "differs_from_the_formulas_by": float(np.abs(q - move.evaluate(t)).max()),
        "farthest_x_mm": 1e3 * float(xy[:, 0].max()),
        "farthest_y_mm": 1e3 * float(xy[:, 1].max()),
        "farthest_at_s": [float(t[: len(t) // 2][xy[: len(t) // 2, 0].argmax()]), float(t[500:][xy[500:, 0].argmax()])],
        "off_the_diagonal_mm": 1e3 * float(np.abs(xy[:, 0] - xy[:, 1]).max()),
        "missed_by_deg_mm": missed.tolist(),
        "missed_by_formula_deg_mm": (move.missed_by[1] * units).tolist(),
        "tool_at_the_middle_mm": [*point.tolist(), 1e3 * float(middle[2])],
        "theta1_rate_minus_theta4_rate_rad_s": float(np.abs(qd[:, 0] - qd[:, 3]).max()),
        "peak_rate_deg_s_mm_s": (np.abs(qd).max(0) * units).tolist(),
        "acceleration_deg_s2_mm_s2": (pull * units).tolist(),
        "tool_misses_pose2_by_mm": 1e3 * past.missed_by.distance_m,
        "jerk": outcome.margins.jerk,
        "end_misses_pose1_by": float(np.abs(q[-1] - through[2]).max()),
        "ruckig_duration_s": sum(profile.duration for profile in timed),
        "ruckig_peak_rate_deg_s_mm_s": (np.abs(ruckig_qd).max(0) * units).tolist(),
        "ruckig_misses_pose2_by": float(np.abs(timed[0].evaluate(timed[0].duration) - through[1]).max()),
        "ruckig_farthest_x_mm": 1e3 * float(ruckig_xy[:, 0].max()),
    }
    off = [f"{value:.2f}".replace("-", "−") for value in missed]
    paragraph = paragraphs(
        "The source moves from POSE1, joint values (0°, 90°, −100 mm, −90°), to POSE2, (90°, −90°, −200 mm, 0°), and "
        "back in 1 s. It reports equal curves of θ̇1 and θ̇4, a middle pose that is not reached, and a straight path "
        "out to x = y = 282.8 mm.",
        f"On the plan of the cell `parabolic-blend` (timing: parabolic_blend, acceleration time 200 ms), panels (a) "
        f"to (d): the same joint values, {path.duration:.3f} s with segments of 400 ms, and |θ̇1 − θ̇4| at most "
        f"{numbers['theta1_rate_minus_theta4_rate_rad_s']:.1g} rad/s. A pose is passed at the middle of its blend: "
        f"that of POSE1 begins with the motion and lasts 200 ms, so its circles stand at 0.1 and 0.9 s, though the "
        f"arm rests in POSE1 at 0 and 1 s.\n\n"
        f"Panels (e) and (f): x = y = {numbers['farthest_x_mm']:.2f} mm, on the diagonal to "
        f"{numbers['off_the_diagonal_mm']:.0e} mm; the arm is stretched there, for it changes from right to left. "
        f"POSE2 is missed by {off[0]}°, {off[1]}°, {off[2]} mm and {off[3]}°, as τ(v2 − v1)/4 says and the plan "
        f"states; in the plane the tool turns back {np.hypot(*(point - 200)):.1f} mm before it.",
        f"It holds, at a price: the acceleration jumps, so the jerk is unbounded. Ruckig (dashed), with the same "
        f"speeds and accelerations as limits and each acceleration built up in 20 ms, meets POSE2 exactly, stops "
        f"there, and takes {numbers['ruckig_duration_s']:.2f} s.",
        f"The source prints no formulas of its zones: these are one reading, chosen because it gives the total time. "
        f"The plan differs from it by {numbers['differs_from_the_formulas_by']:.0e} rad or m at most.",
    )

    def draw(figure: Drawing) -> None:
        top, bottom = figure.subfigures(2, 1, height_ratios=(1.25, 1))
        axes = top.subplots(2, 4, sharex=True)
        names = (r"\theta_1", r"\theta_2", "d_3", r"\theta_4")
        titles = ("(a) base", "(b) elbow", "(c) quill", "(d) wrist")
        for i, name in enumerate(names):
            unit = "mm" if i == 2 else "°"
            for row, ours, other in ((0, q, ruckig_q), (1, qd, ruckig_qd)):
                axes[row, i].plot(ruckig_t, other[:, i] * units[i], color=ORANGE, ls="--", label="Ruckig, jerk-limited")
                axes[row, i].plot(t, ours[:, i] * units[i], color=BLUE, label="parabolic blends (004)")
            axes[0, i].plot(
                move.passed,
                through[:, i] * units[i],
                "o",
                mfc="w",
                color=INK,
                label="POSE1, POSE2, POSE1 at the middle of their blends",
            )
            axes[0, i].set_title(titles[i])
            axes[0, i].set_ylabel(f"${name}$ [{unit}]")
            axes[1, i].set_ylabel(rf"$\dot{{{name.partition('_')[0]}}}_{name[-1]}$ [{unit}/s]")
            axes[1, i].set_xlabel("t [s]")
            axes[1, i].set_xticks([0, 0.5, 1])
            if i != 2:
                axes[0, i].set_yticks(np.arange(-90, 91, 45) if i == 1 else np.arange(-90, 1, 45) + 90 * (i == 0))
        handles = axes[0, 0].get_legend_handles_labels()
        top.legend(*handles, loc="outside upper center", ncols=3)
        path, radius = bottom.subplots(1, 2)
        # the two paths are one line: the wider shows beside the narrower
        path.plot(1e3 * ruckig_xy[:, 0], 1e3 * ruckig_xy[:, 1], color=ORANGE, lw=4)
        path.plot(1e3 * xy[:, 0], 1e3 * xy[:, 1], color=BLUE)
        path.plot(200, 200, "o", mfc="w", color=INK)
        path.plot(*point, "s", color=BLUE)
        arc = np.linspace(np.radians(39.5), np.radians(50.5), 60)
        path.plot(400 * np.cos(arc), 400 * np.sin(arc), color=GREY, lw=0.8, ls=":")
        note = {"textcoords": "offset points", "fontsize": 7, "color": INK}
        path.annotate("POSE1 and POSE2", (200, 200), (14, 0), **note)
        path.annotate(f"middle of the blended move\n({point[0]:.1f}, {point[1]:.1f}) mm", point, (10, -12), **note)
        path.annotate("(282.8, 282.8) mm,\nstretched", (282.84, 282.84), (-12, -4), ha="right", **note)
        path.annotate("edge of the workspace", (400 * np.cos(arc[-1]), 400 * np.sin(arc[-1])), (5, -2), **note)
        plan_view(path)
        path.set_title("(e) path of the tool in the plane")
        radius.axhline(400, color=GREY, lw=0.8, ls=":")
        radius.plot(ruckig_t, 1e3 * np.hypot(*ruckig_xy.T), color=ORANGE, ls="--")
        radius.plot(t, 1e3 * np.hypot(*xy.T), color=BLUE)
        radius.plot(move.passed, np.full(3, 200 * np.sqrt(2)), "o", mfc="w", color=INK)
        radius.plot(0.5, np.hypot(*point), "s", color=BLUE)
        radius.set_xlabel("t [s]")
        radius.set_ylabel("distance from the base axis [mm]")
        radius.set_title("(f) out to 400 mm, twice")

    return Result(numbers, paragraph, (7.2, 5.8), draw)

"""Source 002, singular configurations: joint speed along a straight line at constant speed that passes a singular
position at several distances, and what the planner makes of the same request.

The arm has equal links l and loses control of θ1 at the base axis (folded, θ2 = ±π). With ρ the distance from the
axis, θ1 = atan2(y, x) ∓ θ2/2 and ρ = 2 l |cos(θ2/2)|. On the line y = h, x = v t:

    θ̇2 = −v x/(l² sin θ2), which stays of the order v/l, and θ̇1 = −v/h at x = 0                             (E4)

so that the base must turn half a revolution within a time of about 2 h/v: its speed grows as 1/h, its acceleration as
1/h². Past the hole of an arm with unequal links, of radius r0 = |l1 − l2|, the line y = r0 + h all but touches the
singular circle: there the speeds stay bounded, and the acceleration of θ2 grows as v²/√(2 r0 h l1 l2) (E5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, RED, SKY, plan_view
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.model.outcome import Outcome, Planned
from assur.planner.model.refusal import Reason
from assur.planner.pipeline import plan
from assur.planner.robots.facts import Limits
from assur.planner.robots.scara import Scara
from assur.scenes.requests import scene_of

UNEQUAL = (0.225, 0.175)
"""An arm as long, with a hole of 50 mm, m."""
DISTANCES_MM = (200, 100, 50, 20, 8, 4, 2, 1)
SHOWN_MM = (100, 50, 20, 8)
MODE = 1
"""Working mode `right`."""


@dataclass(frozen=True, eq=False)
class Line:
    """Joint motion (T, 2) along a line at times t (T,), and the margin |sin θ2|."""

    t: FloatArray
    q: FloatArray
    qd: FloatArray
    qdd: FloatArray
    margin: FloatArray


def along(l1: float, l2: float, y: float) -> Line:
    """The line at distance `y` from the base axis, at SPEED, by the dyad; finer in time where the arm is nearest."""
    half = HALF / SPEED
    s = np.linspace(-1, 1, 4001)
    narrow = y / SPEED
    t = half * np.sinh(s * np.arcsinh(half / narrow)) * narrow / half
    p, none, still = np.zeros((len(t), 3)), np.zeros(len(t)), np.zeros((len(t), 3))
    p[:, 0], p[:, 1] = SPEED * t, y
    v = still.copy()
    v[:, 0] = SPEED
    wide = np.full(3, 10.0)
    arm = Scara(name="line", l1=l1, l2=l2, axes=3, limits=Limits(-wide, wide, wide, wide, wide))
    found = arm.inverse(Motion.of(p, v, still, still, none, none, none, none), MODE, 2)
    return Line(t, found.q[:, :2], found.qd[:, :2], found.qdd[:, :2], found.margin)


def slope(x: FloatArray, y: FloatArray) -> float:
    """Exponent of y ~ xⁿ."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def run() -> Result:
    """Peaks of the joints' rates against the distance, with the planner's answers."""
    h = np.array(DISTANCES_MM) / 1e3
    lines = [along(LINK, LINK, y) for y in h]
    tangents = [along(*UNEQUAL, UNEQUAL[0] - UNEQUAL[1] + y) for y in h]
    peak = {
        name: np.array([np.abs(getattr(line, order)[:, joint]).max() for line in group])
        for name, group, order, joint in (
            ("theta1", lines, "qd", 0),
            ("theta2", lines, "qd", 1),
            ("theta1_acceleration", lines, "qdd", 0),
            ("hole_theta2", tangents, "qd", 1),
            ("hole_theta2_acceleration", tangents, "qdd", 1),
        )
    }
    answers = {kind: [decision(mm, kind) for mm in DISTANCES_MM] for kind in ("constant speed", "any speed")}
    near = h < 0.01
    numbers = {
        "distance_mm": list(DISTANCES_MM),
        "speed_m_s": SPEED,
        "peak_rad_s": {name: peak[name].tolist() for name in ("theta1", "theta2", "hole_theta2")},
        "peak_rad_s2": {name: peak[name].tolist() for name in ("theta1_acceleration", "hole_theta2_acceleration")},
        "theta1_peak_over_v_by_h": (peak["theta1"] * h / SPEED).tolist(),
        "exponents_below_10_mm": {name: slope(h[near], values[near]) for name, values in peak.items()},
        "least_margin": [float(line.margin.min()) for line in lines],
        "limit_deg_s": FASTEST_DEG_S,
        "planner": answers,
    }
    return Result(
        numbers, report(numbers, peak, answers), (7.2, 5.6), lambda figure: draw(figure, lines, peak, answers)
    )


def report(numbers: dict[str, Any], peak: dict[str, FloatArray], answers: dict[str, list[dict[str, Any]]]) -> str:
    """The paragraphs."""
    answered = {}
    for kind, rows in answers.items():
        parts: dict[str, list[str]] = {}
        for mm, row in zip(DISTANCES_MM, rows, strict=True):
            parts.setdefault(row["answer"], []).append(f"{mm}")
        answered[kind] = "; ".join(f"{answer} at {', '.join(mm)} mm" for answer, mm in parts.items())
    margins = [row["margin"] for row in answers["constant speed"] if row["answer"] == Reason.NEAR_SINGULARITY]
    grows = {
        name: f"{numbers['exponents_below_10_mm'][name]:.1f}".replace("-", "−")
        for name in ("theta1_acceleration", "hole_theta2_acceleration")
    }
    return paragraphs(
        "Near a singular position, the source says, a constant speed of the tool asks for joint speeds that no drive "
        "reaches. It shows one figure of a SCARA, without numbers.",
        f"At {1e3 * SPEED:.0f} mm/s along a line past the base axis of an arm with equal links, panels (a) and (b), "
        f"the base must turn at {np.degrees(peak['theta1'][0]):.0f}°/s at a distance of {DISTANCES_MM[0]} mm and at "
        f"{np.degrees(peak['theta1'][-1]):,.0f}°/s at {DISTANCES_MM[-1]} mm, as v/h says, panel (c); its "
        f"acceleration grows with h to the power {grows['theta1_acceleration']}.\n\n"
        f"The planner's answers are in panel (d). At this constant speed (a point on a belt, to be followed): "
        f"{answered['constant speed']}; the refusals name the margin |sin θ2|, {margins[0]:.3f} to {margins[-1]:.3f}, "
        f"where 0.05 is required. At any speed (a straight leg): {answered['any speed']}; it slows down, to "
        f"{answers['any speed'][3]['leg_s']:.1f} s at {DISTANCES_MM[3]} mm, and keeps every joint within its "
        f"{FASTEST_DEG_S}°/s.",
        f"It holds for equal links, and not for every singular position: past the hole of an arm with unequal links "
        f"θ̇2 stays below {np.degrees(peak['hole_theta2'].max()):.0f}°/s, panel (c), and its acceleration alone "
        f"grows, with h to the power {grows['hole_theta2_acceleration']}.",
    )


def draw(
    figure: Drawing, lines: list[Line], peak: dict[str, FloatArray], answers: dict[str, list[dict[str, Any]]]
) -> None:
    """Paths, θ̇1 along the lines, peaks against the distance, the planner's answers."""
    parts = figure.add_gridspec(2, 2)
    path, rates, peaks = (figure.add_subplot(parts[place]) for place in ((0, 0), (0, 1), (1, 0)))
    strips = parts[1, 1].subgridspec(2, 1, height_ratios=(2.4, 1), hspace=0.05)
    answered = figure.add_subplot(strips[0])
    refused = figure.add_subplot(strips[1], sharex=answered)
    mm = np.array(DISTANCES_MM, dtype=np.float64)
    colours = dict(zip(SHOWN_MM, (GREEN, SKY, ORANGE, RED), strict=True))
    for (shown, colour), style in zip(colours.items(), (":", "-.", "--", "-"), strict=True):
        line = lines[DISTANCES_MM.index(shown)]
        path.plot([-1e3 * HALF, 1e3 * HALF], [shown, shown], color=colour, ls=style, lw=1.3)
        place = (205, shown - (12 if shown == min(SHOWN_MM) else 0))
        path.annotate(f"{shown} mm", place, color=INK, va="center", fontsize=7)
        rates.plot(1e3 * SPEED * line.t, np.degrees(line.qd[:, 0]), color=colour, ls=style, label=f"h = {shown} mm")
    nearest = lines[DISTANCES_MM.index(20)]
    for t, shade in ((-0.4, 0.35), (-0.1, 0.5), (0.0, 1.0), (0.1, 0.5), (0.4, 0.35)):
        q = np.array([np.interp(t, nearest.t, np.unwrap(nearest.q[:, i])) for i in (0, 1)])
        elbow = 1e3 * LINK * np.array([np.cos(q[0]), np.sin(q[0])])
        tip = elbow + 1e3 * LINK * np.array([np.cos(q.sum()), np.sin(q.sum())])
        path.plot(*np.stack([np.zeros(2), elbow, tip], -1), "o-", color=INK, alpha=shade, lw=1.6, ms=3)
    plan_view(path)
    path.set_aspect("equal", adjustable="box")
    path.set_xlim(-230, 290)
    path.set_ylim(-200, 215)
    path.set_title("(a) lines past the base axis; arm on h = 20 mm")
    rates.axhline(-FASTEST_DEG_S, color=GREY, lw=0.9, ls="--")
    rates.annotate(f"limit {FASTEST_DEG_S}°/s", (-195, -FASTEST_DEG_S), (0, -9), textcoords="offset points", color=GREY)
    rates.set_xlabel("x on the line [mm]")
    rates.set_ylabel(r"$\dot\theta_1$ [°/s]")
    rates.legend(loc="lower right")
    rates.set_title(f"(b) speed of the base, tool at {1e3 * SPEED:.0f} mm/s")
    peaks.loglog(mm, np.degrees(SPEED / (mm / 1e3)), color=GREY, lw=3, alpha=0.5, label="v/h")
    for name, colour, mark, label in (
        ("theta1", BLUE, "o", r"$\dot\theta_1$, equal links"),
        ("theta2", SKY, "s", r"$\dot\theta_2$, equal links"),
        ("hole_theta2", PURPLE, "^", r"$\dot\theta_2$, hole of unequal links"),
    ):
        peaks.loglog(mm, np.degrees(peak[name]), mark + "-", color=colour, lw=1, label=label)
    peaks.axhline(FASTEST_DEG_S, color=GREY, lw=0.9, ls="--")
    peaks.annotate("limit", (120, FASTEST_DEG_S), (0, 3), textcoords="offset points", color=GREY)
    peaks.xaxis.set_major_formatter("{x:g}")
    peaks.yaxis.set_major_formatter("{x:,.0f}")
    peaks.set_xlabel("distance h from the singular position [mm]")
    peaks.set_ylabel("largest joint speed [°/s]")
    peaks.legend(loc="upper right")
    peaks.set_title("(c) what the line asks of the joints")
    planned_and_refused(answered, refused, answers)


def planned_and_refused(planned: Drawing, refused: Drawing, answers: dict[str, list[dict[str, Any]]]) -> None:
    """The planner's answers: the largest joint speed of what it plans, and below, what it refuses and why."""
    planned.axhline(FASTEST_DEG_S, color=GREY, lw=0.9, ls="--")
    planned.annotate(f"limit {FASTEST_DEG_S}°/s", (1.0, FASTEST_DEG_S), (0, 3), textcoords="offset points", color=GREY)
    reasons = {str(Reason.MOTION_LIMIT): ("+", "motion limit"), str(Reason.NEAR_SINGULARITY): ("x", "near singular")}
    seen: set[str] = set()
    for row, (kind, colour, mark) in enumerate((("constant speed", ORANGE, "o-"), ("any speed", BLUE, "s--"))):
        rows = list(zip(DISTANCES_MM, answers[kind], strict=True))
        good = [(mm, answer["peak_deg_s"]) for mm, answer in rows if answer["answer"] == "planned"]
        planned.semilogx(*zip(*good, strict=True), mark, color=colour, lw=1, label=kind)
        for mm, answer in rows:
            if answer["answer"] in reasons:
                cross, words = reasons[answer["answer"]]
                label = None if words in seen else words
                seen.add(words)
                refused.plot(mm, row, cross, ms=6, mew=1.5, color=colour, label=label)
            if row == 0 and "margin_required" in answer:
                note = f"{answer['margin']:.3f}"
                refused.annotate(note, (mm, row), (0, 6), textcoords="offset points", ha="center", fontsize=6.5)
    planned.set_ylim(0, 400)
    planned.set_ylabel("largest joint\nspeed [°/s]")
    planned.tick_params(labelbottom=False)
    planned.legend(loc="lower left", title="planned at", title_fontsize=7)
    planned.set_title("(d) what the planner answers")
    refused.annotate(r"$|\sin\theta_2|=$", (0.28, 0), (0, 6), textcoords="offset points", fontsize=6.5)
    refused.set_ylim(1.6, -1.1)
    refused.set_yticks([0, 1], ["constant", "any"])
    refused.set_ylabel("refused")
    refused.set_xlim(0.27, 250)
    refused.set_xlabel("distance h from the singular position [mm]")
    refused.legend(loc="center right", markerscale=0.8, fontsize=6, handletextpad=0.1, borderpad=0.3)
    for axes in (planned, refused):
        axes.xaxis.set_major_formatter("{x:g}")


LINK = 0.2
"""l1 = l2 of the arm of 004, m."""
SPEED, HALF = 0.25, 0.2
"""Of the tool, m/s, and half of the line's length, m."""
FASTEST_DEG_S = 300
"""Limit of θ1 and θ2 in the catalogue's entry of this arm."""


def request(h_mm: float, kind: str) -> dict[str, Any]:
    """The line as a request: at `constant speed` a point on a belt, to be followed; at `any speed` a straight leg."""

    def joint(name: str, turn_deg: float) -> dict[str, Any]:
        rates = {"velocity_deg_s": FASTEST_DEG_S, "acceleration_deg_s2": 3000, "jerk_deg_s3": 150_000}
        return {"name": name, "range_deg": [-turn_deg, turn_deg], **rates}

    lift = {"velocity_mm_s": 1000, "acceleration_mm_s2": 10_000, "jerk_mm_s3": 500_000}
    shaft = {"cylinder": {"radius_mm": 8, "height_mm": 100}}
    scara = {
        "l1_mm": 1e3 * LINK,
        "l2_mm": 1e3 * LINK,
        # No stops before the singular position: it is the margin that must refuse.
        "joints": [joint("theta1", 720), joint("theta2", 180), {"name": "d3", "range_mm": [-250, -20], **lift}],
        "bodies": [{"name": "shaft", "link": "quill", "shape": shaft, "at_mm": [0, 0, 50]}],
        "self_pairs": [],
    }
    # A body far below: the request is about the arm alone.
    floor = {"name": "floor", "shape": {"box": {"size_mm": [1000, 1000, 20]}}, "pose": {"at_mm": [0, 0, -800]}}
    document: dict[str, Any] = {
        "schema": "assur/1",
        "robot": {"scara": scara, "tool": {"tcp_mm": [0, 0, 0]}},
        "start": {"joints": {"theta1_deg": 150, "theta2_deg": 80, "d3_mm": -100}},
        "bodies": [floor],
        "options": {
            "max_candidates": 30,
            "budget_s": 60,
            "stop": "first",
            "elbow": "right",
            "seed": 1,
            "report": "full",
        },
    }
    begin, end = [-1e3 * HALF, h_mm, -100], [1e3 * HALF, h_mm, -100]
    if kind == "any speed":
        document["task"] = [{"move": {"to": {"at_mm": begin}}}, {"move": {"to": {"at_mm": end}, "leg": "cartesian"}}]
        return document
    took = 2 * HALF / SPEED
    document["frames"] = {"belt": {"conveyor": {"at_mm": begin, "speed_mm_s": 1e3 * SPEED, "at_s": 2}}}
    tracking = {"to": {"frame": "belt", "at_mm": [0, 0, 0]}, "duration_s": took}
    document["task"] = [{"follow": {**tracking, "window_s": [2, 2 + took + 1e-3]}}]
    return document


def decision(h_mm: float, kind: str) -> dict[str, Any]:
    """What the planner answers to the line at this distance."""
    scene = scene_of(request(h_mm, kind))
    outcome: Outcome = plan(scene)
    if isinstance(outcome, Planned):
        leg = outcome.plan.legs[1]
        rates = outcome.plan.trajectory.evaluate(np.linspace(leg.t0, leg.t1, 4001), 1)[:, :2]
        return {
            "answer": "planned",
            "leg_s": leg.t1 - leg.t0,
            "margin": outcome.margins.singularity,
            "peak_deg_s": float(np.degrees(np.abs(rates).max())),
        }
    refused: dict[str, Any] = {"answer": str(outcome.reason), "sentence": outcome.sentence}
    if outcome.reason == Reason.NEAR_SINGULARITY and outcome.refusal is not None and outcome.refusal.amount:
        refused["margin"] = scene.options.singularity_margin - outcome.refusal.amount.value
        refused["margin_required"] = scene.options.singularity_margin
    return refused

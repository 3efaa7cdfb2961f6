"""Source 002, transformation matrices: the polar arm's products and closed form against the dyads, and its det J."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.experiments import closed_forms as forms
from assur.experiments import printed_forms as printed
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, INK, ORANGE, RED
from assur.experiments.plane_figures import NOTE, Plane
from assur.experiments.plane_figures import compared as comparison
from assur.planner.arrays import FloatArray
from assur.planner.robots.facts import Limits
from assur.planner.robots.tilting import PolarArm

L1, LONGEST, SHORTEST = 0.400, 0.650, 1e-3
"""m. The source gives no numbers: the shoulder's height, and how far the ram is out, from nearly nothing."""
TARGETS, SEED = 10_000, 7
SIGNS = {"front": 1, "back": -1}
"""Working mode → the sign of r = C1 p_x + S1 p_y."""
SHOWN, BELOW = (0.40, 0.28), (0.40, -0.28)
"""The targets that are drawn: distance from the base axis, height above the shoulder, m."""


def arm() -> forms.Arm:
    """The planner's arm and the source's, whose θ2 is ψ − 90°; limits play no part but for the longest ram."""
    wide = np.array([10.0, 10.0, LONGEST])
    robot = PolarArm(name="polar", height=L1, limits=Limits(np.array([-10.0, -10.0, SHORTEST]), wide, wide, wide, wide))

    def closed(p: FloatArray, mode: str) -> FloatArray:
        return printed.polar_joints(p, L1, SIGNS[mode])

    def product(q: FloatArray) -> FloatArray:
        return np.asarray(-(q[..., 2] ** 2) * np.sin(q[..., 1]))

    offset = np.array([0.0, -np.pi / 2, 0.0])
    return forms.Arm(robot, offset, closed, lambda q: printed.polar_frames(q, L1), product, (False, False, True))


def targets() -> FloatArray:
    """Points (TARGETS, 3) all around the base, from 1e-5 beside the base axis and SHORTEST beside the shoulder."""
    random = np.random.default_rng(SEED)
    tilt = np.where(
        random.random(TARGETS) < 0.5, 10 ** random.uniform(-5, 0, TARGETS), random.uniform(0.1, np.pi - 0.1, TARGETS)
    )
    tilt = np.where(random.random(TARGETS) < 0.5, tilt, np.pi - tilt)
    reach, turn = random.uniform(SHORTEST, LONGEST, TARGETS), random.uniform(-np.pi, np.pi, TARGETS)
    flat = reach * np.sin(tilt)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), L1 + reach * np.cos(tilt)], -1)


def run() -> Result:
    """The comparison, the printed matrices, the singular positions, and what the arctan as printed gives."""
    both, p = arm(), targets()
    compared = forms.compare(both, p, np.random.default_rng(SEED).normal(0.0, 0.1, p.shape))
    q = printed.polar_joints(p, L1, 1)
    first, second, third = printed.polar_matrices(q, L1)
    tool = printed.polar_frames(q, L1)[-1]
    slip, mended = (printed.third_product(q, L1, as_printed=s) @ tool - third for s in (True, False))
    literal = printed.printed_polar_joints(p, L1)
    below = p[:, 2] < L1
    numbers: dict[str, Any] = {
        **compared.numbers,
        "printed_matrices_minus_table_of_parameters": float(np.abs(first @ second @ third - tool).max()),
        "closed_tool_matrix_minus_product": float(np.abs(printed.printed_polar_tool(q, L1) - tool).max()),
        "product_iii_mended_minus_a3": float(np.abs(mended).max()),
        "product_iii_as_printed_minus_a3_median": float(np.median(np.abs(slip).max((1, 2)))),
        "singular": forms.singular(
            both,
            {
                "interior alignment: flange over the base axis": (0.4, np.pi / 2, 0.5),
                "edge inside: nothing of the ram is out": (0.4, 0.7, 0.0),
            },
        ),
        "as_printed_off_target_m": float(forms.missed(both, literal, p).max()),
        "as_printed_negative_d3_share": float((literal[:, 2] < 0).mean()),
        "as_printed_negative_d3_below_the_shoulder_share": float((literal[below, 2] < 0).mean()),
        "as_printed_negative_d3_above_the_shoulder_share": float((literal[~below, 2] < 0).mean()),
    }
    return Result(numbers, report(numbers), (7.2, 6.3), lambda figure: draw(figure, both, compared))


def report(numbers: dict[str, Any]) -> str:
    """The paragraphs."""
    below = numbers["as_printed_negative_d3_below_the_shoulder_share"]
    above = numbers["as_printed_negative_d3_above_the_shoulder_share"]
    return paragraphs(
        "The source multiplies three matrices to T, and solves a polar arm by taking them to the other side one by "
        "one. It prints no numbers.",
        f"Over {numbers['targets']:,} targets: its matrices follow from its table of parameters to "
        f"{numbers['printed_matrices_minus_table_of_parameters']:.0e} in an entry (1 or m), and the closed T is "
        f"their product to {numbers['closed_tool_matrix_minus_product']:.0e}. The closed form, with atan2, meets its "
        f"target to {numbers['closed_form_by_transforms_off_target_m']:.0e} m, and its joints are those of the "
        f"planner's two RPR dyads, `front` and `back` of panel (a), to "
        f"{numbers['closed_form_minus_dyads_rad_m']:.0e} rad or m at any margin, panel (c). The dyads' velocities "
        f"are J⁻¹ẋ of the matrices to {numbers['inverse_jacobian_minus_dyads_relative_where_margin_above_0.05']:.0e} "
        f"(relative) where the margin is above 0.05. The determinant is −d3² sin θ2 = d3 r to "
        f"{numbers['determinant_by_transforms_and_by_planner_minus_product']:.0e} m², panel (b).",
        "It holds, once mended. The determinant is 0 inside the workspace, where the flange is over the base axis, and "
        "at its inner edge, with nothing of the ram out; at the outer edge it is not, for there the stroke ends and no "
        "axis is lost.",
        f"Product (III), with a 0 for the 1 in its second row, gives ²A₃ to "
        f"{numbers['product_iii_mended_minus_a3']:.0e} in an entry (1 or m); as printed one is wrong by "
        f"{numbers['product_iii_as_printed_minus_a3_median']:.2f} in the median. With arctan as printed, taken to "
        f"the letter, every target is met to {numbers['as_printed_off_target_m']:.0e} m, but {100 * below:.0f} % of "
        f"those below the shoulder, and {100 * above:.0f} % of those above it, with a negative d3, panel (d): the "
        f"ram would have to come out at its back.",
    )


def draw(figure: Drawing, both: forms.Arm, compared: forms.Comparison) -> None:
    """The arm in its plane, |det J| over the plane, closed form against dyads, and d3 as printed."""
    (posture, area), (errors, length) = figure.subplots(2, 2)
    plane = Plane(L1, 0.0, LONGEST, "stroke ends")
    plane.curves(posture, named=True)
    posture.plot([0, 0], [0, 1e3 * L1], color=INK, lw=3.5)
    for (r, up), colour, style in ((SHOWN, BLUE, "-"), (BELOW, ORANGE, "--")):
        target = np.array([r, 0.0, up + L1])
        posture.plot([0, 1e3 * r], [1e3 * L1, 1e3 * (up + L1)], "o" + style, color=colour, lw=2.2, ms=5, mfc="w")
        front, back = (both.closed(target, mode) - both.offset for mode in both.robot.modes)
        text = rf"front: $\psi={np.degrees(front[1]):.0f}°$" + "\n" + rf"back: $\psi={np.degrees(back[1]):.0f}°$"
        place = (8, 8) if up > 0 else (8, -22)
        posture.annotate(text, (1e3 * r, 1e3 * (up + L1)), place, ha="right", color=colour, **NOTE)
    posture.set_title(r"(a) two solutions each; back: $\theta_1 \pm 180°$")
    rho, h = plane.grid()
    reach = np.hypot(rho, h)
    plane.map(figure, area, np.where(reach <= LONGEST, reach * np.abs(rho), np.nan), r"$|\det J|$ [m²]", lines=True)
    area.set_title(r"(b) $|\det J| = |d_3\,\rho|$")
    comparison(errors, compared.margin, compared.apart, 2, grows=False)
    errors.set_xlabel(r"margin: lesser of $d_3$ and $|\rho|$, over the longest $d_3$")
    errors.set_ylabel("closed form − dyads [rad, m]")
    errors.set_title("(c) joints, mended")
    line = np.linspace(-0.5, 0.5, 400)
    p = np.stack([np.full_like(line, SHOWN[0]), np.zeros_like(line), L1 + line], -1)
    for found, colour, style, label in (
        (printed.polar_joints(p, L1, 1), BLUE, "-", "mended"),
        (printed.printed_polar_joints(p, L1), RED, "--", "as printed"),
    ):
        value = 1e3 * found[:, 2]
        value[1:][np.abs(np.diff(value)) > 100] = np.nan  # a jump is no line
        length.plot(1e3 * (L1 + line), value, color=colour, ls=style, label=label)
    length.axvline(1e3 * L1, color=INK, lw=0.8, ls=":")
    length.annotate("shoulder", (1e3 * L1, 120), (4, 0), **NOTE)
    length.set_xlabel(rf"height of a target at $\rho$ = {1e3 * SHOWN[0]:.0f} mm [mm]")
    length.set_ylabel("$d_3$ [mm]")
    length.legend(loc="lower right")
    length.set_title("(d) length of the ram; as printed: with arctan")

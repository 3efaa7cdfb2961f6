"""Source 003: the half-angle formulas of two oblique triangles, mended, against the dyad in the vertical plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.experiments import printed_triangles as printed
from assur.experiments.dyad import LEFT, RRR
from assur.experiments.experiment import Drawing, Result, paragraphs
from assur.experiments.figures import BLUE, GREEN, GREY, INK, ORANGE, RED
from assur.planner.arrays import FloatArray
from assur.planner.robots.facts import Code, principal

HEIGHT, LINK1, LINK2 = 0.300, 0.250, 0.160
"""m. The source gives no lengths; these are widely quoted for its RV-M1, without a maker's document."""
TARGETS, SEED = 10_000, 3
SHOWN = (0.26, 0.42)
"""The target that is drawn: distance from the base axis and height, m."""
FLAT = 0.1
"""sin A_i below which the lower triangle counts as flat (no unit): the target is nearly above or below the shoulder."""
SWEPT_Z = 0.35
"""Height, m, of the horizontal line along which the printed equation is compared."""


def targets() -> tuple[FloatArray, FloatArray]:
    """Distances and heights (TARGETS,) of targets in reach, in front of the base, from 1e-5 rad beside singular."""
    random = np.random.default_rng(SEED)
    near = 10 ** random.uniform(-5, np.log10(np.pi / 2), TARGETS)
    bend = np.where(random.random(TARGETS) < 0.5, near, np.pi - near)
    reach = np.sqrt(LINK1**2 + LINK2**2 + 2 * LINK1 * LINK2 * np.cos(bend))
    elevation = random.uniform(-np.pi / 2, np.pi / 2, TARGETS)
    return reach * np.cos(elevation), HEIGHT + reach * np.sin(elevation)


def by_dyad(r: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The same two angles (..., 2) by the planner's dyad, elbow up being its mode LEFT, and |sin θ2|."""
    found = RRR(LINK1, LINK2).solve(LEFT, (r, z - HEIGHT))
    (ux, uy), (wx, wy) = found.u, found.w
    angles = np.stack([np.arctan2(uy, ux), np.arctan2(found.cross, ux * wx + uy * wy)], -1)
    return np.where((found.code == Code.ASSEMBLED)[..., None], angles, np.nan), found.margin


def run() -> Result:
    """Mended formulas against the dyad over random targets, and how wrong the printed ones are."""
    r, z = targets()
    ours, margin = by_dyad(r, z)
    error = np.abs(np.asarray(principal(printed.joints(r, z, HEIGHT, LINK1, LINK2) - ours))).max(-1)
    flat = np.cos(np.arctan2(z - HEIGHT, r)) < FLAT
    line = np.linspace(0.02, np.sqrt((LINK1 + LINK2) ** 2 - (SWEPT_Z - HEIGHT) ** 2) - 0.002, 300)
    line = line[np.hypot(line, SWEPT_Z - HEIGHT) > abs(LINK1 - LINK2) + 1e-3]
    height = np.full_like(line, HEIGHT)
    sides = (np.hypot(line, SWEPT_Z), height, np.hypot(line, SWEPT_Z - HEIGHT))
    right = printed.angle(*sides)
    in_m, in_mm = printed.printed_angle(*sides), printed.printed_angle(*(1e3 * side for side in sides))
    numbers: dict[str, Any] = {
        "targets": TARGETS,
        "mended_minus_dyad_rad": float(error.max()),
        "mended_minus_dyad_where_margin_above_0.05_rad": float(error[(margin > 0.05) & ~flat].max()),
        "mended_minus_dyad_times_margin_rad": float((error * margin)[~flat].max()),
        "mended_minus_dyad_times_margin_flat_lower_triangle_rad": float((error * margin)[flat].max()),
        "solved_by_both": int(np.isfinite(error).sum()),
        "printed_eq_1_in_m_error_deg": spread(in_m - right),
        "printed_eq_1_in_mm_error_deg": spread(in_mm - right),
    }
    paragraph = paragraphs(
        "The source solves the arm by the two oblique triangles of panel (a), and names the law of tangents.",
        f"Over {TARGETS:,} targets the formulas, mended, give the joint angles of the planner's dyad (elbow up is "
        f"its mode `left` in the vertical plane) to {numbers['mended_minus_dyad_where_margin_above_0.05_rad']:.0e} "
        f"rad where |sin θ2| > 0.05, and nearer to singular positions to "
        f"{numbers['mended_minus_dyad_times_margin_rad']:.0e} rad divided by |sin θ2|, panel (c). Where the target "
        f"is above or below the shoulder the lower triangle is flat and they lose up to two digits more, which the "
        f"dyad, having no such triangle, does not.",
        "The construction holds; what is printed of it does not.",
        f"What is printed are half-angle formulas with a slip: the product under the root is not divided, so that the "
        f"angle depends on the unit of length. Equation 1 as printed is wrong by up to "
        f"{numbers['printed_eq_1_in_m_error_deg'][1]:.0f}° with metres, and by up to "
        f"{numbers['printed_eq_1_in_mm_error_deg'][1]:.0f}° with millimetres, panel (b).",
    )

    def draw(figure: Drawing) -> None:
        left, side = figure.subfigures(1, 2, width_ratios=(1, 1.05))
        triangles(left.subplots())
        swept, errors = side.subplots(2, 1)
        swept.plot(1e3 * line, np.degrees(right), color=BLUE, label="equation 1, mended")
        swept.plot(1e3 * line, np.degrees(in_m), color=ORANGE, ls="--", label="as printed, lengths in m")
        swept.plot(1e3 * line, np.degrees(in_mm), color=RED, ls=":", label="as printed, lengths in mm")
        swept.set_xlabel("distance of the target from the base axis [mm]")
        swept.set_ylabel(r"$A_i$ [°]")
        swept.set_ylim(-5, 185)
        swept.set_yticks([0, 45, 90, 135, 180])
        swept.legend(loc="center right", bbox_to_anchor=(1.0, 0.3))
        swept.set_title(f"(b) angle at the shoulder, target {1e3 * SWEPT_Z:.0f} mm high")
        guide = np.array([1e-5, 1.0])
        steep = rf"target, $\sin A_i<{FLAT}$"
        for rows, colour, mark, label in (
            (~flat, BLUE, ".", "target (0 drawn at $10^{-17}$)"),
            (flat, ORANGE, "+", steep),
        ):
            shown = np.maximum(error[rows], 1e-17)
            size = 1.5 if mark == "." else 3
            errors.loglog(margin[rows], shown, mark, ms=size, mew=0.6, color=colour, rasterized=True, label=label)
        errors.loglog(guide, 2e-15 / guide, color=INK, ls="--", lw=0.9, label=r"$2\cdot 10^{-15}/|\sin\theta_2|$")
        errors.set_xlabel(r"$|\sin\theta_2|$")
        errors.set_ylabel("mended − dyad [rad]")
        errors.set_ylim(3e-18, 3e-7)
        errors.legend(loc="upper right", markerscale=2)
        errors.set_title("(c) both joint angles against the dyad")

    return Result(numbers, paragraph, (7.2, 4.4), draw)


def spread(error: FloatArray) -> list[float]:
    """Least and largest |error|, degrees."""
    return [float(np.degrees(f(np.abs(error)))) for f in (np.min, np.max)]


def triangles(axes: Drawing) -> None:
    """Figure 4 of the source at SHOWN, in the vertical plane, with the elbow as the dyad has it."""
    r, z = np.array(SHOWN[0]), np.array(SHOWN[1])
    first = float(by_dyad(r, z)[0][0])
    origin, shoulder, target = np.zeros(2), np.array([0.0, HEIGHT]), np.array(SHOWN)
    elbow = shoulder + LINK1 * np.array([np.cos(first), np.sin(first)])
    axes.fill(*(1e3 * np.stack([origin, shoulder, target], -1)), color=GREEN, alpha=0.12, lw=0)
    axes.fill(*(1e3 * np.stack([shoulder, elbow, target], -1)), color=BLUE, alpha=0.12, lw=0)
    axes.plot(*(1e3 * np.stack([origin, target], -1)), color=GREEN, lw=1, ls="--")
    axes.plot(*(1e3 * np.stack([shoulder, target], -1)), color=GREY, lw=1, ls="--")
    axes.plot(*(1e3 * np.stack([origin, shoulder, elbow, target], -1)), "o-", color=INK, lw=2.2, ms=5, mfc="w")
    sides = ((origin, target, "a", (6, -8)), (origin, shoulder, "b", (-11, 0)), (shoulder, target, "c = d", (-2, -13)))
    upper = ((elbow, target, "a′", (5, 3)), (shoulder, elbow, "b′", (-14, 3)))
    for one, other, name, offset in (*sides, *upper):
        axes.annotate(name, 500 * (one + other), offset, textcoords="offset points", style="italic")
    for corner, name, towards in (
        (shoulder, "$A_i$", (9, -22)),
        (shoulder, "$A_s$", (14, 16)),
        (elbow, "$D$", (-3, -20)),
    ):
        axes.annotate(name, 1e3 * corner, towards, textcoords="offset points", color=RED)
    for corner, name, offset in (
        (origin, "origin", (8, -2)),
        (shoulder, "shoulder", (-42, -3)),
        (elbow, "elbow", (-2, 8)),
        (target, "target", (8, -3)),
    ):
        axes.annotate(name, 1e3 * corner, offset, textcoords="offset points", color=INK)
    axes.set_aspect("equal")
    axes.set_xlim(-130, 370)
    axes.set_ylim(-40, 620)
    axes.set_xlabel("distance from the base axis [mm]")
    axes.set_ylabel("height [mm]")
    axes.set_title("(a) the two triangles, elbow up")

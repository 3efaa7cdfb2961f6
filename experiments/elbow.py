"""Source 002, geometric method: the elbow arm's closed form against transforms and dyads, and where its det J is 0."""

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
from assur.planner.robots.tilting import ElbowArm

HEIGHT, L2, L3 = 0.300, 0.250, 0.160
"""m. The source gives no lengths; these are those of `oblique-triangles`."""
TARGETS, SEED = 10_000, 6
SIGNS = {"up": (1, -1), "down": (1, 1), "back-up": (-1, 1), "back-down": (-1, -1)}
"""Working mode → the two signs that the source leaves open: of √(p_x² + p_y²), and of √(1 − cos² q3)."""
SHOWN = (0.28, 0.12)
"""The target that is drawn: distance from the base axis, height above the shoulder, m."""


def arm() -> forms.Arm:
    """The planner's arm and the source's; limits play no part."""
    wide = np.full(3, 10.0)
    robot = ElbowArm(name="elbow", height=HEIGHT, l1=L2, l2=L3, limits=Limits(-wide, wide, wide, wide, wide))

    def closed(p: FloatArray, mode: str) -> FloatArray:
        return printed.elbow_joints(p - np.array([0.0, 0.0, HEIGHT]), L2, L3, *SIGNS[mode])

    def product(q: FloatArray) -> FloatArray:
        rho = L2 * np.cos(q[..., 1]) + L3 * np.cos(q[..., 1] + q[..., 2])
        return np.asarray(-rho * L2 * L3 * np.sin(q[..., 2]))

    return forms.Arm(
        robot, np.zeros(3), closed, lambda q: printed.elbow_frames(q, HEIGHT, L2, L3), product, (False,) * 3
    )


def targets() -> FloatArray:
    """Points (TARGETS, 3) all around the base, from 1e-5 beside each singular position."""
    random = np.random.default_rng(SEED)
    near, off_axis = 10 ** random.uniform(-5, np.log10(np.pi / 2), (2, TARGETS))
    bend = np.where(random.random(TARGETS) < 0.5, near, np.pi - near)
    reach = np.sqrt(L2**2 + L3**2 + 2 * L2 * L3 * np.cos(bend))
    tilt = np.where(random.random(TARGETS) < 0.3, off_axis, random.uniform(1e-5, np.pi - 1e-5, TARGETS))
    turn = random.uniform(-np.pi, np.pi, TARGETS)
    flat = reach * np.sin(tilt)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), HEIGHT + reach * np.cos(tilt)], -1)


def run() -> Result:
    """The comparison, the singular positions, and what the arctan as printed misses."""
    both, p = arm(), targets()
    compared = forms.compare(both, p, np.random.default_rng(SEED).normal(0.0, 0.1, p.shape))
    above = p - np.array([0.0, 0.0, HEIGHT])
    off = {
        name: forms.missed(both, printed.printed_elbow_joints(above, L2, L3, *signs), p)
        for name, signs in SIGNS.items()
    }
    reach, ahead = np.linalg.norm(above, axis=-1), p[:, 0] > 0
    fold = float(np.arctan2(L3 * np.sin(1.0), L2 + L3 * np.cos(1.0)))
    numbers: dict[str, Any] = {
        **compared.numbers,
        "singular": forms.singular(
            both,
            {
                "edge outside: stretched": (0.4, 0.7, 0.0),
                "edge inside: folded": (0.4, 0.7, np.pi),
                "interior alignment: flange over the base axis": (0.4, np.pi / 2 - fold, 1.0),
            },
        ),
        "as_printed_missed_by_more_than_1_mm_share": {name: float((m > forms.SHARE).mean()) for name, m in off.items()},
        "as_printed_up_missed_where_ahead_and_bent_below_a_quarter_turn_m": float(
            off["up"][ahead & (reach > np.hypot(L2, L3))].max()
        ),
        "as_printed_missed_in_every_mode_share": float((np.min(list(off.values()), axis=0) > forms.SHARE).mean()),
    }
    return Result(numbers, report(numbers), (7.2, 6.3), lambda figure: draw(figure, both, compared))


def report(numbers: dict[str, Any]) -> str:
    """The paragraphs."""
    missed = numbers["as_printed_missed_by_more_than_1_mm_share"]["up"]
    anyhow = numbers["as_printed_missed_in_every_mode_share"]
    return paragraphs(
        "The source solves an elbow arm with three axes geometrically and leaves two signs open. It says that a "
        "Jacobian whose determinant is 0 marks a singular position, at an edge of the workspace, inner or outer, or "
        "inside it, where axes are aligned. It prints neither lengths nor a Jacobian of this arm.",
        f"Over {numbers['targets']:,} targets, in all four modes that the two signs make: the closed form, with "
        f"atan2, put through products of Denavit-Hartenberg matrices, meets its target to "
        f"{numbers['closed_form_by_transforms_off_target_m']:.0e} m. Its angles are those of the planner's two dyads "
        f"to {numbers['closed_form_minus_dyads_where_margin_above_0.05_rad_m']:.0e} rad where the margin is above "
        f"0.05, and nearer to singular positions to {numbers['closed_form_minus_dyads_times_margin_rad_m']:.0e} rad "
        f"divided by the margin, panel (c). The dyads' velocities are J⁻¹ẋ of those matrices to "
        f"{numbers['inverse_jacobian_minus_dyads_relative_where_margin_above_0.05']:.0e} (relative), and the "
        f"determinant is −ρ l2 l3 sin q3 to {numbers['determinant_by_transforms_and_by_planner_minus_product']:.0e} "
        f"m³, panel (b).",
        "It holds. The determinant is 0 at the outer edge (q3 = 0°, stretched), at the inner edge (q3 = 180°, folded), "
        "and inside, over the base axis (ρ = 0 mm, aligned): the three kinds that the source names, panel (a).",
        f"The arctan of a quotient, for which atan2 is put. Taken to the letter it misses {100 * missed:.0f} % of "
        f"these targets in mode `up`, panel (d): those behind the base, and those that bend the elbow by more than a "
        f"right angle; and {100 * anyhow:.0f} % with any choice of signs.",
    )


def draw(figure: Drawing, both: forms.Arm, compared: forms.Comparison) -> None:
    """The arm in its plane, |det J| over the plane, closed form against dyads, and what arctan as printed misses."""
    (posture, area), (errors, miss) = figure.subplots(2, 2)
    plane = Plane(HEIGHT, L2 - L3, L2 + L3, "stretched")
    plane.curves(posture, named=True)
    posture.plot([0, 0], [0, 1e3 * HEIGHT], color=INK, lw=3.5)
    target = np.array([SHOWN[0], 0.0, SHOWN[1] + HEIGHT])
    for mode, colour, style, mark, place in (("up", BLUE, "-", "o", (-6, 6)), ("down", ORANGE, "--", "s", (-2, -13))):
        frames = both.frames(both.closed(target, mode))
        line = 1e3 * np.array([frame[[0, 2], 3] for frame in frames[1:]])
        posture.plot(*line.T, style, color=colour, lw=2.2)
        posture.plot(*line[1], mark, color=colour, ms=5, mfc="w")
        posture.annotate(f"{mode}", line[1], place, ha="right", color=colour, **NOTE)
    posture.plot(*line[0], "o", color=INK, ms=5, mfc="w")
    posture.plot(*line[-1], "D", color=RED, ms=5)
    posture.annotate("target", line[-1], (2, 8), ha="center", **NOTE)
    posture.annotate("inner edge:\nfolded", (-1e3 * (L2 - L3), 1e3 * HEIGHT), (-4, 0), ha="right", va="center", **NOTE)
    posture.set_title("(a) both postures; singular curves")
    rho, h = plane.grid()
    cosine = (rho**2 + h**2 - L2**2 - L3**2) / (2 * L2 * L3)
    with np.errstate(invalid="ignore"):
        size = np.abs(rho) * L2 * L3 * np.sqrt(1 - cosine**2)
    plane.map(figure, area, 1e3 * size, r"$|\det J|$ [$10^{-3}$ m³]", lines=True)
    area.set_title(r"(b) $|\det J| = |\rho\,l_2\,l_3\,\sin q_3|$")
    comparison(errors, compared.margin, compared.apart, 4, grows=True)
    errors.set_xlabel(r"margin: lesser of $|\sin q_3|$ and $|\rho|/(l_2+l_3)$")
    errors.set_ylabel("closed form − dyads [rad]")
    errors.set_title("(c) joint angles, mended")
    above, shoulder = np.stack([rho, np.zeros_like(rho), h], -1), np.array([0.0, 0.0, HEIGHT])
    off = forms.missed(both, printed.printed_elbow_joints(above, L2, L3, *SIGNS["up"]), above + shoulder)
    plane.map(figure, miss, np.where(off > forms.SHARE, 1e3 * off, np.nan), "target missed by [mm]", lines=False)
    plane.regions(miss, off <= forms.SHARE)
    met = 1e3 * (np.hypot(L2, L3) + L2 + L3) / 2
    for words, at in (("met", (met, 1e3 * HEIGHT)), ("out of\nreach", (0.0, 1e3 * HEIGHT))):
        miss.annotate(words, at, (0, 0), ha="center", va="center", **NOTE)
    miss.annotate("out of reach", (400, 1e3 * HEIGHT + 380), (0, 0), ha="right", **NOTE)
    miss.set_title("(d) as printed, with arctan; mode up")

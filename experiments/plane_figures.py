"""The vertical plane of an arm with tilting links, drawn: its workspace with the singular curves, and maps over it.

Lengths come in m and are drawn in mm; heights come from the shoulder and are drawn from the floor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from assur.experiments.experiment import Drawing
from assur.experiments.figures import BLUE, GREY, INK, SKY
from assur.planner.arrays import FloatArray

COLOURS = "cividis"
"""Of maps: even in lightness, and the same for the colour-blind."""
MANY = 301
"""Points of a map's grid to each side."""
MET, OUT_OF_REACH = "#b9e3d3", "#e6e6e6"
"""Of a map's places that have no value."""
NOTE = {"textcoords": "offset points", "fontsize": 7}


@dataclass(frozen=True, slots=True)
class Plane:
    """The ring that the flange reaches around a shoulder at `height`, from `inner` to `outer`, m; `ends`: what it is at
    its outer edge."""

    height: float
    inner: float
    outer: float
    ends: str

    def grid(self) -> tuple[FloatArray, FloatArray]:
        """Distances from the base axis and heights above the shoulder (MANY, MANY), m."""
        line = 1.02 * self.outer * np.linspace(-1, 1, MANY)
        rho, h = np.meshgrid(line, line)
        return rho, h

    def curves(self, axes: Drawing, *, named: bool) -> None:
        """The outer edge, the inner edge (a point, if it has no radius) and the base axis."""
        around = np.linspace(0, 2 * np.pi, 361)
        x, y, high, far = 1e3 * np.cos(around), 1e3 * np.sin(around), 1e3 * self.height, 1e3 * self.outer
        if named:
            axes.fill(self.outer * x, self.outer * y + high, color=SKY, alpha=0.15, lw=0)
            axes.fill(self.inner * x, self.inner * y + high, color="w", lw=0)
        axes.plot(self.outer * x, self.outer * y + high, color=INK, lw=1.0)
        axes.plot(self.inner * x, self.inner * y + high, color=INK, lw=1.0, ls="--")
        axes.plot([0, 0], [high - 1.08 * far, high + 1.08 * far], color=GREY, lw=1.2, ls="-.")
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlim(-1.12 * far, 1.12 * far)
        axes.set_ylim(high - 1.12 * far, high + 1.12 * far)
        axes.set_xlabel("distance from the base axis [mm]")
        axes.set_ylabel("height [mm]")
        if named:
            corner = far / np.sqrt(2)
            axes.annotate(
                f"outer edge:\n{self.ends}", (-corner, high + corner), (8, -8), ha="left", va="center", **NOTE
            )
            axes.annotate("base axis: aligned", (0, high - 1.04 * far), (5, 0), va="center", **NOTE)

    def map(self, figure: Drawing, axes: Drawing, values: FloatArray, label: str, *, lines: bool) -> None:
        """Values (MANY, MANY) of the grid in colours, NaN left white; `lines`: a quarter, half, three quarters of the
        largest, each with its value."""
        rho, h = self.grid()
        x, y = 1e3 * rho, 1e3 * (h + self.height)
        shown = axes.pcolormesh(x, y, values, cmap=COLOURS, vmin=0.0, shading="auto", rasterized=True)
        if lines:
            levels = float(np.nanmax(values)) * np.array([0.25, 0.5, 0.75])
            drawn = axes.contour(x, y, np.nan_to_num(values), levels=levels, colors="w", linewidths=0.6)
            level = values[MANY // 2, MANY // 2 :]  # to the right, at the height of the shoulder
            outward = [int(np.flatnonzero(level >= least)[0]) + MANY // 2 for least in levels]
            places = [(side * x[MANY // 2, k], 1e3 * self.height) for k in outward for side in (-1, 1)]
            axes.clabel(drawn, fmt="%.2g", fontsize=6, manual=places)
        bar = figure.colorbar(shown, ax=axes, shrink=0.85, pad=0.02)
        bar.set_label(label)
        bar.outline.set_linewidth(0.5)
        axes.grid(visible=False)
        self.curves(axes, named=False)

    def regions(self, axes: Drawing, met: Any) -> None:
        """What a map leaves blank: places (MANY, MANY) where a target is `met`, green, and what is out of reach, "
        "grey."""
        rho, h = self.grid()
        axes.set_facecolor(OUT_OF_REACH)
        x, y = 1e3 * rho, 1e3 * (h + self.height)
        axes.contourf(x, y, np.asarray(met, dtype=np.float64), levels=[0.5, 1.5], colors=[MET])


def compared(axes: Drawing, margin: FloatArray, apart: FloatArray, modes: int, *, grows: bool) -> None:
    """Differences of closed form and dyads against the margin, with what rounding gives: 2e-15, over the margin where
    the closed form's errors grow (`grows`)."""
    guide = np.array([margin.min(), 1.0])
    dots = f"target, worst of {modes} modes\n(0 drawn at $10^{{-17}}$)"
    axes.loglog(margin, np.maximum(apart, 1e-17), ".", ms=1.5, color=BLUE, rasterized=True, label=dots)
    label = r"$2\cdot10^{-15}$" + ("/margin" if grows else "")
    axes.loglog(guide, 2e-15 / guide if grows else [2e-15, 2e-15], color=INK, ls="--", lw=0.9, label=label)
    axes.set_ylim(3e-18, 2e-8 if grows else 2e-13)
    axes.legend(loc="upper right", markerscale=4)

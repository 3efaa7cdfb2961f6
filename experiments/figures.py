"""The one style of all figures, and the only module that imports matplotlib (the extra `plot`) to run."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from assur.experiments.experiment import Drawing
from assur.planner.errors import FaultError, InputError

BLUE, ORANGE, GREEN, RED, PURPLE, SKY, INK, GREY = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#d55e00",
    "#cc79a7",
    "#56b4e9",
    "#222222",
    "#888888",
)
"""Colours that stay apart for the colour-blind (Okabe and Ito), ink and grey."""

PNG_DPI = 200
"""Dots per inch of the PNG: a figure of 7 inches fills a page at print quality."""

EDGE_IN = 0.02
"""Inches by which what is drawn may leave the page: boxes of text are a hair larger than their ink."""

STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same figure on every machine
    "font.size": 8,
    "mathtext.fontset": "dejavusans",
    "axes.titlesize": 8,
    "axes.titlelocation": "left",
    "axes.titlepad": 5,
    "axes.labelsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.5,
    "legend.fontsize": 7,
    "legend.frameon": True,
    "legend.framealpha": 0.9,
    "legend.edgecolor": "#cccccc",
    "legend.fancybox": False,
    "lines.linewidth": 1.3,
    "lines.markersize": 4,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "figure.constrained_layout.use": True,
    "svg.hashsalt": "assur",  # names inside the file do not change from run to run
}


def write(draw: Callable[[Drawing], None], size: tuple[float, float], stem: Path) -> list[Path]:
    """Draw on a new figure of `size` inches and write it as `stem`.png and `stem`.svg; the paths.

    The same figure gives the same bytes: no date is written. Raises `InputError` where matplotlib is not installed.
    """
    paths = [stem.with_name(f"{stem.name}.{kind}") for kind in ("png", "svg")]
    write_to(draw, size, paths)
    return paths


def write_to(draw: Callable[[Drawing], None], size: tuple[float, float], paths: list[Path]) -> None:
    """As `write`, into files that end in .png or .svg."""
    try:
        import matplotlib as mpl
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        raise InputError("matplotlib", "not installed", "an installation with the extra `plot`") from error
    with mpl.rc_context():
        mpl.rcdefaults()
        parameters: Any = mpl.rcParams
        parameters.update(STYLE)
        figure = Figure(figsize=size)
        FigureCanvasAgg(figure)
        draw(figure)
        _whole(figure, size)
        for path in paths:
            if path.suffix.lower() == ".svg":
                figure.savefig(path, metadata={"Date": None})
            else:
                figure.savefig(path, dpi=PNG_DPI)


def _whole(figure: Drawing, size: tuple[float, float]) -> None:
    """Raises `FaultError` if a title, label or legend of the figure leaves the page and would be cut off."""
    figure.draw_without_rendering()
    box = figure.get_tightbbox()
    beyond = max(-box.x0, -box.y0, box.x1 - size[0], box.y1 - size[1])
    if not beyond <= EDGE_IN:
        raise FaultError(f"a figure leaves its page by {beyond:.2f} inches")


def plan_view(axes: Drawing) -> None:
    """Axes of a plane of the workspace in mm: equal scales."""
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")

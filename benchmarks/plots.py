"""The plots of the benchmark: solved over time, duration over budget, scaling. PNG and SVG, drawn from the results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from assur.experiments.experiment import Drawing
from assur.experiments.figures import BLUE, GREEN, GREY, ORANGE, RED, write

Document = dict[str, Any]
Results = Mapping[str, Document]

SETS = {
    "static": BLUE,
    "moving bodies": ORANGE,
    "moving goal": GREEN,
    "moving goal, velocity": RED,
}
PEERS = {"OMPL RRTConnect": GREY, "MPlib": "#bbbbbb"}
KINDS = {"via": BLUE, "move": ORANGE, "pick": GREEN}


def draw(results: Results, folder: Path) -> list[Path]:
    """Every plot for which there is a result; the files."""
    drawn: list[Path] = []
    wanted: tuple[tuple[str, str, tuple[float, float], Callable[[Drawing, Results], None]], ...] = (
        ("solved", "sets", (7.2, 3.0), solved),
        ("duration", "durations", (3.6, 3.0), duration),
        ("scaling", "scaling", (7.2, 3.0), scaling),
    )
    for name, section, size, plot in wanted:
        if section in results and _has_data(section, results[section]):
            folder.mkdir(parents=True, exist_ok=True)
            drawn += write(lambda figure, plot=plot: plot(figure, results), size, folder / name)  # type: ignore[misc]
    return drawn


def _has_data(section: str, document: Document) -> bool:
    data = document["data"]
    if section == "durations":
        return any(point["median"] for curve in data["curve"].values() for point in curve.values())
    return any(data["sets"].values()) if section == "sets" else any(data.values())


def solved(figure: Drawing, results: Results) -> None:
    """Share of problems solved by a time, with adaptivity and without; the peers beside it."""
    left, right = figure.subplots(1, 2, sharey=True)
    data = results["sets"]["data"]["sets"]
    for title, colour in SETS.items():
        for learning, style in (("adaptive", "-"), ("not adaptive", ":")):
            rows = data.get(f"{title}/{learning}", [])
            if rows:
                label = title if learning == "adaptive" else None
                _steps(left, [row[1] for row in rows if row[1] is not None], len(rows), colour, style, label)
    left.set_title("(a) ours; dotted: adaptivity off")
    left.set_ylabel("solved [%]")
    rows_of_peers = results.get("peers", {}).get("data", {}).get("peers", {})
    for title, colour in {"ours": BLUE, **PEERS}.items():
        row = rows_of_peers.get(title)
        if row and not row["missing"] and row["first_s"]:
            _steps(right, [second for _, second in row["first_s"]], row["problems"], colour, "-", title)
    right.set_title("(b) static, beside the peers, free when rechecked")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_xlim(1.5e-3, 1.2)
        axes.set_ylim(0, 102)
        axes.set_xlabel("time from the request [s]")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="lower right" if axes is left else "upper left")


def _steps(axes: Drawing, seconds: list[float], total: int, colour: str, style: str, label: str | None) -> None:
    at = sorted(seconds)
    shares = [100 * (i + 1) / total for i in range(len(at))]
    axes.step(
        [1e-4, *at, 10.0], [0.0, *shares, shares[-1] if shares else 0.0], style, where="post", color=colour, label=label
    )


def duration(figure: Drawing, results: Results) -> None:
    """Duration over the best known, by budget."""
    axes = figure.subplots()
    for title, colour in SETS.items():
        curve = results["durations"]["data"]["curve"].get(title, {})
        points = [(float(budget), row["median"], row["p95"]) for budget, row in curve.items() if row["median"]]
        if points:
            budgets, medians, tails = zip(*points, strict=True)
            axes.plot(budgets, medians, "o-", color=colour, label=title)
            axes.plot(budgets, tails, "o:", color=colour, lw=0.8, ms=2)
    axes.set_xscale("log")
    axes.set_xlabel("budget [s]")
    axes.set_ylabel("duration over the best known")
    axes.set_title("same problems throughout; dotted: 95 %")
    axes.legend(loc="upper right")


def scaling(figure: Drawing, results: Results) -> None:
    """Planning and building over bodies; planning over control points."""
    left, right = figure.subplots(1, 2)
    data = results["scaling"]["data"]
    bodies = data.get("bodies", {})
    for key, colour, label in (("plan_ms", BLUE, "planning, on a built scene"), ("build_ms", ORANGE, "building")):
        if bodies:
            left.loglog(
                [int(n) for n in bodies], [row[key] for row in bodies.values()], "o-", color=colour, label=label
            )
            left.legend(loc="upper left")
    left.set_xlabel("bodies in the cell, same density")
    for kind, colour in KINDS.items():
        rows = data.get(kind, {})
        if rows:
            right.plot(
                [int(n) for n in rows], [row["plan_ms"] for row in rows.values()], "o-", color=colour, label=kind
            )
            right.legend(loc="upper left")
    right.set_xlabel("control points")
    right.set_ylim(bottom=0)
    for axes in (left, right):
        axes.set_ylabel("median time [ms]")
    left.set_title("(a) one control point")
    right.set_title("(b) one cell")

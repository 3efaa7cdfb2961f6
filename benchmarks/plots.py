"""The plots of the benchmark, drawn from the results: solved over time, duration over budget, bodies. PNG and SVG."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from assur.experiments.experiment import Drawing
from assur.experiments.figures import BLUE, GREEN, GREY, ORANGE, RED, write
from benchmarks.durations import curve
from benchmarks.figures import Records
from benchmarks.first_answer import OURS
from benchmarks.judged import SETS, label
from benchmarks.scaling import building, median_s, searching
from benchmarks.side_by_side import TITLES as PEERS
from benchmarks.side_by_side import of, solved

TITLES = {
    "first_answer": "Solved over time",
    "durations": "Duration over budget",
    "scaling": "Planning time over the number of bodies",
}
"""Of the plots, by the scripts whose results they show."""
COLOURS = dict(zip((label(*pair) for pair in SETS), (BLUE, ORANGE, GREEN, RED), strict=True))


def draw(results: Mapping[str, Records], folder: Path) -> list[Path]:
    """Every plot for which there is a result; the files."""
    drawn: list[Path] = []
    folder.mkdir(parents=True, exist_ok=True)
    if "first_answer" in results:
        size = (7.2, 3.0) if "side_by_side" in results else (3.6, 3.0)
        drawn += write(lambda figure: solving(figure, results), size, folder / "first_answer")
    if "durations" in results:
        drawn += write(lambda figure: duration(figure, results["durations"]), (3.6, 3.0), folder / "durations")
    if "scaling" in results:
        drawn += write(lambda figure: scaling(figure, results["scaling"]), (3.6, 3.0), folder / "scaling")
    return drawn


def solving(figure: Drawing, results: Mapping[str, Records]) -> None:
    """Share of problems solved by a time, all seeds pooled; the peers, too, where they were measured."""
    peers = results.get("side_by_side", {})
    left, *right = figure.subplots(1, 2 if peers else 1, sharey=True, squeeze=False)[0]
    for title, colour in COLOURS.items():
        rows = [r for item, r in results["first_answer"].items() if item.startswith(f"{OURS}/{title}/")]
        _steps(left, [row["first_s"] for row in rows if row["status"] == "planned"], len(rows), colour, title)
    left.set_title("(a) ours")
    left.set_ylabel("solved [%]")
    for beside in right:
        for title, colour in zip(("ours", *PEERS.values()), (BLUE, GREY, "#bbbbbb"), strict=True):
            peer = list(of(peers, title).values())
            _steps(beside, [row["first_s"] for row in peer if solved(row)], len(peer), colour, title)
        beside.set_title("(b) static, beside the peers, free when rechecked")
    for axes in (left, *right):
        axes.set_xscale("log")
        axes.set_xlim(3e-4, 1.2)
        axes.set_ylim(0, 102)
        axes.set_xlabel("time from the request [s]")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(loc="lower right")


def _steps(axes: Drawing, seconds: list[float], total: int, colour: str, title: str) -> None:
    if seconds:
        shares = [100 * (i + 1) / total for i in range(len(seconds))]
        axes.step([1e-5, *sorted(seconds), 10.0], [0.0, *shares, shares[-1]], where="post", color=colour, label=title)


def duration(figure: Drawing, records: Records) -> None:
    """Duration over the best known, by budget."""
    axes = figure.subplots()
    for title, colour in COLOURS.items():
        points = [point for point in curve(records, title) if point[1] is not None]
        if points:
            budgets, middle, tails = zip(*points, strict=True)
            axes.plot(budgets, middle, "o-", color=colour, label=title)
            axes.plot(budgets, tails, "o:", color=colour, lw=0.8, ms=2)
            axes.legend(loc="upper right")
    axes.set_xscale("log")
    axes.set_xlabel("budget [s]")
    axes.set_ylabel("duration over the best known")
    axes.set_title("same problems throughout; dotted: 95 %")


def scaling(figure: Drawing, records: Records) -> None:
    """Planning and building over the number of bodies."""
    axes = figure.subplots()
    sizes = sorted({int(item.split("/")[1]) for item in records if item.startswith("distant/")})
    for time_of, colour, title in ((searching, BLUE, "planning, on a built scene"), (building, ORANGE, "building")):
        times = [1e3 * median_s(records, "distant", size, time_of) for size in sizes]
        axes.loglog(sizes, times, "o-", color=colour, label=title)
    axes.set_xlabel("bodies in the cell, same density")
    axes.set_ylabel("median time [ms]")
    axes.legend(loc="upper left")

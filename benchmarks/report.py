"""``python -m benchmarks.report``: tables and plots of docs/benchmarks.md, from `benchmarks/results`.

The page has them between comments that name the block; the rest of the page is not changed. If there is no result yet,
the page states that.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from benchmarks.figures import FOLDER, Document, Figure, read
from benchmarks.judged import SETS, label
from benchmarks.machine import ROOT
from benchmarks.plots import TITLES, draw

PLOTS = ROOT / "docs" / "plots"
SCRIPTS = (
    "first_answer",
    "durations",
    "demo_cycle",
    "session",
    "session_cycle",
    "kept_cell",
    "scaling",
    "legs",
    "service",
    "side_by_side",
)
"""In the order in which `make bench` runs them."""
PAGE = ROOT / "docs" / "benchmarks.md"
MARKED = re.compile(r"(<!-- benchmark: ([a-z-]+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
ORDER = f"Sets in the order {' / '.join(label(*pair) for pair in SETS)}."
NOTHING = "Not measured yet: `make bench` measures, and fills what is empty here."
SHOWN = 12
"""Rooms of a profile that are shown."""

Results = Mapping[str, tuple[Document, dict[str, Document], list[Figure]]]
"""Script → head, records and figures."""


def results(folder: Path = FOLDER) -> Results:
    """The results that are in a folder, in the order in which the scripts run."""
    return {name: read(folder / f"{name}.jsonl") for name in SCRIPTS if (folder / f"{name}.jsonl").exists()}


def table(there: Results, with_bar: bool) -> str:
    """The figures that have a bar, or those that have none."""
    figures: list[Figure] = []
    for script, (_, _, found) in there.items():
        for each in found:
            # counts that every script has are reported for each one
            counted = each.bar == (0.0,)
            if bool(each.bar) is with_bar:
                figures.append(replace(each, name=f"{each.name} ({script})") if counted else each)
    if not figures:
        return NOTHING
    rows = [ORDER, "", "| figure | bar | reached | met | |", "|---|---|---|---|---|"]
    if not with_bar:
        rows = [ORDER, "", "| figure | value | |", "|---|---|---|"]
    for each in figures:
        notes = "; ".join(filter(None, (each.refused and f"refused: {each.refused}", each.beside, each.note)))
        bar = f" {each.required()} | {each.reached()} | {each.met()}" if with_bar else f" {each.reached()}"
        rows.append(f"| {each.name} |{bar} | {notes} |")
    return "\n".join(rows)


def conditions(there: Results) -> str:
    """Where and when each script measured."""
    rows = ["| script | date | commit | processor | cores | Python | NumPy |", "|---|---|---|---|---|---|---|"]
    for name, (head, _, _) in there.items():
        machine = head["machine"]
        commit = (head["commit"] or "none")[:10] + (" and changes" if head["changed"] else "")
        versions = f"{machine['python']} | {machine['libraries'].get('numpy', '?')}"
        rows.append(f"| {name} | {head['date']} | {commit} | {machine['cpu']} | {machine['cores']} | {versions} |")
    return "\n".join(rows) if there else ""


def profile(path: Path = FOLDER / "profile.jsonl") -> str:
    """Where the milliseconds of median requests go, a table for each profile."""
    if not path.exists():
        return NOTHING
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines():
        made: Any = json.loads(line)
        rooms = ", ".join(f"{room} {value:.2f}" for room, value in list(made["own_ms"].items())[:SHOWN])
        rows.append(f"| {made['profile']} | {made['total_ms']:.2f} | {rooms} |")
    return "\n".join(["| set | all, ms | rooms, ms |", "|---|---|---|", *rows])


def plots(there: Results) -> str:
    """The existing plots, as links."""
    found = [f"![{title}](plots/{name}.svg)" for name, title in TITLES.items() if name in there]
    return "\n\n".join(found)


BLOCKS: Mapping[str, Callable[[Results], str]] = {
    "bars": lambda there: table(there, True),
    "others": lambda there: table(there, False),
    "conditions": conditions,
    "profile": lambda _: profile(),
    "plots": plots,
}


def filled(page: str, there: Results) -> str:
    """A page with its blocks filled from the results. `KeyError` for an unknown block."""
    return MARKED.sub(lambda found: f"{found[1]}\n{BLOCKS[found[2]](there)}\n\n{found[4]}", page)


def main(
    folder: Annotated[Path, typer.Option("--results", help="Folder of the results.")] = FOLDER,
    page: Annotated[bool, typer.Option(help="Fill the page, too.")] = True,
    plots_to: Annotated[Path, typer.Option("--plots", help="Folder of the plots.")] = PLOTS,
) -> None:
    """Draw the plots and fill the page."""
    there = results(folder)
    drawn = draw({name: records for name, (_, records, _) in there.items()}, plots_to)
    if page:
        PAGE.write_text(filled(PAGE.read_text(encoding="utf-8"), there), encoding="utf-8")
    Console().print(f"{len(there)} results, {len(drawn)} plots")


if __name__ == "__main__":
    typer.run(main)

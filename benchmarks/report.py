"""``python -m benchmarks.report``: tables and plots of README and docs/benchmarks.md, from `benchmarks/results`.

A page holds them between comments that name what stands there; everything else on it is left as it is. Where a section
has no result yet, the page says so.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from benchmarks.bars import BARS, ORDER, lines, refused
from benchmarks.judged import SETS, label
from benchmarks.machine import ROOT

RESULTS = ROOT / "benchmarks" / "results"
PROFILES = "profile"
"""Results of `benchmarks.profile` begin with this; they are no sections."""
TAGS = ("before", "", "after")
"""Of profiles that are shown beside each other."""
PLOTS = ROOT / "docs" / "plots"
PAGES = (ROOT / "README.md", ROOT / "docs" / "benchmarks.md")
MARKED = re.compile(r"(<!-- benchmark: ([a-z-]+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)
TITLES = {
    "solved": "Solved over time",
    "duration": "Duration over budget",
    "scaling": "Planning time over the size of the cell and the task",
}
"""Of the plots."""
NOTHING = "Not measured yet."
"""In place of a table; blocks that would only repeat it are empty."""
NO_RESULTS = "No results are in the repository yet: `make bench` measures them, and fills what is empty here."

Document = dict[str, Any]
Results = Mapping[str, Document]


def results(folder: Path = RESULTS) -> dict[str, Document]:
    """Section → document, for all that are in a folder."""
    found = {}
    for path in sorted(folder.glob("*.json")):
        document = json.loads(path.read_text(encoding="utf-8"))
        if document.get("schema") == "assur-benchmark/1":
            found[path.stem] = document
    return found


def sections(there: Results) -> dict[str, Document]:
    """Without the profiles."""
    return {name: document for name, document in there.items() if not name.startswith(PROFILES)}


def bars(there: Results) -> str:
    """The table of the bars; without a result, only the bars."""
    if not sections(there):
        rows = [NO_RESULTS, "", f"Sets in the order {ORDER}.", "", "| figure | bar |", "|---|---|"]
        return "\n".join([*rows, *(f"| {line.title} | {line.bar} |" for line in lines({}) if line.bar)])
    rows = [f"Sets in the order {ORDER}.", "", "| figure | bar | reached | met |", "|---|---|---|---|"]
    rows += [f"| {line.title} | {line.bar} | {line.reached} | {line.met} |" for line in lines(sections(there))]
    return "\n".join(rows)


def conditions(there: Results) -> str:
    """Where and when each section was measured."""
    if not sections(there):
        return ""
    rows = ["| section | date | commit | processor | cores | Python | NumPy |", "|---|---|---|---|---|---|---|"]
    for name, document in sections(there).items():
        machine = document["machine"]
        commit = (document["commit"] or "none")[:10] + (" and changes" if document["changed"] else "")
        python, numpy = machine["python"], machine["libraries"].get("numpy", "?")
        sample = f"{name} (a sample)" if document["sample"] else name
        rows.append(
            f"| {sample} | {document['date']} | {commit} | {machine['cpu']} | {machine['cores']} | {python} | {numpy} |"
        )
    return "\n".join(rows)


PEER_COLUMNS = (
    *("planner", "version", "solved", "collide", "all limits kept"),
    *("to a path, median", "to a trajectory, median / 95 %", "duration, median"),
)


def peers(there: Results) -> str:
    """Ours and the peers."""
    if "peers" not in there:
        return NOTHING
    rows = [f"| {' | '.join(PEER_COLUMNS)} |", "|---" * len(PEER_COLUMNS) + "|"]
    figures = {figure["name"]: figure for figure in there["peers"]["figures"]}
    for title, row in there["peers"]["data"]["peers"].items():
        version = row["version"] or ""
        if row["missing"]:
            rows.append(f"| {title} | {version} | missing: {row['missing']} | | | | | |")
            continue
        times = [figures[f"{title}: time to a trajectory, {part}"] for part in ("median", "95 %")]
        told = " / ".join("refused" if one["value"] is None else f"{one['value']:.1f}" for one in times)
        path = "" if row["path_s"] is None else f"{1e3 * row['path_s']:.1f} ms"
        duration = "" if row["duration_s"] is None else f"{row['duration_s']:.3f} s"
        rows.append(
            f"| {title} | {version} | {row['solved']} of {row['problems']} | {row['collide']} of {row['answered']} "
            f"| {row['all_limits']} | {path} | {told} ms | {duration} |"
        )
    return "\n".join(rows)


def others(there: Results) -> str:
    """Every figure that stands in no bar, and every one that has a note; the peers' are in their own table."""
    shown = {name for bar in BARS for name in bar.figures}
    rows = ["| figure | value | |", "|---|---|---|"]
    for name in ("sets", "durations", "dyad", "legs", "scaling", "service"):
        for figure in there.get(name, {}).get("figures", []):
            if figure["name"] not in shown or figure["note"]:
                value = "refused" if figure["value"] is None else f"{figure['value']:.3g} {figure['unit']}".strip()
                rows.append(f"| {figure['name']} | {value} | {figure['refused'] or figure['note']} |")
    return "\n".join(rows) if len(rows) > 2 else NOTHING


def profile(there: Results) -> str:
    """Where a millisecond goes, by the profiles of whole sets: one of a sample is not published."""
    whole = {name: there[name] for name in there if name.startswith(PROFILES) and not there[name]["sample"]}
    return columns(whole)


def columns(there: Results) -> str:
    """Where a millisecond goes, a column for each profile."""
    names = sorted((name for name in there if name.startswith(PROFILES)), key=_place)
    found = {name: there[name] for name in names}
    if not found:
        return NOTHING
    stages = list(dict.fromkeys(stage for document in found.values() for stage in document["data"]["stages_ms"]))
    head = [name.removeprefix(PROFILES).strip("-_").replace("_", " ").replace("-", " ") for name in found]
    rows = ["| stage, ms | " + " | ".join(head) + " |", "|---|" + "---|" * len(found)]
    for stage in stages:
        values = [document["data"]["stages_ms"].get(stage) for document in found.values()]
        rows.append(f"| {stage} | " + " | ".join("" if v is None else f"{v:.2f}" for v in values) + " |")
    totals = [document["data"]["total_ms"] for document in found.values()]
    rows.append("| **all** | " + " | ".join(f"**{total:.2f}**" for total in totals) + " |")
    commits = [(document.get("commit") or "none")[:7] for document in found.values()]
    rows.append("| commit | " + " | ".join(commits) + " |")
    return "\n".join(rows)


def _place(name: str) -> tuple[int, int]:
    """Of a profile in the table: in the order of the sets, and what was before first."""
    tag = next((tag for tag in TAGS if tag and name.endswith(f"-{tag}")), "")
    known = [label(*pair).replace(", ", " ").replace(" ", "-") for pair in SETS]
    stem = name.removeprefix(f"{PROFILES}-").removesuffix(f"-{tag}")
    return known.index(stem) if stem in known else len(known), TAGS.index(tag)


def refusals(there: Results) -> str:
    """What was refused, and why."""
    found = refused(sections(there))
    if not there:
        return ""
    listed = "\n".join(f"- {text}" for text in found) if found else "None: every answer behind a figure was clean."
    return f"Refused figures:\n\n{listed}"


def plots(there: Results, folder: str = "plots") -> str:
    """The plots that are there, as links into `folder`."""
    found = [f"![{title}]({folder}/{name}.svg)" for name, title in TITLES.items() if (PLOTS / f"{name}.svg").exists()]
    return "\n\n".join(found) if there and found else ""


BLOCKS: Mapping[str, Callable[[Results], str]] = {
    "bars": bars,
    "conditions": conditions,
    "peers": peers,
    "others": others,
    "profile": profile,
    "refusals": refusals,
    "plots": plots,
    "readme-bars": lambda there: bars(there) if sections(there) else NO_RESULTS,
    "readme-plots": lambda there: plots(there, "docs/plots"),
}


def printed(title: str, markdown: str) -> Table:
    """A table of a page as it is printed on a terminal."""
    lines_of_it = markdown.replace("**", "").splitlines()
    head, _, *rows = ([cell.strip() for cell in row.strip("|").split("|")] for row in lines_of_it)
    shown = Table(*head, title=title)
    for row in rows:
        shown.add_row(*row)
    return shown


def filled(page: str, there: Results) -> str:
    """A page with its blocks as the results are. `KeyError` for a block that nobody makes."""
    return MARKED.sub(lambda found: f"{found[1]}\n{BLOCKS[found[2]](there)}\n\n{found[4]}", page)


def main(
    folder: Annotated[Path, typer.Option("--results", help="Folder of the results.")] = RESULTS,
    pages: Annotated[bool, typer.Option(help="Fill the pages, too.")] = True,
    plots_to: Annotated[Path, typer.Option("--plots", help="Folder of the plots.")] = PLOTS,
) -> None:
    """Draw the plots and fill the pages."""
    from benchmarks.plots import draw

    there = results(folder)
    drawn = draw(sections(there), plots_to)
    if pages:
        for page in PAGES:
            page.write_text(filled(page.read_text(encoding="utf-8"), there), encoding="utf-8")
    Console().print(f"{len(there)} results, {len(drawn)} plots, {len(PAGES) if pages else 0} pages")


if __name__ == "__main__":
    typer.run(main)

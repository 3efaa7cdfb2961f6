"""The table of docs/how-it-is-tested.md, between its comments, from results in JSON."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.machine import ROOT
from benchmarks.soak_service.row import Row

PAGE = ROOT / "docs" / "how-it-is-tested.md"
KEPT = ROOT / "benchmarks" / "results" / "soak_service.json"
"""The results that the page shows."""
BUSY = 3.0
"""Above this load at its begin a row says so: others had the processors, too."""
MARKED = re.compile(r"(<!-- soak of the service -->\n)(.*?)(<!-- end -->)", re.DOTALL)
NOTHING = "Not measured yet: `make soak-service` measures, and fills what is empty here.\n"

Results = Mapping[str, Any]
"""What a file of results holds: `machine`, and `rows` by name."""


def read(path: Path) -> dict[str, Any]:
    """The results in a file; without rows where there is no file."""
    if not path.exists():
        return {"machine": None, "rows": {}}
    document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return document


def table(rows: Sequence[Row], results: Results) -> str:
    """Head and table: each row with its bar, its result, and the verdict."""
    found = results["rows"]
    if not found:
        return NOTHING
    lines = [_head(rows, results), "", "| figure | first measured | bar | found | verdict |", "|---|---|---|---|---|"]
    for row in rows:
        result = found.get(row.name)
        cells = [row.title, row.before, row.bar, _cell(result), _verdict(result)]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def _head(rows: Sequence[Row], results: Results) -> str:
    """Date, commit and machine of the measurement, and how many rows are met."""
    found = results["rows"]
    commits = sorted(
        {f"{each['commit'] or 'no commit'}"[:10] + ("*" if each["changed"] else "") for each in found.values()}
    )
    dates = sorted({each["date"] for each in found.values()})
    machine = results["machine"] or {}
    counts = {name: sum(each["verdict"] == name for each in found.values()) for name in ("met", "not met", "in part")}
    days = " to ".join(dict.fromkeys((dates[0], dates[-1])))
    where = f"{machine.get('cpu')}, {machine.get('cores')} cores, Python {machine.get('python')}"
    head = (
        f"Measured {days} at {', '.join(commits)} on {where}. Of {len(rows)} rows {counts['met']} are met, "
        f"{counts['in part']} in part, {counts['not met']} not; {len(rows) - sum(counts.values())} were not measured."
    )
    if any(name.endswith("*") for name in commits):
        head += " `*`: with changes that were not committed."
    return head


def _cell(result: Mapping[str, Any] | None) -> str:
    if result is None:
        return "not run"
    notes = ["short form"] if result["short"] else []
    notes += [f"load {result['load']:.0f}"] if result["load"] > BUSY else []
    return str(result["told"]) + (f" ({', '.join(notes)})" if notes else "")


def _verdict(result: Mapping[str, Any] | None) -> str:
    if result is None:
        return "not run"
    if result["verdict"] in ("not there", "met"):
        return str(result["verdict"])
    shown = "; ".join(result["reasons"][:3])
    more = len(result["reasons"]) - 3
    return f"{result['verdict']}: {shown}" + (f"; and {more} more" if more > 0 else "")


def filled(page: str, text: str) -> str:
    """The page with `text` between its comments. Raises `ValueError` where it has none, or several."""
    new, times = MARKED.subn(lambda match: f"{match.group(1)}\n{text}\n{match.group(3)}", page)
    if times != 1:
        raise ValueError(f"the page has {times} places for the table, and must have one")
    return new

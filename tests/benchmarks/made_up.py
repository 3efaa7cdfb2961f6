"""Results and records that nobody measured: every section with figures of a known value."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmarks.best_known import write
from benchmarks.section import Item, Summary
from benchmarks.sections import durations, dyad, legs, scaling, service, sets, side_by_side

Document = dict[str, Any]


def line(first_s: float | None = 0.002, duration_s: float = 0.5, findings: list[str] | None = None) -> Document:
    """A judged line."""
    planned = first_s is not None
    return {
        "status": "planned" if planned else "not_planned",
        "first_s": first_s,
        "proved_s": first_s,
        "elapsed_s": first_s or 1.0,
        "duration_s": duration_s if planned else None,
        "reason": None,
        "findings": findings or [],
        "answers": int(planned),
    }


def records(name: str, parameters: Document, items: list[Item]) -> dict[str, Document]:
    """A record for each item of a section, all alike."""
    made: dict[str, Document] = {
        "sets": line(),
        "durations": line(),
        "dyad": {"ns": {}, "findings": []},
        "legs": {
            "reference_s": 0.5,
            "findings": [],
            "answers": 2,
            "first": {"duration_s": 0.6, "elapsed_s": 0.01},
            "budget": {"duration_s": 0.55, "elapsed_s": 0.2},
            "toppra": {"status": "planned", "duration_s": 0.4, "elapsed_s": 0.004, "findings": [], "version": "0"},
        },
        "peers": {
            "assur": line(),
            "findings": [],
            "answers": 1,
            "versions": {"ompl": "2"},
            "ompl": {
                "status": "planned",
                "first_s": 0.07,
                "path_s": 0.01,
                "duration_s": 0.6,
                "fatal": [],
                "limits": [],
            },
            "mplib": {"status": "missing", "reason": "no wheel", "fatal": [], "limits": []},
        },
    }
    if name == "dyad":
        row = {"ours": 20.0, "printed": 80.0, "relative": 90.0, "natural": 300.0}
        made["dyad"]["ns"] = {str(block): row for block in parameters["blocks"]}
    if name in made:
        return {item.name: made[name] for item in items}
    if name == "scaling":

        def sizes(item: Item) -> Document:
            counts = parameters["bodies" if item.name.startswith("bodies") else "points"]
            return {str(n): {"build_s": [1e-4 * n], "plan_s": [1e-2 + 1e-5 * n]} for n in counts}

        return {item.name: {"findings": [], "sizes": sizes(item)} for item in items}
    return {
        item.name: {"trip_s": 0.012, "planning_s": 0.01, "status": "planned", "findings": [], "answers": 1}
        if item.name.startswith("trip")
        else {"rates": {"1": 5.0, "2": 9.5}, "findings": [], "answers": 4}
        for item in items
    }


def long_records(path: Path) -> None:
    """Records of one problem a set, as if it had been searched for long: 0.45 s where `line` takes 0.5 s."""
    ids = {"static": "A", "moving bodies": "B", "moving goal": "C", "moving goal, velocity": "C"}
    long = {"duration_s": 0.45, "by": "x", "commit": None, "searched_s": 90.0}
    write(path, {name: {f"{letter}000": long} for name, letter in ids.items()})


ALL = (sets, durations, dyad, legs, scaling, service, side_by_side)


def summaries() -> dict[str, Summary]:
    """Every section's summary of made-up records."""
    found = {}
    for module in ALL:
        section = module.SECTION
        parameters = section.parameters(True)
        made = records(section.name, parameters, section.items(parameters))
        found[section.name] = section.summary(parameters, made)
    return found


def results() -> dict[str, Document]:
    """Documents as `benchmarks.bench` writes them, of made-up records."""
    machine = {"cpu": "none", "cores": 1, "python": "3", "libraries": {"numpy": "2"}}
    return {
        name: {
            "schema": "assur-benchmark/1",
            "section": name,
            "sample": False,
            "date": "2026-01-01",
            "commit": "0" * 40,
            "changed": False,
            "machine": machine,
            "answers": {"checked": 10, "not_clean": []},
            "figures": [figure.document() for figure in summary.figures],
            "data": summary.data,
        }
        for name, summary in summaries().items()
    }

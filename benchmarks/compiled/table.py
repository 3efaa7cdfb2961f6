"""The tables of `compiled.json`. Nothing here needs numba."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Document = dict[str, Any]

SHARES = ("median", "95 %")
LEAST_MS = 0.02
"""Functions that take less than this in a request are left out of the table; the result has them."""


def requests(document: Document) -> str:
    """Whole requests: first answers as they are, compiled, and the floor: the compiled time, less the share of compiled
    functions in the requests nearest to it."""
    figures = {figure["name"]: figure["value"] for figure in document["figures"]}
    stages = document["data"]["stages"]
    head = ("set", "", "original", "compiled", "floor", "same motion")
    rows = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for title in document["data"]["sets"]:
        for share in SHARES:
            before, after = (figures[f"{title}: first answer, {share}, {way}"] for way in ("original", "compiled"))
            near = stages.get(f"{title}/{share}")
            least = None if near is None or after is None else after * near["floor_ms"] / near["compiled_ms"]
            same = figures[f"{title}: the same motion in both ways"] if share == SHARES[0] else None
            cells = [_ms(before), _ms(after), _ms(least), "" if same is None else f"{same:.0f} %"]
            rows.append(f"| {title if share == SHARES[0] else ''} | {share} | {' | '.join(cells)} |")
    return "\n".join(rows)


def _ms(value: float | None) -> str:
    return "refused" if value is None else f"{value:.1f} ms"


def stages(document: Document) -> str:
    """Stages of the median requests of each set: original → compiled → what no compiled function does."""
    found: Mapping[str, Document] = {
        name.removesuffix("/median"): of for name, of in document["data"]["stages"].items() if name.endswith("/median")
    }
    names = list(dict.fromkeys(stage for of in found.values() for stage in of["stages_ms"]))
    rows = ["| stage, ms | " + " | ".join(found) + " |", "|---" * (len(found) + 1) + "|"]
    for name in names:
        cells = [of["stages_ms"].get(name) for of in found.values()]
        told = ["" if row is None else _three(row["original"], row["compiled"], row["rest"]) for row in cells]
        rows.append(f"| {name} | {' | '.join(told)} |")
    totals = [_three(of["original_ms"], of["compiled_ms"], of["floor_ms"]) for of in found.values()]
    rows.append("| **all** | " + " | ".join(f"**{total}**" for total in totals) + " |")
    return "\n".join(rows)


def _three(before: float, after: float, rest: float) -> str:
    return f"{before:.2f} → {after:.2f} → {rest:.2f}"


def functions(document: Document) -> str:
    """Function by function on the calls of the median requests."""
    head = ("function", "calls", "original, ms", "compiled, ms", "times", "largest difference")
    rows = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for row in sorted(document["data"]["functions"], key=lambda row: -float(row["before_ms"])):
        if row["before_ms"] >= LEAST_MS:
            name = f"**{row['function']}**" if row["fused"] else row["function"]
            times = row["before_ms"] / row["after_ms"]
            rows.append(
                f"| {name} | {row['calls']:.1f} | {row['before_ms']:.3f} | {row['after_ms']:.3f} | {times:.1f} "
                f"| {row['difference']:.0e} |"
            )
    return "\n".join(rows)


def starting(document: Document) -> str:
    """What a process pays before it is warm."""
    start = document["data"]["start"]
    rows = ["| a new process | imports | first four requests | the same again | memory |", "|---|---|---|---|---|"]
    titles = {"original": "original", "cold": "compiled, nothing kept", "warm": "compiled, kernels kept on disk"}
    for key, title in titles.items():
        of = start[key]
        rows.append(
            f"| {title} | {of['import_s']:.2f} s | {of['first_s']:.2f} s | {of['again_s']:.3f} s "
            f"| {of['memory_mb']:.0f} MB |"
        )
    return "\n".join(rows)


def page(document: Document) -> str:
    """All of it, for docs/benchmarks.md."""
    libraries = " and ".join(f"{name} {version}" for name, version in document["machine"]["numba"].items())
    commit = (document["commit"] or "none")[:10] + (" and changes" if document["changed"] else "")
    disk = document["data"]["start"]["disk_mb"]
    told = (
        f"{libraries}; {document['machine']['cpu']}, Python {document['machine']['python']}, {document['date']}, "
        f"commit {commit}. On disk: " + ", ".join(f"{name} {size:.0f} MB" for name, size in disk.items()) + "."
    )
    note = "Stages of the median requests: original → compiled → floor."
    short = "Functions on the calls of the median requests; those in bold are fused from many."
    parts = (told, requests(document), note, stages(document), short, functions(document), starting(document))
    return "\n\n".join(parts)

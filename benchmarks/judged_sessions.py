"""``python -m benchmarks.judged_sessions``: whether motions of simulated cells keep what they promise, in one world.

Each of the five cells (`benchmarks.flows`) is simulated with a log, and the judge (`benchmarks.judge.sessions`), which
shares no code with the product, plays the log. It runs each committed motion several times, with what is not known at
its ends and at its worst corners; it puts parts that nobody has seen at the line and behind it; and it compares each
motion with the one before it, and with where the parts are.
"""

from __future__ import annotations

import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

import assur
from assur.scenes.session.log import read_log
from benchmarks.figures import Document, Figure, figure, finish, progress
from benchmarks.flows import FLOWS, flow
from benchmarks.judge.faults import Violation
from benchmarks.judge.sessions import broken_sessions

MINUTES, FEW_MINUTES = 10.0, 0.2
"""Length of each run; twelve seeds of the first are ten hours over the five cells."""
SHOWN = 10
"""So many faults of a run are written in full."""


def main(
    minutes: Annotated[float, typer.Option(help="Length of each run, on its own clock.")] = MINUTES,
    seed: Annotated[int, typer.Option(help="Seed of the first run of each cell.")] = 1,
    seeds: Annotated[int, typer.Option(help="Number of runs of each cell, each with the next seed.")] = 1,
    quick: Annotated[bool, typer.Option("--quick", help="A few seconds of each cell.")] = False,
) -> None:
    """Simulate the cells, and judge their logs. Ctrl-C ends it with the runs that are judged by then."""
    minutes = FEW_MINUTES if quick else minutes
    runs = [(name, seed + k) for k in range(seeds) for name in FLOWS]
    records: dict[str, Document] = {}
    try:
        for name, number in progress(runs, "runs"):
            records[f"{name}, seed {number}"] = judged(name, minutes, number)
    except KeyboardInterrupt:
        if not records:
            raise
    parameters: Document = {"minutes": minutes, "seed": seed, "seeds": seeds}
    finish("judged_sessions", "logs of simulated cells, judged", quick, parameters, records, figures(records.values()))


def judged(name: str, minutes: float, seed: int) -> Document:
    """The record of one run: what was simulated, and the faults that the judge finds in its log, by their kinds."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        found = assur.simulate(flow(name), minutes=minutes, seed=seed, log=path)
        document, read = read_log(path)
        events = list(read)
    began = time.perf_counter()
    faults = broken_sessions(document, events)
    return {
        "cell": name,
        "simulated_s": found["runs"][0]["simulated_s"],
        "placed": found["placed"],
        "motions": sum(each["call"] == "commit" and "refused" not in each for each in events),
        "sessions": sum(each["call"] == "session" for each in events),
        "faults": dict(sorted(Counter(each.kind for each in faults).items())),
        "findings": [_words(each) for each in faults[:SHOWN]],
        "judge_s": time.perf_counter() - began,
    }


def _words(fault: Violation) -> str:
    at = "" if fault.time_s is None else f" at {fault.time_s:.6g} s"
    return f"{fault.kind}, {fault.about}: {fault.amount:.6g}, allowed {fault.allowed:.6g}{at}"


def figures(records: Iterable[Document]) -> list[Figure]:
    """How much was judged, and how much is wrong."""
    rows, kinds = list(records), Counter[str]()
    for row in rows:
        kinds.update(row["faults"])
    faults = float(sum(kinds.values()))
    note = ", ".join(f"{kind} {count}" for kind, count in sorted(kinds.items()))
    every = [{str(number): {**row, "findings": []} for number, row in enumerate(rows)}]
    return [
        Figure("faults that the judge finds in logs", (faults,), bar=(0.0,), decimals=0, note=note),
        figure("simulated time that was judged", every, lambda x: sum(r["simulated_s"] for r in x) / 60.0, "min"),
        figure("committed motions in it", every, lambda x: sum(r["motions"] for r in x), decimals=0),
        figure("parts that were put down in it", every, lambda x: sum(r["placed"] for r in x), decimals=0),
    ]  # fmt: skip


if __name__ == "__main__":
    typer.run(main)

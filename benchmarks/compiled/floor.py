"""What remains if everything compiled cost nothing: stage by stage, from samples of the stack (`benchmarks.stages`).

A sample is in a compiled function if the innermost of our frames is this package's: what a fused function asks of the
planner again, such as FCL, is not compiled and counts to its own stage.
"""

from __future__ import annotations

import time
from collections import Counter
from statistics import mean, median
from typing import Any

from benchmarks.cold import forget
from benchmarks.compiled import packing
from benchmarks.compiled.replacements import replaced
from benchmarks.compiled.requests import AFTER, BEFORE, Question
from benchmarks.stages import STAGES, sampled, stage
from planner.pipeline import plan
from scenes.requests import scene_of

Document = dict[str, Any]
MARK = "compiled: "
"""Before the name of a stage whose sample was in a compiled function."""
PACKAGE = "benchmarks.compiled."
STANDS_FOR = {
    f"{PACKAGE}proving": "planner.certificate.proof",
    f"{PACKAGE}screening": "planner.screening",
    f"{PACKAGE}separation": "planner.separation",
    f"{PACKAGE}gjk": "planner.gjk",
}
"""Modules that are called by others than their stage; of the rest the caller tells the stage."""
OURS = ("planner.", "scenes.", PACKAGE)
LEAST_RUNS = 3


def place(modules: list[str]) -> str:
    """The stage of a stack by the modules of its frames, outermost first, marked if it is in a compiled function."""
    ours = [name for name in modules if name.startswith(OURS) and not name.startswith(f"{PACKAGE}floor")]
    told = stage([STANDS_FOR.get(name, name) for name in modules])
    return MARK + told if ours and ours[-1].startswith(PACKAGE) else told


def once(question: Question) -> None:
    forget()
    packing.forget()
    plan(scene_of(question.document))


def seen(question: Question, seconds: float, about_s: float) -> tuple[float, Counter[str]]:
    """Time of the processor for a request unwatched, s, and samples of it by place."""
    runs = max(LEAST_RUNS, int(seconds / 2 / about_s))
    times = []
    for _ in range(runs):
        began = time.process_time()
        once(question)
        times.append(time.process_time() - began)
    with sampled(of=place) as counts:
        for _ in range(runs):
            once(question)
    return median(times), counts


def floor(questions: list[Question], seconds: float, about_s: float) -> Document:
    """Stages of requests on the average, ms: `original`, `compiled`, and of the latter what is no compiled function's:
    `rest`. The sums beside them."""
    with replaced():
        once(questions[0])
    stages: dict[str, dict[str, float]] = {name: {BEFORE: 0.0, AFTER: 0.0, "rest": 0.0} for name in STAGES}
    totals: dict[str, list[float]] = {BEFORE: [], AFTER: []}
    for question in questions:
        for way in (BEFORE, AFTER):
            if way == AFTER:
                with replaced():
                    alone, counts = seen(question, seconds, about_s)
            else:
                alone, counts = seen(question, seconds, about_s)
            totals[way].append(1e3 * alone)
            for name, count in counts.items():
                share = 1e3 * alone * count / counts.total() / len(questions)
                stages[name.removeprefix(MARK)][way] += share
                if way == AFTER and not name.startswith(MARK):
                    stages[name]["rest"] += share
    return {
        "problems": [question.problem["id"] for question in questions],
        "stages_ms": {name: row for name, row in stages.items() if any(row.values())},
        "original_ms": mean(totals[BEFORE]),
        "compiled_ms": mean(totals[AFTER]),
        "floor_ms": sum(row["rest"] for row in stages.values()),
    }

"""Where a program is, by stages, from a sample of its stack.

A timer interrupts the process every fraction of a millisecond, and the stack says which stage it is in: the innermost
frame of ours tells, except that everything below the checker, the margins and the like is theirs, whatever module they
borrow. What a library does counts to the module that called it. Unlike a tracer this slows nothing down, so code of
many small calls does not look worse than it is; its grain is the interval.
"""

from __future__ import annotations

import signal
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

INTERVAL_S = 0.2e-3
"""Between samples. A stage that takes 1 % of 15 ms is seen once in seven requests."""

WHOLE: tuple[tuple[str, str], ...] = (
    ("assur.planner.around", "looking at many ways"),
    ("assur.planner.checker", "checker"),
    ("assur.planner.report.margins", "margins"),
    ("assur.planner.search.lower_bound", "lower bound"),
    ("assur.scenes.requests", "building"),
)
"""Modules whose callees count as theirs, the outermost first."""

PARTS: tuple[tuple[str, str], ...] = (
    ("assur.planner.timing", "timing (ruckig)"),
    ("assur.planner.collision.fcl_door", "screening (fcl)"),
    ("assur.planner.collision.screening", "screening (supports)"),
    ("assur.planner.collision.support_gaps", "screening (supports)"),
    ("assur.planner.collision.footprints", "screening (supports)"),
    ("assur.planner.collision.arrangement", "screening (supports)"),
    ("assur.planner.geometry.pieces", "building"),
    ("assur.planner.collision.gjk", "certificate"),
    ("assur.planner.collision", "certificate"),
    ("assur.planner.model.clearance", "certificate"),
    ("assur.planner.trajectory.sweep", "certificate"),
    ("assur.planner.robots", "kinematics"),
    ("assur.planner.assur", "kinematics"),
    ("assur.planner.legs.tool_motion", "kinematics"),
    ("assur.planner.frames", "kinematics"),
    ("assur.planner.legs", "candidates"),
    ("assur.planner.search.candidates", "candidates"),
    ("assur.planner.search.meeting_options", "candidates"),
    ("assur.planner.search.partial_plan", "candidates"),
    ("assur.planner.search.extension", "candidates"),
    ("assur.planner.search.build", "candidates"),
    ("assur.planner.trajectory", "trajectory"),
    ("assur.planner.search.completion", "trajectory"),
    ("assur.planner.feasibility.necessary", "feasibility"),
)
"""Modules by the stage that they are; what is in none is `REST`."""
REST = "rest"
STAGES = tuple(dict.fromkeys(["building", *(stage for _, stage in PARTS), *(stage for _, stage in WHOLE), REST]))
"""In the order of the table."""


def _of(name: str, rules: tuple[tuple[str, str], ...]) -> str | None:
    return next((stage for module, stage in rules if name == module or name.startswith(module + ".")), None)


def stage(modules: list[str]) -> str:
    """The stage of a stack, given the modules of its frames, outermost first."""
    for name in modules:
        whole = _of(name, WHOLE)
        if whole is not None:
            return whole
    ours = (name for name in reversed(modules) if name.partition(".")[0] in ("planner", "scenes"))
    return _of(next(ours, ""), PARTS) or REST


def _modules(frame: FrameType | None) -> list[str]:
    names = []
    while frame is not None:
        names.append(str(frame.f_globals.get("__name__", "")))
        frame = frame.f_back
    return names[::-1]


@contextmanager
def sampled(interval_s: float = INTERVAL_S) -> Iterator[Counter[str]]:
    """Counts of samples by stage while the block runs. Main thread of a Unix process only."""
    counts: Counter[str] = Counter()

    def look(_: int, frame: FrameType | None) -> None:
        counts[stage(_modules(frame))] += 1

    before: Any = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, interval_s, interval_s)
    try:
        yield counts
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def milliseconds(counts: Counter[str], total_s: float) -> dict[str, float]:
    """Stage → ms of a run that takes `total_s` when nobody looks."""
    every = sum(counts.values())
    return {name: 1e3 * total_s * counts[name] / every for name in STAGES if counts[name]} if every else {}


def clocked(run: Any, repeats: int) -> list[float]:
    """Seconds of each run."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        run()
        times.append(time.perf_counter() - began)
    return times

"""A planner that answers requests over a pipe, one JSON line in and one out: this commit's or another's.

    python -P benchmarks/planner_process.py FOLDER

FOLDER holds the sources of the commit. Commits before the one import name `assur` have the packages `planner` and
`scenes` at the top. Nothing else of this repository is imported here, so that the same program measures both.
"""

from __future__ import annotations

import cProfile
import importlib.util
import json
import os
import pstats
import sys
import time
from collections import defaultdict
from contextlib import nullcontext
from functools import _lru_cache_wrapper
from pathlib import Path
from typing import Any, NamedTuple

Document = dict[str, Any]

KEEP = ("scenes.units", "scenes.catalogue", "scenes.scenarios", "scenes.schema", "planner.kernel_cache")
"""Rooms and modules whose caches hold nothing of a request: spelling of keys, shipped robots and scenarios, what was
read from the models of documents, where compiled kernels are."""
PACKAGES = ("planner", "scenes")
LIBRARIES = "libraries"
"""What a profile calls the time of functions of libraries that other such functions call."""


class Planner(NamedTuple):
    """The functions of a commit that are called."""

    scene_of: Any
    plan: Any
    check: Any
    prefix: str

    def forget(self) -> int:
        """Empties every `functools` cache that may hold something of a request; how many.

        Each problem is also new to its process. Its robot is not, as in a service.
        """
        emptied = 0
        reading = sys.modules.get(f"{self.prefix}scenes.reading.cell")
        getattr(reading, "_kept", {}).clear()  # the cells of earlier requests
        packages = tuple(f"{self.prefix}{package}" for package in PACKAGES)
        keep = tuple(f"{self.prefix}{module}" for module in KEEP)
        for name, module in list(sys.modules.items()):
            if name.startswith(packages):
                for value in list(vars(module).values()):
                    # by where it is written: a module also holds what it imports
                    if isinstance(value, _lru_cache_wrapper) and not value.__module__.startswith(keep):
                        value.cache_clear()
                        emptied += 1
        return emptied


def planner(prefix: str = "assur.") -> Planner:
    """The planner whose packages are named with this prefix."""
    # of commits before both checkers had one entry, it is in the room of the checker
    entry = "planner.checked" if importlib.util.find_spec(f"{prefix}planner.checked") else "planner.checker"
    requests, pipeline, checked = (
        importlib.import_module(prefix + name) for name in ("scenes.requests", "planner.pipeline", entry)
    )
    return Planner(requests.scene_of, pipeline.plan, checked.check, prefix)


def timed(api: Planner, document: Document) -> Document:
    """The answer to a request and its times in seconds: `build_s`; `wall_s` and `cpu_s` from the request in memory to
    the checked answer; `proved_s` to the first proof, `first_s` to the first answer; `check_s` of one more check."""
    api.forget()
    began, cpu = time.perf_counter(), time.process_time()
    scene = api.scene_of(document)
    built = time.perf_counter() - began
    outcome = api.plan(scene)
    cpu_s, wall_s = time.process_time() - cpu, time.perf_counter() - began
    times = {"build_s": built, "wall_s": wall_s, "cpu_s": cpu_s}
    # what the planner proved and its own checker then refused; older commits have the stage in the line itself
    refused = sum(line.count for line in outcome.census.lines if getattr(line, "refusal", line).stage == "checker")
    if not hasattr(outcome, "plan"):
        reason = f"{outcome.reason}: {outcome.sentence}"
        return {"status": "not_planned", "reason": reason, "checker_refused": refused, **times}
    again = time.perf_counter()
    verdict = api.check(scene, outcome.plan)
    checked = time.perf_counter() - again
    knots = outcome.plan.trajectory
    columns = {"time_s": knots.time, "position": knots.q, "velocity": knots.qd, "acceleration": knots.qdd}
    # the planner's last check and the margins are part of a first answer; with a budget only the planner can say when
    # it had one
    proved = built + outcome.first_s
    return {
        "status": "planned",
        **times,
        "first_s": wall_s if document["options"]["stop"] == "first" else proved,
        "proved_s": proved,
        "check_s": checked,
        "duration_s": float(knots.end - knots.start),
        "trajectory": {name: values.tolist() for name, values in columns.items()},
        "arrivals_s": [arrival.time for arrival in outcome.plan.arrivals],
        "checked": verdict.ok,
        "checker_refused": refused + (not verdict.ok),
        "reason": None if verdict.ok else "; ".join(str(finding) for finding in verdict.findings),
    }


def profiled(api: Planner, document: Document, repeats: int) -> Document:
    """Milliseconds a request by room (`own_ms`, with library functions and kernels it calls itself) and by function
    (`calls_ms`, with all that it calls), by cProfile and scaled to the median time without it (`total_ms`)."""

    def once(watch: cProfile.Profile | None = None) -> float:
        api.forget()
        with watch or nullcontext():
            began = time.perf_counter()
            api.plan(api.scene_of(document))
            return time.perf_counter() - began

    alone = sorted(once() for _ in range(repeats))[repeats // 2]
    watch = cProfile.Profile()
    for _ in range(repeats):
        once(watch)
    stats: Any = pstats.Stats(watch)
    scale = 1e3 * alone / stats.total_tt
    own: dict[str, float] = defaultdict(float)
    calls: dict[str, float] = {}
    for function, (_, _, seconds, whole, callers) in stats.stats.items():
        room = room_of(function)
        if room is not None:
            own[room] += scale * seconds
            calls[f"{room}/{Path(function[0]).stem}: {function[2]}"] = scale * whole
            continue
        for caller, edge in callers.items():
            own[room_of(caller) or LIBRARIES] += scale * edge[2]
        own[LIBRARIES] += scale * (seconds - sum(edge[2] for edge in callers.values()))
    return {"total_ms": 1e3 * alone, "own_ms": own, "calls_ms": calls}


def room_of(function: tuple[str, int, str]) -> str | None:
    """The room of a function of a profile: the folder below `planner` or the module there; `scenes`; None elsewhere."""
    parts = Path(function[0]).parts
    for package in PACKAGES:
        if package in parts:
            inside = parts[len(parts) - parts[::-1].index(package) :]
            return package if package == "scenes" else inside[0].removesuffix(".py")
    return None


def main(folder: Path) -> None:
    """Answers line by line until there are no more; what libraries print goes to standard error."""
    one_name = (folder / "src" / "assur").exists()
    sys.path.insert(0, str(folder / "src" if one_name else folder))
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    api = planner("assur." if one_name else "")
    out.write(json.dumps({"ready": True}) + "\n")
    out.flush()
    for line in sys.stdin:
        question = json.loads(line)
        try:
            repeats = question.get("profile")
            answer = timed(api, question["request"]) if repeats is None else profiled(api, question["request"], repeats)
        except Exception as error:  # noqa: BLE001 - a fault in one problem is its answer, and the run goes on
            answer = {"status": "error", "reason": f"{type(error).__name__}: {error}"}
        out.write(json.dumps(answer, allow_nan=False) + "\n")
        out.flush()


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())

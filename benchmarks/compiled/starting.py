"""``python -m benchmarks.compiled.starting original|compiled``: what the first request of a process costs.

A process of its own, told where numba keeps what it compiled: an empty folder is a cold start, the same folder again a
warm one. It writes one JSON object.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from contextlib import nullcontext
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Any

from benchmarks.machine import ROOT

Document = dict[str, Any]
LIMIT_S = 900.0
LIBRARIES = ("numba", "llvmlite")


def first_requests(compiled: bool) -> Document:
    """Seconds of importing numba, of the first four requests (goal standing and moving, position and velocity) and of
    the same again; memory, MB, at the end."""
    began = time.perf_counter()
    if compiled:
        from benchmarks.compiled import replacements

        stand_in = replacements.replaced()
    else:
        import planner.pipeline

        stand_in = nullcontext(vars(planner.pipeline))  # type: ignore[assignment]
    imported = time.perf_counter() - began
    from benchmarks.judged import problem_set, warm_up

    problems, times = problem_set("static"), []
    with stand_in:
        for _ in range(2):
            began = time.perf_counter()
            warm_up(problems)
            times.append(time.perf_counter() - began)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"import_s": imported, "first_s": times[0], "again_s": times[1], "memory_mb": memory}


def starts(folder: Path | None = None) -> Document:
    """Original, compiled with nothing kept, and compiled from what was kept; and megabytes of the libraries on disk."""
    with tempfile.TemporaryDirectory(dir=folder) as kept:
        found = {
            name: _process(way, kept)
            for name, way in (("original", "original"), ("cold", "compiled"), ("warm", "compiled"))
        }
        size = sum(path.stat().st_size for path in Path(kept).rglob("*") if path.is_file())
    found["disk_mb"] = {name: _megabytes(name) for name in LIBRARIES} | {"kernels": size / 1e6}
    return found


def _process(way: str, kept: str) -> Document:
    command = [sys.executable, "-m", "benchmarks.compiled.starting", way]
    environment = os.environ | {"NUMBA_CACHE_DIR": kept}
    ran = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=LIMIT_S, check=True
    )
    told: Document = json.loads(ran.stdout.splitlines()[-1])
    return told


def _megabytes(name: str) -> float:
    try:
        return sum(Path(str(path.locate())).stat().st_size for path in files(name) or [] if path.size) / 1e6
    except PackageNotFoundError:
        return 0.0


if __name__ == "__main__":
    print(json.dumps(first_requests(sys.argv[1] == "compiled")))

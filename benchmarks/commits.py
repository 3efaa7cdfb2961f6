"""The planner of this commit and that of another one, each in a warm process of its own."""

from __future__ import annotations

import io
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchmarks.dialogue import Document, Program
from benchmarks.machine import ROOT
from benchmarks.problem_set import ProblemSet
from benchmarks.translation import Terms, request, unrelated_problem
from deploy.packaging.backend import link

PROGRAM = Path(__file__).with_name("planner_process.py")
START_S = 300.0
"""Longest time until a planner is ready: kernels may have to be compiled."""
LIMIT_S = 120.0
"""Longest time for one answer."""
WARM_UP_SEEDS = range(987_654_321, 987_654_325)
"""Of the unrelated problems with which a process is warmed up, goal standing and moving."""


@contextmanager
def sources(commit: str | None) -> Iterator[Path]:
    """The folder with the sources of a commit; None: the working tree."""
    if commit is None:
        yield ROOT
        return
    packed = subprocess.run(["git", "archive", commit], cwd=ROOT, capture_output=True, check=True).stdout
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
            archive.extractall(folder, filter="data")
        root = Path(folder)
        if (root / "deploy" / "packaging").exists():  # before, the links were in git
            link(root)
        yield root


@contextmanager
def planning(folder: Path, problems: ProblemSet) -> Iterator[Program]:
    """A planner that is warm: libraries are loaded and every path was taken once, on problems that are in no set."""
    # -P: modules here must not take the names of the standard library's
    command = [sys.executable, "-P", str(PROGRAM), str(folder)]
    with Program(command, folder=folder, start_s=START_S) as program:
        for seed in WARM_UP_SEEDS:
            for match in ("position", "velocity"):
                problem = unrelated_problem(seed, moving_goal=seed % 2 == 0)
                ask(program, request(problem, problems.limits, Terms(match=match)))
        yield program


def ask(program: Program, document: Document, **more: int) -> Document:
    """The answer of a planner to a request."""
    return program.ask({"request": document, **more}, LIMIT_S)

"""The planner of this commit, and beside it that of another, each in a warm process of its own."""

from __future__ import annotations

import io
import json
import subprocess
import sys
import tarfile
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks.machine import ROOT
from benchmarks.problem_set import ProblemSet
from benchmarks.translation import Terms, request, unrelated_problem

Document = dict[str, Any]

GRACE_S = 5.0
"""A process that was asked to end is killed after this."""


class ProgramDied(Exception):
    """The process ended, was killed for taking too long, or wrote what is no answer."""


class Program:
    """A process that answers: one JSON object a line in, one out. The first line that it writes says that it is warm.
    What a library prints in it, or how it dies, is no concern of others."""

    def __init__(self, command: Sequence[str], *, folder: Path, start_s: float):
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
        )
        try:
            self._line(start_s)
        except ProgramDied:
            self.close()
            raise

    def ask(self, question: Document, limit_s: float) -> Document:
        """The answer to a question. Raises `ProgramDied` when there is none within `limit_s`."""
        pipe = self._process.stdin
        assert pipe is not None
        try:
            pipe.write(json.dumps(question, allow_nan=False) + "\n")
            pipe.flush()
        except OSError as error:
            raise ProgramDied("ended before it was asked") from error
        return self._line(limit_s)

    def _line(self, limit_s: float) -> Document:
        pipe = self._process.stdout
        assert pipe is not None
        late = threading.Timer(limit_s, self._process.kill)
        late.start()
        try:
            text = pipe.readline()
        finally:
            late.cancel()
        if not text:
            raise ProgramDied(f"no answer within {limit_s:g} s, or ended (exit {self._process.wait()})")
        try:
            answer = json.loads(text)
        except ValueError as error:
            raise ProgramDied(f"wrote what is not JSON: {text[:80]!r}") from error
        if not isinstance(answer, dict):
            raise ProgramDied(f"wrote what is no object: {text[:80]!r}")
        return answer

    def close(self) -> None:
        """Ends the process."""
        try:
            self._process.communicate(timeout=GRACE_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


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
        yield Path(folder)


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

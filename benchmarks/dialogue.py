"""Both ends of a process that answers: one JSON object a line in, one out.

Each measured planner, ours or a peer, runs in a process of its own: warm, on one core, and independent of what
libraries in other processes print, or how they end. Only the standard library is used here, since a peer's environment
does not have our packages.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

Document = dict[str, Any]

GRACE_S = 5.0
"""A process is killed if it does not end within this time after the request to end."""


class ProgramDied(Exception):
    """The process ended, was killed for taking too long, or wrote what is no answer."""


class Program:
    """The asking end. The first line that the process writes, once it is warm, is its `greeting`."""

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
            self.greeting = self._line(start_s)
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
            raise ProgramDied("ended before the request") from error
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


def answer_lines(prepare: Callable[[], tuple[Document, Callable[[Document], Document]]]) -> None:
    """The answering end: `prepare` warms up and gives the greeting and the function that answers; then line by line
    until there are no more. Whatever libraries print goes to standard error."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    greeting, answer = prepare()
    print(json.dumps(greeting, allow_nan=False), file=out, flush=True)
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line)), allow_nan=False), file=out, flush=True)

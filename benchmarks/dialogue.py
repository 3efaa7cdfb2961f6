"""A process that answers: one JSON object a line in, one out. Both ends of it.

What is measured runs in a process of its own, ours and the peers' alike: warm, on its one core, and what a library
prints or how it dies is no concern of the others. Only the standard library is used here, for a peer's environment
has not what ours has.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

Document = dict[str, Any]

GRACE_S = 5.0
"""A process that was asked to end is killed after this."""


class ProgramDied(Exception):
    """The process ended, was killed for taking too long, or wrote what is no answer."""


class Program:
    """The asking end. The first line that the process writes, once it is warm, is its `greeting`; `opening` is what it
    is told before."""

    def __init__(
        self,
        command: Sequence[str],
        *,
        folder: Path,
        opening: Document | None = None,
        log: Path | None = None,
        start_s: float = 120.0,
    ):
        self._log = log.open("ab") if log is not None else None
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log or subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
        )
        try:
            self.greeting = self._line(start_s) if opening is None else self.ask(opening, start_s)
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
        if self._process.stdin is not None:
            try:
                self._process.stdin.close()
            except BrokenPipeError:
                self._process.kill()
        try:
            self._process.wait(GRACE_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()
        if self._log is not None:
            self._log.close()

    def __enter__(self) -> Program:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def answer_lines(prepare: Callable[[], tuple[Document, Callable[[Document], Document]]]) -> None:
    """The answering end: `prepare` warms up and gives the greeting and the function that answers; then line by line
    until there are no more. Whatever libraries print goes to standard error."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    greeting, answer = prepare()
    _write(out, greeting)
    for line in sys.stdin:
        _write(out, answer(json.loads(line)))


def _write(out: Any, document: Document) -> None:
    out.write(json.dumps(document, allow_nan=False) + "\n")
    out.flush()

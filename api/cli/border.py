"""The border of the command line: exit codes, exceptions as one line, what is printed, files that can be written."""

from __future__ import annotations

import errno
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, ParamSpec

import typer

from assur.api.cli import console_report
from assur.api.documents import to_json
from assur.api.logs import where
from assur.api.problems import Problem, printable
from assur.api.workers.memory import MEMORY_MIB, limited_memory
from assur.planner.errors import FaultError, InputError

RIGHT, WRONG, BAD_INPUT, FAULT = 0, 1, 2, 3
OUT_OF_MEMORY = errno.ENOMEM
"""As a worker ends."""
INTERRUPTED, PIPE_CLOSED = 128 + signal.SIGINT, 128 + signal.SIGPIPE

PROGRESS_S = 10.0
"""How often the progress of long work is reported."""

P = ParamSpec("P")

AsJson = Annotated[bool, typer.Option("--json", help="Print the document that the service would answer with.")]


def bordered(command: Callable[P, int]) -> Callable[P, None]:
    """`command` with its exit code raised as `typer.Exit`, and every exception turned into one line and a code."""

    @wraps(command)
    def inside(*arguments: P.args, **options: P.kwargs) -> None:
        raise typer.Exit(code_of(lambda: command(*arguments, **options)))

    return inside


def within_memory(command: Callable[P, int]) -> Callable[P, int]:
    """`command` with the memory of a worker: what takes more is out of memory, and the machine goes on."""

    @wraps(command)
    def inside(*arguments: P.args, **options: P.kwargs) -> int:
        with limited_memory(MEMORY_MIB):
            return command(*arguments, **options)

    return inside


def code_of(run: Callable[[], int]) -> int:
    try:
        code = run()
        sys.stdout.flush()
        return code
    except InputError as error:
        problem = Problem.of_input(error)
        for fault in problem.errors:
            say(str(fault), line=fault.line)
        if problem.left_out:
            say(f"and {problem.left_out} more faults, which are reported when these are corrected")
        return BAD_INPUT
    except MemoryError:
        why = f"out of memory: this takes more than the {MEMORY_MIB} MiB that a command may allocate"
        return say(f"{why}; plan less: shorter times, fewer or simpler bodies", OUT_OF_MEMORY)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # so that the flush at exit is silent too
        return PIPE_CLOSED
    except KeyboardInterrupt:
        return say("interrupted", INTERRUPTED)
    except Exception as error:  # noqa: BLE001 - the border: a user gets one line, with what a report of it needs
        if isinstance(error, OSError) and error.filename is not None:
            return say(f"{error.filename}: {error.strerror}", BAD_INPUT)
        last = "".join(where(error.__traceback__)[-1:])
        message = f" ({error})" if isinstance(error, FaultError) else ""
        return say(f"a fault of assur itself: {type(error).__name__} in {last}{message}; please report it", FAULT)


def say(text: str, code: int = RIGHT, line: int | None = None) -> int:
    """One line on standard error; returns `code`."""
    at = "" if line is None else f"line {line}: "
    sys.stderr.write(f"assur: {at}{printable(text, 2500)}\n")
    return code


@contextmanager
def telling(how_far: Callable[[], str]) -> Iterator[None]:
    """Says on standard error how far something long is, every `PROGRESS_S` while the block runs."""
    ended = threading.Event()

    def tell() -> None:
        while not ended.wait(PROGRESS_S):
            say(how_far())

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield
    finally:
        ended.set()
        teller.join()


def writable(out: Path | None, *others: str | Path | None, option: str = "--out") -> None:
    """Accepts no file, and one that can be written. `others`: what the command reads, or writes as well; it is not
    overwritten. Raises `InputError` that names the option."""
    if out is None:
        return
    if out.is_dir() or not out.parent.is_dir():
        raise InputError(option, str(out), "a file in a folder that exists")
    if any(out.resolve() == Path(other).resolve() for other in others if other is not None):
        raise InputError(option, str(out), "another file than those that the command reads or writes as well")


def show(*parts: Any) -> None:
    console = console_report.console()
    for part in parts:
        console.print(part, soft_wrap=isinstance(part, str))


def show_json(document: Any) -> None:
    sys.stdout.buffer.write(to_json(document) + b"\n")


def answered(document: Any, words: Callable[[], Iterable[Any]], *, as_json: bool, right: bool = True) -> int:
    """Prints an answer as its document, or in `words`; the exit code of an answer that is `right` or not."""
    if as_json:
        show_json(document)
    else:
        show(*words())
    return RIGHT if right else WRONG

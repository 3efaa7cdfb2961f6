"""Runs what the pages show in processes that are forked from one that has loaded the product and its kernels.

To start an interpreter and to load the kernels takes two seconds of processor time, and the pages show about a hundred
commands and programs. Each gets a process, a folder and output of its own, as from a shell; only the start is shared.
tests/api/test_command_line.py starts real processes.
"""

from __future__ import annotations

import atexit
import json
import os
import runpy
import signal
import subprocess
import sys
import warnings
from contextlib import suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tests.docs.pages import ENVIRONMENT, ROOT

ASSUR = "assur"
"""The command line, in place of `python`."""


def run_words(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs `assur ...`, `python FILE`, `python -m MODULE ...` or `python [-W error] -c PROGRAM` in `folder`."""
    with TemporaryDirectory() as made:
        files = [str(Path(made) / name) for name in ("out", "err")]
        code = _server_answer({"words": words, "folder": str(folder), "files": files})
        out, err = (Path(file).read_text(encoding="utf-8") for file in files)
    return subprocess.CompletedProcess(words, code, out, err)


@cache
def _server() -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "tests.docs.warm_process"]
    pipe = subprocess.PIPE
    server = subprocess.Popen(
        command, cwd=ROOT, env=ENVIRONMENT, stdin=pipe, stdout=pipe, text=True, start_new_session=True
    )
    assert server.stdin is not None
    atexit.register(server.stdin.close)  # then the server ends
    return server


def _server_answer(job: dict[str, Any]) -> int:
    server = _server()
    assert server.stdin is not None
    assert server.stdout is not None
    try:
        server.stdin.write(json.dumps(job) + "\n")
        server.stdin.flush()
        return int(server.stdout.readline())
    except BaseException:
        # the answer would come later, and be taken for that of the next job: of a page that runs out of time the server
        # ends, with what it runs, and the next page gets another
        os.killpg(server.pid, signal.SIGKILL)
        with suppress(BrokenPipeError), server:
            _server.cache_clear()
        raise


def _serve() -> None:
    from assur.api import command_line  # noqa: F401 - what each command needs is loaded before the first
    from assur.scenes.kernels import load

    load()
    jobs, answers = os.fdopen(os.dup(0)), os.fdopen(os.dup(1), "w")
    for line in jobs:
        job = json.loads(line)
        child = os.fork()
        if child == 0:
            jobs.close()
            answers.close()
            _become(job)
            return
        _, status = os.waitpid(child, 0)
        answers.write(f"{os.waitstatus_to_exitcode(status)}\n")
        answers.flush()


def _become(job: dict[str, Any]) -> None:
    """What the job names runs in this process, which then ends as it says."""
    os.chdir(job["folder"])
    for target, name in ((0, os.devnull), *zip((1, 2), job["files"], strict=True)):
        os.dup2(os.open(name, os.O_RDWR | os.O_CREAT), target)
    program, *arguments = job["words"]
    if program == ASSUR:
        from assur.api.command_line import main

        sys.argv = [program, *arguments]
        main()
    elif arguments[0] == "-m":
        sys.argv = arguments[1:]
        runpy.run_module(arguments[1], run_name="__main__", alter_sys=True)
    elif "-c" in arguments:
        *options, flag, text = arguments
        assert flag == "-c"
        assert options in ([], ["-W", "error"])
        if options:
            warnings.simplefilter("error")
        sys.argv = [flag]
        exec(compile(text, "<string>", "exec"), {"__name__": "__main__"})
    else:
        sys.argv = arguments
        runpy.run_path(arguments[0], run_name="__main__")


if __name__ == "__main__":
    _serve()

"""Nobody waits for the log, and what cannot be written is counted and told."""

from __future__ import annotations

import base64
import copy
import fcntl
import json
import os
import re
import signal
import subprocess
import sys

import httpx
import pytest

from assur.api.log_lines import LONGEST_LINE, AtOnce, Later
from assur.api.workers.jobs import FIRST_PLAN
from assur.api.workers.pool import why_not_started
from assur.api.workers.worker_process import CrashedError
from tests.api.processes import ROOT, environment, until

LINE = json.dumps({"time": "now", "level": "info", "logger": "assur", "event": "x" * 300})


def small_pipe() -> tuple[int, int]:
    """A pipe that takes two pages, and then no more."""
    read, write = os.pipe()
    fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, 8192)
    return read, write


def test_lines_that_nobody_reads_are_dropped_and_told_when_somebody_reads() -> None:
    read, write = small_pipe()
    lines = Later(write, most=5)
    for _ in range(200):
        lines.put(LINE)  # never waits
    until(lambda: lines.dropped > 100)
    lost = lines.dropped_ever
    found = b""
    while b"were dropped" not in found:
        found += os.read(read, 65536)
    whole = [json.loads(line) for line in found.split(b"\n")[:-1]]
    (told,) = (line for line in whole if line["event"] == "lines of the log were dropped")
    assert told["count"] == lost == lines.dropped_ever
    lines.end()
    os.close(read)
    os.close(write)


def test_a_worker_drops_lines_at_once_and_tells_how_many() -> None:
    read, write = small_pipe()
    lines = AtOnce(write)
    for _ in range(50):
        lines.put(LINE)
    dropped = lines.dropped
    assert dropped > 30
    first = os.read(read, 65536).splitlines()
    assert len(first) == 50 - dropped
    lines.put(LINE)
    told, last = os.read(read, 65536).splitlines()
    assert json.loads(told)["count"] == dropped
    assert json.loads(last) == json.loads(LINE)
    os.close(read)
    os.close(write)
    lines.put(LINE)
    assert lines.dropped == 1, "the reader is gone"


def test_a_line_that_is_too_long_keeps_its_short_facts() -> None:
    read, write = os.pipe()
    AtOnce(write).put(json.dumps({"event": "request", "where": ["x" * 100] * 100}))
    line = os.read(read, 65536)
    assert len(line) <= LONGEST_LINE
    assert json.loads(line) == {"event": "request", "shortened": True}
    os.close(read)
    os.close(write)


@pytest.mark.slow
def test_a_service_whose_log_nobody_reads_answers_and_ends() -> None:
    read, write = os.pipe()
    command = [sys.executable, "-m", "assur.api.command_line", "serve", "--port", "0"]
    process = subprocess.Popen(command, cwd=ROOT, env=environment(WORKERS="1"), stderr=write)
    try:
        head = b""
        while (found := re.search(rb'"port": (\d+)', head)) is None:
            head += os.read(read, 4096)  # the last that is read
        with httpx.Client(base_url=f"http://127.0.0.1:{int(found[1])}", timeout=60.0) as client:
            until(lambda: client.get("/livez").status_code == 200)
            statuses = [client.get(path).status_code for _ in range(1000) for path in ("/none", "/livez")]
            lost = re.search(r"^assur_log_lines_lost_total (\S+)", client.get("/metrics").text, re.MULTILINE)
        assert statuses == [404, 200] * 1000
        assert lost is not None
        process.send_signal(signal.SIGTERM)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()
        os.close(read)
        os.close(write)


WORKER = """
import json, os, socket, sys, warnings
from assur.api.workers.worker_process import About, Line
from assur.api import logs
from assur.api.workers import jobs
from assur.api.workers.traced import Traced
logs.configure_worker("info")
body = sys.stdin.buffer.read()
def work():
    warnings.warn("the secret of a request")
    try:
        raise ValueError("the secret of a request")
    except ValueError:
        import traceback
        traceback.print_exc()
    return jobs.plan(body, "digest", 10.0, Line(socket.socketpair()[0], About({}, False)))
print(Traced(work, {"request": "abc", "traceparent": "00-1-2-00"})().kind)
"""


def test_what_libraries_say_in_a_worker_is_lines_of_json_about_its_request_without_a_word_of_it() -> None:
    stl = b"solid x\nfacet normal 0 0 secret\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    request = copy.deepcopy(FIRST_PLAN)
    data = base64.b64encode(stl + b"endsolid").decode()
    request["bodies"][1]["shape"] = {"mesh": {"data": data, "format": "stl", "unit": "m"}}
    run = subprocess.run(
        [sys.executable, "-c", WORKER],
        input=json.dumps(request).encode(), cwd=ROOT, env=environment(), capture_output=True, timeout=120, check=True,
    )  # fmt: skip
    assert run.stdout.split()[-1] == b"bad-input"
    lines = [json.loads(line) for line in run.stderr.splitlines()]
    assert {line["event"] for line in lines} >= {
        "a library warns", "a library says something", "a worker printed to standard error"
    }  # fmt: skip
    assert all(line["request"] == "abc" and line["traceparent"] == "00-1-2-00" for line in lines)
    assert any(line["logger"].startswith("trimesh") and line["fault"] == "ValueError" for line in lines)
    assert b"secret" not in run.stderr


RAW = """
import os, subprocess, sys
from assur.api.logs import configure, event, one_log
configure("info")
with one_log():
    event("ours")
    os.write(2, b"terminate called\\n{not ours}\\n")
    subprocess.run([sys.executable, "-c", "import os; os.write(2, b'from a child')"], check=True)
os.write(2, b"after")
"""


def test_what_is_written_past_the_log_is_lines_of_json_too() -> None:
    run = subprocess.run([sys.executable, "-c", RAW], cwd=ROOT, capture_output=True, timeout=60, check=True)
    text = run.stderr.replace(b"after", b"")
    lines = [json.loads(line) for line in text.splitlines()]
    assert [line["event"] for line in lines] == ["ours", "terminate called", "{not ours}", "from a child"]
    assert [line["logger"] for line in lines] == ["assur", "stderr", "stderr", "stderr"]
    assert run.stderr != text, "standard error is as it was before"


def test_a_worker_that_does_not_start_says_what_the_system_denied_and_what_to_do() -> None:
    crashed = CrashedError("its first plan raised OSError")
    crashed.__cause__ = OSError(28, "No space left on device", "/a/customers/name")
    assert why_not_started(crashed) == (
        "its first plan raised OSError: OSError ENOSPC (No space left on device). "
        "Make room on the volume, or in /dev/shm, or mount a larger one."
    )
    assert "lower ASSUR_WORKERS" in why_not_started(BlockingIOError(11, "Resource temporarily unavailable"))
    assert why_not_started(CrashedError("was killed by SIGKILL")) == "was killed by SIGKILL"

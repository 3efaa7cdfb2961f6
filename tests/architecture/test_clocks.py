"""Nothing is decided by the time of day, which jumps: whatever waits or measures asks a monotonic clock."""

from __future__ import annotations

import ast

import pytest

from tests.architecture.source_tree import PRODUCT, Source, sources

WALL = frozenset(
    {
        "time.time", "time.time_ns", "time.localtime", "time.gmtime", "time.ctime", "time.strftime",
        "datetime.now", "datetime.utcnow", "datetime.today", "datetime.fromtimestamp", "date.today",
        "datetime.datetime.now", "datetime.datetime.utcnow", "datetime.date.today",
    }
)  # fmt: skip
"""Calls that read the time of day, as they are written."""
TELLING = {"api/logs.py", "api/log_lines.py", "scenes/meshes/folder.py", "api/web/mesh_routes.py"}
"""Modules that tell people when something was. The time in a line of the log decides nothing. Files of meshes outlive
processes, and have the time of day: one that is removed too early is sent, or covered, again."""


def wall_clocks(modules: tuple[Source, ...]) -> list[str]:
    """Where the time of day is read, or `time` brings names that would hide it."""
    found = []
    for source in modules:
        for node in ast.walk(source.tree):
            if isinstance(node, ast.Attribute) and ast.unparse(node) in WALL:
                found.append(f"{source.path}:{node.lineno} {ast.unparse(node)}")
            if isinstance(node, ast.ImportFrom) and node.module == "time":
                names = {f"time.{alias.name}" for alias in node.names} & WALL
                found += [f"{source.path}:{node.lineno} {name}" for name in sorted(names)]
    return found


def test_no_decision_asks_for_the_time_of_day() -> None:
    every = wall_clocks(sources(*PRODUCT))
    assert [place for place in every if place.split(":")[0] not in TELLING] == []
    assert {place.split(":")[0] for place in every} == TELLING, "a module that is named here reads no time of day"


@pytest.mark.parametrize(
    "text",
    ["import time\nend = time.time() + 3", "from time import time\ntime()", "datetime.now(UTC)", "clock = time.time"],
)
def test_a_wall_clock_is_found(text: str) -> None:
    assert len(wall_clocks((Source("assur.api.x", "api/x.py", text, ast.parse(text)),))) == 1


def test_a_monotonic_clock_is_not_found() -> None:
    text = "import time\ntime.monotonic()\ntime.perf_counter()\ntime.sleep(1)"
    assert wall_clocks((Source("assur.api.x", "api/x.py", text, ast.parse(text)),)) == []

"""Compiles the planner's kernels, or loads what was compiled before. Importing this loads no compiler."""

from __future__ import annotations

import pkgutil
import subprocess
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from assur.planner.kernel_cache import ROOMS, folder, is_compiled

__all__ = ["LoadedKernels", "counted", "folder", "is_compiled", "load", "load_room"]


@dataclass(frozen=True, slots=True)
class LoadedKernels:
    """How many kernels Python calls, the names of those that had to be compiled now, and how long it took, s."""

    count: int
    compiled: tuple[str, ...]
    seconds: float
    folder: Path


def counted() -> int:
    """How many kernels the folder has by now: while they are compiled, how far that is."""
    return sum(1 for _ in folder().rglob("*.nbi"))


def load_room(room: str) -> list[str]:
    """Loads the kernels of one room of the planner and of those within it, and what they call. Returns the names of
    those that had to be compiled now."""
    from assur.planner import compiled

    package = import_module(f"assur.planner.{room}")
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        import_module(module.name)
    compiled.load_defined(f"{package.__name__}.")
    return compiled.compiled_now()


def load() -> LoadedKernels:
    """Loads every kernel. Where the folder does not have them, every room is compiled by a process of its own.

    The rooms share next to no kernel, so that takes about half as long on two processors, some minute.
    Raises `FaultError` for a kernel that is not there where the folder cannot be written.
    """
    begun = time.perf_counter()
    elsewhere = [] if is_compiled() else [_in_a_process(room) for room in ROOMS[1:]]
    names = load_room(ROOMS[0])
    for process in elsewhere:
        names += process.communicate()[0].split()
    for room in ROOMS[1:]:
        names = list(dict.fromkeys(names + load_room(room)))
    from assur.planner import compiled

    compiled.mark_whole()
    return LoadedKernels(len(compiled.entries()), tuple(names), time.perf_counter() - begun, folder())


def _in_a_process(room: str) -> subprocess.Popen[str]:
    """Compiles a room; if that fails, loading it here fails again and says why."""
    program = (
        f"import gc; gc.set_threshold(50_000); from assur.scenes import kernels; print(*kernels.load_room({room!r}))"
    )
    return subprocess.Popen(  # noqa: S603 - no word of it comes from outside
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )

"""Compiles the planner's kernels, or loads what was compiled before. Importing this loads no compiler."""

from __future__ import annotations

import pkgutil
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from assur.planner.kernel_cache import ROOMS, folder, is_compiled

__all__ = ["Loaded", "folder", "is_compiled", "load"]


@dataclass(frozen=True, slots=True)
class Loaded:
    """How many kernels there are, the names of those that had to be compiled now, and how long it took, s."""

    count: int
    compiled: tuple[str, ...]
    seconds: float
    folder: Path


def load() -> Loaded:
    """Loads every kernel, compiling those that are not in the folder yet (about a minute if none is).

    Raises `FaultError` for a kernel that is not there where the folder cannot be written.
    """
    begun = time.perf_counter()
    from assur.planner import compiled

    for room in ROOMS:
        package = import_module(f"assur.planner.{room}")
        for module in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
            import_module(module.name)
    compiled.mark_whole()
    return Loaded(len(compiled.KERNELS), tuple(compiled.compiled_now()), time.perf_counter() - begun, folder())

"""The memory of a process: what it may allocate, and what a worker gives back to the system between its jobs.

A worker is bounded for good, a command of the command line while it runs. What is bounded is the memory that is its own
and may be written (`RLIMIT_DATA`), not its address space: most of that is libraries, and what is reserved and never
used. A process that has planned has 400 MiB of the one, 900 of the other. The limit of a command counts what the
command takes; what its process had before, as where another program calls it, is not counted.
"""

from __future__ import annotations

import ctypes
import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

MEMORY_MIB = 2048
"""Memory of a worker that no setting and no container says otherwise of, and of a command that plans, MiB."""

GROWN_BYTES = 16 << 20
"""By so much a process must have grown before it asks what of that is free: to ask takes it 4 to 20 ms."""
RESIDENT, DATA = 1, 5
"""Where `STATM` has the number of pages that a process holds, and of those that it may write."""
STATM = "/proc/self/statm"
STATM_BYTES = 256
"""More than it has."""


def limit_memory(memory_mib: int) -> None:
    """Bounds the memory of this process for good: an allocation beyond it raises `MemoryError`."""
    size = memory_mib << 20
    resource.setrlimit(resource.RLIMIT_DATA, (size, size))


@contextmanager
def limited_memory(memory_mib: int) -> Iterator[None]:
    """Bounds what the block may allocate on top of what the process has. A limit that is narrower already stays."""
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    own = _bytes(Path(STATM).read_bytes(), DATA) + (memory_mib << 20)
    size = min([own, *(bound for bound in (soft, hard) if bound != resource.RLIM_INFINITY)])
    resource.setrlimit(resource.RLIMIT_DATA, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


class FreedMemory:
    """What a process has freed, and its C library still holds: without this it keeps most of what its largest job took,
    and the next large job comes on top of that."""

    def __init__(self) -> None:
        self._statm = os.open(STATM, os.O_RDONLY)  # stays open: to open it takes ten times as long as to read it
        self._held_bytes = self._resident_bytes()

    def give_back(self) -> None:
        """Gives it back to the system, if the process has grown since the last time."""
        if self._resident_bytes() - self._held_bytes >= GROWN_BYTES:
            ctypes.CDLL(None).malloc_trim(0)
            self._held_bytes = self._resident_bytes()

    def _resident_bytes(self) -> int:
        return _bytes(os.pread(self._statm, STATM_BYTES, 0), RESIDENT)


def _bytes(statm: bytes, column: int) -> int:
    return int(statm.split()[column]) * resource.getpagesize()

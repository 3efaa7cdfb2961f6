"""The bound on what a process may allocate: of a worker for good, of a command of the command line while it runs."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager

MEMORY_MIB = 4096
"""Address space of a worker, unless a setting says otherwise, and of a command that plans."""


def limit_memory(memory_mib: int) -> None:
    """Bounds the address space of this process for good: an allocation beyond it raises `MemoryError`."""
    size = memory_mib << 20
    resource.setrlimit(resource.RLIMIT_AS, (size, size))


@contextmanager
def limited_memory(memory_mib: int) -> Iterator[None]:
    """The same inside the block. A limit that is narrower already stays."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    size = min([memory_mib << 20, *(bound for bound in (soft, hard) if bound != resource.RLIM_INFINITY)])
    resource.setrlimit(resource.RLIMIT_AS, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))

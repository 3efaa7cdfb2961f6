"""The bound on what a process may allocate: of a worker for good, of a command of the command line while it runs.

What is bounded is the memory that is its own and may be written (`RLIMIT_DATA`), not its address space: most of that is
libraries, and what is reserved and never used. A process that has planned has 400 MiB of the one, 900 of the other.
"""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager

MEMORY_MIB = 2048
"""Memory of a worker that no setting and no container says otherwise of, and of a command that plans, MiB."""


def limit_memory(memory_mib: int) -> None:
    """Bounds the memory of this process for good: an allocation beyond it raises `MemoryError`."""
    size = memory_mib << 20
    resource.setrlimit(resource.RLIMIT_DATA, (size, size))


@contextmanager
def limited_memory(memory_mib: int) -> Iterator[None]:
    """The same inside the block. A limit that is narrower already stays."""
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    size = min([memory_mib << 20, *(bound for bound in (soft, hard) if bound != resource.RLIM_INFINITY)])
    resource.setrlimit(resource.RLIMIT_DATA, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))

"""Why a worker does not start, and what an operator can do about it."""

from __future__ import annotations

import errno

_FOLDERS = (
    "Planning reads the installed package and its compiled kernels (`assur kernels` makes them): "
    "see that both are there and readable, and that /tmp or /dev/shm can be written, where the socket is made by which "
    "workers are forked."
)
_SPACE = "Make room on the volume, or in /dev/shm, or mount a larger one."
_PROCESSES = "Raise the limit of processes and threads (pids_limit of the container), or lower ASSUR_WORKERS."
_FILES = "Raise the limit of open files, or lower ASSUR_CONNECTIONS."
_MEMORY = "Raise the limit of memory, or ASSUR_WORKER_MEMORY_MIB, or lower ASSUR_WORKERS."
WHAT_TO_DO = {
    errno.ENOENT: _FOLDERS,
    errno.EACCES: _FOLDERS,
    errno.EPERM: _FOLDERS,
    errno.EROFS: _FOLDERS,
    errno.ENOSYS: _FOLDERS,
    errno.ENOSPC: _SPACE,
    errno.EDQUOT: _SPACE,
    errno.EAGAIN: _PROCESSES,
    errno.EMFILE: _FILES,
    errno.ENFILE: _FILES,
    errno.ENOMEM: _MEMORY,
}
"""What an operator can do about an error of the system, by its number."""


def why_not_started(error: Exception) -> str:
    """Why a worker did not start, and what to do. It repeats only names of errors of the system."""
    cause = error if isinstance(error, OSError) else error.__cause__
    if not isinstance(cause, OSError):
        return str(error)
    name = errno.errorcode.get(cause.errno or 0, "no number")
    todo = WHAT_TO_DO.get(cause.errno or 0, "See what the system denies to this process, and allow it.")
    before = "its process was not made" if error is cause else str(error)
    return f"{before}: {type(cause).__name__} {name} ({cause.strerror}). {todo}"

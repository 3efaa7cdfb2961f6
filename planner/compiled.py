"""The one door to numba: kernels are plain Python functions, compiled once and kept in a cache folder.

A kernel has one explicit signature, checks its indices, and raises what plain Python would raise. With
`NUMBA_DISABLE_JIT=1` the same source runs as plain Python. Nothing here relaxes floating-point arithmetic, so the bits
of a result do not depend on the processor.

Numba decides by a kernel's own file whether its cached code is still good, and does not look at the kernels that it
calls. Therefore the cache folder is named by the digest of all of them.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numba

F = TypeVar("F", bound=Callable[..., object])

KERNELS = ("kernels", "checker")
"""Rooms of the planner whose modules may hold kernels."""


def _digest() -> str:
    """A number for the sources of all kernels."""
    found = hashlib.sha256()
    here = Path(__file__).parent
    for path in [here / "compiled.py", *sorted(path for room in KERNELS for path in (here / room).glob("*.py"))]:
        found.update(path.name.encode() + b"\0" + path.read_bytes())
    return found.hexdigest()[:16]


def _folder() -> Path:
    """Where compiled code is kept: below the folder that numba was told of, else below the user's cache."""
    told = numba.config.CACHE_DIR
    return (Path(told) if told else Path.home() / ".cache" / "assur" / "kernels") / _digest()


CACHE = _folder()
"""The folder that holds the compiled code of these very sources."""
numba.config.CACHE_DIR = str(CACHE)


def kernel(signature: str) -> Callable[[F], F]:
    """Compiles a function for one signature, such as ``"float64(float64[:, ::1], int64)"``, when it is defined.

    An index beyond the end raises `IndexError` (a negative one counts from the end, as in Python: test it yourself);
    a division by zero raises `ZeroDivisionError`. An argument of another type, a read-only array among them, raises
    `TypeError`.
    """
    return numba.njit(signature, cache=True, nogil=True, error_model="python", boundscheck=True)  # type: ignore[no-any-return]

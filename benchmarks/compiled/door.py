"""The one door to numba. Where it is not installed the kernels are plain Python: right and slow, good enough for tests,
and never timed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

try:
    import numba
except ImportError:
    numba = None

F = TypeVar("F", bound=Callable[..., Any])

KERNELS: list[Any] = []
"""Every compiled kernel of this process."""

MISSING = (
    "numba is not installed in this environment, so there is nothing compiled to measure: run `make bench-compiled`, "
    "or install the extra with `pip install -e .[compiled]`. The planner does not need it."
)


def is_there() -> bool:
    """Whether numba can be used here."""
    return numba is not None


def version() -> str:
    """Of numba; empty without it."""
    return "" if numba is None else str(numba.__version__)


def kernel(function: F) -> F:
    """The function compiled without Python objects, cached on disk. NaN and infinity as in NumPy: no fast mathematics,
    and a division by zero is no exception."""
    if numba is None:
        return function
    made: F = numba.njit(cache=True, error_model="numpy")(function)
    KERNELS.append(made)
    return made


def inner(function: F) -> F:
    """A kernel that is written out wherever another one calls it: a call hands over each array as seven words, which
    costs as much as a support."""
    if numba is None:
        return function
    made: F = numba.njit(cache=True, error_model="numpy", inline="always")(function)
    return made


def variants() -> int:
    """How many variants of all kernels have been compiled or loaded. It must not grow while something is timed."""
    return sum(len(made.signatures) for made in KERNELS)

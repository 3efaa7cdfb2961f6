"""Array types, and the one way in which a fact's arrays are made read-only."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from assur.planner.errors import InputError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

A_FEW = 32
"""Up to so many numbers are examined one by one."""


def frozen(values: Any, shape: Sequence[int | None], field: str) -> FloatArray:
    """A read-only float64 copy of `values` that has `shape` (None: any length) and is finite.

    Raises `InputError` naming `field` otherwise.
    """
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(field, values, "numbers") from error
    if shape not in (array.shape, (None,) * array.ndim) and not _fits(array.shape, shape):
        wanted = tuple("any" if want is None else want for want in shape)
        raise InputError(field, array.shape, f"an array of shape {wanted}")
    # Python is faster for a few numbers, and most facts of a scene are a few
    finite = all(map(math.isfinite, array.ravel().tolist())) if array.size <= A_FEW else np.isfinite(array).all()
    if not finite:
        raise InputError(field, values, "finite numbers")
    array.setflags(write=False)
    return array


def every(flags: BoolArray) -> BoolArray:
    """`flags.all(-1)` (...), for a last axis of a few: NumPy reduces a short axis four times as slowly."""
    return np.asarray(reduce(np.logical_and, [flags[..., k] for k in range(flags.shape[-1])]))


def _fits(shape: tuple[int, ...], wanted: Sequence[int | None]) -> bool:
    return len(shape) == len(wanted) and all(want in (None, have) for have, want in zip(shape, wanted, strict=True))

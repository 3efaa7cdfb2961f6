"""Arrays of numbers as short text: little-endian numbers in base64, with their shape."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from assur.planner.errors import FaultError
from assur.scenes.schema import view as document


def floats(values: Any) -> document.Floats:
    """Numbers of 32 bits: of lengths in m some 0.1 µm, of times in s 0.1 µs."""
    array = np.asarray(values, dtype=np.float64)
    if not np.isfinite(array).all():
        raise FaultError("what is to be shown is not finite")
    return {"shape": list(array.shape), "float32": _text(array.astype("<f4"))}


def words(values: Any) -> document.Words:
    """Whole numbers from 0 to 65,535."""
    array = np.asarray(values)
    if array.size and not (array.min() >= 0 and array.max() < 1 << 16):
        raise FaultError("a number of what is to be shown has more than 16 bits")
    return {"shape": list(array.shape), "uint16": _text(array.astype("<u2"))}


def unpacked(packed: Any) -> NDArray[np.float64]:
    """The numbers again, (shape)."""
    for key, kind in (("float32", "<f4"), ("uint16", "<u2")):
        if key in packed:
            raw = np.frombuffer(base64.b64decode(packed[key]), dtype=kind)
            return raw.astype(np.float64).reshape(packed["shape"])
    raise FaultError("neither float32 nor uint16")


def _text(array: NDArray[Any]) -> str:
    return base64.b64encode(array.tobytes()).decode("ascii")

"""Numbers of Python and NumPy as a document has them: float, int, bool and lists, where that is exact.

What looks like a number but is not one of a document must not get past the reader: units are converted by type, so an
`np.float64` of millimetres would be taken for as many metres.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.scenes.bounds import MAX_DEPTH
from assur.scenes.faults import DocumentError, Path, dotted

PLAIN = frozenset((str, float, int, bool, type(None)))
"""Types of a document's leaves."""
ALLOWED = "a number that a float or an int is exactly"


def plain(document: object, path: Path = ()) -> Any:
    """The document with numbers and arrays of NumPy, and subclasses of float and int, as plain numbers and lists.

    Raises `DocumentError` for a number that is not exactly one of these (`Decimal`, `Fraction`, complex, an extended
    float between two floats), and for nesting without end. Whatever else is no number is left for the model to refuse,
    NaN and infinity, too.
    """
    if type(document) in PLAIN:
        return document
    if len(path) >= MAX_DEPTH:
        raise DocumentError(dotted(path[:4]), "deeper nesting", f"nesting up to {MAX_DEPTH} levels")
    if isinstance(document, dict):
        return {
            key: value if type(value) in PLAIN else plain(value, (*path, str(key))) for key, value in document.items()
        }
    if isinstance(document, list) or (isinstance(document, np.ndarray) and document.ndim):
        return [value if type(value) in PLAIN else plain(value, (*path, i)) for i, value in enumerate(document)]
    return _scalar(document[()] if isinstance(document, np.ndarray) else document, path)


def _scalar(value: object, path: Path) -> object:
    if isinstance(value, str):
        return str(value)
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, np.timedelta64):  # NumPy counts it among the whole numbers, whatever its unit
        raise DocumentError(dotted(path), value, ALLOWED)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        number = float(value)
        if number == value or number != number:
            return number
    elif not any(hasattr(value, name) for name in ("__float__", "__index__", "__complex__")):
        return value
    raise DocumentError(dotted(path), value, ALLOWED)

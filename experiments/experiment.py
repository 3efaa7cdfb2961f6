"""What an experiment hands over: numbers, a paragraph that puts the claim beside them, and how to draw the figure.

Numbers come first and need no plotting library; drawing gets an empty figure in the shared style (`figures`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Drawing = Any
"""A figure, or axes, of matplotlib, whose own types differ from release to release."""


@dataclass(frozen=True)
class Result:
    """One experiment, run: `numbers` that JSON can hold, units in the keys; `paragraph` in Markdown; and the figure,
    drawn by `draw` on `size` (width, height) inches."""

    numbers: dict[str, Any]
    paragraph: str
    size: tuple[float, float]
    draw: Callable[[Drawing], None]

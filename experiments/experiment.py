"""The result of an experiment: numbers, paragraphs that compare them with the claim, and how to draw the figure.

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
    """One experiment, run: `numbers` that JSON can hold, units in the keys; `paragraph`, the report on them in
    Markdown (`paragraphs`); and the figure, drawn by `draw` on `size` (width, height) inches."""

    numbers: dict[str, Any]
    paragraph: str
    size: tuple[float, float]
    draw: Callable[[Drawing], None]


def paragraphs(claim: str, measured: str, verdict: str, mended: str = "") -> str:
    """What the paper claims, what was measured and where it is drawn, whether the claim holds, and what had to be
    mended, as paragraphs of Markdown that say which is which. A part may itself be of two paragraphs."""
    parts = {"Claim": claim, "Measured": measured, "Verdict": verdict, "Mended": mended}
    return "\n\n".join(f"**{head}.** {words}" for head, words in parts.items() if words)

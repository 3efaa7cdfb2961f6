"""Five cells with streams of parts, published as cell files: `assur simulate benchmarks/flows/NAME.yaml`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import assur

FOLDER = Path(__file__).parent
FLOWS = ("belt-to-nest", "one-lane", "upstream-nest", "mixed-parts", "two-belts-two-places")
"""Names of the cells."""


def flow(name: str) -> dict[str, Any]:
    """A cell, as its file has it."""
    return dict(assur.load(FOLDER / f"{name}.yaml"))

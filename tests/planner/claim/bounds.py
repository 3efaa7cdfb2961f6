"""What the columns of a claim may hold, in plain Python."""

from __future__ import annotations

import numpy as np

from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim


def outside(claim: Claim) -> list[str]:
    """The columns of a claim that hold a number which they may not hold."""
    counts = {name: float(len(table)) for name, table in claim._asdict().items()}
    counts |= {**c.RANGES, "own links": float(claim.arms[0, c.ARM_LINKS])}
    found = []
    for name, first, many, low, high in c.BOUNDS:
        values = getattr(claim, name)[:, first : None if many < 0 else first + many]
        if isinstance(high, str):
            right = (values >= low) & (values < counts[high]) & (values == np.floor(values))
        else:
            right = (values >= low) & (values <= high)
        if not right.all():
            found.append(f"{name}, from column {first} on")
    return found

"""What one normal a row amounts to, for many rows at once (equations C2, C3 and C4 in docs/guarantees.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.model.clearance import SLACK_M


@dataclass(frozen=True, slots=True)
class Claim:
    """What one normal a row amounts to: gaps at start, middle, end, bounds, and the bound of the gap in between."""

    normal: FloatArray
    gap0: FloatArray
    gap_mid: FloatArray
    gap1: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    least: FloatArray
    required: FloatArray

    @property
    def proved(self) -> BoolArray:
        return self.least - SLACK_M >= self.required

    def better(self, other: Claim) -> Claim:
        """Row by row, the one with more to spare."""
        take = ~(self.least - self.required >= other.least - other.required)
        chosen = {}
        for name in Claim.__slots__:
            mine, its = getattr(self, name), getattr(other, name)
            chosen[name] = np.where(take[:, None] if mine.ndim == 2 else take, its, mine)
        return Claim(**chosen)


def take(claim: Claim, key: BoolArray | IntArray) -> Claim:
    return Claim(*(getattr(claim, name)[key] for name in Claim.__slots__))


def put(claim: Claim, where: IntArray, found: Claim) -> Claim:
    result = Claim(*(getattr(claim, name).copy() for name in Claim.__slots__))
    for name in Claim.__slots__:
        getattr(result, name)[where] = getattr(found, name)
    return result

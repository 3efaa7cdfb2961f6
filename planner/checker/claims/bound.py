"""Whether a lower bound of the duration that an answer states is proved."""

from __future__ import annotations

from assur.planner.checker.bound.duration import least_duration
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.scene import Scene


def bound(scene: Scene, lasts: float, claimed: float | None) -> list[Finding]:
    """A finding if a plan that takes `lasts` seconds, or any other of the request, is not proved to take as long as is
    `claimed` (None: nothing is)."""
    if claimed is None or claimed <= 0.0:
        return []
    where = "lower_bound_s"
    if not claimed <= lasts + TIME_S:
        what = f"{where} is {claimed:.6f}, but this plan takes only {lasts:.6f}"
        return [Finding(Code.CLAIM, what, claimed - lasts, "s", where)]
    proved = least_duration(scene)
    if proved is None:
        return [Finding(Code.CLAIM, f"{where} is {claimed:.6f}, but no bound can be proved", where=where)]
    if not claimed <= proved + TIME_S:
        what = f"{where} is {claimed:.6f}, but only {proved:.6f} can be proved"
        return [Finding(Code.CLAIM, what, claimed - proved, "s", where)]
    return []

"""How far the planning of a request has come, for whoever watches it, and may end it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Progress:
    """The search so far. `stage`: the search for a plan, or that for a change of the request that would help.

    `candidates` tried; `steps` of the task up to which some candidate came; `duration_s` of the best plan (None: there
    is none yet) and `lower_bound_s`, which no plan beats (None: not known yet).
    """

    stage: Literal["search", "relaxation"]
    elapsed_s: float
    candidates: int
    steps: int
    duration_s: float | None
    lower_bound_s: float | None


Watch = Callable[[Progress], None]
"""Is told now and then, from the thread that plans. What it raises ends the planning and is raised there."""

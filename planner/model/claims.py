"""What an answer says of a plan beside the plan itself. What it leaves out is no claim."""

from __future__ import annotations

from dataclasses import dataclass

from assur.planner.model.load import Carried
from assur.planner.model.outcome import Contact, JointPeak, Nearest, ToolPeaks


@dataclass(frozen=True, slots=True)
class Claims:
    """Claims about one plan, each None where nothing is claimed.

    `nearest`: the smallest clearance of the arm, its tool and what it holds, and `placed` that of parts that were put
    down, (None,) being that there is nothing to keep apart; `pairs`: how near pairs of
    bodies come; `carried`: the loads; `contacts`: which bodies may touch; `peaks`: of the joints; `tool`: of the tool
    point over all of the motion, and `tool_acceleration`, m/s², the largest while a part is carried (where none is:
    over all of the motion). `singularity`, `parallel`: the least margins; (None,) is that there is none.
    `modes`: the working modes of the arrivals; `lower_bound`, s: a duration that no plan of the request beats.
    `not_checked`: the fields of the answer that are notes.
    """

    nearest: tuple[Nearest | None] | None = None
    placed: tuple[Nearest | None] | None = None
    pairs: tuple[Nearest, ...] = ()
    carried: tuple[Carried, ...] | None = None
    contacts: tuple[Contact, ...] | None = None
    peaks: tuple[JointPeak, ...] | None = None
    tool: ToolPeaks | None = None
    tool_acceleration: float | None = None
    singularity: tuple[float | None] | None = None
    parallel: tuple[float | None] | None = None
    modes: tuple[str | None, ...] | None = None
    not_checked: tuple[str, ...] = ()
    lower_bound: float | None = None


NOTHING = Claims()

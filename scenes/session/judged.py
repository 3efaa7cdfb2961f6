"""The plan of a task in a cell that is kept, and the checker's verdict on its answer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.faults import located
from assur.scenes.proposals.files import answer_to_task
from assur.scenes.requests import cell_of, check_cell
from assur.scenes.tasks.joining import joined
from assur.scenes.tasks.kept_cell import KeptCellFile, TaskOfCell, of_task

if TYPE_CHECKING:
    from assur.planner.model.outcome import Plan
    from assur.scenes.reading.cell import Cell

Document = dict[str, Any]


@dataclass(frozen=True, eq=False)
class JudgedAnswer:
    """The `answer` to the `request` of a task, which makes the `cell`; `plan`: that of the answer, None where there is
    none. `verdict`: on an answer with a plan."""

    request: Document
    cell: Cell
    answer: Document
    plan: Plan | None = None
    verdict: Document | None = None

    @property
    def reason(self) -> str:
        """Why the answer has no plan that the checker accepts; empty where it has one."""
        if self.verdict is None:
            return str(self.answer["sentence"])
        return "" if self.verdict["ok"] else f"the checker refuses it: {self.verdict['findings'][0]['what']}"


def judged(kept: KeptCellFile, task: Document) -> JudgedAnswer:
    """The answer to a task, as `KeptCellFile.plan` gives it. The checker judges the answer, and the search leaves its
    plan to that. Where the answer is refused, the search is made once more, and has its plans checked.

    Raises `DocumentError`, as `KeptCellFile.plan`.
    """
    from assur.planner.model.outcome import Planned
    from assur.planner.pipeline import plan
    from assur.scenes.answer import answer_of

    made = kept.joined(task)
    try:
        cell = cell_of(made.request, task=TaskOfCell(kept, made))
        for checked in (False, True):
            with located(cell.document):
                outcome = plan(cell.scene, checked=checked)
            answer = dict(answer_of(cell, outcome))
            if not isinstance(outcome, Planned):
                answer = answer_to_task(answer, made, lambda values: joined(kept.file, task, values))
                return JudgedAnswer(made.request, cell, answer)
            found = JudgedAnswer(made.request, cell, answer, outcome.plan, check_cell(cell, answer))
            if not found.reason:
                break
    except InputError as error:
        raise of_task(made.relocated(error)) from error
    return found

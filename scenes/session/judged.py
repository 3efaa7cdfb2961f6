"""The plan of a task in a cell that is kept, and the checker's verdict on it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.faults import located
from assur.scenes.proposals.files import answer_to_task
from assur.scenes.requests import cell_of
from assur.scenes.tasks.joining import joined
from assur.scenes.tasks.kept_cell import KeptCellFile, TaskOfCell, of_task
from assur.scenes.tasks.origins import Joined

if TYPE_CHECKING:
    from assur.planner.checker.verdict import Verdict
    from assur.planner.model.outcome import Outcome, Plan
    from assur.scenes.reading.cell import Cell

Document = dict[str, Any]


@dataclass(frozen=True, eq=False)
class JudgedOutcome:
    """The `outcome` of planning a `task` in a cell that is kept. Both make the `request`, and this the `cell`. `plan`:
    that of the outcome, and `verdict`: the checker's on it; both are None where there is no plan."""

    kept: KeptCellFile
    task: Document
    made: Joined
    cell: Cell
    outcome: Outcome
    plan: Plan | None = None
    verdict: Verdict | None = None

    @property
    def request(self) -> Document:
        return self.made.request

    @cached_property
    def answer(self) -> Document:
        """The answer to the request, as `KeptCellFile.plan` gives it. It is written when it is read first."""
        from assur.scenes.answer import answer_of

        answer = dict(answer_of(self.cell, self.outcome))
        return answer_to_task(answer, self.made, lambda values: joined(self.kept.file, self.task, values))

    @property
    def reason(self) -> str:
        """Why there is no plan that the checker accepts; empty where there is one."""
        if self.verdict is None:
            return str(self.answer["sentence"])
        return "" if self.verdict.ok else f"the checker refuses it: {self.verdict.findings[0].what}"


def judged(kept: KeptCellFile, task: Document) -> JudgedOutcome:
    """The outcome of planning a task. The checker judges the plan with the knots that its answer has, and the search
    leaves its plan to that. Where the plan is refused, the search is made once more, and has its plans checked.

    Raises `DocumentError`, as `KeptCellFile.plan`.
    """
    from assur.planner.checked import check
    from assur.planner.model.outcome import Planned
    from assur.planner.pipeline import plan
    from assur.scenes.written_knots import with_rounded_knots

    made = kept.joined(task)
    try:
        cell = cell_of(made.request, task=TaskOfCell(kept, made))
        for checked in (False, True):
            with located(cell.document):
                outcome = plan(cell.scene, checked=checked)
            if not isinstance(outcome, Planned):
                return JudgedOutcome(kept, task, made, cell, outcome)
            outcome = replace(outcome, plan=with_rounded_knots(cell, outcome.plan))
            verdict = check(cell.scene, outcome.plan)
            found = JudgedOutcome(kept, task, made, cell, outcome, outcome.plan, verdict)
            if verdict.ok:
                break
    except InputError as error:
        raise of_task(made.relocated(error)) from error
    return found

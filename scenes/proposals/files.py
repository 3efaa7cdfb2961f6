"""A proposed change of a request as values of the cell and the task that the request comes from."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.proposals.edits import value_at
from assur.scenes.schema.normal import normal
from assur.scenes.set_values import GIVEN, Changed
from assur.scenes.tasks.origins import Joined

Origin = tuple[str, str, object]
"""The document that has a value (`OF_CELL`, `OF_TASK` or `GIVEN`), its field there, and the value."""
STEP = re.compile(r"task\[(\d+)\]\.(\w+)\.(\w+)")
"""A field of a step of a request, with the fields inside."""
SET = "set."
"""What the fields of a task begin with that are values of its cell."""
NUMBER = re.compile(r"\[(\d+)\]")


def answer_to_task(
    answer: dict[str, Any], made: Joined, again: Callable[[Mapping[str, object]], Joined]
) -> dict[str, Any]:
    """The answer to a request that a cell and a task made, as one to the task: the change that it proposes is stated by
    paths of the task and the cell. `again`: the request that both make with values that are set last."""
    proposed = answer.get("relaxation")
    if not proposed or not proposed["set"]:
        return answer
    found = values_of_task(made, proposed["set"], again)
    return {**answer, "relaxation": {**proposed, "set": found}}


def values_of_task(
    made: Joined, values: Mapping[str, object], again: Callable[[Mapping[str, object]], Joined]
) -> dict[str, Any] | None:
    """The values of a request as values of its task and cell; None: none make the same request."""
    changed = Changed(made.request, values, "")
    wanted = normal(changed.document)
    for origins in origins_of(made, changed):
        found = {NUMBER.sub(r".\1", field.removeprefix(SET)): value for _, field, value in origins}
        try:
            if normal(again(found).request) == wanted:
                return found
        except InputError:
            continue
    return None


def origins_of(made: Joined, changed: Changed) -> Iterator[list[Origin]]:
    """Where the fields that were changed in a request may be changed in the task and the cell: in the step itself;
    where the values were written; and in the step, as a whole what the step had of elsewhere."""
    for place in (_in_step, _written, _whole_in_step):
        found = [place(made, changed.document, field) for field in changed.fields]
        yield [(*_split(field), value) for field, value in found]


def _split(field: str) -> tuple[str, str]:
    if field.startswith(GIVEN):
        return GIVEN, field.removeprefix(GIVEN)
    head, _, inside = field.partition(".")
    return head, inside


def _in_step(made: Joined, changed: Any, field: str) -> tuple[str, object]:
    step = STEP.match(field)
    if step is None:
        return _written(made, changed, field)
    head = f"task[{step[1]}]"
    return made.origin(head) + field[len(head) :], value_at(changed, field)


def _whole_in_step(made: Joined, changed: Any, field: str) -> tuple[str, object]:
    step = STEP.match(field)
    return _in_step(made, changed, field if step is None else step[0])


def _written(made: Joined, changed: Any, field: str) -> tuple[str, object]:
    return made.origin(field), value_at(changed, field)

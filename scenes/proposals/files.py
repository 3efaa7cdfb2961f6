"""A proposed change of a request as values of the cell and the task that the request comes from."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.proposals.edits import in_unit, is_written, other_unit, value_at
from assur.scenes.schema.normal import normal
from assur.scenes.set_values import GIVEN, Changed
from assur.scenes.tasks.origins import OF_CELL, OF_TASK, Joined

Origin = tuple[str, str, object]
"""The document that has a value (`OF_CELL`, `OF_TASK` or `GIVEN`), its field there, and the value."""
STEP = re.compile(r"task\[(\d+)\]\.(\w+)\.(\w+)")
"""A field of a step of a request, with the fields inside."""
TRANSFER = re.compile(r"steps(?:\[|\.)(\d+)\]?\.transfer\Z")
"""A step of a task that is a transfer."""
OF_PART = ("pick", "place")
"""The steps of a request for each part of a transfer."""
SET = "set."
"""What the fields of a task begin with that are values of its cell."""
KEYS = re.compile(r"\w+(?=[.\[]|\Z)")
"""The keys of a field."""
NUMBER = re.compile(r"\[(\d+)\]")


def answer_to_task(
    answer: dict[str, Any], made: Joined, again: Callable[[Mapping[str, object]], Joined]
) -> dict[str, Any]:
    """The answer to a request that a cell and a task made, as one to the task: the change that it proposes is stated by
    paths of the task and the cell, and names the part of a transfer that it is for. `again`: the request that both make
    with values that are set last."""
    proposed = answer.get("relaxation")
    if not proposed or not proposed["set"]:
        return answer
    found = values_of_task(made, proposed["set"], again)
    part = part_of_transfer(made, Changed(made.request, proposed["set"], ""))
    value = f"{proposed['value']}, for {part}" if part else proposed["value"]
    return {**answer, "relaxation": {**proposed, "value": value, "set": found}}


def part_of_transfer(made: Joined, changed: Changed) -> str:
    """In words, the part of a transfer of several parts whose pick or place is all that was changed in a request; empty
    if there is none."""
    numbers = {None if step is None else int(step[1]) for step in map(STEP.match, changed.fields)}
    number = numbers.pop() if len(numbers) == 1 else None
    if number is None:
        return ""
    origins = [made.origin(f"task[{each}]") for each in range(len(made.request["task"]))]
    transfer = TRANSFER.search(origins[number])
    if transfer is None or origins.count(origins[number]) <= len(OF_PART):
        return ""
    kind = next(each for each in OF_PART if each in made.request["task"][number])
    part = made.request["task"][number][kind]["part"]
    return f"the {kind} of {part} in step {int(transfer[1]) + 1}, transfer; the others keep their values"


def values_of_task(
    made: Joined, values: Mapping[str, object], again: Callable[[Mapping[str, object]], Joined]
) -> dict[str, Any] | None:
    """The values of a request as values of its task and cell; None: none make the same request."""
    changed = Changed(made.request, values, "")
    wanted = normal(changed.document)
    for origins in origins_of(made, changed):
        given = (_in_unit_of_cell(made.cell, *each) for each in origins)
        found = {NUMBER.sub(r".\1", field.removeprefix(SET)): value for field, value in given}
        try:
            if normal(again(found).request) == wanted:
                return found
        except InputError:
            continue
    return None


def _in_unit_of_cell(cell: dict[str, Any], document: str, field: str, value: object) -> tuple[str, object]:
    """A value at a field, under the key in the other unit where the cell is written so."""
    if document == OF_CELL:
        for key in KEYS.findall(field):
            other = field.replace(f".{key}", f".{other_unit(key)}")
            if other_unit(key) and is_written(cell, other) and not is_written(cell, field):
                return other, in_unit(value, key, other_unit(key))
    return field, value


def origins_of(made: Joined, changed: Changed) -> Iterator[list[Origin]]:
    """Where the fields that were changed in a request may be changed in the task and the cell: in the step itself;
    where the values were written; in the step, as a whole what the step had of elsewhere; and in a transfer, whose
    window is left out."""
    for place in (_in_step, _written, _whole_in_step, _without_window):
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


def _without_window(made: Joined, changed: Any, field: str) -> tuple[str, object]:
    origin = made.origin(field)
    if TRANSFER.search(origin) is None:
        return _written(made, changed, field)
    own = value_at(made.task, origin.removeprefix(f"{OF_TASK}."))
    return origin, {key: value for key, value in own.items() if not key.startswith("window_")}


def _written(made: Joined, changed: Any, field: str) -> tuple[str, object]:
    return made.origin(field), value_at(changed, field)

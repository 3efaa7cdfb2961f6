"""No forged answer is believed: each of more than a hundred lies is refused, and the answers that they are made of are
not."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.planner.model.digest import digest
from assur.planner.report.straight_parts import assumed
from assur.scenes.reading.cell import Cell
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, check_plan, read_plan
from tests.scenes.forged_cells import SHIPPED, SMALL, answered, request_of
from tests.scenes.forgeries import FORGERIES, Forgery

KINDS = 100
"""So many kinds of lies there are at least."""


def sealed(cell: Cell, answer: dict[str, Any]) -> dict[str, Any]:
    """The answer with a digest that fits it, as anyone can compute it; as it is where it is no plan any more."""
    try:
        made, _ = plan_of(answer, cell.conventions)
    except InputError:
        return answer
    fits = digest(cell.scene.digest, made.trajectory, made.legs, made.arrivals, made.certificate)
    return {**answer, "certificate": {**answer["certificate"], "digest": fits}}


def forged(forgery: Forgery) -> tuple[Cell, dict[str, Any]]:
    """The cell that an answer is shown for, and the answer."""
    cell, true = answered(forgery.cell)
    answer = copy.deepcopy(true)
    if forgery.request is not None:
        request, folder = request_of(forgery.cell)
        forgery.request(request)
        cell = cell_of(request, folder=folder)
        assert cell.scene.digest != true["request_digest"], "the request is the same"
        scene = cell.scene
        answer |= {"request_digest": scene.digest, "assumptions": list(assumed(scene))}
        answer["margins"]["tool_acceleration_limit_m_s2"] = scene.carry_acceleration
        answer = sealed(cell, answer)
    else:
        assert forgery.cell in {**SMALL, **SHIPPED}
    before = copy.deepcopy(answer)
    forgery.change(answer)
    assert forgery.request is not None or answer != before, "nothing is changed"
    return cell, sealed(cell, answer) if forgery.sealed else answer


def findings(cell: Cell, answer: dict[str, Any]) -> list[str]:
    """What the checker finds; an answer that cannot be read is refused, too."""
    try:
        verdict = check_plan(cell, *read_plan(cell, answer))
    except InputError as error:
        return [str(error)]
    assert verdict["ok"] is not bool(verdict["findings"])
    return [f"{each['code']}: {each['what']} ({each['where']})" for each in verdict["findings"]]


@pytest.mark.parametrize("name", [*SMALL, *SHIPPED])
def test_the_answers_themselves_are_right(name: str) -> None:
    cell, answer = answered(name)
    assert answer["status"] == "planned", answer.get("sentence")
    assert findings(cell, answer) == []
    assert sealed(cell, answer) == answer


def test_there_are_as_many_kinds_as_are_promised() -> None:
    assert len({forgery.name for forgery in FORGERIES}) == len(FORGERIES) >= KINDS


@pytest.mark.parametrize("forgery", FORGERIES, ids=str)
def test_a_lie_is_refused(forgery: Forgery) -> None:
    cell, answer = forged(forgery)
    assert findings(cell, answer), f"{forgery.name} is believed"

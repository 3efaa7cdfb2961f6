"""No forgery is accepted: each is shown to every judge that must refuse it, and what forgeries are made of is right."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker.claim.verdict import check_claim
from assur.planner.claim.columns import Claim
from assur.planner.errors import InputError
from assur.planner.model.digest import digest
from assur.scenes.reading.cell import Cell
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import check_plan, read_plan
from tests.forgeries import answers, claims, omissions, requests
from tests.forgeries.answers import ANSWERS
from tests.forgeries.claims import CLAIMS, read
from tests.forgeries.omissions import MORE, OMISSIONS
from tests.forgeries.requests import REQUESTS, shown_for
from tests.forgeries.stated import STATED, document_of
from tests.planner.checker.statement.cases import Case, case_of, differences
from tests.prover.bundles import Document, shown
from tests.scenes.forged_cells import SHIPPED, SMALL, answered


def names(forgeries: Sequence[Any]) -> list[str]:
    """The names of forgeries, each of which comes first in its row."""
    return [each[0] for each in forgeries]


@pytest.mark.parametrize("forgeries", [ANSWERS, REQUESTS, CLAIMS, OMISSIONS, MORE])
def test_forgeries_have_names_of_their_own(forgeries: Sequence[Any]) -> None:
    assert len({(each[0], each[1]) for each in forgeries}) == len(forgeries)


def sealed(cell: Cell, answer: dict[str, Any]) -> dict[str, Any]:
    """The answer with a digest that fits it, as anyone can compute it; as it is where it is no plan any more."""
    try:
        made, _ = plan_of(answer, cell.conventions)
    except InputError:
        return answer
    fits = digest(cell.scene.digest, made.trajectory, made.legs, made.arrivals, made.certificate)
    return {**answer, "certificate": {**answer["certificate"], "digest": fits}}


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


@pytest.mark.parametrize("forgery", ANSWERS, ids=names(ANSWERS))
def test_a_forged_answer_is_refused(forgery: answers.Forgery) -> None:
    cell, true = answered(forgery.cell)
    answer = copy.deepcopy(true)
    forgery.change(answer)
    assert answer != true
    found = findings(cell, sealed(cell, answer) if forgery.sealed else answer)
    assert any(each.startswith(forgery.finds) for each in found), found


@pytest.mark.parametrize("other", REQUESTS, ids=names(REQUESTS))
def test_a_plan_and_its_claim_are_refused_for_another_request(other: requests.Other) -> None:
    case = shown_for(other)
    found = {each.code for each in check(case.scene, case.plan, case.claims).findings}
    assert other.found in found if other.found else not found
    assert other.of_claim in {each.code for each in differences(case)}


def test_claims_with_rows_of_all_kinds_are_right() -> None:
    document = document_of(STATED)
    assert check_claim(read(document)).findings == ()
    assert shown(document)[0]
    assert all(len(table) for table in read(document)[list(Claim._fields).index("points") :])


def forged(forgery: claims.Forgery) -> Document:
    """The forged bundle, which differs from the right one."""
    document = document_of(forgery.scenario)
    forgery.change(document)
    assert repr(document) != repr(document_of(forgery.scenario))
    return document


@pytest.mark.parametrize("forgery", CLAIMS, ids=names(CLAIMS))
def test_a_forged_claim_is_refused(forgery: claims.Forgery) -> None:
    if forgery.code is None:
        with pytest.raises(InputError):
            read(forged(forgery))
        return
    verdict = check_claim(read(forged(forgery)))
    assert not verdict.accepted
    assert forgery.code in {finding.code for finding in verdict.findings}


NOT_OF_THE_PROVER = "a time beyond what rounding is bounded for"
"""The prover bounds rounding at all times. It refuses this claim for its limits."""
BEFORE_THE_PROVER = [each for each in CLAIMS if each.what != NOT_OF_THE_PROVER]


@pytest.mark.parametrize("forgery", BEFORE_THE_PROVER, ids=names(BEFORE_THE_PROVER))
def test_the_prover_refuses_a_forged_claim_too(forgery: claims.Forgery) -> None:
    try:
        right, lines = shown(forged(forgery))
    except ValueError:
        return
    assert not right
    assert lines[-1].startswith("claims that are not shown: ")


def changed(case: Case, claim: Claim) -> bool:
    """Whether a claim differs from that of the case."""
    return any(not np.array_equal(one, other) for one, other in zip(claim, case.claim, strict=True))


@pytest.mark.parametrize("omission", OMISSIONS, ids=names(OMISSIONS))
def test_a_claim_that_states_less_is_reported(omission: omissions.Omission) -> None:
    case = case_of(omission.case)
    assert differences(case) == []
    less = omission.change(case)
    assert changed(case, less)
    assert omission.code in {each.code for each in differences(case, less)}


@pytest.mark.parametrize(("name", "change"), [each[1:] for each in MORE], ids=names(MORE))
def test_a_claim_that_states_more_is_accepted(name: str, change: omissions.Change) -> None:
    case = case_of(name)
    more = change(case)
    assert changed(case, more)
    assert differences(case, more) == []

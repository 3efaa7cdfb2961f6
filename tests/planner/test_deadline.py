"""The deadline in force is the innermost one, and it is looked at only where work asks for it."""

from __future__ import annotations

import time

import pytest

from assur.planner.model.deadline import Deadline, OutOfTimeError, out_of_time, raise_if_late
from assur.scenes.requests import plan_document, shipped


def test_no_deadline_is_in_force_outside() -> None:
    assert not out_of_time()
    raise_if_late()


def test_a_deadline_that_has_passed_ends_the_work_that_looks() -> None:
    with Deadline(time.perf_counter() - 1.0, 0.5), pytest.raises(OutOfTimeError):
        raise_if_late()
    raise_if_late()


def test_the_innermost_deadline_counts_and_the_one_before_it_is_in_force_again() -> None:
    now = time.perf_counter()
    with Deadline(now, -1.0):
        with Deadline(now, 1e6):
            assert not out_of_time()
        assert out_of_time()


def test_a_deadline_ends_where_an_error_leaves_it() -> None:
    with pytest.raises(KeyError), Deadline(time.perf_counter(), -1.0):
        raise KeyError
    assert not out_of_time()


def test_a_request_whose_budget_ends_while_its_cell_is_built_is_answered() -> None:
    request = dict(shipped("demo").request)
    request["options"] = {"budget_s": 0.5, "seed": 7}
    answer = plan_document(request, folder=shipped("demo").folder, started=time.perf_counter() - 1.0)
    assert (answer["status"], answer["reason"], answer["proved"]) == ("not_planned", "TIMED_OUT", False)
    assert "before the cell was built" in answer["sentence"]
    assert answer["cut_by_clock"] is True
    assert answer["seed"] == 7
    assert answer["elapsed_s"] >= 1.0

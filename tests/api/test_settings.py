"""Settings come from the environment, and a wrong one stops the service before it starts."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest

from assur.api.web.settings import PREFIX, Settings, processors
from assur.planner.errors import InputError

PAGE = Path(__file__).parents[2] / "docs" / "service.md"


def test_an_empty_environment_gives_the_defaults() -> None:
    assert Settings.from_environment({}) == Settings()


def test_variables_of_others_are_not_read() -> None:
    assert Settings.from_environment({"PORT": "9", "WORKERS": "x", "MYASSUR_PORT": "9"}) == Settings()


def test_each_setting_is_read_from_its_own_variable() -> None:
    given = {
        "ASSUR_HOST": "0.0.0.0",
        "ASSUR_PORT": "0",
        "ASSUR_WORKERS": "3",
        "ASSUR_QUEUE": "0",
        "ASSUR_QUEUE_WAIT_S": "1.5",
        "ASSUR_MAX_BUDGET_S": "2",
        "ASSUR_GRACE_S": "0.25",
        "ASSUR_CHECK_S": "7",
        "ASSUR_WARM_S": "60",
        "ASSUR_BODY_S": "3",
        "ASSUR_MAX_TASKS": "10",
        "ASSUR_WORKER_MEMORY_MIB": "1024",
        "ASSUR_JOBS_KEPT": "4",
        "ASSUR_JOB_KEPT_S": "5",
        "ASSUR_CONNECTIONS": "9",
        "ASSUR_LOG_LEVEL": "warning",
        "ASSUR_CONNECTIONS_PER_ADDRESS": "8",
        "ASSUR_HEADER_S": "2.5",
        "ASSUR_KEEP_ALIVE_S": "61",
        "ASSUR_WRITE_S": "11",
        "ASSUR_DRAIN_S": "6",
        "ASSUR_REPLICA": "a1",
    }
    assert {PREFIX + field.name.upper() for field in fields(Settings)} == set(given)
    assert Settings.from_environment(given) == Settings(
        "0.0.0.0", 0, 3, 0, 1.5, 2.0, 0.25, 7.0, 60.0, 3.0, 10, 1024, 4, 5.0, 9, "warning",
        8, 2.5, 61.0, 11.0, 6.0, "a1",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ASSUR_PORT", "tcp://10.0.0.1:8000"),
        ("ASSUR_PORT", "65536"),
        ("ASSUR_REPLICA", "a-b"),
        ("ASSUR_PORT", ""),
        ("ASSUR_PORT", "٣"),
        ("ASSUR_PORT", "9" * 5000),
        ("ASSUR_WORKERS", "-1"),
        ("ASSUR_WORKERS", "2.0"),
        ("ASSUR_MAX_BUDGET_S", "nan"),
        ("ASSUR_MAX_BUDGET_S", "inf"),
        ("ASSUR_MAX_BUDGET_S", "0"),
        ("ASSUR_GRACE_S", "half"),
        ("ASSUR_LOG_LEVEL", "INFO"),
        ("ASSUR_HOST", "a b"),
        ("ASSUR_HOST", ""),
        ("ASSUR_WORKER", "2"),
        ("ASSUR_", "2"),
    ],
)
def test_a_value_that_is_not_allowed_and_a_misspelt_name_are_refused_by_name(name: str, value: str) -> None:
    with pytest.raises(InputError) as refused:
        Settings.from_environment({name: value})
    assert refused.value.field == name


def test_a_misspelt_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(InputError, match=r"allowed: one of .*; did you mean ASSUR_MAX_BUDGET_S\?"):
        Settings.from_environment({"ASSUR_MAX_BUDGETS": "2"})


def test_no_number_of_workers_means_one_per_processor() -> None:
    assert Settings(workers=0).processes == processors() >= 1
    assert Settings(workers=5).processes == 5


def test_a_stopping_service_has_time_for_the_slowest_request_that_it_accepted() -> None:
    settings = Settings(body_s=1, queue_wait_s=2, max_budget_s=3, grace_s=0.5, check_s=4)
    assert settings.stop_s >= 1 + 2 + 2 * 3 + 0.5


def test_the_page_on_the_service_lists_every_setting_with_its_default() -> None:
    rows = dict(re.findall(r"^\| `(ASSUR_\w+)` \| `?([^`|]*?)`? \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    assert rows == {PREFIX + field.name.upper(): _text(field.default) for field in fields(Settings)}


def _text(default: object) -> str:
    return f"{default:g}" if isinstance(default, float) else str(default)

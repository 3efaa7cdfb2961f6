"""Settings come from the environment, and a wrong one stops the service before it starts."""

from __future__ import annotations

import re
from dataclasses import asdict, fields
from pathlib import Path

import pytest

from assur.api.web.settings import PREFIX, Settings, processors
from assur.planner.errors import InputError
from tests.refused import refused_at

PAGE = Path(__file__).parents[2] / "docs" / "operating.md"


def test_an_empty_environment_gives_the_defaults() -> None:
    assert Settings.from_environment({}) == Settings()


def test_variables_of_others_are_not_read() -> None:
    assert Settings.from_environment({"PORT": "9", "WORKERS": "x", "MYASSUR_PORT": "9"}) == Settings()


TEXTS = {
    "host": "0.0.0.0",
    "log_level": "warning",
    "keys_file": "/run/keys.json",
    "forwarded_from": "10.0.0.0/8, 192.0.2.1",
    "replica": "a-1",
    "commit": "0a1b2c",
    "mesh_folder": "/var/meshes",
}
"""For each setting that is a text, a value that is not the default. The others are numbers in a range."""


def test_each_text_is_read_from_its_own_variable() -> None:
    read = Settings.from_environment({PREFIX + name.upper(): text for name, text in TEXTS.items()})
    assert asdict(read) == {**asdict(Settings()), **TEXTS}
    assert not TEXTS.items() & asdict(Settings()).items()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ASSUR_PORT", "tcp://10.0.0.1:8000"),
        ("ASSUR_PORT", "65536"),
        ("ASSUR_PORT", ""),
        ("ASSUR_PORT", "٣"),
        ("ASSUR_PORT", "9" * 5000),
        ("ASSUR_WORKERS", "-1"),
        ("ASSUR_COMMIT", "a b"),
        ("ASSUR_WORKERS", "2.0"),
        ("ASSUR_MAX_BUDGET_S", "nan"),
        ("ASSUR_MAX_BUDGET_S", "inf"),
        ("ASSUR_MAX_BUDGET_S", "0"),
        ("ASSUR_GRACE_S", "half"),
        ("ASSUR_LOG_LEVEL", "INFO"),
        ("ASSUR_HOST", "a b"),
        ("ASSUR_HOST", ""),
        ("ASSUR_FORWARDED_FROM", "10.0.0.1/8"),
        ("ASSUR_FORWARDED_FROM", "*"),
        ("ASSUR_REPLICA", "a-"),
        ("ASSUR_KEYS_FILE", "a\nb"),
        ("ASSUR_WORKER", "2"),
        ("ASSUR_", "2"),
    ],
)
def test_a_value_that_is_not_allowed_and_a_misspelt_name_are_refused_by_name(name: str, value: str) -> None:
    with refused_at(name):
        Settings.from_environment({name: value})


def test_a_misspelt_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(InputError, match=r"allowed: one of .*; did you mean ASSUR_MAX_BUDGET_S\?"):
        Settings.from_environment({"ASSUR_MAX_BUDGETS": "2"})


def test_no_number_of_workers_means_one_per_processor() -> None:
    assert Settings(workers=0).processes == processors() >= 1
    assert Settings(workers=5).processes == 5


def test_a_stopping_service_has_time_for_the_slowest_request_that_it_accepted() -> None:
    settings = Settings(body_s=1, queue_wait_s=2, max_budget_s=3, grace_s=0.5, check_s=4)
    assert settings.stop_s >= 1 + 2 + 2 * 3 + 0.5


def test_the_page_lists_every_setting_with_its_default_what_is_allowed_and_its_meaning() -> None:
    rows = re.findall(
        r"^\| `(ASSUR_\w+)` \| `?([^`|]*?)`? \| ([^|]+) \| ([^|]+) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE
    )
    assert [(name, default, allowed, _plain(about)) for name, default, allowed, about in rows] == [
        (
            PREFIX + field.name.upper(),
            _text(field.default),
            field.metadata["reader"].allowed,
            _plain(field.metadata["about"]),
        )
        for field in fields(Settings)
    ]


def test_the_ends_of_each_range_that_is_stated_are_accepted_and_what_is_beyond_is_not() -> None:
    ranges = {
        field.name: re.fullmatch(r"(a whole number|seconds) from (\S+) to (\S+)", field.metadata["reader"].allowed)
        for field in fields(Settings)
    }
    assert [name for name, found in ranges.items() if found is None] == [name for name in ranges if name in TEXTS]
    for name, found in ranges.items():
        if found is None:
            continue
        variable, (lowest, highest) = PREFIX + name.upper(), (float(end) for end in found.groups()[1:])
        step = 1.0 if found[1] == "a whole number" else 0.001
        for value in (lowest, highest):
            read = Settings.from_environment({variable: f"{value:.12g}"})
            assert asdict(read) == {**asdict(Settings()), name: value}
        for value in (lowest - step, highest + step):
            with pytest.raises(InputError):
                Settings.from_environment({variable: f"{value:.15g}"})


def _plain(text: str) -> str:
    """A text without code spans and links."""
    return re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", text).replace("`", "")


def _text(default: object) -> str:
    return f"{default:g}" if isinstance(default, float) else str(default)

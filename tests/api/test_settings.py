"""Settings come from the environment, and a wrong one stops the service before it starts."""

from __future__ import annotations

import re
from dataclasses import asdict, fields
from pathlib import Path

import pytest

from assur.api.web.settings import PREFIX, Settings, processors
from assur.planner.errors import InputError

PAGE = Path(__file__).parents[2] / "docs" / "operating.md"


def test_an_empty_environment_gives_the_defaults() -> None:
    assert Settings.from_environment({}) == Settings()


def test_variables_of_others_are_not_read() -> None:
    assert Settings.from_environment({"PORT": "9", "WORKERS": "x", "MYASSUR_PORT": "9"}) == Settings()


EACH: dict[str, tuple[str, object]] = {
    "host": ("0.0.0.0", "0.0.0.0"),
    "port": ("0", 0),
    "workers": ("3", 3),
    "queue": ("0", 0),
    "queue_wait_s": ("1.5", 1.5),
    "max_budget_s": ("2", 2.0),
    "grace_s": ("0.25", 0.25),
    "check_s": ("7", 7.0),
    "warm_s": ("60", 60.0),
    "body_s": ("3", 3.0),
    "max_tasks": ("10", 10),
    "worker_memory_mib": ("1024", 1024),
    "jobs_kept": ("4", 4),
    "job_kept_s": ("5", 5.0),
    "connections": ("9", 9),
    "log_level": ("warning", "warning"),
    "short_s": ("0.5", 0.5),
    "short_workers": ("2", 2),
    "client_running": ("3", 3),
    "client_waiting": ("0", 0),
    "client_seconds": ("60", 60),
    "keys_file": ("/run/keys.json", "/run/keys.json"),
    "forwarded_from": ("10.0.0.0/8, 192.0.2.1", "10.0.0.0/8, 192.0.2.1"),
    "quarantine_s": ("60", 60.0),
    "replica": ("a-1", "a-1"),
    "results_mib": ("64", 64),
    "commit": ("0a1b2c", "0a1b2c"),
    "mesh_folder": ("/var/meshes", "/var/meshes"),
    "mesh_quota_mib": ("16", 16),
    "mesh_kept_s": ("60", 60.0),
    "header_s": ("2.5", 2.5),
    "keep_alive_s": ("61", 61.0),
    "drain_s": ("6", 6.0),
}
"""For each setting a text, and what it says; none of them is the default."""


def test_each_setting_is_read_from_its_own_variable() -> None:
    assert [field.name for field in fields(Settings)] == list(EACH)
    read = Settings.from_environment({PREFIX + name.upper(): text for name, (text, _) in EACH.items()})
    assert asdict(read) == {name: value for name, (_, value) in EACH.items()}
    assert not [name for name, value in asdict(Settings()).items() if value == EACH[name][1]]


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
    ranges = 0
    for field in fields(Settings):
        found = re.fullmatch(r"(a whole number|seconds) from (\S+) to (\S+)", field.metadata["reader"].allowed)
        if found is None:
            continue
        ranges += 1
        name, (lowest, highest) = PREFIX + field.name.upper(), (float(end) for end in found.groups()[1:])
        step = 1.0 if found[1] == "a whole number" else 0.001
        for value in (lowest, highest):
            assert getattr(Settings.from_environment({name: f"{value:.12g}"}), field.name) == value
        for value in (lowest - step, highest + step):
            with pytest.raises(InputError):
                Settings.from_environment({name: f"{value:.15g}"})
    assert ranges > 20


def _plain(text: str) -> str:
    """A text without code spans and links."""
    return re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", text).replace("`", "")


def _text(default: object) -> str:
    return f"{default:g}" if isinstance(default, float) else str(default)

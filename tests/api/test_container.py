"""What a container gives, from the files in which Linux tells it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from assur.api.web import settings as container
from assur.api.web import settings as settings_module
from assur.api.web.settings import LEAST_MIB, WEB_MIB, Settings, memory_mib, processors
from assur.api.workers.memory import MEMORY_MIB
from assur.planner.errors import InputError

SEEN = len(os.sched_getaffinity(0))


def system(folder: Path, own: str, **files: str) -> tuple[Path, Path]:
    """Folders of control groups with these files (`__` for a slash), and the file that says which group is ours."""
    for name, text in files.items():
        path = folder / "groups" / name.replace("__", "/").replace("_DOT_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n", encoding="utf-8")
    (folder / "own").write_text(own, encoding="utf-8")
    return folder / "groups", folder / "own"


def test_without_groups_there_are_the_processors_that_are_seen_and_no_limit(tmp_path: Path) -> None:
    nothing = tmp_path / "groups", tmp_path / "own"
    assert processors(*nothing) == SEEN
    assert memory_mib(*nothing) is None


@pytest.mark.parametrize(
    ("quota", "found"),
    [("100000 100000", 1), ("50000 100000", 1), ("190000 100000", min(SEEN, 1)), ("max 100000", SEEN)],
)
def test_a_quota_of_version_2_counts_in_whole_processors(tmp_path: Path, quota: str, found: int) -> None:
    assert processors(*system(tmp_path, "0::/\n", cpu_DOT_max=quota)) == found


def test_a_quota_of_version_1_counts(tmp_path: Path) -> None:
    files = {"cpu,cpuacct__cpu_DOT_cfs_quota_us": "100000", "cpu,cpuacct__cpu_DOT_cfs_period_us": "100000"}
    files |= {"cpu__cpu_DOT_cfs_quota_us": "100000", "cpu__cpu_DOT_cfs_period_us": "100000"}
    assert processors(*system(tmp_path, "4:cpu,cpuacct:/docker/abc\n", **files)) == 1
    assert processors(*system(tmp_path, "4:cpu,cpuacct:/\n", cpu__cpu_DOT_cfs_quota_us="-1")) == SEEN


def test_the_least_limit_of_memory_of_all_groups_above_counts(tmp_path: Path) -> None:
    groups = system(
        tmp_path, "0::/pods/one\n", memory_DOT_max="max", pods__memory_DOT_max=str(2 << 30),
        pods__one__memory_DOT_max=str(3 << 30),
    )  # fmt: skip
    assert memory_mib(*groups) == 2048


def test_memory_of_version_1_counts_and_its_number_for_no_limit_does_not(tmp_path: Path) -> None:
    groups = system(tmp_path, "4:memory:/one\n", memory__memory_DOT_limit_in_bytes="9223372036854771712")
    assert memory_mib(*groups) is None
    groups = system(tmp_path, "4:memory:/one\n", memory__one__memory_DOT_limit_in_bytes=str(1 << 30))
    assert memory_mib(*groups) == 1024


def test_what_the_system_says_here_can_be_read() -> None:
    assert 1 <= container.processors() <= SEEN
    assert (container.memory_mib() or 1) > 0


@pytest.mark.parametrize(
    ("has", "workers", "asked", "given"),
    [
        (None, 2, 0, MEMORY_MIB),
        (None, 2, 4096, 4096),
        (WEB_MIB + 2 * 700, 2, 0, 700),
        (WEB_MIB + 2 * 4000, 2, 0, MEMORY_MIB),
        (WEB_MIB + 2 * 4000, 2, 3000, 3000),
        (WEB_MIB + LEAST_MIB, 1, 0, LEAST_MIB),
        (WEB_MIB + LEAST_MIB - 1, 1, 0, None),
        (WEB_MIB + 2 * LEAST_MIB, 3, 0, None),
        (WEB_MIB + 2 * 1000, 2, 1001, None),
        (None, 1, LEAST_MIB - 1, None),
    ],
)
def test_workers_fit_in_the_container_or_the_service_does_not_start(
    monkeypatch: pytest.MonkeyPatch, has: int | None, workers: int, asked: int, given: int | None
) -> None:
    monkeypatch.setattr(settings_module, "memory_mib", lambda: has)
    settings = Settings(workers=workers, worker_memory_mib=asked, simulation_workers=0)
    if given is not None:
        assert settings.worker_mib == given
        return
    with pytest.raises(InputError) as caught:
        _ = settings.worker_mib
    assert "ASSUR_WORKERS" in caught.value.field
    assert str(LEAST_MIB) in caught.value.allowed


def test_workers_for_simulations_have_their_share_of_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settings_module, "memory_mib", lambda: WEB_MIB + 3 * 600)
    assert Settings(workers=2, simulation_workers=1).worker_mib == 600
    with pytest.raises(InputError, match="ASSUR_SIMULATION_WORKERS"):
        _ = Settings(workers=2, simulation_workers=2).worker_mib


@pytest.mark.parametrize(("workers", "short", "reserved"), [(1, 1, 0), (2, 1, 1), (2, 5, 1), (8, 2, 2), (8, 0, 0)])
def test_one_worker_at_the_least_is_for_all_requests(workers: int, short: int, reserved: int) -> None:
    assert Settings(workers=workers, short_workers=short).reserved == reserved

"""The bound on memory of workers and commands, and what is said beyond it."""

from __future__ import annotations

import resource

import numpy as np
import pytest

from assur.api.cli.border import OUT_OF_MEMORY, code_of, within_memory
from assur.api.web.settings import Settings
from assur.api.workers.memory import MEMORY_MIB, limited_memory


def allocate(mib: int) -> int:
    return len(np.empty(mib << 20, dtype=np.uint8))


def test_more_than_the_limit_is_refused_inside_and_not_behind_it() -> None:
    before = resource.getrlimit(resource.RLIMIT_DATA)
    with limited_memory(512):
        assert allocate(64) == 64 << 20
        with pytest.raises(MemoryError):
            allocate(1024)
    assert resource.getrlimit(resource.RLIMIT_DATA) == before
    assert allocate(1024) == 1024 << 20


def test_what_the_process_had_before_the_command_is_not_counted() -> None:
    held = np.ones(256 << 20, dtype=np.uint8)
    with limited_memory(128):
        assert allocate(64) == 64 << 20
        with pytest.raises(MemoryError):
            allocate(256)
    assert len(held) == 256 << 20


def test_a_narrower_limit_stays() -> None:
    with limited_memory(512), limited_memory(4096), pytest.raises(MemoryError):
        allocate(1024)


def test_a_command_without_memory_says_so_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    def command() -> int:
        raise MemoryError

    assert code_of(within_memory(command)) == OUT_OF_MEMORY == 12
    said = capsys.readouterr().err
    assert said.startswith(f"assur: out of memory: this takes more than the {MEMORY_MIB} MiB")
    assert said.count("\n") == 1


def test_a_command_may_take_as_much_as_a_worker() -> None:
    assert Settings().worker_mib <= MEMORY_MIB
    assert Settings(worker_memory_mib=MEMORY_MIB).worker_mib == MEMORY_MIB

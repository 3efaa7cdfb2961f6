"""Long work says how far it is: the compilation of the kernels."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from assur.api.cli import border
from assur.planner import kernel_cache
from assur.scenes import kernels


def test_kernels_are_counted_in_the_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert kernels.counted() >= len(kernels.load().folder.joinpath(kernel_cache.WHOLE).read_text().split()) > 50
    monkeypatch.setattr(kernels, "folder", lambda: tmp_path)
    assert kernels.counted() == 0
    (tmp_path / "checker").mkdir()
    (tmp_path / "checker" / "one.nbi").write_bytes(b"")
    assert kernels.counted() == 1
    assert kernel_cache.is_compiled()


def test_how_far_it_is_is_said_until_it_ends(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(border, "PROGRESS_S", 0.01)
    said: list[int] = []

    def how_far() -> str:
        said.append(len(said))
        return f"{len(said)} of many"

    with border.telling(how_far):
        while len(said) < 3:
            time.sleep(0.01)
    told = len(said)
    time.sleep(0.05)
    assert len(said) == told
    assert capsys.readouterr().err.splitlines()[:2] == ["assur: 1 of many", "assur: 2 of many"]

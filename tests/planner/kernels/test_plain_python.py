"""Kernels run as plain Python and compiled agree."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from assur.planner.kernels.laws import last_begun
from assur.planner.kernels.links import place_links
from tests.planner.kernels import recorded
from tests.planner.kernels.arms import ARMS

CLOSE = 1e-12
"""Relative, to the largest number of an output if that is more than 1."""


def test_plain_python_and_compiled_code_agree(tmp_path: Path) -> None:
    path = tmp_path / "plain.npz"
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-m", "tests.planner.kernels.recorded", str(path)]
    subprocess.run(command, check=True, env=environment, cwd=Path(__file__).parents[3])
    plain, compiled = np.load(path), recorded.outputs()
    assert set(plain) == set(compiled)
    for name, value in compiled.items():
        assert np.array_equal(np.isfinite(value), np.isfinite(plain[name])), name
        known = np.isfinite(value)
        if known.any():
            scale = np.maximum(1.0, np.abs(value[known]))
            assert (np.abs(value[known] - plain[name][known]) <= CLOSE * scale).all(), name


def test_an_index_beyond_a_table_raises() -> None:
    with pytest.raises(IndexError):
        place_links(ARMS["scara"].row, np.zeros(4), np.zeros((4, 12)))
    with pytest.raises(IndexError):
        last_begun(np.zeros((2, 1)), 0, 9, 1.0)

"""`from assur.planner import Scene, check, plan`, looked up when they are asked for."""

from __future__ import annotations

import subprocess
import sys

import pytest

from assur import planner


def test_the_three_names_are_those_of_their_modules() -> None:
    from assur.planner.checked import check
    from assur.planner.model.scene import Scene
    from assur.planner.pipeline import plan

    assert (planner.Scene, planner.check, planner.plan) == (Scene, check, plan)
    assert set(planner.__all__) <= set(dir(planner))


def test_another_name_is_refused() -> None:
    with pytest.raises(AttributeError, match="no attribute 'plam'"):
        _ = planner.plam


@pytest.mark.parametrize(
    ("program", "loaded"),
    [
        ("import assur.planner", []),
        ("from assur.planner import Scene", []),
        ("from assur.planner import plan", ["fcl", "ruckig"]),
    ],
)
def test_native_libraries_come_with_plan_only(program: str, loaded: list[str]) -> None:
    probe = f"import sys\n{program}\nprint([name for name in ('fcl', 'ruckig') if name in sys.modules])"
    ran = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == str(loaded)

"""What is no plan cannot be made, and a plan of another task gets findings: never another exception, never a yes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.model.scene import Window
from assur.planner.trajectory import Trajectory
from tests.planner.checker.hand_made import COLUMNS, asking, belt_case, crossing_case, sealed
from tests.planner.trajectory.changed import changed as changed_path

KNOTS = ("time", "q", "qd", "qdd")


def refused(part: Any, **changes: Any) -> None:
    """A part of a plan, with changes, is no such part."""
    with pytest.raises(InputError):
        (changed_path if isinstance(part, Trajectory) else replace)(part, **changes)


@pytest.mark.parametrize("name", ["legs", "arrivals"])
@pytest.mark.parametrize("wrong", [None, [], 3, "legs"])
def test_legs_and_arrivals_that_are_none_are_refused(name: str, wrong: Any) -> None:
    _, plan = crossing_case()
    refused(plan, **{name: wrong})


@pytest.mark.parametrize("name", KNOTS)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_knots_that_are_not_finite_are_refused(name: str, value: float) -> None:
    _, plan = crossing_case()
    values = getattr(plan.trajectory, name).copy()
    values.flat[-1] = value
    refused(plan.trajectory, **{name: values})


def test_time_that_does_not_increase_is_refused() -> None:
    _, plan = crossing_case()
    time = plan.trajectory.time
    for wrong in (time[::-1].copy(), np.zeros_like(time), np.array([0.0, 0.1, 0.1, 1.0])):
        refused(plan.trajectory, time=wrong)


@pytest.mark.parametrize("name", KNOTS)
@pytest.mark.parametrize("wrong", [None, "q", 3.0, np.zeros(0), np.zeros((4, 3)), np.full((4, 4), np.nan), [[0.0]]])
def test_knots_of_another_shape_or_kind_are_refused(name: str, wrong: Any) -> None:
    _, plan = crossing_case()
    refused(plan.trajectory, **{name: wrong})


def test_a_single_knot_is_refused() -> None:
    _, plan = crossing_case()
    refused(plan.trajectory, **{name: getattr(plan.trajectory, name)[:1] for name in KNOTS})


@pytest.mark.parametrize("name", COLUMNS)
def test_columns_of_the_certificate_that_are_short_or_not_numbers_are_refused(name: str) -> None:
    _, plan = crossing_case()
    column = getattr(plan.certificate, name)
    wrong: list[Any] = [column[:-1], None, "rows", column.astype(object), column[None]]
    if column.dtype == np.float64:
        wrong.append(np.where(np.arange(column.size).reshape(column.shape) == 3, np.nan, column))
    else:
        wrong.append(column.astype(np.float64))
    for values in wrong:
        refused(plan.certificate, **{name: values})


def test_names_that_are_not_different_texts_are_refused() -> None:
    _, plan = crossing_case()
    names = plan.certificate.names
    for wrong in (list(names), (*names[:-1], names[0]), (*names[:-1], 7)):
        refused(plan.certificate, names=wrong)
    for covers in (None, list(plan.certificate.covers)):
        refused(plan.certificate, covers=covers)


@pytest.mark.parametrize(
    "changes",
    [
        {"step": -1},
        {"step": True},
        {"step": 0.0},
        {"t0": np.nan},
        {"t1": "x"},
        {"kind": "MOVE"},
        {"route": 5},
    ],
)
def test_legs_of_no_step_time_or_kind_are_refused(changes: dict[str, Any]) -> None:
    _, plan = crossing_case()
    refused(plan.legs[0], **changes)


@pytest.mark.parametrize(
    "changes",
    [
        {"step": None},
        {"time": np.nan},
        {"until": np.inf},
        {"pose": None},
        {"pose": SimpleNamespace(x=np.nan, y=0.0, z=0.0, yaw=0.0)},
        {"yaw_offset": np.nan},
        {"along_m": np.nan},
        {"window_left_s": "long"},
        {"pitch": np.nan},
        {"roll": "flat"},
        {"control_point": None},
    ],
)
def test_arrivals_at_no_step_time_or_place_are_refused(changes: dict[str, Any]) -> None:
    _, plan = crossing_case()
    refused(plan.arrivals[0], **changes)


def test_a_plan_of_more_steps_or_other_joints_than_the_scene_has_is_refused() -> None:
    scene, plan = crossing_case()
    for other in (
        replace(plan, legs=(*plan.legs, replace(plan.legs[-1], step=2))),
        replace(plan, arrivals=(*plan.arrivals, replace(plan.arrivals[-1], step=7))),
        replace(plan, trajectory=Trajectory(*(np.zeros((2, 3)) if k else np.arange(2.0) for k in range(4)))),
        replace(plan, certificate=replace(plan.certificate, covers=("separation",))),
        replace(plan, trajectory=changed_path(plan.trajectory, jumps=True)),
    ):
        assert {finding.code for finding in check(scene, sealed(scene, other)).findings} == {Code.FORM}


@given(
    what=st.sampled_from(["legs", "arrivals", "rows", "knots"]),
    seed=st.integers(0, 2**32 - 1),
    value=st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300),
)
@example(what="legs", seed=0, value=-1e300)
@example(what="arrivals", seed=0, value=1e300)
@example(what="arrivals", seed=1, value=1e300)
@example(what="arrivals", seed=3, value=-1e300)
@example(what="rows", seed=5, value=1e300)
def test_any_number_anywhere_is_answered(what: str, seed: int, value: float) -> None:
    """One number of a right plan is replaced by any other; the checker answers, and does not accept it."""
    scene, plan = belt_case()
    scene = asking(scene, 0, window=Window(time=(0.7, 0.8), along=(-0.03, -0.02)))
    rng = np.random.default_rng(seed)
    changed: Any
    if what == "legs":
        i, name = int(rng.integers(len(plan.legs))), str(rng.choice(["t0", "t1"]))
        changed = replace(plan, legs=(*plan.legs[:i], replace(plan.legs[i], **{name: value}), *plan.legs[i + 1 :]))  # type: ignore[arg-type]
    elif what == "arrivals":
        i, name = int(rng.integers(3)), str(rng.choice(["time", "until", "yaw_offset"]))
        moved = replace(plan.arrivals[i], **{name: value})  # type: ignore[arg-type]
        changed = replace(plan, arrivals=(*plan.arrivals[:i], moved, *plan.arrivals[i + 1 :]))
    elif what == "rows":
        name = str(rng.choice(["t0", "t1", "normal"]))
        column = getattr(plan.certificate, name).copy()
        column.flat[rng.integers(column.size)] = value
        changed = replace(plan, certificate=replace(plan.certificate, **{name: column}))
    else:
        name = str(rng.choice(["q", "qd", "qdd"]))
        column = getattr(plan.trajectory, name).copy()
        column.flat[rng.integers(column.size)] += value
        line = changed_path(plan.trajectory, **{name: column})
        changed = replace(plan, trajectory=line)
    verdict = check(scene, sealed(scene, changed))
    assert verdict.ok == (not verdict.findings)
    if abs(value) > 100:
        assert not verdict.ok

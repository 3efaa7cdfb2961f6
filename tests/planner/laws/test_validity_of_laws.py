"""A law is known where it says and nowhere else, and cannot be made of what is not a law."""

from __future__ import annotations

import dataclasses
import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.laws import (
    ALWAYS,
    Change,
    Law,
    Motion,
    Pose,
    conveyor,
    fixed,
    indexer,
    keyframes,
    linear,
    oscillation,
    swing,
    turntable,
)
from assur.planner.laws.validity import FURTHEST_S
from tests.planner.laws.bounded import bounded
from tests.planner.laws.test_motions_of_laws import PARTS

HOME = Pose(0.1, -0.2, 0.3, 0.4)
STOP = Change(1.0, 0.0, 2.0, 20.0)
UP = np.array([[0.0, 0.6, 0.8]])

MAKERS: dict[str, Callable[[tuple[float, float]], Law]] = {
    "fixed": lambda valid: fixed(HOME, valid),
    "linear": lambda valid: linear(HOME, (0.1, 0.2, 0.3), 0.5, valid),
    "conveyor": lambda valid: conveyor(HOME, 0.25, (STOP,), 0.0, valid),
    "turntable": lambda valid: turntable(HOME, 1.0, 0.1, (STOP,), 0.0, valid),
    "indexer": lambda valid: indexer(HOME, 0.5, 0.4, 0.2, "turn", 0.0, valid),
    "travelling indexer": lambda valid: indexer(HOME, 0.5, 0.4, 0.2, "travel", 0.0, valid),
    "swing": lambda valid: swing(HOME, 0.5, 1.6, 0.0, valid),
    "oscillation": lambda valid: oscillation(HOME, (0.0, 0.6, 0.8), 0.5, 1.6, 0.0, valid),
    "repeated keyframes": lambda valid: keyframes((-0.2, 0.5, 1.0), (HOME, Pose(), HOME), "periodic", valid),
    "keyframes": lambda valid: keyframes((-9.0, 0.0, 9.0), (HOME, Pose(), HOME), "natural", valid),
}


def known(motion: Motion) -> list[bool]:
    """Row by row; each row must be known in all fields or in none."""
    fields = np.stack([getattr(motion, name).reshape(len(motion.yaw), -1).sum(axis=1) for name in PARTS])
    finite = np.isfinite(fields)
    assert (finite.all(axis=0) == finite.any(axis=0)).all()
    return [bool(row) for row in finite.all(axis=0)]


@pytest.mark.parametrize("kind", MAKERS)
def test_a_motion_is_known_up_to_its_ends_and_not_one_rounding_beyond(kind: str) -> None:
    law = MAKERS[kind]((-1.5, 2.5))
    assert law.valid == (-1.5, 2.5)
    t = np.array([-1.5, 2.5, 0.0, np.nextafter(-1.5, -9), np.nextafter(2.5, 9), 1e300, math.nan, -math.inf, math.inf])
    assert known(law.motion(t)) == 3 * [True] + 6 * [False]
    assert np.isnan(law.motion(np.array(3.0)).p).all()
    assert np.isfinite(law.motion(np.array(2.0)).p).all()


@pytest.mark.parametrize("kind", MAKERS)
def test_bounds_are_infinite_unless_all_of_the_interval_is_known(kind: str) -> None:
    law = MAKERS[kind]((-1.5, 2.5))
    fine = [(-1.5, 2.5), (2.5, 2.5), (-1.5, -1.5)]
    bad = [(-1.6, 0.0), (0.0, np.nextafter(2.5, 9)), (3.0, 4.0), (1.0, 0.0), (math.nan, 1.0), (0.0, math.nan)]
    bad += [(0.0, math.inf), (-math.inf, 0.0), (math.inf, math.inf)]
    t0, t1 = np.array(fine + bad).T
    found = bounded(law, t0, t1, np.repeat(UP, len(t0), axis=0)).table
    assert np.isfinite(found[:, :3]).all()
    assert np.isposinf(found[:, 3:]).all()


@pytest.mark.parametrize("kind", MAKERS)
def test_a_law_without_an_end_is_known_as_far_as_clocks_resolve(kind: str) -> None:
    law = MAKERS[kind](ALWAYS)
    first, last = (-9.0, 9.0) if kind == "keyframes" else (-FURTHEST_S, FURTHEST_S)
    assert known(law.motion(np.array([first, last]))) == [True, True]
    beyond = np.array([np.nextafter(first, -math.inf), np.nextafter(last, math.inf)])
    assert known(law.motion(beyond)) == [False, False]


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize(
    "valid", [(1.0, 1.0), (2.0, 1.0), (math.nan, 1.0), (0.0, math.nan), (1e7, 1e8), "no", (1.0,), None]
)
def test_a_validity_that_is_no_interval_is_refused(kind: str, valid: object) -> None:
    with pytest.raises(InputError, match=r"valid"):
        MAKERS[kind](valid)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", MAKERS)
def test_a_law_cannot_be_changed_and_survives_the_way_to_another_process(kind: str) -> None:
    law = MAKERS[kind](ALWAYS)
    with pytest.raises(dataclasses.FrozenInstanceError):
        law.valid = (0.0, 1.0)  # type: ignore[misc]
    copy = pickle.loads(pickle.dumps(law))
    t = np.linspace(-2, 2, 7)
    for name in PARTS:
        np.testing.assert_array_equal(getattr(copy.motion(t), name), getattr(law.motion(t), name))


def test_laws_of_the_same_numbers_are_equal() -> None:
    for kind, make in MAKERS.items():
        if "keyframes" not in kind:
            assert make((0.0, 1.0)) == make((0.0, 1.0)) != make((0.0, 2.0))


NUMBERS = (math.nan, math.inf, -math.inf, 1e7, "fast", None)
POSITIVE = (*NUMBERS, 0.0, -1.0)

REFUSED: list[tuple[str, Callable[[float], object], tuple[object, ...]]] = [
    ("pose.x", lambda x: Pose(x=x), NUMBERS[:3]),
    ("pose.yaw", lambda x: Pose(yaw=x), NUMBERS[:3]),
    ("fixed.pose.y", lambda x: fixed(Pose(y=x)), (1e7,)),
    ("linear.pose.z", lambda x: linear(Pose(z=x), (0, 0, 0)), (-1e7,)),
    ("linear.velocity[1]", lambda x: linear(HOME, (0, x, 0)), NUMBERS),
    ("linear.at_time", lambda x: linear(HOME, (0, 0, 0), x), NUMBERS),
    ("conveyor.speed", lambda x: conveyor(HOME, x), NUMBERS),
    ("conveyor.at_time", lambda x: conveyor(HOME, 0.1, (), x), NUMBERS),
    ("conveyor.pose.yaw", lambda x: conveyor(Pose(yaw=x), 0.1), (1e7,)),
    ("turntable.pose.x", lambda x: turntable(Pose(x), 0.1), (1e7,)),
    ("turntable.rate", lambda x: turntable(HOME, x), NUMBERS),
    ("turntable.rise", lambda x: turntable(HOME, 0.1, x), NUMBERS),
    ("turntable.at_time", lambda x: turntable(HOME, 0.1, 0.0, (), x), NUMBERS),
    ("change.time", lambda x: Change(x, 0.1, 1.0, 1.0), NUMBERS),
    ("change.speed", lambda x: Change(0.0, x, 1.0, 1.0), NUMBERS),
    ("change.acceleration", lambda x: Change(0.0, 0.1, x, 1.0), POSITIVE),
    ("change.jerk", lambda x: Change(0.0, 0.1, 1.0, x), (math.nan, -math.inf, 0.0, -1.0, 1e10, "fast", None)),
    ("indexer.pose.x", lambda x: indexer(Pose(x), 0.1, 1.0, 1.0), (1e7,)),
    ("indexer.step", lambda x: indexer(HOME, x, 1.0, 1.0), NUMBERS),
    ("indexer.move_s", lambda x: indexer(HOME, 0.1, x, 1.0), (*POSITIVE, 1e-4)),
    ("indexer.dwell_s", lambda x: indexer(HOME, 0.1, 1.0, x), (*NUMBERS, -1.0)),
    ("indexer.start", lambda x: indexer(HOME, 0.1, 1.0, 1.0, "turn", x), NUMBERS),
    ("indexer.kind", lambda x: indexer(HOME, 0.1, 1.0, 1.0, x), ("spin", None)),  # type: ignore[arg-type]
    ("swing.pose.x", lambda x: swing(Pose(x), 0.1, 1.0), (1e7,)),
    ("swing.amplitude", lambda x: swing(HOME, x, 1.0), NUMBERS),
    ("swing.period", lambda x: swing(HOME, 0.1, x), (*POSITIVE, 1e-4)),
    ("swing.phase", lambda x: swing(HOME, 0.1, 1.0, x), NUMBERS),
    ("oscillation.pose.x", lambda x: oscillation(Pose(x), (0, 0, 1), 0.1, 1.0), (1e7,)),
    ("oscillation.direction[2]", lambda x: oscillation(HOME, (0, 0, x), 0.1, 1.0), NUMBERS),
    ("oscillation.direction", lambda x: oscillation(HOME, (0, 0, x), 0.1, 1.0), (0.0, 1e-4)),
    ("oscillation.amplitude", lambda x: oscillation(HOME, (0, 0, 1), x, 1.0), NUMBERS),
    ("oscillation.period", lambda x: oscillation(HOME, (0, 0, 1), 0.1, x), (*POSITIVE, 1e-4)),
    ("oscillation.phase", lambda x: oscillation(HOME, (0, 0, 1), 0.1, 1.0, x), NUMBERS),
    ("keyframes.times", lambda x: keyframes((0.0, x), (HOME, HOME)), (math.nan, math.inf, "late")),
    ("keyframes.points[1].time", lambda x: keyframes((0.0, x), (HOME, HOME)), (0.0, -1.0, 1e-4, 1e7)),
    ("keyframes.points[1].x", lambda x: keyframes((0.0, 1.0), (HOME, Pose(x))), (1e7,)),
    ("keyframes.ends", lambda x: keyframes((0.0, 1.0), (HOME, HOME), x), ("loose", None)),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(
    ("field", "make", "value"), [(field, make, value) for field, make, values in REFUSED for value in values]
)
def test_a_number_that_is_not_allowed_is_refused_by_its_name(
    field: str, make: Callable[[object], object], value: object
) -> None:
    with pytest.raises(InputError) as refused:
        make(value)
    assert refused.value.field == field


@pytest.mark.parametrize("times", [(), (0.0,), (0.0, 1.0, 2.0), ((0.0, 1.0), (2.0, 3.0))])
def test_keyframes_need_two_poses_and_as_many_times(times: object) -> None:
    with pytest.raises(InputError, match=r"keyframes\.(times|points)"):
        keyframes(times, (HOME, HOME)[: len(times) if len(times) < 2 else 2])  # type: ignore[arg-type]


def test_keyframes_refuse_a_validity_that_misses_their_times() -> None:
    with pytest.raises(InputError) as refused:
        keyframes((0.0, 1.0), (HOME, HOME), valid=(1.0, 2.0))
    assert refused.value.field == "keyframes.valid"


def test_a_velocity_or_a_direction_of_two_numbers_is_refused() -> None:
    with pytest.raises(InputError) as refused:
        linear(HOME, (0.1, 0.2))  # type: ignore[arg-type]
    assert refused.value.field == "linear.velocity"
    with pytest.raises(InputError) as refused:
        oscillation(HOME, (0.1, 0.2), 0.1, 1.0)  # type: ignore[arg-type]
    assert refused.value.field == "oscillation.direction"

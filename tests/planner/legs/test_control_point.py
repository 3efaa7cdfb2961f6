"""When a control point may be met: windows in seconds and along a belt, dwells, the ends of laws."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws import Change, Law, belt_window, conveyor, fixed, linear, turntable
from assur.planner.laws.belt_window import HORIZON_S, WINDOW_STEP_S, times_inside, travelled
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.model.attachments import AT_START
from assur.planner.model.scene import Follow, Window
from tests.planner.cells import at, cell, frame


def point(
    law: Law, window: Window = Window(), dwell: float = 0.0, x: float = 0.0, start: float = 0.0, **more: Any
) -> ControlPoint:
    step = Follow("f", at(x, 0.0, 0.0, 0.0, "moving"), dwell, window)
    scene = cell(step, frames=(frame("moving", law),), time=start, **more)
    return control_point(scene, 0, AT_START, 0.0)


BELT = conveyor(Pose(-0.3, 0.4, 0.05, 0.3), 0.25)


def test_without_a_window_tracking_may_begin_from_the_start_on() -> None:
    assert point(BELT, start=0.7).intervals == [(0.7, math.inf)]


def test_a_window_in_seconds_holds_all_of_the_tracking() -> None:
    assert point(BELT, Window(time=(1.0, 2.0)), 0.3).intervals == [(1.0, 1.7)]
    assert point(BELT, Window(time=(1.0, 2.0)), 1.0).intervals == [(1.0, 1.0)]
    assert point(BELT, Window(time=(1.0, 2.0)), 1.01).intervals == []
    assert point(BELT, Window(time=(1.0, 2.0)), start=1.5).intervals == [(1.5, 2.0)]
    assert point(BELT, Window(time=(1.0, 2.0)), start=2.5).intervals == []


@given(st.integers(0, 10**8), st.integers(1, 5000), st.sampled_from([BELT, fixed(Pose())]))
def test_a_window_that_is_exactly_as_long_as_the_dwell_is_open_once(opens: int, dwell: int, law: Law) -> None:
    """Both in whole milliseconds, as they are read: differences of such numbers round to less than the dwell."""
    first = opens / 1000
    window = Window(time=(first, (opens + dwell) / 1000))
    ((low, high),) = point(law, window, dwell / 1000).intervals
    assert low == first
    assert low <= high <= low + 1e-9
    # a nanosecond more does not fit
    assert point(law, window, dwell / 1000 + 1e-9 + 1e-7 * (opens > 10**6)).intervals == []


def test_a_window_that_seems_shorter_by_rounding_is_open_but_no_law_is_asked_beyond_its_end() -> None:
    assert 1.4 - 0.3 < 1.1
    assert point(BELT, Window(time=(1.1, 1.4)), 0.3).intervals == [(1.1, 1.1)]
    assert point(BELT, Window(time=(1.1, 2.0)), 0.3, latest_end_s=1.4).intervals == [(1.1, 1.1)]
    ends = conveyor(Pose(-0.3, 0.4, 0.05, 0.3), 0.25, valid=(0.0, 1.4))
    assert point(ends, Window(time=(1.1, 2.0)), 0.3).intervals == []


@given(st.floats(0.02, 0.6), st.floats(-0.3, 0.3), st.floats(0.0, 0.3), st.floats(0.0, 0.2))
def test_a_window_along_a_belt_is_met_where_and_only_where_the_point_is_inside(
    speed: float, x: float, low: float, dwell: float
) -> None:
    law = conveyor(Pose(-0.3, 0.4, 0.05, 0.3), speed)
    high = low + 0.1
    found = point(law, Window(along=(low, high)), dwell, x)
    # in closed form: the point is at x + speed t
    first, last = max(0.0, (low - x) / speed), (high - x) / speed - dwell
    if last < first - 1e-9 or (high - x) / speed > 59:
        assert last < first or found.intervals == [] or (high - x) / speed > 59
        return
    assert len(found.intervals) == 1 or last - first < 1e-9
    if found.intervals:
        assert found.intervals[0] == pytest.approx((first, last), abs=1e-9)
        for t in found.intervals[0]:
            for now in (t, t + dwell):
                way = found.along(np.array(now))
                assert way is not None
                assert low - 1e-12 <= float(way) <= high + 1e-12


def test_a_belt_that_runs_backwards_and_one_that_stops_have_their_windows() -> None:
    back = point(conveyor(Pose(0.2, 0.4), -0.1), Window(along=(-0.05, -0.02)))
    assert back.intervals == [pytest.approx((0.2, 0.5))]
    stops = conveyor(Pose(0.0, 0.4), 0.1, (Change(1.0, 0.0, 0.5, 5.0), Change(3.0, 0.1, 0.5, 5.0)))
    found = point(stops, Window(along=(0.0, 0.15)), 0.5).intervals
    assert len(found) == 1
    low, high = found[0]
    assert low == 0.0
    way = point(stops).along(np.array([high + 0.5, high + 0.5 + 1e-3]))
    assert way is not None
    assert way[0] == pytest.approx(0.15, abs=1e-9)


@pytest.mark.parametrize("width", [0.005, 0.0004])
def test_a_window_that_is_passed_in_less_than_a_grid_step_is_found(width: float) -> None:
    fast = conveyor(Pose(-0.3, 0.4), 0.5)
    found = point(fast, Window(along=(0.1013, 0.1013 + width))).intervals
    assert found == [pytest.approx((0.2026, 0.2026 + width / 0.5), abs=1e-9)]


def test_both_windows_count() -> None:
    found = point(BELT, Window(time=(0.5, 1.0), along=(0.0, 0.2)))
    assert found.intervals == [pytest.approx((0.5, 0.8))]


def test_a_law_that_ends_and_a_latest_end_bound_the_times() -> None:
    assert point(conveyor(Pose(), 0.1, valid=(-1.0, 5.0)), dwell=1.0).intervals == [(0.0, 4.0)]
    assert point(BELT, latest_end_s=3.0, dwell=1.0).intervals == [(0.0, 2.0)]


def test_millimetres_of_a_frame_that_is_no_conveyor_are_refused_by_name() -> None:
    with pytest.raises(InputError, match="window"):
        _ = point(turntable(Pose(0.3, 0.0), 1.0), Window(along=(0.0, 0.1))).intervals
    with pytest.raises(InputError, match="conveyor"):
        _ = point(fixed(Pose(0.3, 0.0)), Window(along=(0.0, 0.1))).intervals


def test_the_way_along_a_belt_is_that_of_the_point_itself_wherever_it_sits_in_its_frame() -> None:
    """Against the frame's own motion, for points beside the origin of a frame that is turned."""
    seat = Pose(0.03, -0.02, 0.01, 0.4)
    laws = (
        conveyor(Pose(0.1, 0.2, 0.0, 0.7), 0.25, at_time=0.5),
        linear(Pose(0.1, 0.2, 0.0, 0.7), (0.1, -0.2, 0.05), 0.5),
    )
    t = np.linspace(-1.0, 2.0, 7)
    for law in laws:
        moved = law.motion(t).at(seat).p - law.numbers.pose.position
        direction = law.motion(t).v[0]
        assert travelled(law, seat, t) == pytest.approx(moved @ (direction / np.linalg.norm(direction)), abs=1e-12)
    known = linear(Pose(), (0.1, 0.0, 0.0), 0.0, (0.0, 1.0))
    assert np.isnan(travelled(known, seat, np.array([-0.1, 0.5, 1.1, np.nan]))).tolist() == [True, False, True, True]


@given(st.floats(-3.0, 3.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_a_part_on_a_belt_that_stands_is_inside_a_window_that_begins_or_ends_where_it_is(
    yaw: float, x: float, y: float
) -> None:
    belt, part = conveyor(Pose(0.3, -0.7, 0.1, yaw), 0.0), Pose(x, y)
    for window in ((x, x + 0.1), (x - 0.1, x)):
        ((begin, end),) = times_inside(belt, part, window, 0.0)
        assert begin == 0.0
        assert end >= HORIZON_S


@given(
    st.floats(-3.0, 3.0),
    st.floats(-6.0, 1.0),
    st.floats(-2.0, 12_002.0) | st.integers(-2, 12_002).map(float),
    st.sampled_from((0.0, 1e-9, 0.005, 0.7)) | st.floats(0.0, 70.0),
    st.floats(0.0, 1e4),
)
def test_times_inside_a_window_are_to_the_bit_those_of_the_whole_grid(
    yaw: float, decades: float, rows: float, lasts: float, start: float
) -> None:
    """Of a belt of constant speed few times of the grid are evaluated. `rows`: when the part comes into the window."""
    speed, part = 10.0**decades, Pose(-0.4, 0.1, 0.01, 0.3)
    belt = conveyor(Pose(0.3, -0.7, 0.1, yaw), speed)
    low = float(travelled(belt, part, np.array([start + rows * WINDOW_STEP_S]))[0])
    window = low, low + speed * lasts
    assert times_inside(belt, part, window, start) == inside_by_all(belt, part, window, start)


def inside_by_all(law: Law, part: Pose, window: tuple[float, float], start: float) -> tuple[tuple[float, float], ...]:
    """The times inside a window, with all times of the grid."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(belt_window, "_sampled", lambda _law, _point, _stretch, grid: grid)
        return times_inside.__wrapped__(law, part, window, start)

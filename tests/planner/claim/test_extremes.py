"""Where a joint is largest, by exact extremes of the motion and by samples."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.claim.lifts import between_jumps, largest
from assur.planner.trajectory import Trajectory
from tests.prover.bundles import planned

NAMES = ("demo", "five-bar", "rv-m1", "parabolic-blend")


@pytest.mark.parametrize(("name", "order"), [(name, order) for name in NAMES for order in (1, 2, 3)][:-1])
def test_a_derivative_is_largest_where_the_exact_extremes_are(name: str, order: int) -> None:
    """The jerk of the last one has no bound where its acceleration jumps."""
    path = planned(name)[1].trajectory
    low, high = path.extrema(order)
    t, value = largest(path, order, path.start, path.end)
    assert np.abs(value) == pytest.approx(np.maximum(-low, high), rel=1e-7, abs=1e-9)
    own = path.evaluate(t, order).diagonal()
    assert own == pytest.approx(value, rel=1e-9, abs=1e-9 * np.abs(value).max())


def test_a_jerk_that_is_constant_is_largest_where_its_piece_begins() -> None:
    """There it rounds least. It is not the jerk of the piece before, which ends at that instant."""
    half = [(0.0, 0.0, 0.0, 1.0), (0.5, 0.0208, 0.125, 0.5), (0.51, 0.0221, 0.13, 0.49)]
    time = np.array([t for t, *_ in half])
    path = Trajectory(time, *(np.array([[row[k]] for row in half]) for k in (1, 2, 3)))
    jerks = path.evaluate(time[:-1], 3)[:, 0]
    t, value = largest(path, 3, path.start, path.end)
    begin = int(np.abs(jerks).argmax())
    assert value[0] == jerks[begin]
    assert t[0] == time[begin]


@pytest.mark.parametrize("name", NAMES)
def test_within_an_interval_nothing_is_larger(name: str) -> None:
    path = planned(name)[1].trajectory
    t0, t1 = path.start + 0.31 * (path.end - path.start), path.start + 0.52 * (path.end - path.start)
    samples = np.linspace(t0, t1, 2001)[:-1]
    for order, size in ((0, np.positive), (0, np.negative), (1, np.abs), (2, np.abs), (3, np.abs)):
        t, value = largest(path, order, t0, t1, size)
        assert (t >= t0).all()
        assert (t <= t1).all()
        seen = size(path.evaluate(samples, order)).max(0)
        assert (size(value) >= seen - 1e-9 * np.abs(seen) - 1e-12).all()
    t, value = largest(path, 2, t1, t1)
    assert (t.tolist(), value.tolist()) == ([t1] * path.n, [0.0] * path.n)


def test_parts_of_a_motion_end_where_its_acceleration_jumps() -> None:
    path = planned("demo")[1].trajectory
    assert between_jumps(path, path.start, path.end) == [(path.start, path.end)]
    path = planned("parabolic-blend")[1].trajectory
    assert [t for t, _ in between_jumps(path, path.start, path.end)] == path.edges[:-1].tolist()
    t0, t1 = (0.5 * (path.edges[:2] + path.edges[1:3])).tolist()
    assert between_jumps(path, t0, t1) == [(t0, path.edges[1]), (path.edges[1], t1)]

"""Cover without gaps: the compiled sweep against painting, and against what a hole is."""

from __future__ import annotations

from collections.abc import Callable
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from assur.planner.checker import rows as rows_of
from assur.planner.checker.row_table import COLUMNS, OTHER_PIECE, PIECE, T0, T1, hole
from assur.planner.checker.rows import Apart
from assur.planner.checker.solids import solids
from assur.planner.checker.world import World
from assur.planner.model.deadline import OutOfTimeError
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import phases
from assur.planner.model.scene import Scene
from tests.planner.checker.hand_made import belt_case, crossing_case

LENGTH = 8
span = st.tuples(st.integers(0, LENGTH), st.integers(0, LENGTH)).map(lambda ends: (min(ends), max(ends)))
rows = st.lists(st.tuples(st.integers(0, 2), span), max_size=14)


def painted(spans: list[tuple[int, int]], begin: int, end: int) -> int:
    """Where painting all spans leaves the first bare unit between two ranks, −1 if none."""
    bare = [k for k in range(begin, end) if not any(a <= k and k + 1 <= b for a, b in spans)]
    return bare[0] if bare else -1


pieces = st.tuples(st.integers(-1, 2), st.integers(-1, 1))


def holes(given_rows: list[tuple[int, tuple[int, int], tuple[int, int]]], counts: tuple[int, int]) -> list[float]:
    """What the checker finds of three pairs of bodies of so many pieces: NaN for a pair that is covered."""
    found = []
    for key in range(3):
        own = sorted((row for row in given_rows if row[0] == key), key=lambda row: row[2][0])
        table, chain = np.zeros((len(own), COLUMNS)), np.zeros((len(own), 2), dtype=np.int64)
        for i, (_, of, ends) in enumerate(own):
            turned = i % 2  # every other row names the pair the other way round
            table[i, T0], table[i, T1], chain[i] = *ends, (i + 1 if i + 1 < len(own) else -1, turned)
            table[i, PIECE + 2 * turned], table[i, OTHER_PIECE - 2 * turned] = of
        found.append(float(hole(table, 0 if own else -1, chain, *counts, 0.0, float(LENGTH), 0.0, 0.0)))
    return found


@given(rows)
@example([(0, (0, 4)), (0, (4, 8))])
@example([(0, (0, 4)), (0, (5, 8))])
@example([(0, (2, 2)), (0, (0, 8)), (1, (1, 8)), (2, (0, 7))])
def test_holes_are_where_nothing_was_painted(given_rows: list[tuple[int, tuple[int, int]]]) -> None:
    found = holes([(key, (-1, 0), ends) for key, ends in given_rows], (1, 1))
    for i in range(3):
        wanted = painted([span for k, span in given_rows if k == i], 0, LENGTH)
        assert found[i] == wanted if wanted >= 0 else np.isnan(found[i])


@given(st.lists(st.tuples(st.integers(0, 1), pieces, span), max_size=16))
@example([(0, (i, -1), (0, LENGTH)) for i in range(3)] + [(1, (-1, j), (0, LENGTH)) for j in range(2)])
@example([(0, (i, -1), (0, LENGTH)) for i in range(2)] + [(1, (-1, -1), (0, LENGTH))])
def test_every_pair_of_pieces_must_be_painted(given_rows: list[tuple[int, tuple[int, int], tuple[int, int]]]) -> None:
    """Pairs of bodies, the first of three pieces and the second of two; -1 stands for all of them."""
    found = holes(given_rows, (3, 2))
    for k in range(2):
        of_pieces = []
        for i in range(3):
            for j in range(2):
                mine = [s for key, (a, b), s in given_rows if key == k and a in (-1, i) and b in (-1, j)]
                of_pieces.append(painted(mine, 0, LENGTH))
        open_ = [hole for hole in of_pieces if hole >= 0]
        assert found[k] == min(open_) if open_ else np.isnan(found[k])


@pytest.mark.parametrize("case", [crossing_case, belt_case])
def test_rows_are_judged_in_blocks_of_whole_intervals_and_alike_in_all_of_them(
    case: Callable[[], tuple[Scene, Plan]], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, plan = case()
    of_plan, c = phases(scene, plan.legs, plan.arrivals), plan.certificate
    apart = Apart.of(scene, of_plan, solids(scene, of_plan), World(scene, plan).tables)
    intervals = len(set(zip(c.t0.tolist(), c.t1.tolist(), strict=True)))
    robots = sum(apart.marks.shape[1] for phase in of_plan if phase.t1 > phase.t0)
    found = {}
    for size in (1, 7, len(c)):
        monkeypatch.setattr(rows_of, "BLOCK", size)
        look = Mock()
        found[size] = [table.tobytes() for table in apart.judged(c, (1e-3, 1e-3), look)]
        blocks = look.call_count - robots
        assert 1 <= blocks <= -(-len(c) // size)
        assert size > 1 or blocks == intervals
    assert found[1] == found[7] == found[len(c)]


def test_what_is_called_between_blocks_ends_the_work_with_what_it_raises() -> None:
    scene, plan = crossing_case()

    def out_of_time() -> None:
        raise OutOfTimeError

    of_plan = phases(scene, plan.legs, plan.arrivals)
    apart = Apart.of(scene, of_plan, solids(scene, of_plan), World(scene, plan).tables)
    with pytest.raises(OutOfTimeError):
        apart.found(plan.certificate, between=out_of_time)


def test_the_asked_pairs_of_a_phase_are_the_robot_against_the_rest_and_its_self_pairs() -> None:
    for case in (crossing_case, belt_case):
        scene, plan = case()
        of_plan = phases(scene, plan.legs, plan.arrivals)
        table = solids(scene, of_plan)
        names = [body.name for body in table.bodies]
        wanted_links = {frozenset(links) for links in scene.robot.self_pairs}
        link = {item.body.name: scene.robot.links[item.link] for item in scene.robot.bodies}
        link |= {body.name: "flange" for body in scene.tool.bodies}
        apart = Apart.of(scene, of_plan, table, World(scene, plan).tables)
        for i, phase in enumerate(of_plan):
            mine = dict(link)
            if phase.attached.held is not None:
                mine[phase.attached.held.part] = "flange"
            for a, one in enumerate(names):
                for b, other in enumerate(names):
                    both = one in mine and other in mine and frozenset((mine[one], mine[other])) in wanted_links
                    wanted = a != b and (both or (one in mine) != (other in mine))
                    # the part on the turning dial is kept clear of what does not turn with it
                    down = {one, other} - {"part"}
                    passes = (
                        "part" in (one, other)
                        and "part" not in mine
                        and case is belt_case
                        and i >= 7
                        and len(down) == 1
                    )
                    wanted = wanted or (passes and down <= {"bed", "neighbour"})
                    contact = tuple(sorted((one, other))) in phase.contacts
                    assert apart.required(i, a, b) == (wanted and not contact), (i, one, other)

"""The distance that two bodies must keep, by the checker's own reading of the request and by the planner's."""

from __future__ import annotations

from itertools import product

from assur.planner.checker.statement.distances import required_between
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import AT_START, Phase, rule_of
from assur.planner.model.scene import Clearance, ClearanceException
from tests.planner.cells import table_to_table

EXCEPTIONS = (
    ClearanceException(frozenset(), frozenset({"part"}), 0.004, 0.003),
    ClearanceException(frozenset({"cup", "quill"}), frozenset({"left-table", "part"}), 0.002, 0.001),
    ClearanceException(frozenset({"part"}), frozenset({"quill"}), 0.0, 0.0),
)


def test_both_read_the_same_rule_and_distance_for_all_pairs() -> None:
    scene = table_to_table(clearance=Clearance(0.006, 0.005, EXCEPTIONS))
    names, found = ("cup", "quill", "part", "left-table", "right-table"), set()
    for kind, one, other in product((LegKind.MOVE, LegKind.FOLLOW), names, names):
        phase = Phase(0.0, 0.0, kind, 0, AT_START)
        own = required_between(scene, phase.near, one, other)
        assert own == rule_of(scene, phase, one, other)
        found.add(own)
    assert len(found) == 7  # two of each rule, and one of the last


def test_other_distances_of_a_pair_are_those_of_no_other_pair() -> None:
    clearance = Clearance(0.006, 0.005)
    changed = clearance.lowered(0.002, 0.001, ("cup", "part"))
    assert changed.distances("part", "cup") == (0.002, 0.001)
    assert changed.distances("part", "quill") == changed.distances() == (0.006, 0.005)
    assert clearance.lowered(0.002, 0.001, ()).distances("part", "quill") == (0.002, 0.001)

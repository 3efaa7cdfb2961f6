"""The distance that two bodies must keep, by the checker's own reading of the request and by that of this test."""

from __future__ import annotations

from itertools import product

from assur.planner.checker.statement.distances import required_between
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Clearance, ClearanceException
from tests.planner.cells import table_to_table

EXCEPTIONS = (
    ClearanceException(frozenset(), frozenset({"part"}), 0.004, 0.003),
    ClearanceException(frozenset({"cup", "quill"}), frozenset({"left-table", "part"}), 0.002, 0.001),
    ClearanceException(frozenset({"part"}), frozenset({"quill"}), 0.0, 0.0),
)


def expected(clearance: Clearance, one: str, other: str, *, near: bool) -> tuple[str, float]:
    """The last exception that names both bodies, in either order, else the distance of all pairs."""
    for rule in reversed(clearance.exceptions):
        sides = [[not names or name in names for names in (rule.first, rule.second)] for name in (one, other)]
        if (sides[0][0] and sides[1][1]) or (sides[1][0] and sides[0][1]):
            return "exception", rule.near_m if near else rule.travel_m
    return ("near", clearance.near_m) if near else ("travel", clearance.travel_m)


def test_both_read_the_same_rule_and_distance_for_all_pairs() -> None:
    scene = table_to_table(clearance=Clearance(0.006, 0.005, EXCEPTIONS))
    names, found = ("cup", "quill", "part", "left-table", "right-table"), set()
    for kind, one, other in product((LegKind.MOVE, LegKind.FOLLOW), names, names):
        phase = Phase(0.0, 0.0, kind, 0, AT_START)
        own = required_between(scene, phase.near, one, other)
        assert own == expected(scene.options.clearance, one, other, near=phase.near)
        found.add(own)
    assert len(found) == 7  # two of each rule, and one of the last


def test_other_distances_of_a_pair_are_those_of_no_other_pair() -> None:
    clearance = Clearance(0.006, 0.005)
    changed = clearance.lowered(0.002, 0.001, ("cup", "part"))
    assert changed.distances("part", "cup") == (0.002, 0.001)
    assert changed.distances("part", "quill") == changed.distances() == (0.006, 0.005)
    assert clearance.lowered(0.002, 0.001, ()).distances("part", "quill") == (0.002, 0.001)

"""Facts that are written down in too many places: kinds of laws, families of arms, required distances, kinds of steps.

Each table lists the modules of a folder that may have the fact. It may become shorter, and not longer: a change that
moves a description writes its new place here and takes the old one away. Folders at commit e2d18ee and aims: a kind of
law in 17 and at most 5, a family of arms in 16 and at most 7, a required distance in 10 and at most 3; files with
`isinstance` on a step: 55 and at most 12.
"""

from __future__ import annotations

import ast
import re
from functools import cache

import pytest

from tests.architecture.source_tree import Source, names, sources

PACKAGES = ("planner", "scenes", "api", "prover")
KIND_OF_LAW = re.compile(
    r"(?i:conveyor|turntable|indexer(?!ror)|keyframe|oscillation)|^swing$|^(Fixed|Linear|Swing)(Document)?$"
)
"""`fixed` and `linear` are also common words: only as names of classes they are kinds."""
FAMILY = re.compile(r"scara|five_?bar|polar_?arm|elbow_?arm|five_?axis", re.IGNORECASE)
DISTANCE = re.compile(r"^(travel_m|near_m|clearances|rule_of|contact_gap)$")
"""The clearances of a request, and what derives the distance of a pair from them."""
LONGEST = 16
"""Characters of a text that may be a name."""
STEPS = frozenset({"Move", "Follow", "Trace", "Pick", "Place"})

LAWS = """
planner/bound: events
planner/checker/statement: laws
planner/laws: __init__ kinds law
scenes/reading: frames
scenes/schema: frames
"""
FAMILIES = """
planner/checker/statement: arms joints
planner/kernels: inverse links motion uncertainty
planner/robots: five_axis_arm five_bar kinematics scara tilting
scenes/reading: arms start
scenes/schema: robots
scenes/urdf: arm_text carriers families importing
"""
DISTANCES = """
planner/checker/statement: distances points
planner/claim: obligations
planner/model: options phases scene
"""
MOST_CHECKS, MOST_FILES = 149, 49
"""Calls of `isinstance` on a step, and files that have one."""


@cache
def words(source: Source) -> frozenset[str]:
    """Names that a module uses, imports and defines, and texts that may be one name."""
    found = {name for name, _ in names(source.tree)}
    for node in ast.walk(source.tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.arg):
            found.add(node.arg)
        elif isinstance(node, ast.alias):
            found.add(node.name.rpartition(".")[2])
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < LONGEST:
            found.add(node.value)
    return frozenset(found)


def naming(pattern: re.Pattern[str], source: Source) -> bool:
    """Whether a module has a name that the pattern is in."""
    return any(pattern.search(word) for word in words(source))


def modules(table: str) -> set[str]:
    """The paths of a table, a line of which is a folder and its modules."""
    lines = [line.partition(": ") for line in table.strip().splitlines()]
    return {f"{folder}/{module}.py" for folder, _, those in lines for module in those.split()}


def step_checks(source: Source) -> int:
    """Calls of `isinstance` with a kind of step."""
    calls = [node for node in ast.walk(source.tree) if isinstance(node, ast.Call) and len(node.args) == 2]
    named = [call for call in calls if isinstance(call.func, ast.Name) and call.func.id == "isinstance"]
    return sum(bool(STEPS & {name for name, _ in names(call.args[1])}) for call in named)


CASES = [(KIND_OF_LAW, LAWS), (FAMILY, FAMILIES), (DISTANCE, DISTANCES)]


@pytest.mark.parametrize(("pattern", "table"), CASES)
def test_no_further_module_has_the_fact(pattern: re.Pattern[str], table: str) -> None:
    assert {source.path for source in sources(*PACKAGES) if naming(pattern, source)} - modules(table) == set()


def test_no_further_file_distinguishes_kinds_of_steps() -> None:
    counts = [count for source in sources(*PACKAGES) if (count := step_checks(source))]
    assert len(counts) <= MOST_FILES
    assert sum(counts) <= MOST_CHECKS


def made_up(text: str) -> Source:
    """A module that does not exist."""
    return Source("assur.planner.x", "planner/x.py", text, ast.parse(text))


@pytest.mark.parametrize(
    ("pattern", "text", "has"),
    [
        (KIND_OF_LAW, "isinstance(law, Conveyor)", True),
        (KIND_OF_LAW, "from assur.planner.frames.fixed import Linear as Line", True),
        (KIND_OF_LAW, "kind = 'turntable'", True),
        (KIND_OF_LAW, "def conveyor_of(law): ...", True),
        (KIND_OF_LAW, "raise IndexError(linear, fixed, 'swings')", False),
        (FAMILY, "arm.five_bar", True),
        (FAMILY, "class PolarArmRow: ...", True),
        (FAMILY, "five = bar", False),
        (DISTANCE, "options.clearance.near_m", True),
        (DISTANCE, "from assur.planner.model.phases import rule_of", True),
        (DISTANCE, "clearance = NEAR_M", False),
    ],
)
def test_a_fact_is_seen_in_a_syntax_tree(pattern: re.Pattern[str], text: str, has: bool) -> None:
    assert naming(pattern, made_up(text)) is has


def test_kinds_of_steps_are_counted_by_class_and_by_union() -> None:
    text = "isinstance(step, Pick | m.Place) and isinstance(x, (Move,)) and isinstance(x, Path)"
    assert step_checks(made_up(text)) == 2

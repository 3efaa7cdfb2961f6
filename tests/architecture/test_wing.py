"""Parabolic blends are a wing of the planner: one small folder behind one entry, named by few other modules."""

from __future__ import annotations

import ast
import re

import pytest

from tests.architecture.source_tree import PRODUCT, Source, imports, sources

WING, ENTRY = "planner/blends/", "assur.planner.blends"
MOST_LINES = 700
NAMED = {
    "planner/model/options.py": "the option of the request, and which tasks go with it",
    "planner/pipeline.py": "the story chooses the search",
    "planner/checker/statement/order.py": "parabolas, and vias that are missed by what is stated",
    "planner/model/outcome.py": "the course of a leg, which is a note",
}
"""The modules of the planner that name the wing, at most four, and why."""
CODES = {
    "planner/checker/verdict.py": "the code",
}
"""Modules that name the code `BLEND` of a finding, and nothing else of the wing."""
CORNERS = {
    "planner/checker/statement/curves.py",
    "planner/checker/statement/guides.py",
    "planner/model/path.py",
    "planner/model/task.py",
    "planner/relaxation/changes.py",
    "planner/relaxation/kinds.py",
}
"""Modules in which a blend is the rounding of a corner of a path (`blend_mm`), which is no parabolic blend."""


def names_wing(text: str) -> bool:
    """Whether a module says anything about parabolic blends."""
    return re.search("blend", text, re.IGNORECASE) is not None


def other_entries(source: Source) -> list[str]:
    """What a module imports of the wing past its entry."""
    allowed = {ENTRY, f"{ENTRY}.BlendSearch"}
    return [name for name, _ in imports(source.tree) if name.startswith(ENTRY) and name not in allowed]


def test_the_folder_is_small() -> None:
    lines = sum(source.text.count("\n") for source in sources("planner") if source.path.startswith(WING))
    assert 0 < lines <= MOST_LINES


def test_few_other_modules_of_the_planner_name_the_wing() -> None:
    others = [source for source in sources("planner") if not source.path.startswith(WING)]
    naming = {source.path for source in others if names_wing(source.text)}
    assert naming - CORNERS == NAMED.keys() | CODES.keys()
    assert len(NAMED) <= 4
    assert naming >= CORNERS
    assert [each.path for each in others if each.path in CORNERS and "parabol" in each.text.lower()] == []


def test_the_wing_has_one_entry_and_only_the_story_imports_it() -> None:
    others = [source for source in sources(*PRODUCT, "benchmarks", "deploy") if not source.path.startswith(WING)]
    importing = [each.path for each in others if any(name.startswith(ENTRY) for name, _ in imports(each.tree))]
    assert importing == ["planner/pipeline.py"]
    assert [source.path for source in others if other_entries(source)] == []


@pytest.mark.parametrize(
    "text",
    ["from assur.planner.blends.run import Run", "import assur.planner.blends.law as law", "x = 'parabolic_blend'"],
)
def test_what_names_the_wing_is_noticed(text: str) -> None:
    source = Source("some.module", "some/module.py", text, ast.parse(text))
    assert names_wing(source.text)
    assert bool(other_entries(source)) is ("import" in text)

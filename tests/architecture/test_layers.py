"""Arrows only inwards: api → scenes → planner, and inside the planner only to the left."""

from __future__ import annotations

import ast
import tomllib
from typing import Any

import pytest

from tests.architecture.source_tree import PRODUCT, ROOT, Source, imports, sources

CONTRACTS: list[dict[str, Any]] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
    "importlinter"
]["contracts"]
"""The contracts that `make check` gives to import-linter; here the same order is held by plain reading of imports, so
that `make test` alone refuses a wrong arrow, too."""

PACKAGES, INSIDE = (
    [layer.strip("()") for layer in contract["layers"]]
    for contract in CONTRACTS
    if contract["type"] == "layers" and contract.get("containers") in (None, ["assur.planner"])
)
"""Outermost first."""
IGNORED = [arrow.split(" -> ") for contract in CONTRACTS for arrow in contract.get("ignore_imports", ())]


def wrong_arrows(modules: tuple[Source, ...]) -> list[str]:
    """Imports that point outwards."""
    return [
        f"{source.path}:{line} imports {name}"
        for source in modules
        for name, line in imports(source.tree)
        if _outwards(source.name.split("."), name.split("."))
        and not any(
            source.name == here and (name == there.rpartition(".")[0] or f"{name}.".startswith(f"{there}."))
            for here, there in IGNORED
        )
    ]


def _outwards(here: list[str], there: list[str]) -> bool:
    if there[0] != "assur" or len(there) < 2:
        return there[0] in ("tests", "benchmarks")
    if len(here) < 2:
        return False  # assur itself names what is everywhere
    ours, theirs = ".".join(here[:2]), ".".join(there[:2])
    if ours != theirs:
        return PACKAGES.index(theirs) < PACKAGES.index(ours)
    if ours != "assur.planner" or len(here) < 3 or len(there) < 3 or here[2] == there[2]:
        return False
    if not {here[2], there[2]} <= set(INSIDE):
        return False  # a module without a place is found by a test of its own
    return INSIDE.index(there[2]) < INSIDE.index(here[2])


def test_every_import_points_inwards() -> None:
    assert wrong_arrows(sources(*PRODUCT)) == []


def test_every_module_of_the_planner_has_its_place_in_the_order() -> None:
    there = {source.name.split(".")[2] for source in sources("planner") if source.name.count(".") > 1}
    assert there - set(INSIDE) == set()


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("assur.planner.arrays", "from assur.planner.model.scene import Scene"),
        ("assur.planner.arrays", "import assur.planner.model.scene"),
        ("assur.planner.arrays", "from assur.planner import pipeline"),
        ("assur.planner.model.scene", "def f():\n    from assur.planner.pipeline import plan"),
        ("assur.planner.model.scene", "from assur.scenes.answer import answer"),
        ("assur.scenes.answer", "import assur.api"),
        ("assur.scenes.answer", "from assur.request import Request"),
        ("assur.request", "from assur.api.python.answer import Answer"),
        ("assur", "from tests import x"),
        ("assur.planner.model.scene", "from tests import x"),
        ("assur.planner.robots.facts", "from assur.planner.claim import chain"),
        ("assur.planner.robots.scara", "from assur.planner.claim import columns as c"),
    ],
)
def test_an_arrow_that_points_outwards_is_found(name: str, text: str) -> None:
    assert len(wrong_arrows((Source(name, name, text, ast.parse(text)),))) >= 1


def test_arrows_that_point_inwards_are_not_found() -> None:
    for name, text in (
        ("assur.api.plans", "from assur.scenes import requests"),
        ("assur", "from assur.api.python.client import Client"),
        ("assur.planner.model.scene", "from assur.planner.arrays import x"),
    ):
        assert wrong_arrows((Source(name, name, text, ast.parse(text)),)) == []

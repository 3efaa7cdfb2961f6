"""A kind of law is named where requests are read and where laws are made; every computation reads the tables."""

from __future__ import annotations

import ast

from tests.architecture.source_tree import FRONT, Source, sources

KINDS = frozenset({"conveyor", "turntable", "indexer", "swing", "oscillation", "keyframes"})
"""Those whose words mean nothing else in the product."""
FOLDERS = ("planner/checker/", "planner/laws/", "scenes/reading/frames.py", "scenes/schema/frames.py", f"{FRONT}/")
"""Where a kind may be named. The checker, which has laws of its own, is to be replaced."""


def names_a_kind(tree: ast.AST) -> bool:
    """Whether a module has a kind of law as a text, a name, or a definition."""
    words = set[str]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            words.add(node.value.lower())
        elif isinstance(node, ast.Name):
            words.add(node.id.lower())
        elif isinstance(node, ast.Attribute):
            words.add(node.attr.lower())
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            words.add(node.name.lower())
    return bool(words & KINDS)


def naming(modules: tuple[Source, ...]) -> list[str]:
    return [module.path for module in modules if names_a_kind(module.tree)]


def test_kinds_of_laws_are_named_in_five_folders() -> None:
    found = naming(sources("planner", "scenes", "api", "prover", FRONT))
    assert [path for path in found if not path.startswith(FOLDERS)] == []
    assert [folder for folder in FOLDERS if not any(path.startswith(folder) for path in found)] == []


def test_a_module_that_names_a_kind_is_noticed() -> None:
    for text in ('law.kind == "conveyor"', "swing(pose, 1.0, 2.0)", "laws.Turntable", "def indexer(): ..."):
        assert names_a_kind(ast.parse(text))
    assert not names_a_kind(ast.parse("law.is_fixed or law.way is None"))

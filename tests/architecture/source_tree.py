"""The project's own source, parsed: what every architecture test reads."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
FRONT = "src/assur"
"""What `import assur` and `assur.request` are; the packages are linked there."""
PRODUCT = ("planner", "scenes", "api", "experiments", "prover", FRONT)
"""The packages that are installed, as assur.planner and so on, and what names them."""
BESIDE = ("benchmarks", "deploy", "tests")
"""What is only in the repository."""


@dataclass(frozen=True, eq=False)
class Source:
    """A module: its dotted `name`, its `path` below the root, its `text` and `tree`."""

    name: str
    path: str
    text: str
    tree: ast.Module


@cache
def sources(*packages: str) -> tuple[Source, ...]:
    """Every module of the packages."""
    found = []
    for package in packages:
        for path in sorted((ROOT / package).rglob("*.py")):
            relative = path.relative_to(ROOT)
            parts = list(relative.with_suffix("").parts)
            if parts[-1] == "__init__":
                parts.pop()
            text = path.read_text(encoding="utf-8")
            if package in PRODUCT:
                parts = parts[1:] if package == FRONT else ["assur", *parts]
            name = ".".join(parts)
            found.append(Source(name, relative.as_posix(), text, ast.parse(text)))
    return tuple(found)


def imports(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Dotted names that are imported anywhere in a module, lazily too, each with its line: for ``from a.b import c``
    both ``a.b`` and ``a.b.c``, for c may be a module."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, node.lineno
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module, node.lineno
            for alias in node.names:
                yield f"{node.module}.{alias.name}", node.lineno
        elif isinstance(node, ast.Call) and dotted(node.func) in (
            "importlib.import_module",
            "import_module",
            "__import__",
        ):
            for argument in node.args[:1]:
                if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
                    yield argument.value, node.lineno


def uses(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Dotted names that are read (``fcl.distance``), names imported from a module among them, each with its line."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            name = dotted(node)
            if name:
                yield name, node.lineno
    yield from imports(tree)


def names(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Every name, attribute and keyword that appears, each with its line."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            yield node.id, node.lineno
        elif isinstance(node, ast.Attribute):
            yield node.attr, node.lineno
        elif isinstance(node, ast.keyword) and node.arg:
            yield node.arg, node.value.lineno


def dotted(node: ast.AST) -> str:
    """``a.b.c`` of an attribute of an attribute of a name; empty for anything else."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        head = dotted(node.value)
        return f"{head}.{node.attr}" if head else ""
    return ""

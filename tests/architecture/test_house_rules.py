"""Names, sizes and habits that a machine can hold us to."""

from __future__ import annotations

import ast
import re
import tokenize
from collections import Counter
from collections.abc import Iterable
from io import BytesIO
from pathlib import PurePosixPath

import pytest

from tests.architecture.source_tree import BESIDE, PRODUCT, ROOT, Source, sources

NAMELESS = frozenset({"utils", "util", "helpers", "helper", "common", "core", "misc"})
"""Module names that say nothing about what is inside."""

MOST_LINES = 400
"""Above this a module of the product needs a reason in LONG."""
LONG: dict[str, str] = {
    "planner/claim/columns.py": "every column of the claim, once, with its meaning and what it may hold",
    "planner/model/outcome.py": "all facts of an outcome, each documented, beside the plan that they belong to",
    "planner/model/refusal.py": "the reasons and the facts of each, one list that must be complete",
    "prover/prove.py": "a second checker that is read as a whole, and copied as one file",
    "scenes/schema/answer.py": "the form of one document",
}
"""Path of a module → why one idea needs that many lines."""

TEXTS = frozenset({".py", ".toml", ".md", ".yaml", ".yml", ".cfg", ".sh", ".json", ""})
"""Suffixes of what is read as text."""
UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
SKIPPING = frozenset({"skip", "skipif", "xfail", "importorskip"})


def test_no_module_has_a_name_that_says_nothing() -> None:
    every = sources(*PRODUCT, *BESIDE)
    assert [source.path for source in every if NAMELESS & set(source.name.split("."))] == []


def test_no_module_grows_beyond_one_idea_without_a_reason() -> None:
    lines = {source.path: source.text.count("\n") for source in sources(*PRODUCT, "benchmarks")}
    assert {path: count for path, count in lines.items() if count > MOST_LINES and path not in LONG} == {}
    assert [path for path in LONG if lines.get(path, 0) <= MOST_LINES] == []


MOST_FLAT, MOST_IN_A_FOLDER = 7, 25
"""Modules directly in `planner/`, `__init__` among them, and in any folder of planner, scenes and api."""


def test_no_room_is_overcrowded() -> None:
    folders = Counter(PurePosixPath(source.path).parent.as_posix() for source in sources("planner", "scenes", "api"))
    assert folders["planner"] <= MOST_FLAT
    assert {folder: count for folder, count in folders.items() if count > MOST_IN_A_FOLDER} == {}


def test_every_module_of_the_product_says_what_it_is() -> None:
    every = [source for source in sources(*PRODUCT, "benchmarks") if source.text.strip()]
    assert [source.path for source in every if not ast.get_docstring(source.tree)] == []


def runs_early(source: Source) -> bool:
    """Whether what a module does as a program is in front of a part of it."""
    programs = [isinstance(node, ast.If) and "__main__" in ast.unparse(node.test) for node in source.tree.body]
    return any(programs[:-1])


def test_a_program_runs_when_all_of_its_module_is_defined() -> None:
    assert [source.path for source in sources(*PRODUCT, *BESIDE) if runs_early(source)] == []
    assert runs_early(made_up('if __name__ == "__main__":\n    main()\ndef main(): ...'))


MOST_SHARED = 40
"""Public functions and classes of `planner/` that have a name in common with one of another module."""


def shared(modules: Iterable[Source]) -> list[str]:
    """Names of public functions and classes that stand in two or more modules: a name is to mean one thing."""
    kinds = ast.FunctionDef | ast.ClassDef
    names = [node.name for source in modules for node in source.tree.body if isinstance(node, kinds)]
    return sorted(name for name, count in Counter(names).items() if count > 1 and not name.startswith("_"))


def test_a_name_mostly_means_one_thing() -> None:
    assert len(shared(sources("planner"))) <= MOST_SHARED


def test_a_name_with_two_meanings_is_found() -> None:
    assert shared([made_up("def f(): ...\ndef _g(): ..."), made_up("class f: ...\ndef _g(): ...")]) == ["f"]


def unfinished(source: Source) -> list[str]:
    """Notes to self, placeholders and swallowed errors in a module."""
    found = []
    for token in tokenize.tokenize(BytesIO(source.text.encode()).readline):
        if token.type == tokenize.COMMENT and UNFINISHED.search(token.string):
            found.append(f"{source.path}:{token.start[0]} {token.string}")
    for node in ast.walk(source.tree):
        if isinstance(node, ast.Raise) and "NotImplementedError" in ast.dump(node):
            found.append(f"{source.path}:{node.lineno} NotImplementedError")
        if isinstance(node, ast.ExceptHandler) and all(isinstance(line, ast.Pass) for line in node.body):
            found.append(f"{source.path}:{node.lineno} an error is swallowed")
    return found


def test_nothing_is_left_unfinished_or_swallowed() -> None:
    assert [finding for source in sources(*PRODUCT, "benchmarks") for finding in unfinished(source)] == []


def skipped(source: Source) -> list[str]:
    """Tests that do not run."""
    return [
        f"{source.path}:{node.lineno} {node.attr}"
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Attribute) and node.attr in SKIPPING and "pytest" in ast.dump(node.value)
    ]


def test_no_test_is_skipped() -> None:
    assert [finding for source in sources("tests") for finding in skipped(source)] == []


def test_no_tracked_text_names_a_folder_of_somebodys_machine() -> None:
    folders = re.compile(r"(?<![\w.])/(home|Users|root|work)/\w")
    found = []
    for path in ROOT.rglob("*"):
        relative = PurePosixPath(path.relative_to(ROOT).as_posix())
        hidden = any(part.startswith(".") and part not in (".ci", ".gitignore") for part in relative.parts)
        if hidden or relative.suffix not in TEXTS or relative.parts[0] == "out" or not path.is_file():
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        found += [f"{relative}: {match.group(0)}" for match in folders.finditer(text)]
    assert found == []


def made_up(text: str) -> Source:
    """A module that is not there."""
    return Source("assur.planner.x", "planner/x.py", text, ast.parse(text))


@pytest.mark.parametrize(
    "text",
    [
        "x = 1  # TO" + "DO: later",
        "def f():\n    raise NotImplementedError",
        "def f():\n    raise NotImplementedError('x')",
        "try:\n    f()\nexcept ValueError:\n    pass",
    ],
)
def test_what_is_unfinished_is_found(text: str) -> None:
    assert len(unfinished(made_up(text))) == 1


@pytest.mark.parametrize(
    "text", ["@pytest.mark.skip\ndef test_x(): ...", "pytest.skip('no')", "pytest.importorskip('x')"]
)
def test_what_is_skipped_is_found(text: str) -> None:
    assert len(skipped(made_up(text))) == 1

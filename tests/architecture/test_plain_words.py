"""Words that have to be read twice are in no docstring, comment, message, public name or page.

Plain words are: reported, required, stated, evaluated, the caller, whose, in addition, wrong. Readers have English as a
second language, and the refused words have several meanings or need a sentence that is turned round.
"""

from __future__ import annotations

import ast
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from io import BytesIO

import pytest

from tests.architecture.source_tree import PRODUCT, ROOT, Source, sources

REFUSED = re.compile(r"(?<!\w)(told|asked|said|looked at|whoever|of which|beside it|amiss)(?!\w)", re.IGNORECASE)
PART = re.compile(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])")
"""A word of a name in snake case or camel case."""
PAGES = (".md", ".yaml", ".yml", ".html", ".js", ".css", ".cfg", ".toml", ".sh")
"""Suffixes of files that are read as one text: pages, and what has comments and is not Python."""

FOLDERS = (*PRODUCT, "benchmarks", "deploy", "docs")
"""Folders that are read, in addition to README.md. Tests are not read: their texts are not public."""

EXCEPTIONS = {
    ("benchmarks/soak_service/rolling_restart.py", "lost, and told so"): "a key of recorded results",
    ("docs/how-it-is-tested.md", "lost, and told so"): "a key of recorded results",
    ("benchmarks/soak_service/row.py", "told"): "a field of recorded results",
}
"""File, and a name, or a phrase in a text, that may have a refused word → why."""


def plain(text: str) -> str:
    """The text on one line: a phrase may be broken in two."""
    return " ".join(text.split())


def comments(source: Source) -> Iterator[str]:
    """The comments of a module; those on lines that follow each other are one text."""
    block: list[str] = []
    last = 0
    for token in tokenize.tokenize(BytesIO(source.text.encode()).readline):
        if token.type == tokenize.COMMENT:
            if token.start[0] > last + 1 and block:
                yield " ".join(block)
                block = []
            block.append(token.string.lstrip("#: "))
            last = token.start[0]
    yield " ".join(block)


def texts(source: Source) -> Iterator[str]:
    """Docstrings and messages of a module: every string that has more than one word. A single word is a key."""
    parts = set()
    for node in ast.walk(source.tree):
        if isinstance(node, ast.JoinedStr):
            parts |= set(map(id, node.values))
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else "0" for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in parts:
            yield node.value if " " in node.value.strip() else ""


def public_names(source: Source) -> Iterator[str]:
    """Names that a module, its classes and its public functions show: modules, definitions, fields, parameters."""
    yield source.name.rpartition(".")[2]
    bodies: list[list[ast.stmt]] = [source.tree.body]
    while bodies:
        for node in bodies.pop():
            if isinstance(node, ast.Assign | ast.AnnAssign):
                for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                    yield from (each.id for each in ast.walk(target) if isinstance(each, ast.Name))
            elif isinstance(node, ast.ClassDef):
                yield node.name
                bodies.append(node.body)
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield node.name
                if not node.name.startswith("_"):
                    every = node.args
                    yield from (each.arg for each in (*every.posonlyargs, *every.args, *every.kwonlyargs))


def spoken(name: str) -> str:
    """`looked_at` and `LookedAt` as `looked at`; nothing for a private name."""
    return "" if name.startswith("_") else " ".join(PART.findall(name)).lower()


@cache
def all_texts() -> tuple[tuple[str, str], ...]:
    """Path of a file, and each text of it that is read: pages as a whole."""
    found = []
    for source in (*sources(*PRODUCT, "benchmarks"), *sources("deploy")):
        for text in (*comments(source), *texts(source), *map(spoken, public_names(source))):
            found.append((source.path, plain(text)))
    pages = [ROOT / "README.md"]
    for folder in FOLDERS:
        pages += (ROOT / folder).rglob("*")
    for page in sorted(pages):
        if page.suffix in PAGES and page.is_file():
            found.append((page.relative_to(ROOT).as_posix(), plain(page.read_text(encoding="utf-8"))))
    return tuple(found)


def refused(path: str, text: str) -> list[str]:
    """Each refused word of a text with what is round it, except phrases that the file may have."""
    for file, phrase in EXCEPTIONS:
        if file == path:
            text = text.replace(phrase, "") if " " in phrase or text == phrase else text
    return [f"{path}: …{text[max(match.start() - 60, 0) : match.end() + 40]}…" for match in REFUSED.finditer(text)]


def test_no_text_has_a_word_that_must_be_read_twice() -> None:
    assert [finding for path, text in all_texts() for finding in refused(path, text)] == []


def test_each_exception_occurs_and_needs_to_be_one() -> None:
    assert [(path, phrase) for path, phrase in EXCEPTIONS if not REFUSED.search(phrase)] == []
    every = [(path, text) for path, text in all_texts() if REFUSED.search(text)]
    assert [key for key in EXCEPTIONS if not any(path == key[0] and key[1] in text for path, text in every)] == []


@pytest.mark.parametrize(
    "text",
    [
        '"""What the caller is told."""',
        'def f():\n    """A hull, the corners of\n    which are few."""',
        "x = 1  # so it was\n# said",
        "raise ValueError(f'{x} was asked for')",
        "class Told: ...",
        "class A:\n    looked_at: int",
        "def f(*, asked): ...",
        "SAID = 1",
    ],
)
def test_each_kind_of_text_is_read(text: str) -> None:
    source = Source("assur.x", "x.py", text, ast.parse(text))
    every = [*comments(source), *texts(source), *map(spoken, public_names(source))]
    assert len([finding for each in every for finding in refused("x.py", plain(each))]) == 1


@pytest.mark.parametrize(
    "text", ['x = {"told": 1}', "def f():\n    asked = 1", "mask = 'ma' + 'sk'", "class _Told: ..."]
)
def test_keys_and_private_names_are_not_read(text: str) -> None:
    source = Source("assur.x", "x.py", text, ast.parse(text))
    assert [each for each in (*texts(source), *map(spoken, public_names(source))) if refused("x.py", plain(each))] == []

"""The tutorials are followed as a reader follows them: every block goes into the file, every command is run, and what
is printed is compared line by line."""

from __future__ import annotations

import re
import runpy
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import assur
from assur.scenes.requests import load_scenario
from tests.docs.pages import FENCE, ROOT, text
from tests.docs.test_commands import run, unlike


@dataclass(frozen=True)
class Tutorial:
    """A tutorial: its name, which its page, cell and drawing have; before the keys of the cell so many spaces; how many
    commands it has at least, and how many of them end in a refusal; and files that they make."""

    name: str
    indent: int
    commands: int
    refused: int
    made: frozenset[str]

    @property
    def page(self) -> str:
        return f"docs/{self.name}.md"

    @property
    def whole(self) -> Path:
        return ROOT / "docs" / f"{self.name}.yaml"

    @property
    def drawing(self) -> Path:
        return ROOT / "docs" / "drawings" / f"{self.name}.svg"

    def draw(self, cell: dict[str, Any]) -> str:
        """The drawing of a cell."""
        made = runpy.run_path(str(self.drawing.with_name(f"{self.name.replace('-', '_')}.py")), run_name="drawing")
        return str(made["draw"](cell))


BELT = Tutorial("first-belt-cell", 2, 10, 3, frozenset({"plan.json", "report.html", "motion.csv", "motion.yaml"}))
MINUTE = Tutorial("from-a-drawing-to-parts-a-minute", 0, 5, 1, frozenset({"run.html"}))
TUTORIALS = pytest.mark.parametrize("tutorial", [BELT, MINUTE], ids=lambda each: each.name)
INSTRUCTION = re.compile(
    r"(?P<what>Save as|Add to|Replace) (?:`(?P<key>\w+)` in )?`(?P<file>[\w.-]+)`:\s*\Z",
)


def section(content: str, key: str, indent: int) -> tuple[int, int]:
    """Where the lines of a key with so many spaces before it begin and end."""
    match = re.search(rf"^ {{{indent}}}{key}:.*\n(?:^ {{{indent + 1}}}.*\n)*", content, re.MULTILINE)
    assert match is not None, key
    return match.span()


def edited(content: str, what: str, key: str | None, block: str, indent: int) -> str:
    """The file after an instruction was followed."""
    if what == "Save as":
        return block
    if key is None:
        assert what == "Add to"
        return content + block
    start, end = section(content, key, indent)
    return content[:start] + block + content[end:] if what == "Replace" else content[:end] + block + content[end:]


def steps(page: str) -> Iterator[tuple[str, str, str]]:
    """The blocks of a page in order: language, the prose before each, and its text."""
    content = text(page)
    for match in FENCE.finditer(content):
        yield match.group(1), content[: match.start()], match.group(2)


def contents(tutorial: Tutorial) -> Iterator[tuple[str, str, str]]:
    """The blocks of the page in order: language, text, and what the file holds by then."""
    content = ""
    for language, before, block in steps(tutorial.page):
        if language == "yaml":
            said = INSTRUCTION.search(before)
            assert said is not None, block
            assert said["file"] == "cell.yaml"
            content = edited(content, said["what"], said["key"], block, tutorial.indent)
        yield language, block, content


def differences(shown: list[str], printed: list[str]) -> list[str]:
    """Lines that are shown and are not printed next; ``...`` stands for any lines."""
    wrong, at, any_lines = [], 0, False
    for line in shown:
        if line == "...":
            any_lines = True
            continue
        ahead = printed[at:] if any_lines else printed[at : at + 1]
        if line in ahead:
            at += ahead.index(line) + 1
        else:
            wrong.append(line)
        any_lines = False
    return wrong if any_lines or at == len(printed) else [*wrong, "there is more"]


def missed(tutorial: Tutorial, shown: list[str], printed: list[str]) -> list[str]:
    """What is shown and is not printed. A plan is the same everywhere, so its lines are; the figures of a run of many
    plans change with each change of the planner, so there the words count, and the parts a minute to a tenth."""
    if tutorial is BELT:
        return differences(shown, printed)
    return unlike(tuple(shown), "\n".join(printed)) + [
        f"{one} and {other} parts a minute"
        for one, other in zip(rates(shown), rates(printed), strict=False)
        if abs(one - other) > 0.1 * other
    ]


def rates(lines: list[str]) -> list[float]:
    """The parts a minute in these lines."""
    return [float(each) for each in re.findall(r"cell: ([\d.]+) parts a minute", "\n".join(lines))]


@pytest.mark.timeout(900)  # a dozen commands, one after the other
@TUTORIALS
def test_a_tutorial_can_be_followed_from_the_first_line_to_the_last(tutorial: Tutorial, tmp_path: Path) -> None:
    ran = refused = 0
    for language, block, content in contents(tutorial):
        (tmp_path / "cell.yaml").write_text(content, encoding="utf-8")
        if language == "yaml":
            continue
        assert language == "console"
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            line, *shown = part.splitlines()
            result = run(line, tmp_path)
            fault = any(each.startswith("assur: ") for each in shown)
            refusal = fault or any(each.endswith(": not planned") for each in shown)
            assert result.returncode == int(refusal) + int(fault), (line, result.stdout, result.stderr)
            printed = [each.rstrip() for each in (result.stderr if fault else result.stdout).splitlines()]
            assert not shown or missed(tutorial, shown, printed) == [], (line, result.stdout)
            ran, refused = ran + 1, refused + refusal
    assert ran >= tutorial.commands
    assert refused == tutorial.refused
    assert {path.name for path in tmp_path.iterdir()} >= tutorial.made


def test_the_change_of_the_second_tutorial_is_a_gain() -> None:
    shown = [each for _, block, _ in contents(MINUTE) for each in rates(block.splitlines())]
    assert len(shown) == 2
    assert shown[1] > 1.1 * shown[0]
    assert f"{shown[1] - shown[0]:.1f} pots a minute more" in text(MINUTE.page)
    assert missed(MINUTE, ["cell: 46.0 parts a minute"], ["cell: 40.0 parts a minute"]) != []
    assert missed(MINUTE, ["cell: 46.0 parts a minute"], ["cell: 45.0 parts a minute"]) == []


@TUTORIALS
def test_the_file_at_the_end_is_the_one_that_is_shipped(tutorial: Tutorial) -> None:
    *_, (_, _, content) = contents(tutorial)
    assert content == tutorial.whole.read_text(encoding="utf-8")


def test_a_line_that_differs_is_found() -> None:
    assert differences(["a", "...", "c"], ["a", "b", "c"]) == []
    assert differences(["a", "..."], ["a", "b"]) == []
    assert differences(["a", "c"], ["a", "b", "c"]) == ["c", "there is more"]
    assert differences(["1.00 s"], ["1.01 s"]) == ["1.00 s", "there is more"]


@pytest.mark.parametrize(
    ("what", "key", "block", "after"),
    [
        ("Add to", None, "  c: 3\n", "r:\n  a:\n    - 1\n  b: 2\n  c: 3\n"),
        ("Add to", "a", "    - 4\n", "r:\n  a:\n    - 1\n    - 4\n  b: 2\n"),
        ("Replace", "a", "  a: 5\n", "r:\n  a: 5\n  b: 2\n"),
    ],
)
def test_an_instruction_changes_what_it_names(what: str, key: str | None, block: str, after: str) -> None:
    assert edited("r:\n  a:\n    - 1\n  b: 2\n", what, key, block, 2) == after


def test_the_drawings_are_those_of_the_cells() -> None:
    request, cell = load_scenario(BELT.whole).request, assur.load(MINUTE.whole)
    for tutorial, drawn in ((BELT, request), (MINUTE, cell)):
        assert tutorial.draw(drawn) == tutorial.drawing.read_text(encoding="utf-8")
        drawn["bodies"][-1]["pose"]["at_mm"][0] += 10
        assert tutorial.draw(drawn) != tutorial.drawing.read_text(encoding="utf-8")

"""The tutorial is followed as a reader follows it: every block goes into the file, every command is run, and what is
printed is compared line by line."""

from __future__ import annotations

import re
import runpy
from collections.abc import Iterator
from pathlib import Path

import pytest

from assur.scenes.requests import load_scenario
from tests.docs.pages import FENCE, ROOT, text
from tests.docs.test_commands import run

PAGE = "docs/first-belt-cell.md"
WHOLE = ROOT / "docs" / "first-belt-cell.yaml"
DRAWING = ROOT / "docs" / "drawings" / "first-belt-cell.svg"
INSTRUCTION = re.compile(
    r"(?P<what>Save as|Add to|Replace) (?:`(?P<key>\w+)` in )?`(?P<file>[\w.-]+)`:\s*\Z",
)


def section(content: str, key: str) -> tuple[int, int]:
    """Where the lines of a key of the request begin and end."""
    match = re.search(rf"^  {key}:.*\n(?:^   .*\n)*", content, re.MULTILINE)
    assert match is not None, key
    return match.span()


def edited(content: str, what: str, key: str | None, block: str) -> str:
    """The file after an instruction was followed."""
    if what == "Save as":
        return block
    if key is None:
        assert what == "Add to"
        return content + block
    start, end = section(content, key)
    return content[:start] + block + content[end:] if what == "Replace" else content[:end] + block + content[end:]


def steps() -> Iterator[tuple[str, str, str]]:
    """The blocks of the page in order: language, the prose before each, and its text."""
    content = text(PAGE)
    for match in FENCE.finditer(content):
        yield match.group(1), content[: match.start()], match.group(2)


def contents() -> Iterator[tuple[str, str, str]]:
    """The blocks of the page in order: language, text, and what the file holds by then."""
    content = ""
    for language, before, block in steps():
        if language == "yaml":
            said = INSTRUCTION.search(before)
            assert said is not None, block
            assert said["file"] == "cell.yaml"
            content = edited(content, said["what"], said["key"], block)
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


@pytest.mark.timeout(900)  # a dozen commands, one after the other
def test_the_tutorial_can_be_followed_from_the_first_line_to_the_last(tmp_path: Path) -> None:
    ran = refused = 0
    for language, block, content in contents():
        (tmp_path / "cell.yaml").write_text(content, encoding="utf-8")
        if language == "yaml":
            continue
        assert language == "console"
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            line, *shown = part.splitlines()
            result = run(line, tmp_path)
            refusal = any("not planned" in each for each in shown)
            assert result.returncode == int(refusal), (line, result.stdout, result.stderr)
            printed = [each.rstrip() for each in result.stdout.splitlines()]
            assert not shown or differences(shown, printed) == [], (line, result.stdout)
            ran, refused = ran + 1, refused + refusal
    assert ran >= 10
    assert refused == 3
    assert {path.name for path in tmp_path.iterdir()} >= {"plan.json", "report.html", "motion.csv", "motion.yaml"}


def test_the_file_at_the_end_is_the_one_that_is_shipped() -> None:
    *_, (_, _, content) = contents()
    assert content == WHOLE.read_text(encoding="utf-8")


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
    assert edited("r:\n  a:\n    - 1\n  b: 2\n", what, key, block) == after


def test_the_drawing_is_that_of_the_cell() -> None:
    draw = runpy.run_path(str(ROOT / "docs" / "drawings" / "first_belt_cell.py"), run_name="drawing")["draw"]
    request = load_scenario(WHOLE).request
    assert draw(request) == DRAWING.read_text(encoding="utf-8")
    request["bodies"][-1]["pose"]["at_mm"][0] += 100
    assert draw(request) != DRAWING.read_text(encoding="utf-8")

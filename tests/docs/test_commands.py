"""Every command that README and docs show is run as it stands there, in a folder of its own."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.docs.curl import sent
from tests.docs.pages import HOST, PAGES, ROOT, Command, commands, of_language, save_files
from tests.docs.warm_process import run_words

ELSEWHERE = (
    "docs/service.md",
    "docs/first-belt-cell.md",
    "docs/from-a-drawing-to-parts-a-minute.md",
    "docs/examples.md",
)
"""Their commands are run by tests/api/test_service_page.py, test_tutorials.py and test_examples.py."""
SHOWN = [command for page in PAGES if page not in ELSEWHERE for command in commands(page)]
RUN = ("assur", "python")
"""Programs that are run here; `curl` is, against a service of its own."""
OURS = ("benchmarks/", "docs/", "scenes/")
"""Folders of the repository: what a command names below them is there already; everything else it makes."""
SHORTER = {
    "benchmarks.run_problems": ["--limit", "2"],
    "benchmarks.recheck": ["--partial"],
    "benchmarks.flows": ["--only", "one-lane", "--minutes", "0.1", "--seeds", "1"],
    "benchmarks.profile": ["--limit", "2", "--repeats", "2"],
    "benchmarks.best_known": ["--known", "out/known.json", "--work", "out", "--only", "A000", "--budget-s", "0.05"],
    "benchmarks.record": ["--only", "scenarios"],
    "benchmarks.report": ["--no-page", "--plots", "out"],
}
"""What the tests add to a command that would take minutes, or write into the repository."""


def run(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a line of the shell: `assur` and `python` of this environment; files of the repository are found."""
    program, *arguments = shlex.split(line)
    where = [str(ROOT / word) if word.startswith(OURS) else word for word in arguments]
    extra = SHORTER.get(arguments[1], []) if program == "python" and arguments[0] == "-m" else []
    return run_words([program, *where, *extra], folder)


def signature(line: str) -> str:
    """What a printed line says whatever its numbers are: its first cell, digits replaced."""
    return re.sub(r"\d+(\.\d+)?", "#", re.split(r"\s{2,}|;", line.strip())[0])


def unlike(shown: tuple[str, ...], printed: str) -> list[str]:
    """Lines that are shown and are like no line that was printed, in order; ``...`` stands for any lines."""
    there = iter([signature(line) for line in printed.splitlines()])
    return [line for line in shown if line.strip() and line != "..." and signature(line) not in there]


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=[pytest.mark.slow] if page == "docs/benchmarks.md" else [])
        for page in sorted({command.page for command in SHOWN if command.program in RUN})
    ],
)
def test_every_command_of_a_page_succeeds_and_prints_what_is_shown(page: str, tmp_path: Path) -> None:
    save_files(page, tmp_path)
    (tmp_path / "out").mkdir()
    ran = 0
    for command in commands(page):
        if command.program in RUN and not command.line.startswith("assur serve") and page not in MEASURED:
            result = run(command.line, tmp_path)
            refused = any(line.endswith(": not planned") for line in command.output)
            assert result.returncode == int(refused), (command.line, result.stdout[-2000:], result.stderr[-2000:])
            assert unlike(command.output, result.stdout) == [], (command.line, result.stdout)
            ran += 1
    assert ran or page in MEASURED


MEASURED = tuple(page for page in PAGES if page.startswith("docs/decisions/"))
"""Their commands take minutes; test_decisions.py runs each on less."""


def test_a_line_that_is_not_printed_is_found() -> None:
    assert unlike(("duration  1.2 s", "...", "plan checked"), "duration   3.4 s\n\nplan checked\n") == []
    assert unlike(("plan checked",), "plan wrong\n") == ["plan checked"]
    assert unlike(("b", "a"), "a\nb\n") == ["a"]


def test_every_command_is_of_a_kind_that_is_held_to_something() -> None:
    assert {command.program for command in SHOWN} <= {*RUN, "curl", "make"}
    assert {block.language for block in of_language("sh", "bash", "shell")} <= {"sh"}


def test_every_target_of_make_that_is_shown_is_there() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    shown = {command.line.split()[1] for command in SHOWN if command.program == "make"}
    assert shown >= {"demo", "test"}
    assert shown <= targets


def lacking(shown: Any, got: Any, where: str = "") -> list[str]:
    """What of the JSON that is shown the JSON that came has not."""
    if isinstance(shown, dict) and isinstance(got, dict):
        return [miss for key, value in shown.items() for miss in lacking(value, got.get(key), f"{where}.{key}")]
    if isinstance(shown, list) and isinstance(got, list) and len(shown) <= len(got):
        return [miss for i, value in enumerate(shown) for miss in lacking(value, got[i], f"{where}[{i}]")]
    return [] if shown == got else [f"{where}: {got!r}"]


CURLS = [command for command in SHOWN if command.program == "curl"]


@pytest.mark.parametrize("command", CURLS, ids=[f"{command.page}-{i}" for i, command in enumerate(CURLS)])
def test_every_call_is_answered_as_shown(command: Command, service: str, tmp_path: Path) -> None:
    save_files(command.page, tmp_path)
    words = shlex.split(command.line.replace(HOST, service))[1:]
    answers = [sent(words, tmp_path).json()]
    curl = shutil.which("curl")
    if curl is not None:  # where it is, the very line is run, too
        answers.append(json.loads(subprocess.run([curl, *words], cwd=tmp_path, capture_output=True, check=True).stdout))
    for answer in answers:
        if command.output:
            shown = json.loads("\n".join(command.output))
            assert lacking(shown, answer) == []
            assert lacking(answer, shown) == []  # nothing that is printed is left out
        else:
            assert answer["status"] == "planned", answer


def test_what_is_lacking_in_an_answer_is_found() -> None:
    assert lacking({"a": [1]}, {"a": [1, 2], "b": 3}) == []
    assert lacking({"a": [1], "c": 0}, {"a": [2]}) == [".a[0]: 2", ".c: None"]


def test_readme_shows_the_commands_that_a_newcomer_needs() -> None:
    lines = [command.line for command in commands("README.md")]
    assert {"make demo", "make test", "assur serve"} <= set(lines)
    assert any(line.startswith("curl ") for line in lines)


def test_the_error_that_is_shown_is_what_the_command_line_prints(tmp_path: Path) -> None:
    (shown,) = (block.text.strip() for block in of_language("text") if block.page == "docs/api.md")
    save_files("docs/api.md", tmp_path)
    cell = tmp_path / "cell.yaml"
    right = cell.read_text(encoding="utf-8")
    cell.write_text(right.replace("j1_deg: -40,", 'j1_deg: "-40",'), encoding="utf-8")
    assert cell.read_text(encoding="utf-8") != right
    result = run("assur plan cell.yaml", tmp_path)
    assert result.returncode != 0
    assert result.stderr.strip() == shown

"""Every Python, YAML and JSON block of README and docs is executed: run, planned, or held to the documents' rules."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path
from typing import Any

import pytest

from assur.scenes import load, plan
from assur.scenes.requests import load_robot, load_scenario, parse_json, plan_scenario, unmet
from assur.scenes.schema.cell_file import CELL, CellDocument
from assur.scenes.schema.read import read
from assur.scenes.schema.robots import FAMILIES
from assur.scenes.tasks.next_task import end_state
from assur.scenes.text.yaml_text import parse_yaml
from tests.docs.pages import HOST, PAGES, ROOT, Block, blocks, of_language, save_files
from tests.docs.warm_process import run_words
from tests.refused import refused_at

ELSEWHERE = (
    "docs/request.md",
    "docs/first-belt-cell.md",
    "docs/from-a-drawing-to-parts-a-minute.md",
    "docs/service.md",
)
"""Their fragments are built into scenes by tests/scenes/test_request_docs.py and test_tutorials.py, and sent to a
service by test_cells_over_http.py."""
PYTHON = of_language("python")
YAML = [block for block in of_language("yaml", "yml") if block.page not in ELSEWHERE]
JSON = [block for block in of_language("json") if block.page not in ELSEWHERE]
NOT_CODE = {"xml", "", "console", "sh", "text"}
"""Languages of blocks that are no documents: formulas, commands, Docker's, output."""


def ids(shown: list[Block]) -> list[str]:
    return [f"{block.page}:{block.line}" for block in shown]


@pytest.mark.parametrize("block", PYTHON, ids=ids(PYTHON))
def test_every_python_block_runs_by_itself(block: Block, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    save_files(block.page, tmp_path)
    program = block.text
    if HOST in program:
        program = program.replace(HOST, request.getfixturevalue("service"))
    ran = run_words(["python", "-W", "error", "-c", program], tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert ran.stderr == ""


def test_a_page_that_runs_out_of_time_fails_alone(tmp_path: Path) -> None:
    class OutOfTimeError(Exception):
        pass

    def out_of_time(*_: object) -> None:
        raise OutOfTimeError

    before = signal.signal(signal.SIGUSR1, out_of_time)
    try:
        program = f"import os, signal, time; os.kill({os.getpid()}, signal.SIGUSR1); time.sleep(60)"
        with pytest.raises(OutOfTimeError):
            run_words(["python", "-c", program], tmp_path)
    finally:
        signal.signal(signal.SIGUSR1, before)
    ran = run_words(["python", "-c", "print('next')"], tmp_path)
    assert (ran.returncode, ran.stdout) == (0, "next\n")


def whole(block: Block, base: dict[str, Any]) -> dict[str, Any]:
    """The request that a fragment stands for: its keys in place of those of `base`."""
    document, _ = parse_yaml(block.text.encode())
    return {**base, **document}


@pytest.mark.parametrize("block", YAML, ids=ids(YAML))
def test_every_yaml_block_is_planned_by_itself_or_in_the_small_cell(block: Block, tmp_path: Path) -> None:
    save_files(block.page, tmp_path)
    if block.saved is not None and any(block.text.startswith(f"{family}:") for family in FAMILIES):
        assert load_robot(tmp_path / block.saved).listed()["joints"]
    elif block.text.startswith(f"schema: {CELL}"):
        assert read(CellDocument, parse_yaml(block.text.encode())[0]).robot
    elif block.saved is not None:
        after = None
        if "start:" not in block.text:
            first = load_scenario(tmp_path / "task.yaml")
            after = end_state(first.request, plan_scenario(first))
        scenario = load_scenario(tmp_path / block.saved, after)
        assert unmet(scenario.expect, plan_scenario(scenario)) == []
    else:
        (base,) = (json.loads(other.text) for other in JSON if other.saved == "request.json")
        answer = plan(whole(block, base), certificate="digest")
        assert answer["status"] == "planned", answer.get("sentence")


@pytest.mark.parametrize("block", JSON, ids=ids(JSON))
def test_every_json_block_is_a_request_that_is_planned(block: Block, tmp_path: Path) -> None:
    answer = plan(parse_json(block.text.encode()), certificate="digest")
    assert answer["status"] == "planned"


def test_a_fragment_that_is_not_right_is_refused() -> None:
    (base,) = (json.loads(block.text) for block in JSON if block.saved == "request.json")
    wrong = Block("x", 1, "yaml", "options: {clearance: 5}\n", None)
    with refused_at("options.clearance"):
        plan(whole(wrong, base))


def test_the_small_cell_is_the_same_in_yaml_and_in_json(tmp_path: Path) -> None:
    save_files("docs/api.md", tmp_path)
    assert load(tmp_path / "cell.yaml") == load(tmp_path / "request.json")


def test_no_block_is_of_a_language_that_nothing_executes() -> None:
    shown = {block.language for page in PAGES for block in blocks(page)}
    assert {"python", "yaml", "json", "console"} <= shown <= {"python", "yaml", "json", *NOT_CODE}


def test_readme_shows_five_lines_of_python() -> None:
    (block,) = (block for block in PYTHON if block.page == "README.md")
    assert len([line for line in block.text.splitlines() if line.strip()]) <= 5


def test_the_example_of_typed_requests_is_the_file_that_is_type_checked() -> None:
    (block,) = (block for block in PYTHON if "from assur.request import" in block.text)
    assert block.page == "docs/python.md"
    assert block.text == (ROOT / "tests" / "docs" / "belt_pick.py").read_text(encoding="utf-8")

"""Answers that know their requests: saved and read again, reported, and shown in a notebook."""

from __future__ import annotations

import copy
import html
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import assur
from assur.api.workers.jobs import FIRST_PLAN
from assur.scenes.plan_file import PlanFile
from tests.api.test_command_line import run
from tests.refused import refused_at

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def answer() -> assur.Answer:
    return assur.plan(FIRST_PLAN)


@pytest.fixture
def saved(answer: assur.Answer, tmp_path: Path) -> Path:
    return answer.save(tmp_path / "plan.json", title="small", about="It moves.")


def test_an_answer_is_saved_with_its_request_and_read_again(answer: assur.Answer, saved: Path) -> None:
    again = assur.load_answer(saved)
    assert again == answer
    assert again.request == answer.request == FIRST_PLAN
    assert assur.load(saved) == FIRST_PLAN
    assert again.request is not None
    assert assur.check(again.request, again)["ok"]
    assert run("check", str(saved))[0] == 0


def test_a_request_that_is_changed_later_is_not_that_of_the_answer(answer: assur.Answer, tmp_path: Path) -> None:
    request = copy.deepcopy(FIRST_PLAN)
    made = assur.plan(request)
    request["bodies"].clear()
    assert made.request == FIRST_PLAN
    assert assur.load_answer(made.save(tmp_path / "plan.json")).request == FIRST_PLAN


def test_a_refusal_is_saved_and_reported_too(tmp_path: Path) -> None:
    refused = assur.plan({**FIRST_PLAN, "task": [{"move": {"to": {"at_mm": [1500, 0, 250]}}}]})
    assert assur.load_answer(refused.save(tmp_path / "plan.json")).sentence == refused.sentence != ""
    page = refused.report(tmp_path / "report.html").read_text(encoding="utf-8")
    assert html.escape(refused.sentence) in page


def test_an_answer_that_does_not_know_its_request_says_so(answer: assur.Answer, tmp_path: Path) -> None:
    bare = assur.Answer(answer.document)
    assert bare.request is None
    for call in (lambda: bare.save(tmp_path / "x.json"), lambda: bare.report(tmp_path / "x.html"), bare.show):
        with pytest.raises(assur.InputError, match=r"answer\.request"):
            call()
    assert list(tmp_path.iterdir()) == []
    assert assur.Answer(answer.document, FIRST_PLAN).save(tmp_path / "x.json").exists()


def test_what_is_no_plan_file_is_refused(saved: Path, answer: assur.Answer, tmp_path: Path) -> None:
    other = {**FIRST_PLAN, "bodies": FIRST_PLAN["bodies"][:1]}
    for document, field in (
        (answer.document, "schema"),
        (FIRST_PLAN, "schema"),
        ([], "request"),
        (PlanFile(other, answer.document).document, "plan.request_digest"),
        (PlanFile({**FIRST_PLAN, "robot": {}}, answer.document).document, "request.robot"),
    ):
        saved.write_text(json.dumps(document))
        with refused_at(field):
            assur.load_answer(saved)
    for given in (tmp_path / "none.json", tmp_path, "demo"):
        with pytest.raises(assur.InputError, match=r"^path: .*a plan file that is there"):
            assur.load_answer(given)
    with pytest.raises(assur.InputError, match="title"):
        answer.save(saved, title="x" * 5000)


def test_a_report_is_written_and_says_what_the_checker_says(answer: assur.Answer, tmp_path: Path) -> None:
    page = answer.report(tmp_path / "report.html", title="A & B", about="Why <it> exists").read_text(encoding="utf-8")
    assert "the plan is right" in page
    assert "A &amp; B" in page
    assert "Why &lt;it&gt; exists" in page
    told = copy.deepcopy(answer.document)
    told["margins"]["nearest"]["gap_m"] += 0.01
    wrong = assur.Answer(told, FIRST_PLAN).report(tmp_path / "wrong.html").read_text(encoding="utf-8")
    assert "the plan is wrong" in wrong


CELLS = (
    "import assur\nanswer = assur.plan(assur.load('transfer'))",
    "answer.show(height_px=400, title='in a notebook')",
    "answer.show(height_px=0)",
)


def test_a_notebook_shows_the_viewer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kernel as Jupyter runs it, in a process of its own."""
    monkeypatch.setenv("PYTHONPATH", f"{ROOT / 'src'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")
    cells = [nbformat.v4.new_code_cell(text) for text in CELLS]  # type: ignore[no-untyped-call]
    notebook = nbformat.v4.new_notebook(cells=cells)  # type: ignore[no-untyped-call]
    NotebookClient(notebook, timeout=150, kernel_name="python3", allow_errors=True).execute()
    planned, shown, refused = (cell["outputs"] for cell in notebook["cells"])
    assert planned == []
    (output,) = shown
    assert output["output_type"] == "execute_result"
    frame = output["data"]["text/html"]
    assert "height: 400px" in frame
    assert output["data"]["text/plain"].startswith("<the viewer of an answer")
    page = html.unescape(re.search(r'srcdoc="([^"]*)"', frame).group(1))  # type: ignore[union-attr]
    assert "<title>in a notebook" in page
    assert "the plan is right" in page
    assert len(page) < 1_000_000
    assert "height_px: got 0" in refused[0]["evalue"]


def test_where_there_is_no_notebook_it_says_what_to_do() -> None:
    program = "import assur; print(assur.plan(assur.load('transfer')).show())"
    command = [sys.executable, "-c", program]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    ran = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    assert "no notebook is running here" in ran.stderr
    assert "answer.report('report.html')" in ran.stderr
    assert "answer.report('report.html')" in ran.stdout

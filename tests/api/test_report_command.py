"""`assur report` and `assur plan --open`: the page that they write, and how they end."""

from __future__ import annotations

import base64
import copy
import json
import re
import webbrowser
from pathlib import Path
from typing import Any

import pytest

from assur.api.cli.border import BAD_INPUT, RIGHT, WRONG
from assur.api.workers.jobs import FIRST_PLAN
from assur.scenes.meshes.assets import asset
from assur.scenes.report.assembly import EXPORT, FIRST, IMPORT, PAGE, inline, script
from assur.scenes.requests import plan_document
from tests.api.test_command_line import run

MOST_LINES = 3_000
"""Of HTML, CSS and JavaScript together."""


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path, Path]:
    """A request, its answer, and where a report may go."""
    request, answer = tmp_path / "small.json", tmp_path / "plan.json"
    request.write_text(json.dumps(FIRST_PLAN))
    answer.write_text(json.dumps(plan_document(FIRST_PLAN)))
    return request, answer, tmp_path / "report.html"


def held(page: str) -> dict[str, Any]:
    """The view that a page holds."""
    found = re.search(r'<script type="application/json" id="view">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    view: dict[str, Any] = json.loads(found.group(1))
    return view


def test_a_report_is_written_says_where_and_holds_view_tables_and_documents(files: tuple[Path, Path, Path]) -> None:
    request, answer, out = files
    code, output, errors = run("report", str(request), str(answer), "--out", str(out))
    assert (code, errors) == (RIGHT, "")
    assert str(out) in output
    page = out.read_text(encoding="utf-8")
    assert held(page)["status"] == "planned"
    for word in (
        "Arrivals",
        "Margins",
        "Assumptions",
        "the plan is right",
        "sha256:",
        "ISO 10218",
        "Request",
        "Answer",
    ):
        assert word in page
    assert "its digest stands for them" in page
    assert '"t0_s"' not in page


def test_without_a_plan_the_request_is_planned_first(files: tuple[Path, Path, Path]) -> None:
    request, _, out = files
    assert run("report", str(request), "--out", str(out))[0] == RIGHT
    assert held(out.read_text(encoding="utf-8"))["moves"] is True


def test_a_plan_that_the_checker_refuses_is_reported_as_wrong(files: tuple[Path, Path, Path]) -> None:
    request, answer, out = files
    told = json.loads(answer.read_text())
    told["margins"]["nearest"]["gap_m"] += 0.01
    answer.write_text(json.dumps(told))
    code, _, errors = run("report", str(request), str(answer), "--out", str(out))
    assert code == WRONG
    assert "the checker refuses" in errors
    assert "the plan is wrong" in out.read_text(encoding="utf-8")


def test_a_plan_with_a_digest_says_that_it_was_not_checked(files: tuple[Path, Path, Path]) -> None:
    request, answer, out = files
    brief = plan_document(FIRST_PLAN, certificate="digest")
    answer.write_text(json.dumps(brief))
    assert run("report", str(request), str(answer), "--out", str(out))[0] == RIGHT
    assert "the plan was not checked" in out.read_text(encoding="utf-8")


def test_wrong_files_are_named(files: tuple[Path, Path, Path], tmp_path: Path) -> None:
    request, answer, out = files
    for arguments, named in (
        ([str(request), str(tmp_path / "none.json")], "PLAN"),
        ([str(request), str(request)], "plan.status"),
        (["demo", str(answer)], "plan.request_digest"),
        ([str(request), str(answer), "--out", str(tmp_path / "no" / "where.html")], "--out"),
    ):
        code, _, errors = run("report", *arguments, *([] if "--out" in arguments else ["--out", str(out)]))
        assert code == BAD_INPUT
        assert named in errors
    assert not out.exists()


def test_open_shows_the_page_in_a_browser(
    files: tuple[Path, Path, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    opened = list[str]()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def shown(address: str) -> bool:
        opened.append(address)
        return True

    monkeypatch.setattr(webbrowser, "open", shown)
    code, _, errors = run("plan", str(files[0]), "--open")
    assert code == RIGHT
    assert len(opened) == 1
    path = Path(opened[0].removeprefix("file://"))
    assert str(path) in errors
    assert held(path.read_text(encoding="utf-8"))["status"] == "planned"
    monkeypatch.setattr(webbrowser, "open", lambda _: False)
    assert "no browser" in run("report", str(files[0]), str(files[1]), "--out", str(files[2]), "--open")[2]


def test_the_content_of_a_mesh_is_replaced_by_its_digest(tmp_path: Path) -> None:
    request = copy.deepcopy(FIRST_PLAN)
    data = base64.b64encode(asset("bracket")).decode()
    request["bodies"][1]["shape"] = {"mesh": {"data": data, "format": "stl", "unit": "mm"}}
    (tmp_path / "mesh.json").write_text(json.dumps(request))
    out = tmp_path / "report.html"
    assert run("report", str(tmp_path / "mesh.json"), "--out", str(out))[0] == RIGHT
    page = out.read_text(encoding="utf-8")
    assert data not in page
    assert f"{len(asset('bracket'))} bytes, SHA-256" in page


def test_text_of_a_request_cannot_end_an_element_of_the_page() -> None:
    nasty = "</script><script>alert(1)</script>&<!--"
    assert "<" not in inline({"name": nasty})
    assert json.loads(inline({"name": nasty})) == {"name": nasty}


def test_the_page_is_of_a_size_that_one_can_read() -> None:
    lines = {path.name: path.read_text(encoding="utf-8").count("\n") for path in PAGE.iterdir()}
    assert sum(lines.values()) <= MOST_LINES
    assert {name: count for name, count in lines.items() if count > 500} == {}


def test_every_module_of_the_page_is_in_the_script_behind_what_it_imports() -> None:
    code = script()
    for path in PAGE.glob("*.js"):
        at = code.index(f'modules["{path.name}"] = ')
        source = path.read_text(encoding="utf-8")
        for names, other in IMPORT.findall(source):
            assert code.index(f'modules["{other}"] = ') < at
            exported = EXPORT.findall((PAGE / other).read_text(encoding="utf-8"))
            assert {name.strip() for name in names.strip("{ }").split(",") if name.strip()} <= set(exported)
    assert code.count("modules[") > 10
    assert f'modules["{FIRST}"]' in code
    assert not re.search(r"^(import|export) ", code, re.MULTILINE)


def test_the_page_names_no_address_of_a_network() -> None:
    address = re.compile(r"https?://|//\w+\.\w+/|fetch\(|XMLHttpRequest|WebSocket|import\(")
    assert address.search("fetch('x')")
    for path in PAGE.iterdir():
        assert not address.search(path.read_text(encoding="utf-8"))

"""The examples that keep a cell and plan a task in it, and that simulate: a shell runs their lines as they stand."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import assur
from assur.scenes import load
from tests.api.processes import serving, until
from tests.docs.pages import ENVIRONMENT, HOST, blocks, save_files, text


def printed(lines: str, folder: Path, meshes: Path) -> str:
    """What the lines of a shell print in a folder, against a service that keeps cells."""
    programs = {"python": ""} if shutil.which("curl") else {"python": "", "curl": "-m tests.docs.curl"}
    for name, words in programs.items():
        (folder / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {words} "$@"\n', encoding="utf-8")
        (folder / name).chmod(0o755)
    known = {**ENVIRONMENT, "PATH": f"{folder}{os.pathsep}{ENVIRONMENT['PATH']}"}
    with serving(others=ENVIRONMENT, WORKERS="1", GRACE_S="30", MESH_FOLDER=str(meshes)) as server:
        until(server.ready)
        shell = ["bash", "-euo", "pipefail", "-c", lines.replace(HOST, server.address)]
        ran = subprocess.run(shell, cwd=folder, env=known, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_a_cell_is_kept_and_a_task_is_planned_in_it(tmp_path: Path) -> None:
    (lines,) = (block.text for block in blocks("docs/service.md") if "/plans?fields=" in block.text)
    folder = tmp_path / "meshes"
    assert "`ASSUR_MESH_FOLDER=meshes assur serve`" in text("docs/service.md")
    for page in ("docs/cells.md", "docs/service.md"):
        save_files(page, tmp_path)
    output = printed(lines, tmp_path, folder)
    stored, end = json.JSONDecoder().raw_decode(output)
    answer = json.loads(output[end:])
    assert [path.name for path in folder.glob("*.cell")] == [f"{stored['sha256']}.cell"]
    assert json.loads((tmp_path / "cell.json").read_bytes()) == load(tmp_path / "cell.yaml")
    assert list(answer) == ["status", "duration_s", "arrivals", "trajectory"]
    assert answer["status"] == "planned"
    assert [each["control_point"] for each in answer["arrivals"]] == ["pick-a", "place-a", "move-3"]
    assert list(answer["trajectory"]) == ["time_s"]
    assert answer["trajectory"]["time_s"][-1] == answer["duration_s"]
    assert f"{answer['duration_s']:.6g}" == str(answer["duration_s"])


@pytest.mark.parametrize(("page", "seeds"), [("docs/service.md", 2), ("docs/simulation.md", 1)])
def test_a_cell_is_simulated(page: str, seeds: int, tmp_path: Path) -> None:
    (lines,) = (block.text for block in blocks(page) if "/simulations" in block.text)
    save_files("docs/simulation.md", tmp_path)
    printed(lines, tmp_path, tmp_path / "meshes")
    found = json.loads((tmp_path / "result.json").read_bytes())
    assert found == json.loads(json.dumps(assur.simulate(load(tmp_path / "cell.yaml"), minutes=0.3, seeds=seeds)))
    *_, last = (tmp_path / "progress.txt").read_text(encoding="utf-8").strip().split("\n\n")
    assert last.startswith("event: done\n")
    assert "parts a minute" in (tmp_path / "run.html").read_text(encoding="utf-8")

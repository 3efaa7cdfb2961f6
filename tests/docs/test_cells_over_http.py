"""The example of docs/service.md that keeps a cell and plans a task in it: a shell runs its lines as they stand."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from assur.scenes import load
from tests.api.processes import serving, until
from tests.docs.pages import ENVIRONMENT, HOST, blocks, save_files, text


def test_a_cell_is_kept_and_a_task_is_planned_in_it(tmp_path: Path) -> None:
    (lines,) = (block.text for block in blocks("docs/service.md") if "v1/cells/" in block.text)
    folder = tmp_path / "meshes"
    assert "`ASSUR_MESH_FOLDER=meshes assur serve`" in text("docs/service.md")
    for page in ("docs/cells.md", "docs/service.md"):
        save_files(page, tmp_path)
    programs = {"python": ""} if shutil.which("curl") else {"python": "", "curl": "-m tests.docs.curl"}
    for name, words in programs.items():
        (tmp_path / name).write_text(f'#!/bin/sh\nexec "{sys.executable}" {words} "$@"\n', encoding="utf-8")
        (tmp_path / name).chmod(0o755)
    known = {**ENVIRONMENT, "PATH": f"{tmp_path}{os.pathsep}{ENVIRONMENT['PATH']}"}
    with serving(others=ENVIRONMENT, WORKERS="1", GRACE_S="30", MESH_FOLDER=str(folder)) as server:
        until(server.ready)
        shell = ["bash", "-euo", "pipefail", "-c", lines.replace(HOST, server.address)]
        ran = subprocess.run(shell, cwd=tmp_path, env=known, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    stored, end = json.JSONDecoder().raw_decode(ran.stdout)
    answer = json.loads(ran.stdout[end:])
    assert [path.name for path in folder.glob("*.cell")] == [f"{stored['sha256']}.cell"]
    assert json.loads((tmp_path / "cell.json").read_bytes()) == load(tmp_path / "cell.yaml")
    assert list(answer) == ["status", "duration_s", "arrivals", "trajectory"]
    assert answer["status"] == "planned"
    assert [each["control_point"] for each in answer["arrivals"]] == ["pick-a", "place-a", "move-3"]
    assert list(answer["trajectory"]) == ["time_s"]
    assert answer["trajectory"]["time_s"][-1] == answer["duration_s"]
    assert f"{answer['duration_s']:.6g}" == str(answer["duration_s"])

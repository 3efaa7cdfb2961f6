"""What docs/request.md shows is taken as it stands, and runs."""

from __future__ import annotations

import copy
import re
from pathlib import Path
from typing import Any

import pytest

from assur.scenes.catalogue import models
from assur.scenes.meshes.assets import asset_names
from assur.scenes.requests import scene_of
from assur.scenes.schema.request import RequestDocument
from assur.scenes.text.yaml_text import parse_yaml

TEXT = (Path("docs") / "request.md").read_text()
PARTS = re.findall(r"```yaml\n(.*?)```", TEXT, re.DOTALL)
PROGRAMS = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)

BASE: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
    "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
    "task": [{"move": {"to": {"at_mm": [350, 0, 120]}}}],
}


@pytest.mark.parametrize("text", PARTS, ids=lambda text: str(text).split(":")[0])
def test_each_part_of_a_request_makes_a_scene(text: str) -> None:
    part, _ = parse_yaml(text.encode())
    scene = scene_of({**copy.deepcopy(BASE), **part})
    for name, frame in part.get("frames", {}).items():
        assert (name in scene.frames) == ("frame" not in frame.get("fixed", {}))
    for body in part.get("bodies", ()):
        assert body["name"] in scene.index


def test_every_field_of_a_request_is_shown() -> None:
    shown = {key for text in PARTS for key in parse_yaml(text.encode())[0]}
    fields = {field.alias or name for name, field in RequestDocument.model_fields.items()}
    assert shown == fields - {"schema"}


def test_every_model_and_asset_is_listed() -> None:
    for name in (*models(), *asset_names()):
        assert f"`{name}`" in TEXT


@pytest.mark.parametrize("program", PROGRAMS)
def test_the_program_runs(program: str) -> None:
    exec(compile(program, "docs/request.md", "exec"), {})

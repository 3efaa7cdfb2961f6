"""The Khronos validator accepts the model of every shipped scenario. `make test-gltf` installs it and runs this."""

from __future__ import annotations

import base64
import json
import os
import struct
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.scenes.exports.test_glb import PLANNED, exported

SCRIPT = Path(__file__).with_name("validate.cjs")
FOLDER = os.environ.get("GLTF_VALIDATOR", str(Path(__file__).parents[2] / ".venv" / "gltf-validator"))
"""Where npm has installed it."""


def judged(files: list[Path]) -> list[dict[str, Any]]:
    """What the validator says of each file."""
    asked = ["node", str(SCRIPT), FOLDER, *map(str, files)]
    run = subprocess.run(asked, capture_output=True, text=True, timeout=170, check=False)
    assert run.returncode == 0, run.stderr
    found: list[dict[str, Any]] = json.loads(run.stdout)
    return found


@pytest.mark.parametrize("name", PLANNED)
def test_a_model_has_no_error_and_no_warning(name: str, tmp_path: Path) -> None:
    path = tmp_path / f"{name}.glb"
    path.write_bytes(base64.b64decode(exported(name)["file"]))
    (found,) = judged([path])
    assert (found["numErrors"], found["numWarnings"], found["truncated"]) == (0, 0, False), found["messages"]
    assert {message["code"] for message in found["messages"]} <= {"NODE_EMPTY"}


def test_what_is_wrong_is_found(tmp_path: Path) -> None:
    data = base64.b64decode(exported("demo")["file"])
    (size,) = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20 : 20 + size])
    sampler = document["animations"][0]["samplers"][0]
    view = document["bufferViews"][document["accessors"][sampler["input"]]["bufferView"]]
    late = bytearray(data)
    # the first key after the second
    struct.pack_into("<f", late, 28 + size + view["byteOffset"], 9.0)
    paths = [tmp_path / "short.glb", tmp_path / "late.glb"]
    paths[0].write_bytes(data[:-8])
    paths[1].write_bytes(late)
    assert all(found["numErrors"] > 0 for found in judged(paths))

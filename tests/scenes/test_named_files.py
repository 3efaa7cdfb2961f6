"""Files that a request names: those below the folder of the file that names them, of one kind each, and no others."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from assur.scenes.catalogue import FOLDER
from assur.scenes.requests import cell_of
from tests.changed import GONE, changed
from tests.refused import refused_at
from tests.scenes.bad_requests import GOOD_REQUEST, NEIGHBOUR
from tests.scenes.meshes.solids import SOLIDS, binary_stl

PLAN = {"status": "planned", "trajectory": NEIGHBOUR["neighbours"][0]["trajectory"]}
KINDS: dict[str, tuple[Any, dict[str, Any], str, bytes]] = {
    "bodies[1].shape.mesh.file": (
        GOOD_REQUEST,
        {"bodies[1].shape.mesh": {"unit": "mm"}},
        ".stl",
        binary_stl(SOLIDS["bracket"]),
    ),
    "robot.file": (GOOD_REQUEST, {"robot.model": GONE}, ".yaml", (FOLDER / "mitsubishi-rh-6frh5520.yaml").read_bytes()),
    "neighbours[0].plan.file": (
        NEIGHBOUR,
        {"neighbours[0].trajectory": GONE, "neighbours[0].plan": {}},
        ".json",
        json.dumps(PLAN).encode(),
    ),
}
"""Field → a request, what is changed in it, the end of the name of a file, and what is in such a file."""


@pytest.mark.parametrize("field", KINDS)
def test_a_file_below_the_folder_is_read_and_a_request_alone_never_names_one(tmp_path: Path, field: str) -> None:
    on, changes, end, content = KINDS[field]
    (tmp_path / "inside").mkdir()
    (tmp_path / "inside" / f"part{end}").write_bytes(content)
    request = changed(on, {**changes, field: f"inside/part{end}"})
    cell_of(request, folder=tmp_path)
    with refused_at(field):
        cell_of(request)


OTHERS = (
    *("../outside", "inside/../../outside", "link", "linked/outside"),
    *("missing", "secret.txt", "a\0", "inside", "/etc/passwd"),
)


@pytest.mark.parametrize("field", KINDS)
@pytest.mark.parametrize("name", OTHERS)
def test_no_other_file_is_ever_read(tmp_path: Path, field: str, name: str) -> None:
    on, changes, end, content = KINDS[field]
    folder, outside = tmp_path / "cell", tmp_path / f"outside{end}"
    (folder / "inside").mkdir(parents=True)
    outside.write_bytes(content)
    (folder / "secret.txt").write_bytes(content)
    (folder / f"link{end}").symlink_to(outside)
    (folder / "linked").symlink_to(tmp_path)
    for spelt in (name, f"{name}{end}", str(outside), f"/{name}{end}"):
        with refused_at(field, "a file below the folder of the file that names it"):
            cell_of(changed(on, {**changes, field: spelt}), folder=folder)

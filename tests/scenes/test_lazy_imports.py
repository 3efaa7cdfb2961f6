"""Documents, catalogue and scenarios load without a native library: each door in a fresh interpreter."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = ("fcl", "ruckig", "trimesh", "scipy")

DOORS = {
    "reading": "import assur.scenes.requests as r; r.validate(r.shipped('demo').request)",
    "listing": "import assur.scenes.requests as r; r.robots(); r.shipped_scenarios(); r.request_schema()",
    "parsing": "import assur.scenes.requests as r; r.parse_json(b'{}')",
    "digest": "import assur.scenes.requests as r; r.request_digest(r.shipped('demo').request)",
    "scene": (
        "import assur.scenes.requests as r\n"
        "request = dict(r.shipped('demo').request)\n"
        "request['bodies'] = [dict(b, shape={'box': {'size_mm': [60, 40, 20]}}) for b in request['bodies']]\n"
        "r.scene_of(request)"
    ),
    "every module": (
        "import importlib, pkgutil\nfrom assur import scenes\n"
        "for module in pkgutil.walk_packages(scenes.__path__, 'assur.scenes.'):\n"
        "    if not module.name.startswith('assur.scenes.meshes.'): importlib.import_module(module.name)"
    ),
}


@pytest.mark.parametrize("door", sorted(DOORS))
def test_no_native_library_is_loaded(door: str) -> None:
    probe = f"{DOORS[door]}\nimport sys; print([m for m in {HEAVY} if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_the_probe_sees_a_library_that_is_loaded() -> None:
    doors = "assur.scenes.meshes.load, assur.scenes.meshes.hull"
    probe = f"import {doors}, sys; print([m for m in {HEAVY} if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "['scipy']"

"""Documents, catalogue, web process and listing commands load no native library: each door in a fresh interpreter.

So a crash or a hang of one cannot reach the web process, and nobody waits for a compiler to read a list.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.source_tree import ROOT

NATIVE = {"fcl", "ruckig", "trimesh", "scipy", "numba", "llvmlite"}

DOORS = {
    "reading": "import assur.scenes.requests as r; r.validate(r.shipped('demo').request)",
    "listing": "import assur.scenes.requests as r; r.robots(); r.shipped_scenarios(); r.request_schema()",
    "naming": "import assur; dir(assur); assert all(hasattr(assur, name) for name in assur.__all__)",
    "building": "from assur.request import Joints, Start, deg; Start(joints=Joints(j1_rad=deg(17)))",
    "a client": "import assur; assur.Client('http://127.0.0.1:8000').close()",
    "parsing": "import assur.scenes.requests as r; r.parse_json(b'{}')",
    "digest": "import assur.scenes.requests as r; r.request_digest(r.shipped('demo').request)",
    "loading": "from assur.scenes import check, load, plan\nload('demo')",
    "scene": """
import assur.scenes.requests as r
request = dict(r.shipped('demo').request)
request['bodies'] = [dict(b, shape={'box': {'size_mm': [60, 40, 20]}}) for b in request['bodies']]
r.scene_of(request)
""",
    "every module of scenes": """
import importlib, pkgutil
from assur import scenes
native = tuple('assur.scenes.' + name for name in ('identification', 'meshes.', 'resampling', 'view.distances'))
for module in pkgutil.walk_packages(scenes.__path__, 'assur.scenes.'):
    if not module.name.startswith(native): importlib.import_module(module.name)
""",
    "making the application": "from assur.api.web.app import create_app\ncreate_app()",
    "serving": """
from assur.api.workers.jobs import FIRST_PLAN
from tests.api.running import running
with running() as client:
    for address in ("/v1/scenes", "/v1/robots", "/v1/schema", "/openapi.json"):
        assert client.get(address).status_code == 200
    assert client.post("/v1/plans", json=FIRST_PLAN).json()["status"] == "planned"
    assert client.post("/v1/plans", json={"schema": "assur/1"}).status_code == 422
    assert client.post("/v1/plans/check", json={}).status_code == 422
    pose = {"at_mm": [350, 0, 150], "yaw_deg": 0}
    assert client.post("/v1/ik", json={"request": FIRST_PLAN, "pose": pose}).json()["status"] == "reached"
""",
} | {
    f"assur {command}": f"""
from assur.api.command_line import app
try:
    app([{command!r}])
except SystemExit as end:
    assert end.code == 0, end.code
"""
    for command in ("scenes", "robots", "schema", "--help")
}


def loaded_after(program: str) -> set[str]:
    """The modules that are loaded after `program` ran in a new process."""
    report = "\nimport sys\nprint('loaded', *sorted(sys.modules))"
    run = subprocess.run([sys.executable, "-c", program + report], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = run.stdout.splitlines()[-1].split()
    assert loaded[0] == "loaded"
    return set(loaded[1:])


def native_after(program: str) -> set[str]:
    """The native libraries that are loaded after `program` ran in a new process."""
    return {name.partition(".")[0] for name in loaded_after(program)} & NATIVE


@pytest.mark.parametrize("door", DOORS)
def test_no_native_library_is_loaded_by(door: str) -> None:
    assert native_after(DOORS[door]) == set()


def test_a_library_that_is_loaded_is_seen() -> None:
    assert {"scipy", "fcl"} <= native_after("import assur.scenes.meshes.load, assur.scenes.meshes.hull, fcl")


UNUSED = {"trimesh", "networkx", "scipy.optimize", "ruckig", "starlette", "numba.np.arraymath", "numba.np.linalg"}
"""What a check does not need: half a second. The last two come with numba's compiler."""


@pytest.mark.parametrize(
    ("scenario", "needed", "unused"),
    [("demo", {"numba", "scipy.spatial"}, UNUSED), ("five-bar", {"numba"}, UNUSED | {"scipy.spatial", "scipy.linalg"})],
)
def test_a_check_loads_no_more_than_it_needs(scenario: str, needed: set[str], unused: set[str], tmp_path: Path) -> None:
    """`demo` has a mesh, in a binary STL file, and `five-bar` none."""
    run = "from assur.api.command_line import app\ntry: app({!r})\nexcept SystemExit as end: assert not end.code"
    plan_file = str(tmp_path / "plan.json")
    planned = loaded_after(run.format(["plan", scenario, "--out", plan_file]))
    assert "ruckig" in planned
    assert loaded_after(run.format(["check", plan_file])) & (needed | unused) == needed

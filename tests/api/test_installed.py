"""What is installed claims one name: the wheel, and the editable install, beside somebody else's `planner`, `api` and
`scenes`. The demo is planned there, spawned workers too, and no kernel is compiled anew."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

import assur
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner import kernel_cache
from tests.api.processes import serving, until

ROOT = Path(__file__).parents[2]
PACKAGES = ("planner", "scenes", "api", "experiments", "prover")
OTHERS = ("planner", "scenes", "api")
"""Names that other packages have, too."""
THEIRS = "OWNER = 'somebody else'\n"
PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet")
OFFLINE = ("--no-index", "--no-deps")

PROGRAM = """
import json, sys
import assur

heavy = sorted({"numba", "fcl", "pydantic"} & set(sys.modules))
request = assur.load("demo")
request["options"] |= {"stop": "first"}
answer = assur.plan(request)
taken = sorted({"planner", "scenes", "api"} & set(sys.modules))
import planner, scenes, api
from assur.planner import compiled, kernel_cache
print(json.dumps({
    "file": assur.__file__,
    "heavy": heavy,
    "planned": answer.planned,
    "ok": assur.check(request, answer)["ok"],
    "columns": answer.trajectory.sample(0.004).positions.shape[1],
    "taken": taken,
    "owners": [planner.OWNER, scenes.OWNER, api.OWNER],
    "folder": str(kernel_cache.folder()),
    "compiled": compiled.compiled_now(),
}))
"""


def clean() -> dict[str, str]:
    """This process's environment without what leads to the sources of the repository."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def ran(*command: str | Path, folder: Path) -> str:
    result = subprocess.run(command, cwd=folder, env=clean(), capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of what a build reads: it writes beside its sources."""
    copy = tmp_path_factory.mktemp("source")
    for name in (*PACKAGES, "src"):
        shutil.copytree(
            ROOT / name, copy / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
        )
    for name in ("pyproject.toml", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    return copy


@pytest.fixture(scope="module")
def wheel(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("wheel")
    ran(*PIP, "wheel", ".", *OFFLINE, "--no-build-isolation", "--wheel-dir", made, folder=source)
    (found,) = made.glob("*.whl")
    return found


def top_level(names: list[str]) -> set[str]:
    """The names that a wheel claims in the environment where it is installed."""
    return {name.split("/")[0] for name in names if not name.split("/")[0].endswith(".dist-info")}


def test_the_wheel_claims_one_name_and_holds_every_module(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as opened:
        names = opened.namelist()
    assert top_level(names) == {"assur"}
    modules = {
        f"assur/{path.relative_to(ROOT).as_posix()}" for package in PACKAGES for path in (ROOT / package).rglob("*.py")
    }
    modules |= {f"assur/{path.name}" for path in (ROOT / "src" / "assur").glob("*.py")}
    assert {name for name in names if name.endswith(".py")} == modules
    assert {"assur/py.typed", "assur/planner/py.typed", "assur/scenes/cells/demo.yaml"} <= set(names)


def test_a_wheel_that_claims_more_is_seen() -> None:
    assert top_level(["assur/x.py", "planner/y.py", "assur-0.1.0.dist-info/METADATA"]) == {"assur", "planner"}


@pytest.fixture(scope="module", params=["wheel", "editable"])
def python(request: pytest.FixtureRequest, source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of a new environment with other packages of our folders' names, and then with assur. The
    libraries that assur needs are those of this environment."""
    home = tmp_path_factory.mktemp(request.param)
    ran(sys.executable, "-m", "venv", "--without-pip", home, folder=home)
    found = home / "bin" / "python"
    packages = Path(ran(found, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", folder=home).strip())
    for name in OTHERS:
        (packages / name).mkdir()
        (packages / name / "__init__.py").write_text(THEIRS, encoding="utf-8")
    shared = [path for path in sys.path if Path(path).name == "site-packages"]
    what = (request.getfixturevalue("wheel"),) if request.param == "wheel" else ("--no-build-isolation", "-e", source)
    libraries = packages / "libraries.pth"  # of these folders the .pth files are not read: no other assur is found
    libraries.write_text("\n".join(shared) + "\n", encoding="utf-8")
    ran(*PIP, "--python", found, "install", *OFFLINE, "--force-reinstall", *what, folder=home)
    for name in OTHERS:
        assert (packages / name / "__init__.py").read_text(encoding="utf-8") == THEIRS
    return found


@pytest.mark.slow
def test_the_demo_is_planned_beside_packages_of_other_people(python: Path, source: Path, tmp_path: Path) -> None:
    told: dict[str, Any] = json.loads(ran(python, "-W", "error", "-c", PROGRAM, folder=tmp_path))
    assert Path(told["file"]).is_relative_to(python.parents[1]) or Path(told["file"]).is_relative_to(source)
    assert told["heavy"] == []
    assert told["planned"]
    assert told["ok"]
    assert told["columns"] == 4
    assert told["taken"] == []
    assert told["owners"] == ["somebody else"] * 3
    assert told["folder"] == str(kernel_cache.folder())
    if kernel_cache.is_compiled():
        assert told["compiled"] == []


@pytest.mark.slow
def test_spawned_workers_plan_beside_packages_of_other_people(python: Path, tmp_path: Path) -> None:
    for name in OTHERS:  # in the working folder, too
        (tmp_path / f"{name}.py").write_text(THEIRS, encoding="utf-8")
    program = [str(python.parent / "assur")]
    with serving(program=program, folder=tmp_path, others=clean(), WORKERS="1", GRACE_S="30") as server:
        until(server.ready)
        with assur.Client(server.address) as service:
            answer = service.plan(FIRST_PLAN)
            assert answer.planned
            assert service.check(FIRST_PLAN, answer)["ok"]

"""What is installed, from a clone and from a source archive: one name, as a wheel and editable, with spawned processes,
mypy, and other packages called `planner`, `api` and `scenes`. The demo is planned there, and no kernel is compiled
again."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
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
FRONT = "src/assur"
BACKEND = "deploy/packaging"
OTHERS = ("planner", "scenes", "api")
"""Names that other packages have, too."""
THEIRS = "OWNER = 'somebody else'\n"
PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet")
OFFLINE = ("--no-index", "--no-deps")
BUILD_SDIST = "import sys; sys.path.insert(0, sys.argv[1]); import backend; backend.build_sdist(sys.argv[2])"
SPAWNED = f"""
import importlib, json, multiprocessing


def file_of(name):
    return importlib.import_module("assur." + name).__file__


if __name__ == "__main__":
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        print(json.dumps(pool.map(file_of, {PACKAGES})))
"""
TYPED = """
from assur.api.web import settings
from assur.experiments import figures
from assur.planner.errors import InputError
from assur.prover import prove
from assur.planner.no_such_module import NUMBER
from assur.scenes import faults
reveal_type(InputError("field", 1, "2").field)
""".lstrip()
MYPY = """
[mypy]
strict = True
[mypy-assur.api.*,assur.experiments.*,assur.prover.*,assur.request,assur.scenes.*]
follow_imports = skip
[mypy-assur.planner.checked,assur.planner.model.*,assur.planner.pipeline]
follow_imports = skip
"""
"""A module that is skipped has to be there; it is not read, so mypy takes little time."""

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
    """What a fresh clone has of the sources and of what builds them: no link, and nothing that a build has written."""
    copy = tmp_path_factory.mktemp("source")
    generated = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in PACKAGES:
        shutil.copytree(ROOT / name, copy / name, ignore=generated)
    (copy / FRONT).mkdir(parents=True)
    for path in (ROOT / FRONT).iterdir():
        if path.is_file():
            shutil.copy(path, copy / FRONT)
    shutil.copytree(ROOT / BACKEND, copy / BACKEND, ignore=generated)
    for name in ("pyproject.toml", "MANIFEST.in", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    return copy


@pytest.fixture(scope="module")
def sdist(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source archive."""
    made = tmp_path_factory.mktemp("sdist")
    ran(sys.executable, "-c", BUILD_SDIST, source / BACKEND, made, folder=source)
    (found,) = made.glob("*.tar.gz")
    return found


@pytest.fixture(scope="module")
def unpacked(sdist: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The source tree that the archive holds."""
    folder = tmp_path_factory.mktemp("unpacked")
    with tarfile.open(sdist) as opened:
        opened.extractall(folder, filter="data")
    (found,) = folder.iterdir()
    return found


def wheel_of(source: Path, made: Path) -> Path:
    ran(*PIP, "wheel", ".", *OFFLINE, "--no-build-isolation", "--wheel-dir", made, folder=source)
    (found,) = made.glob("*.whl")
    return found


@pytest.fixture(scope="module")
def wheel(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return wheel_of(source, tmp_path_factory.mktemp("wheel"))


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
    modules |= {f"assur/{path.name}" for path in (ROOT / FRONT).glob("*.py")}
    assert {name for name in names if name.endswith(".py")} == modules
    assert {"assur/py.typed", "assur/planner/py.typed", "assur/scenes/cells/demo.yaml"} <= set(names)


def test_a_wheel_that_claims_more_is_seen() -> None:
    assert top_level(["assur/x.py", "planner/y.py", "assur-0.1.0.dist-info/METADATA"]) == {"assur", "planner"}


def test_the_source_archive_has_the_layout_of_the_repository_and_no_link(sdist: Path) -> None:
    with tarfile.open(sdist) as opened:
        members = opened.getmembers()
    assert [member.name for member in members if not (member.isfile() or member.isdir())] == []
    names = {member.name.partition("/")[2] for member in members if member.isfile()}
    modules = {path.relative_to(ROOT).as_posix() for package in PACKAGES for path in (ROOT / package).rglob("*.py")}
    modules |= {f"{FRONT}/{path.name}" for path in (ROOT / FRONT).glob("*.py")}
    modules |= {f"{BACKEND}/{path.name}" for path in (ROOT / BACKEND).glob("*.py")}
    assert {name for name in names if name.endswith(".py")} == modules
    assert {"pyproject.toml", "LICENSE", "scenes/cells/demo.yaml", f"{FRONT}/py.typed"} <= names


def test_clone_and_source_archive_give_one_wheel(wheel: Path, unpacked: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(wheel) as of_clone, zipfile.ZipFile(wheel_of(unpacked, tmp_path)) as of_archive:
        assert {name: of_archive.read(name) for name in of_archive.namelist()} == {
            name: of_clone.read(name) for name in of_clone.namelist()
        }


def environment(home: Path) -> Path:
    """The interpreter of a new environment. The libraries that assur needs are those of this environment."""
    ran(sys.executable, "-m", "venv", "--without-pip", home, folder=home)
    found = home / "bin" / "python"
    libraries = packages_of(found) / "libraries.pth"  # .pth files of these folders are not read: no other assur is seen
    shared = [path for path in sys.path if Path(path).name == "site-packages"]
    libraries.write_text("\n".join(shared) + "\n", encoding="utf-8")
    return found


def packages_of(python: Path) -> Path:
    """The folder where an interpreter's packages are installed."""
    return Path(
        ran(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", folder=python.parent).strip()
    )


def install(python: Path, *what: str | Path) -> None:
    ran(*PIP, "--python", python, "install", *OFFLINE, "--force-reinstall", *what, folder=python.parent)


@pytest.fixture(scope="module")
def editable(unpacked: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of an environment where an unpacked source archive is installed editable."""
    found = environment(tmp_path_factory.mktemp("editable"))
    install(found, "--no-build-isolation", "-e", unpacked)
    return found


def test_an_editable_install_makes_the_links_and_spawned_processes_import_through_them(
    editable: Path, unpacked: Path, tmp_path: Path
) -> None:
    program = tmp_path / "program.py"
    program.write_text(SPAWNED, encoding="utf-8")
    assert json.loads(ran(editable, program, folder=tmp_path)) == [
        str(unpacked / FRONT / name / "__init__.py") for name in PACKAGES
    ]
    assert {path.name for path in (unpacked / FRONT).iterdir() if path.is_symlink()} == set(PACKAGES)


def test_a_new_module_is_there_without_another_install(editable: Path, unpacked: Path, tmp_path: Path) -> None:
    (unpacked / "planner" / "added_later.py").write_text("NUMBER = 7\n", encoding="utf-8")
    program = "from assur.planner.added_later import NUMBER; print(NUMBER)"
    assert ran(editable, "-c", program, folder=tmp_path) == "7\n"


def test_mypy_finds_the_editable_install(editable: Path, tmp_path: Path) -> None:
    (tmp_path / "mypy.ini").write_text(MYPY, encoding="utf-8")
    (tmp_path / "program.py").write_text(TYPED, encoding="utf-8")
    command = (sys.executable, "-m", "mypy", "--python-executable", editable, "--cache-dir", tmp_path / "cache")
    result = subprocess.run(
        [*command, "program.py"], cwd=tmp_path, env=clean(), capture_output=True, text=True, check=False
    )
    missing = 'module named "assur.planner.no_such_module"  [import-not-found]'
    assert re.findall(r"program.py:(\d+): (.*)", result.stdout) == [
        ("5", f"error: Cannot find implementation or library stub for {missing}"),
        ("5", "note: See https://mypy.readthedocs.io/en/stable/running_mypy.html#missing-imports"),
        ("7", 'note: Revealed type is "str"'),
    ], result.stderr


@pytest.fixture(scope="module", params=["wheel", "editable"])
def python(request: pytest.FixtureRequest, source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of a new environment with other packages of our folders' names, and then with assur."""
    found = environment(tmp_path_factory.mktemp(request.param))
    packages = packages_of(found)
    for name in OTHERS:
        (packages / name).mkdir()
        (packages / name / "__init__.py").write_text(THEIRS, encoding="utf-8")
    if request.param == "wheel":
        install(found, request.getfixturevalue("wheel"))
    else:
        install(found, "--no-build-isolation", "-e", source)
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

"""The list of what is installed is CycloneDX, is complete, and names no place."""

from __future__ import annotations

import copy
import json
import shutil
import subprocess
import sys
import sysconfig
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
from packaging.utils import canonicalize_name

from deploy import locks, sbom

LIBRARIES = ("numpy", "numba", "python-fcl", "uvicorn")


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of an environment that has, as far as metadata tell, some libraries of this one, and assur
    installed from a folder."""
    folder = tmp_path_factory.mktemp("small")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    installed = Path(sysconfig.get_path("purelib"))
    for name in (*LIBRARIES, "assur"):
        # by its folder: metadata.distribution("assur") may find an egg-info beside the sources first
        (about,) = installed.glob(f"{name.replace('-', '_')}-*.dist-info")
        shutil.copytree(about, packages / about.name)
    (own,) = packages.glob("assur*.dist-info")
    origin = {"url": "file:///srv/assur", "dir_info": {"editable": True}}
    (own / "direct_url.json").write_text(json.dumps(origin), encoding="utf-8")
    return folder / "bin" / "python"


@pytest.fixture(scope="module")
def document(small: Path) -> dict[str, Any]:
    return sbom.listed(small, locks.PYPROJECT)


@pytest.mark.slow
def test_every_installed_library_is_listed_with_its_version(document: dict[str, Any]) -> None:
    listed: dict[str, str] = {canonicalize_name(each["name"]): each["version"] for each in document["components"]}
    assert listed == {name: metadata.version(name) for name in LIBRARIES}
    assert document["metadata"]["component"]["name"] == "assur"
    assert document["specVersion"] == sbom.VERSION


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda it: it.update(components=[]), "empty"),
        (lambda it: it["components"][0].pop("name"), "not CycloneDX"),
        (lambda it: it["components"][0].update(colour="red"), "not CycloneDX"),
        (lambda it: it["components"][0].update(copyright="see /opt" + "/somewhere"), "names a place: /opt/"),
        (lambda it: it["components"][0].update(publisher="https://host.example/simple"), "names a place: ://"),
    ],
)
def test_a_list_that_is_wrong_or_names_a_place_is_refused(document: dict[str, Any], change: Any, words: str) -> None:
    other = copy.deepcopy(document)
    change(other)
    with pytest.raises(ValueError, match=words):
        sbom.check(other)


def test_addresses_are_taken_out_at_any_depth() -> None:
    part = {"tools": [{"name": "x", "externalReferences": [{"url": "https://host.example"}]}], "description": "d"}
    assert sbom.without_addresses(part) == {"tools": [{"name": "x"}]}

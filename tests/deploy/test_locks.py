"""The lock files have all that pyproject.toml asks for, with hashes, and no place of any machine."""

from __future__ import annotations

import subprocess
import sys
from importlib import metadata

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from deploy import check, locks

RUNTIME, BUILD = (locks.read(path.read_text(encoding="utf-8")) for path in (locks.RUNTIME, locks.BUILD))
HASH = "--hash=sha256:" + "0" * 64


def test_every_floor_is_met_and_nothing_is_missing() -> None:
    assert check.of_locks() == []


def test_no_lock_names_an_index_or_a_path() -> None:
    for path in (locks.RUNTIME, locks.BUILD):
        text = path.read_text(encoding="utf-8")
        assert [word for word in ("://", "--index", "--find-links", "--trusted", "file:", " /") if word in text] == []


@pytest.mark.parametrize(
    "line",
    [
        f"numpy>=2.1 {HASH}",
        f"numpy==2.* {HASH}",
        "numpy==2.4.6",
        "numpy==2.4.6 --hash=md5:0123456789abcdef0123456789abcdef",
        f"numpy @ https://host.example/numpy.whl {HASH}",
        "--extra-index-url https://host.example/simple",
        "-r other.lock",
    ],
)
def test_what_has_no_place_in_a_lock_is_refused(line: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        locks.read(f"rich==15.0.0 \\\n    {HASH}\n{line}\n")


def test_what_the_lock_does_not_meet_is_found() -> None:
    pins = locks.read(
        f"numpy==2.0.0 ; python_full_version < '3.12' \\\n    {HASH}\n"
        f"numpy==2.4.6 ; python_full_version >= '3.12' \\\n    {HASH}\n"
        f"rich==15.0.0 {HASH}\nrich==15.0.1 {HASH}\n"
    )
    assert locks.unmet(["numpy>=2.1"], pins) == [
        f"numpy: 2.0.0 is locked for Python 3.11 on {machine}, and >=2.1 is required"
        for machine in ("aarch64", "x86_64")
    ]
    assert locks.unmet(["scipy>=1.14; python_version < '3.12'"], pins) == [
        f"scipy: not locked for Python 3.11 on {machine}" for machine in ("aarch64", "x86_64")
    ]
    assert len(locks.unmet(["rich>=13"], pins)) == len(locks.ENVIRONMENTS)
    assert locks.unmet(["numpy>=2.0"], pins) == []


def declared() -> dict[str, list[Requirement]]:
    """What the locked releases ask for themselves, of those that are installed here in the locked version."""
    found = {}
    for pin in RUNTIME:
        try:
            there = metadata.version(pin.name)
        except metadata.PackageNotFoundError:
            continue
        if there == pin.version:
            found[pin.name] = [Requirement(each) for each in metadata.requires(pin.name) or []]
    return found


def test_what_the_locked_releases_ask_for_is_locked_too_or_left_out_for_a_reason() -> None:
    asked = [
        str(each)
        for requirements in declared().values()
        for each in requirements
        if canonicalize_name(each.name) not in locks.LEFT_OUT
    ]
    assert locks.unmet(asked, RUNTIME) == []


def test_what_is_left_out_is_not_locked_and_not_needed() -> None:
    assert {pin.name for pin in RUNTIME} & set(locks.LEFT_OUT) == set()
    without = (
        "import sys; sys.modules['Cython'] = None; import fcl; fcl.CollisionObject(fcl.Sphere(1.0)); print('fine')"
    )
    ran = subprocess.run([sys.executable, "-c", without], capture_output=True, text=True, check=True)
    assert ran.stdout == "fine\n"


def test_what_builds_is_locked_and_stays_out_of_what_runs() -> None:
    assert {"setuptools", "cyclonedx-bom"} <= {pin.name for pin in BUILD}
    assert {"setuptools", "pip", "wheel", "cyclonedx-bom"} & {pin.name for pin in RUNTIME} == set()

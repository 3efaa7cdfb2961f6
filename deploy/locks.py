"""The lock files: the releases that are installed into the image, each file with its hashes.

`deploy/requirements.lock` is what the service needs to run, for every Python and platform that we name;
`deploy/requirements-build.lock` is what builds the image and stays out of it. `make lock` writes both with uv.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

HERE = Path(__file__).parent
PYPROJECT = HERE.parent / "pyproject.toml"
RUNTIME = HERE / "requirements.lock"
BUILD = HERE / "requirements-build.lock"
BUILD_TOOLS = ("cyclonedx-bom",)
"""Needed while the image is built, beside what `[build-system]` of pyproject.toml requires."""

PYTHONS = ("3.11", "3.12", "3.13")
MACHINES = ("x86_64", "aarch64")
ENVIRONMENTS = [
    {
        "python_version": python,
        "python_full_version": python + ".0",
        "implementation_name": "cpython",
        "platform_python_implementation": "CPython",
        "os_name": "posix",
        "sys_platform": "linux",
        "platform_system": "Linux",
        "platform_machine": machine,
        "extra": "",
    }
    for python in PYTHONS
    for machine in MACHINES
]
"""Where the lock must hold, as environment markers have it."""

LEFT_OUT = {"cython": "python-fcl declares it, and needs it only to be compiled; its wheel is compiled already"}
"""Requirements of libraries that the image does not have, with the reason."""

HASH = re.compile(r"--hash=(\w+):([0-9a-f]+)")


@dataclass(frozen=True, slots=True)
class Pin:
    """A locked release: the requirement ``name==version ; marker``, and the SHA-256 of each of its files."""

    requirement: Requirement
    hashes: tuple[str, ...]

    @property
    def name(self) -> str:
        return canonicalize_name(self.requirement.name)

    @property
    def version(self) -> str:
        (only,) = self.requirement.specifier
        return only.version

    def holds_in(self, environment: dict[str, str]) -> bool:
        marker = self.requirement.marker
        return marker is None or marker.evaluate(environment)


def read(lock: str) -> list[Pin]:
    """The pins of a lock file's text.

    Raises `ValueError` for a line that is not ``name==version`` with at least one SHA-256, and for every option: an
    index, a path or an address has no place in a lock.
    """
    plain = "\n".join(line for line in lock.splitlines() if not line.lstrip().startswith("#"))
    pins = []
    for line in plain.replace("\\\n", " ").splitlines():
        if not line.strip():
            continue
        hashes = HASH.findall(line)
        text = HASH.sub("", line).strip()
        requirement = Requirement(text)  # refuses options, for they are no requirements
        exact = [clause.operator for clause in requirement.specifier] == ["=="]
        if requirement.url or not exact or "*" in str(requirement.specifier):
            raise ValueError(f"{text}: a lock has name==version")
        if not hashes or any(kind != "sha256" or len(value) != 64 for kind, value in hashes):
            raise ValueError(f"{text}: a lock has the SHA-256 of each file")
        pins.append(Pin(requirement, tuple(value for _, value in hashes)))
    return pins


def unmet(requirements: Iterable[str], pins: Sequence[Pin]) -> list[str]:
    """The requirements that the pins do not meet, in any environment of `ENVIRONMENTS`."""
    found = set()
    for text in requirements:
        requirement = Requirement(text)
        name = canonicalize_name(requirement.name)
        for environment in ENVIRONMENTS:
            if requirement.marker is not None and not requirement.marker.evaluate(environment):
                continue
            here = [pin for pin in pins if pin.name == name and pin.holds_in(environment)]
            where = f"Python {environment['python_version']} on {environment['platform_machine']}"
            if not here:
                found.add(f"{name}: not locked for {where}")
            elif len(here) > 1:
                found.add(f"{name}: locked twice for {where}")
            elif not requirement.specifier.contains(here[0].version, prereleases=True):
                found.add(f"{name}: {here[0].version} is locked for {where}, and {requirement.specifier} is required")
    return sorted(found)


def of_project() -> tuple[list[str], list[str]]:
    """The requirements of pyproject.toml: to run, and to build the image."""
    project = tomllib.loads(PYPROJECT.read_text(encoding="utf-8"))
    return project["project"]["dependencies"], [*project["build-system"]["requires"], *BUILD_TOOLS]


if __name__ == "__main__":
    print("\n".join(of_project()[1]))  # make lock gives this to uv

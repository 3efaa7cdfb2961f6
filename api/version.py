"""Which version of assur this is."""

from __future__ import annotations

import platform
from functools import cache
from importlib import metadata

from typing_extensions import TypedDict

from assur.planner.kernel_cache import digest
from assur.scenes.schema.request import SCHEMA

LIBRARIES = (
    "fastapi", "numba", "numpy", "pydantic", "python-fcl", "ruckig", "scipy", "starlette", "trimesh", "uvicorn",
)  # fmt: skip
"""Whose versions an answer may depend on, or how it is served."""


def version() -> str:
    """The version of the installed package; "0" in a source tree that was never installed."""
    try:
        return metadata.version("assur")
    except metadata.PackageNotFoundError:
        return "0"


class VersionDocument(TypedDict):
    """Which build this is. `schema`: of requests and answers; `kernels`: the digest of the inner loops' sources;
    `commit`: what `ASSUR_COMMIT` says, null where it says nothing."""

    version: str
    schema: str
    kernels: str
    commit: str | None
    python: str
    libraries: dict[str, str]


@cache
def version_document(commit: str) -> VersionDocument:
    """Which build this is. Two services with the same build give the same answers."""
    libraries = {name: metadata.version(name) for name in LIBRARIES}
    return {
        "version": version(),
        "schema": SCHEMA,
        "kernels": digest(),
        "commit": commit or None,
        "python": platform.python_version(),
        "libraries": libraries,
    }

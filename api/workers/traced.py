"""A job that says, in each line that its worker logs, which request it is of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from assur.api import logs
from assur.api.workers import jobs
from assur.scenes.meshes.folder import MeshFolder


@dataclass(frozen=True)  # with slots, Python code would pickle it
class Traced:
    """A job, and the request that it is of. It is pickled and called in a worker."""

    job: Callable[..., Any]
    request: Mapping[str, str]

    def __call__(self, *arguments: Any) -> Any:
        token = logs.ABOUT.set(self.request)
        try:
            return self.job(*arguments)
        finally:
            logs.ABOUT.reset(token)


def warm(level: str, meshes: MeshFolder | None = None) -> str:
    """What a new worker does first: its log is led to standard error from `level` on, and it plans once. `meshes`: the
    folder for meshes."""
    logs.configure_worker(level)
    return jobs.warm(meshes)

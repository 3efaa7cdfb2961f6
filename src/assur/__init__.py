"""Motion planning for SCARA-type robots when targets and obstacles move.

``answer = assur.plan(assur.load("demo"))``: requests are plain documents, or are built of `assur.request`; the answer
is a mapping with attributes. `assur.Client` and `assur.AsyncClient` ask a service for the same.

Each name is imported on its first use, so ``import assur`` loads neither numba, nor fcl, nor pydantic.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from assur import request as request
    from assur.api.python.answer import Answer, NotPlannedError
    from assur.api.python.calls import bundle, check, ik, load, plan, robots, scenarios
    from assur.api.python.cell import Cell
    from assur.api.python.client import AsyncClient, Client
    from assur.api.python.exchange import Health
    from assur.api.python.motion import Samples, Trajectory
    from assur.api.python.saved import load_answer
    from assur.api.python.service_errors import ProblemError, RemoteInputError, ServiceError
    from assur.api.python.session import CommittedPlan, Proposal, Session, replay
    from assur.api.python.simulation import simulate
    from assur.planner.errors import AssurError, InputError

    __version__: str

__all__ = [
    "Answer",
    "AssurError",
    "AsyncClient",
    "Cell",
    "Client",
    "CommittedPlan",
    "Health",
    "InputError",
    "NotPlannedError",
    "ProblemError",
    "Proposal",
    "RemoteInputError",
    "Samples",
    "ServiceError",
    "Session",
    "Trajectory",
    "bundle",
    "check",
    "ik",
    "load",
    "load_answer",
    "plan",
    "replay",
    "request",
    "robots",
    "scenarios",
    "simulate",
]

_CALLS = "assur.api.python.calls"
_HOME = {
    **dict.fromkeys(("bundle", "check", "ik", "load", "plan", "robots", "scenarios"), _CALLS),
    "Cell": "assur.api.python.cell",
    "load_answer": "assur.api.python.saved",
    **dict.fromkeys(("Answer", "NotPlannedError"), "assur.api.python.answer"),
    **dict.fromkeys(("Samples", "Trajectory"), "assur.api.python.motion"),
    **dict.fromkeys(("AsyncClient", "Client"), "assur.api.python.client"),
    **dict.fromkeys(("CommittedPlan", "Proposal", "Session", "replay"), "assur.api.python.session"),
    "simulate": "assur.api.python.simulation",
    "Health": "assur.api.python.exchange",
    **dict.fromkeys(("ProblemError", "RemoteInputError", "ServiceError"), "assur.api.python.service_errors"),
    **dict.fromkeys(("AssurError", "InputError"), "assur.planner.errors"),
}
"""Name → the module that it is in."""

if not TYPE_CHECKING:  # a type checker would take any name for one that is there

    def __getattr__(name):
        """One of `__all__`, or a package of ours, imported now. Raises `AttributeError` for any other name."""
        from importlib import import_module

        if name in _HOME:
            found = getattr(import_module(_HOME[name]), name)
        elif name in ("request", "planner", "scenes", "api"):
            return import_module(f"assur.{name}")
        elif name == "__version__":
            from assur.api.version import version

            found = version()
        else:
            raise AttributeError(f"module 'assur' has no attribute {name!r}")
        globals()[name] = found  # the next use finds it at once
        return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

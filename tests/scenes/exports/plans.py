"""Plans of shipped scenarios, each made once, for the tests of exports."""

from __future__ import annotations

from functools import cache
from typing import Any

from assur.scenes import load, plan


@cache
def request_of(name: str) -> dict[str, Any]:
    """The request of a shipped scenario."""
    return load(name)


@cache
def planned(name: str) -> dict[str, Any]:
    """The answer to it, which is a plan."""
    answer = plan(request_of(name))
    assert answer["status"] == "planned"
    return answer

"""Reading a file of problems (`benchmarks/problems/README.md` says what they mean)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Problem = dict[str, Any]
"""One problem as it is in the file."""

LIMITS = ("qmin", "qmax", "vmax", "amax", "jmax")
"""Names of the joint limits in a file, each a list of four numbers: shoulder, elbow, height, wrist."""


@dataclass(frozen=True)
class ProblemSet:
    """A family of problems for one robot: joint `limits` by their names in the file, and the `problems`."""

    family: str
    limits: Mapping[str, tuple[float, ...]]
    problems: tuple[Problem, ...]


def read_problem_set(path: Path) -> ProblemSet:
    """The problem set in a file; `ValueError` or `KeyError` if it is of another form, or an id is there twice."""
    document = json.loads(path.read_bytes())
    problems = document["problems"]
    if len({problem["id"] for problem in problems}) != len(problems):
        raise ValueError(f"{path.name}: every problem needs an id of its own")
    limits = {name: tuple(float(value) for value in document[name]) for name in LIMITS}
    return ProblemSet(str(document.get("family", "")), limits, tuple(problems))

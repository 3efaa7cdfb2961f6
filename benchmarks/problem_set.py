"""Reading a file of problems (`benchmarks/problems/README.md` says what they mean)."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Problem = dict[str, Any]
"""One problem as it stands in the file."""

LIMITS = ("qmin", "qmax", "vmax", "amax", "jmax")
"""Names of the joint limits in a file, each a list of four numbers: shoulder, elbow, height, wrist."""

JOINTS = 4
"""q = [q1, q2, z, q4]."""


class ProblemSetError(Exception):
    """A file is not of the form of the problem sets."""


@dataclass(frozen=True)
class ProblemSet:
    """A family of problems for one robot: joint `limits` by their names in the file, and the `problems`."""

    family: str
    limits: Mapping[str, tuple[float, ...]]
    problems: tuple[Problem, ...]


def read_problem_set(path: Path) -> ProblemSet:
    """The problem set in a file; `ProblemSetError` if limits, problems or their ids are missing or twice there."""
    try:
        document = json.loads(path.read_bytes())
    except ValueError as error:
        raise ProblemSetError(f"{path.name}: not JSON ({error})") from error
    if not isinstance(document, dict):
        raise ProblemSetError(f"{path.name}: an object with limits and problems is wanted")
    limits = {name: _four(path, name, document.get(name)) for name in LIMITS}
    problems = document.get("problems")
    if not isinstance(problems, list) or not problems:
        raise ProblemSetError(f"{path.name}: 'problems' must be a list that is not empty")
    names = [problem.get("id") for problem in problems if isinstance(problem, dict)]
    if len(names) != len(problems) or len(set(names)) != len(names) or None in names:
        raise ProblemSetError(f"{path.name}: every problem needs an id of its own")
    return ProblemSet(str(document.get("family", "")), limits, tuple(problems))


def _four(path: Path, name: str, values: object) -> tuple[float, ...]:
    if (
        isinstance(values, list)
        and len(values) == JOINTS
        and all(isinstance(value, int | float) and math.isfinite(value) for value in values)
    ):
        return tuple(float(value) for value in values)
    raise ProblemSetError(f"{path.name}: {name!r} must hold {JOINTS} finite numbers")

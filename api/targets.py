"""What the command line was pointed at: a scenario file, a bare request, a shipped scenario, a plan."""

from __future__ import annotations

import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from planner.errors import InputError
from scenes.bounds import MAX_JSON_BYTES
from scenes.requests import load_scenario, parse_json, shipped, shipped_scenarios


@dataclass(frozen=True)
class Target:
    """A request to plan: its `name` for people, the document, the folder below which it may name files, and what
    its scenario expects (empty: nothing said)."""

    name: str
    request: Any
    folder: Path | None = None
    expect: dict[str, Any] = field(default_factory=dict)


def target(text: str) -> Target:
    """What `text` names: a file (a scenario in YAML, or a request in JSON), else a shipped scenario.

    Raises `InputError`, or `OSError` for a file that cannot be read.
    """
    path = Path(text)
    if not path.is_file():
        if text in shipped_scenarios():
            scenario = shipped(text)
            return Target(scenario.name, scenario.request, scenario.folder, scenario.expect)
        if not path.exists():
            allowed = "an existing file, or a shipped scenario: " + ", ".join(shipped_scenarios())
            raise InputError("FILE", text, allowed)
    if path.suffix.lower() == ".json":
        return Target(path.stem, json_file(path, "FILE"), path.parent)
    _require_file(path, "FILE")
    scenario = load_scenario(path)
    return Target(scenario.name, scenario.request, scenario.folder, scenario.expect)


def json_file(path: Path, name: str) -> Any:
    """The document in the JSON file that was given as `name`. Raises `InputError` or `OSError`."""
    size = _require_file(path, name)
    if size > MAX_JSON_BYTES:
        raise InputError(name, f"{size} bytes", f"at most {MAX_JSON_BYTES} bytes")
    return parse_json(path.read_bytes())


def _require_file(path: Path, name: str) -> int:
    """The length of a regular file: no folder, no device, no pipe. Raises `InputError` or `OSError`."""
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise InputError(name, path.name, "a regular file")
    return status.st_size

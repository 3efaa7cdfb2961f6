"""What the command line was pointed at: a scenario file, a bare request, a shipped scenario, a plan."""

from __future__ import annotations

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
    if not _is_file(path):
        if text not in shipped_scenarios():
            raise InputError("FILE", text, "a file, or a shipped scenario: " + ", ".join(shipped_scenarios()))
        scenario = shipped(text)
        return Target(scenario.name, scenario.request, scenario.folder, scenario.expect)
    if path.suffix.lower() == ".json":
        return Target(path.stem, json_file(path, "FILE"), path.parent)
    scenario = load_scenario(path)
    return Target(scenario.name, scenario.request, scenario.folder, scenario.expect)


def json_file(path: Path, name: str) -> Any:
    """The document in the JSON file that was given as `name`. Raises `InputError` or `OSError`."""
    if not _is_file(path):
        raise InputError(name, str(path), "a file")
    size = path.stat().st_size
    if size > MAX_JSON_BYTES:
        raise InputError(name, f"{size} bytes", f"at most {MAX_JSON_BYTES} bytes")
    return parse_json(path.read_bytes())


def _is_file(path: Path) -> bool:
    """Whether there is a regular file: no folder, no device, no pipe, and not a name that no file can have."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long; a null character in it
        return False

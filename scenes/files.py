"""Puts the content of files in place of their names in a scenario or a robot's file, so that a request is complete."""

from __future__ import annotations

import base64
import os
from collections.abc import Collection
from pathlib import Path
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_DEPTH, MAX_JSON_BYTES, MAX_MESH_BYTES, MAX_PLAN_FILE_BYTES
from assur.scenes.faults import NOTHING, WHOLE, DocumentError, dotted
from assur.scenes.not_requests import refuse_but
from assur.scenes.plan_file import LONGEST_BEGINNING, begins_a_plan_file, is_plan_file, plan_file_in
from assur.scenes.schema.answer import Trajectory
from assur.scenes.schema.read import read_normal
from assur.scenes.text.json_text import parse_json

FORMATS = {".stl": "stl", ".obj": "obj", ".ply": "ply", ".glb": "glb"}
"""Endings of the mesh files that a document may name."""


def empty(path: Path, allowed: str) -> DocumentError:
    """The error for a file that says nothing: it has no bytes, or blanks and comments alone."""
    return DocumentError(path.name, "an empty file", allowed)


def is_file(path: Path) -> bool:
    """Whether there is a regular file: no folder, no device, no pipe, and not a name that no file can have."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long; a null character in it
        return False


def is_json(path: Path) -> bool:
    """Whether a file is read as JSON: by its ending, or, a plan file that was written under another name, by how it
    begins. Raises `OSError`."""
    if path.suffix.lower() == ".json":
        return True
    with path.open("rb") as file:
        return begins_a_plan_file(file.read(LONGEST_BEGINNING))


def json_in(path: Path, allowed: str) -> Any:
    """The value that the JSON in a file spells. Raises `DocumentError` with the name of the file, what is wrong
    with its text, and what is `allowed`; of a field as `parse_json` does; or `OSError`."""
    with path.open("rb") as file:
        return json_of(file.read(MAX_PLAN_FILE_BYTES + 1), path.name, allowed)


def json_of(data: bytes, name: str, allowed: str) -> Any:
    """The value that the content of a file called `name` spells, up to `MAX_PLAN_FILE_BYTES` of it and one more: of a
    document that is no plan file, `MAX_JSON_BYTES`. Raises `DocumentError`, as `json_in` does."""
    if not data.strip():
        raise empty(Path(name), allowed)
    if len(data) > MAX_PLAN_FILE_BYTES:
        raise InputError(WHOLE, f"more than {MAX_PLAN_FILE_BYTES} bytes", f"at most {MAX_PLAN_FILE_BYTES} bytes")
    try:
        document = parse_json(data, limit_bytes=MAX_PLAN_FILE_BYTES)
    except InputError as error:
        if error.field != WHOLE:
            raise  # it names the field in the file
        if not data.lstrip().startswith((b"{", b"[")):  # else it is JSON that is broken: its place is named
            refuse_but("", data, Path(name), allowed)
        raise DocumentError(name, error.value, f"{allowed}; {error.allowed.removeprefix('JSON: ')}") from None
    if len(data) > MAX_JSON_BYTES and not is_plan_file(document):
        raise InputError(WHOLE, f"{len(data)} bytes", f"at most {MAX_JSON_BYTES} bytes, for it is no plan file")
    return document


def below(folder: Path, name: str, field: str, endings: Collection[str], most_bytes: int) -> Path:
    """The file that `name` leads to from `folder`. Raises `DocumentError` at `field` unless it is a regular file of up
    to `most_bytes` below `folder`, with one of `endings`."""
    folder = folder.resolve()
    allowed = f"a file below the folder of the file that names it, ending in {', '.join(endings)}"
    if "\0" not in name and Path(name).is_absolute():
        relative = f"; its path is relative to that folder, as in {Path(name).name}, and an absolute one is refused"
        raise DocumentError(field, name, allowed + relative)
    if "\0" in name or Path(name).suffix.lower() not in endings:
        raise DocumentError(field, name, allowed)
    found = Path(os.path.normpath(folder / name))
    if not found.is_relative_to(folder):
        raise DocumentError(field, name, f"{allowed}; a path that leads out of that folder is refused")
    # Links are refused, not followed: what a name leads to must be seen from the name.
    if not os.path.lexists(found):
        raise DocumentError(field, name, f"{allowed}; this one does not exist")
    if found.resolve() != found or not found.is_file():
        raise DocumentError(field, name, f"{allowed}, and no link")
    if found.stat().st_size > most_bytes:
        raise DocumentError(field, name, f"a file of up to {most_bytes} bytes")
    return found


def with_meshes(document: Any, folder: Path) -> Any:
    """The document with the bytes of every mesh file that it names, which must lie below `folder`, in their place."""
    return _inlined(document, (), folder)


def _inlined(value: Any, path: tuple[str | int, ...], folder: Path) -> Any:
    if len(path) > MAX_DEPTH:
        return value  # the reader of the document refuses it
    if isinstance(value, dict):
        if path and path[-1] == "mesh" and isinstance(value.get("file"), str):
            return _inlined_mesh(value, path, folder)
        return {key: _inlined(item, (*path, str(key)), folder) for key, item in value.items()}
    if isinstance(value, list):
        return [_inlined(item, (*path, i), folder) for i, item in enumerate(value)]
    return value


def _inlined_mesh(mesh: dict[str, Any], path: tuple[str | int, ...], folder: Path) -> dict[str, Any]:
    found = below(folder, mesh["file"], dotted((*path, "file")), FORMATS, MAX_MESH_BYTES)
    inlined = {key: value for key, value in mesh.items() if key != "file"}
    inlined.setdefault("format", FORMATS[found.suffix.lower()])
    return {**inlined, "data": base64.b64encode(found.read_bytes()).decode("ascii")}


def with_plans(document: Any, folder: Path) -> Any:
    """The request with the trajectory of every answer's file that a neighbour names, which must lie below `folder`, in
    its place. Raises `DocumentError` at the file's name for whatever is wrong in it."""
    others = document.get("neighbours") if isinstance(document, dict) else None
    if not isinstance(others, list):
        return document
    return {**document, "neighbours": [_with_plan(other, i, folder) for i, other in enumerate(others)]}


def _with_plan(other: Any, i: int, folder: Path) -> Any:
    plan = other.get("plan") if isinstance(other, dict) and "trajectory" not in other else None
    if not isinstance(plan, dict) or plan.keys() != {"file"} or not isinstance(plan["file"], str):
        return other  # nothing to put in, or a document that its model refuses
    field = dotted(("neighbours", i, "plan", "file"))
    found = below(folder, plan["file"], field, (".json",), MAX_PLAN_FILE_BYTES)
    try:
        answer = json_in(found, "JSON")
        answer = plan_file_in(answer).plan if is_plan_file(answer) else answer
        status = answer.get("status") if isinstance(answer, dict) else NOTHING
        if status != "planned":
            raise InputError("status", status, "planned")
        trajectory = answer.get("trajectory", NOTHING)
        read_normal(Trajectory, trajectory, trajectory, ("trajectory",))
    except InputError as error:
        allowed = f"a file with a planned answer, as assur plan --out writes it; in this one {error}"
        raise DocumentError(field, plan["file"], allowed) from error
    return {**{key: value for key, value in other.items() if key != "plan"}, "trajectory": trajectory}

"""Documents in, facts out, and back: requests, scenario files, robot catalogue, meshes, answers.

`scenes` imports `planner`; `planner` never imports `scenes`. Units, the makers' joint conventions and every limit of
size are handled here. Importing anything of this package loads neither fcl, nor ruckig, nor trimesh, nor scipy: they
are loaded when a scene is planned or a mesh is read.

The shortest entry points, `load`, `plan`, `check` and `ik`, work on plain documents; the others are in
`assur.scenes.requests`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

__all__ = ["check", "ik", "load", "plan"]


def load(name: str | Path) -> dict[str, Any]:
    """The request in a scenario file (YAML), a request file (``.json``) or a plan file (as ``assur plan --out`` writes
    it), or in the shipped scenario of that name; of a cell file the cell, which `assur.Cell` takes.

    A plain document of its own each time: change it, plan it, post it. What the files hold that a scenario names (of
    robots, plans and meshes), which must lie below its folder, is in it already. As on the command line, a file that is
    there comes before a scenario's name. Raises `InputError` naming the field (in YAML with its line), or
    where neither a file nor a scenario has the name; `OSError` for a file that cannot be read.
    """
    from assur.planner.errors import InputError
    from assur.scenes.faults import choices
    from assur.scenes.files import is_file, is_json, json_in
    from assur.scenes.plan_file import is_plan_file, plan_file_in
    from assur.scenes.requests import shipped, shipped_scenarios
    from assur.scenes.scenario import with_files
    from assur.scenes.scenarios import load_yaml

    path = Path(name)
    is_there = is_file(path)
    if not is_there and str(name) not in shipped_scenarios():
        names = choices(shipped_scenarios(), path.stem)
        raise InputError("name", str(name), f"a file that is there, or a shipped scenario, one of {names}")
    if is_there and is_json(path):
        given = json_in(path, "a request or a plan file, as JSON")
        document: dict[str, Any] = (
            plan_file_in(given).request if is_plan_file(given) else with_files(given, path.parent)
        )
        return document
    scenario = load_yaml(path) if is_there else shipped(str(name))
    if isinstance(scenario, dict):
        return scenario
    with scenario.located():
        request: dict[str, Any] = with_files(scenario.request, scenario.folder)
    return request


def plan(request: object, *, certificate: Literal["full", "digest"] = "full") -> dict[str, Any]:
    """The answer to a request: ``status`` is ``planned``, or ``not_planned`` and then it says why.

    `certificate`: the whole table of the proof, which `check` needs, or its digest and size.
    Raises `InputError` naming the field that is not right.
    """
    from assur.scenes.requests import plan_document

    return plan_document(request, certificate=certificate)


def check(request: object, answer: object) -> dict[str, Any]:
    """What the checker, which trusts no planner, says of an answer: ``{"ok": ..., "findings": [...]}``.

    Of a refusal it says whether what is called proved is proved. Raises `InputError` for a plan whose certificate is
    not in full.
    """
    from assur.scenes.requests import check_document

    return check_document(request, answer)


def ik(request: object | None = None, **question: object) -> dict[str, Any]:
    """All joint positions of a request's robot at ``pose={"at_mm": ..., "yaw_deg": ..., "frame": ...}``, with their
    margins; or the pose of its tool at ``joints={"j1_deg": ..., ...}``. At the time ``at_s``, or that of the start.

    Without a request ``robot={"model": ..., "tool": ...}`` says which robot.
    Raises `InputError` naming the field that is not right.
    """
    from assur.scenes.requests import ik_document

    return ik_document(request, question)

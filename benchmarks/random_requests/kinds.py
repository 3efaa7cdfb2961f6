"""All kinds of random cells, in SI: those that are run with shifts, and those that are only judged as planned."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np

from benchmarks.judge.poses import Document
from benchmarks.judge.solids import solid_of
from benchmarks.random_requests import random_cells
from benchmarks.random_requests.drafts import (
    ELBOW,
    FIVE_AXES,
    FIVE_BAR,
    POLAR,
    SCARAS,
    THREE_AXES,
    TILTING,
    Draft,
    finished,
)
from benchmarks.random_requests.points import blended, through_points, traced


def random_cell(kind: str, seed: int) -> Document:
    """The request of a kind (one of `KINDS`) and a seed: the same on every machine."""
    if kind in random_cells.KINDS:
        return random_cells.random_cell(kind, seed)
    rng = np.random.default_rng([seed, 1000 + list(OWN).index(kind)])
    return finished(OWN[kind](rng).request)


def _changed(kind: str, change: Callable[[Draft], None]) -> Callable[[np.random.Generator], Draft]:
    """A cell that is run with shifts, with a further requirement."""

    def make(rng: np.random.Generator) -> Draft:
        draft = random_cells.KINDS[kind](rng)
        change(draft)
        return draft

    return make


def _arches(draft: Draft) -> None:
    top = float(draft.base.p[2]) + draft.low + draft.between(0.5, 0.9) * draft.stroke
    for step in draft.request["task"]:
        ((_, given),) = step.items()
        if draft.chance(0.7):
            given["arch"] = {"top_m": top}


def _loads(draft: Draft) -> None:
    """Masses, a table of what they leave, and how hard the part may be pulled."""
    draft.request["robot"]["tool"]["mass_kg"] = draft.between(0.1, 0.8)
    for body in draft.request["bodies"]:
        if body["name"] == "part":
            body["mass_kg"] = draft.between(0.1, 1.5)
    limits = draft.request["robot"].setdefault("limits", {})
    limits["acceleration_by_load"] = [
        {"mass_kg": 0.5, "share": 1.0},
        {"mass_kg": 2.5, "share": draft.between(0.3, 0.9)},
    ]
    if draft.chance(0.6):
        draft.request["carry"] = {"acceleration_m_s2": draft.between(5.0, 30.0)}


def _late(draft: Draft) -> None:
    """A window in seconds or along the belt, and straight parts that stop."""
    start = draft.request["start"].get("at_s", 0.0)
    ((_, given),) = draft.request["task"][0].items()
    begin = start + draft.between(0.0, 0.8)
    given["window_s"] = [begin, begin + draft.between(0.8, 3.0)]
    if draft.chance(0.5):
        given["window_m"] = [-draft.between(0.0, 0.3) * draft.reach, draft.between(0.1, 0.4) * draft.reach]
    for end in ("approach", "depart"):
        if draft.chance(0.4):
            given[end]["stop"] = True


def _mesh_part(draft: Draft) -> None:
    """The part is a shipped mesh at the same place."""
    asset = draft.one_of("bracket", "housing")  # whose hulls are the solid itself
    shape = {"mesh": {"asset": asset, "unit": "mm"}}
    half, (pick, place) = solid_of(shape).half_z, draft.request["task"][:2]
    for body in draft.request["bodies"]:
        if body["name"] == "part":
            body["shape"], body["pose"]["at_m"][2], body["yaw_symmetry"] = shape, half, 1
    pick["pick"]["grasp_m"][2] = half
    place["place"]["to"]["at_m"][2] = half


def _taken_away(draft: Draft) -> None:
    """A second part goes to the same place, from which somebody takes each part; most robots may be late."""
    task, bodies = draft.request["task"], draft.request["bodies"]
    (part,) = [body for body in bodies if body["name"] == "part"]
    bodies.append(copy.deepcopy(part) | {"name": "part-2"})
    bodies[-1]["pose"]["at_m"][0] -= draft.between(3.0, 5.0) * draft.half[0]
    task[1]["place"]["gone_after_s"] = draft.one_of(0.0, draft.between(0.0, 2.0))
    for given in copy.deepcopy(task[:2]):
        ((_, step),) = given.items()
        step["part"] = "part-2"
        task.append(given)
    if draft.chance(0.5):
        draft.request["options"]["stay_safe_s"] = draft.between(0.1, 2.5)


OWN: dict[str, Callable[[np.random.Generator], Draft]] = {
    "points, SCARA": through_points((*SCARAS, THREE_AXES)),
    "points, five-bar": through_points((FIVE_BAR,)),
    "points, elbow arm": through_points((ELBOW,)),
    "points, polar arm": through_points((POLAR,)),
    "points, five axes": through_points((FIVE_AXES,)),
    "start in motion, SCARA": through_points(SCARAS, moving_start=True),
    "start in motion, five-bar": through_points((FIVE_BAR,), moving_start=True),
    "start in motion, tilting": through_points(TILTING, moving_start=True),
    "traces, SCARA": traced(SCARAS),
    "traces, five-bar": traced((FIVE_BAR,)),
    "traces, tilting": traced(TILTING),
    "blends, SCARA": blended((*SCARAS, THREE_AXES)),
    "blends, tilting": blended(TILTING),
    "arches": _changed("table to table", _arches),
    "arches, belt": _changed("belt to table", _arches),
    "loads": _changed("table to table", _loads),
    "windows": _changed("belt to table", _late),
    "mesh parts": _changed("table to table", _mesh_part),
    "mesh parts, belt": _changed("belt to dial", _mesh_part),
    "taken away": _changed("table to table", _taken_away),
    "taken away, belt": _changed("belt to dial", _taken_away),
}
KINDS = (*random_cells.KINDS, *OWN)

"""The robots that are shipped: by name, each number with its source and status."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.catalogue.entry import Axis, Entry, Number
from assur.scenes.catalogue.fanuc import SR_3IA
from assur.scenes.catalogue.mitsubishi import RH_6CRH6020, RH_6FRH5520
from assur.scenes.catalogue.mitsubishi_rp import RP_5AH
from assur.scenes.catalogue.papers import BENCHMARK_SCARA, FIUBA_SCARA, OVIEDO_SCARA
from assur.scenes.catalogue.rv_m1 import RV_M1
from assur.scenes.catalogue.textbook import ELBOW_ARM, LAB_SCARA, OLIER_SCARA, POLAR_ARM
from assur.scenes.faults import likeliest

if TYPE_CHECKING:
    from assur.scenes.catalogue.arm import Arm

ENTRIES: dict[str, Entry] = {
    entry.model: entry
    for entry in (
        RH_6FRH5520,
        RH_6CRH6020,
        RP_5AH,
        SR_3IA,
        BENCHMARK_SCARA,
        OVIEDO_SCARA,
        FIUBA_SCARA,
        OLIER_SCARA,
        LAB_SCARA,
        ELBOW_ARM,
        POLAR_ARM,
        RV_M1,
    )
}


def entry_of(model: str) -> Entry:
    """The catalogue's entry of a model. Raises `InputError` for a model that is not there."""
    if model not in ENTRIES:
        raise InputError("robot.model", model, f"one of {likeliest(model, sorted(ENTRIES))}")
    return ENTRIES[model]


@lru_cache(maxsize=len(ENTRIES))
def arm_named(model: str) -> Arm:
    """The arm of a model, built once."""
    from assur.scenes.catalogue.of_entry import arm_of

    return arm_of(entry_of(model))


def robots() -> list[dict[str, Any]]:
    """Every robot of the catalogue as plain data, each number with unit, status and source."""
    return [_listed(entry) for entry in ENTRIES.values()]


def _listed(entry: Entry) -> dict[str, Any]:
    listed: dict[str, Any] = {
        "model": entry.model,
        "title": entry.title,
        "family": entry.family,
        **{name: _number(number) for name, number in entry.lengths()},
        "joints": [_joint(axis) for axis in entry.axes],
        "solids": {
            "status": entry.solids_status,
            "source": entry.solids_source,
            "unit": "mm",
            "each": [
                {"name": s.name, "link": s.link, "shape": s.kind, "size": list(s.size), "at": list(s.at)}
                for s in entry.solids
            ],
        },
        "self_pairs": [list(pair) for pair in entry.self_pairs],
        "assumptions": list(entry.assumptions()),
    }
    if entry.payload is not None:
        listed["payload"] = _number(entry.payload)
    return listed


def _joint(axis: Axis) -> dict[str, Any]:
    joint: dict[str, Any] = {"name": axis.name, "kind": axis.kind, "sign": axis.sign}
    for name in ("lower", "upper", "velocity", "acceleration", "jerk", "zero"):
        number = getattr(axis, name)
        if number is not None:
            joint[name] = _number(number)
    return joint


def _number(number: Number) -> dict[str, Any]:
    return {"value": number.value, "unit": number.unit, "status": number.status, "source": number.source}

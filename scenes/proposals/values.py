"""The values that make the scene of a request the one that was tried: by their paths, in the keys and units that the
request has, as `set` takes them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any, cast

import numpy as np

from assur.planner.errors import InputError
from assur.planner.model.options import Clearance
from assur.planner.model.scene import Scene
from assur.planner.model.task import Step
from assur.scenes.faults import Refused, written_key
from assur.scenes.reading.cell import Cell, cell_of
from assur.scenes.schema.read import read_fields
from assur.scenes.schema.request import RequestDocument
from assur.scenes.schema.task import StepDocument
from assur.scenes.set_values import with_values
from assur.scenes.units import from_si, si_key, to_si, twin_of

Value = tuple[tuple[str | int, ...], object]
"""The keys of a field of a request, and its new value."""
EXACT = 1e-12
"""Numbers, SI, that differ by no more are the same: rounding of what was written in the other unit."""
SIMPLE = re.compile(r"[A-Za-z][A-Za-z0-9_-]*\Z")
"""Names that a path has in place of the number of an entry."""
ENDS = {"move": "to", "follow": "to", "place": "to", "trace": "start"}
"""Key of the pose of each kind of step that has one."""
LIFTS = {"approach_m": "approach", "depart_m": "depart"}
LEADS = ("lead_in_m", "lead_out_m")
WINDOWS = {"time": "window_s", "along": "window_m"}


class _Unstated(Exception):
    """No values are the change."""


def values_of(cell: Cell, tried: Scene) -> dict[str, Any] | None:
    """The values that are the change from the scene of a cell to the one that was `tried`; None: no values are, or the
    request with them does not read as that scene."""
    document = cast("dict[str, Any]", cell.document)
    try:
        found = {path_of(document, keys): value for keys, value in _values(document, cell.scene, tried)}
        changed = with_values(document, found)
        again = _read_again(cell, changed).scene
    except (_Unstated, InputError, Refused):
        return None
    return found if _is_tried(again, cell.scene, tried) else None


def path_of(document: Any, keys: tuple[str | int, ...]) -> str:
    """A path of `set`: an entry of a list by its name where that is a plain word, else by its number."""
    found = list[str]()
    for key in keys:
        inside = _inside(document, key)
        step = next(iter(inside.values()), None) if isinstance(inside, dict) and len(inside) == 1 else inside
        name = step.get("name") if isinstance(step, dict) and isinstance(key, int) else None
        found.append(name if isinstance(name, str) and SIMPLE.match(name) else str(key))
        document = inside
    return ".".join(found)


def _inside(node: Any, key: str | int) -> Any:
    """The value at a key; None: there is none."""
    if isinstance(node, dict):
        return node.get(key)
    return node[key] if isinstance(node, list) and isinstance(key, int) and key < len(node) else None


def written_number(si: float, key: str) -> float | int:
    """The shortest number that is `si` under a key with a unit."""
    si, unit = float(si), (si_key(key) or ("", ""))[1]
    value = from_si(si, unit) if unit else si
    for digits in range(16):
        short = round(value, digits)
        if abs(si_number(short, key) - si) <= EXACT:
            return int(short) if short == int(short) else short
    return value


def si_number(value: float, key: str) -> float:
    """A number under a key with a unit, in SI."""
    twin = si_key(key)
    return float(value) if twin is None else cast(float, to_si(float(value), twin[1]))


def stated_as(inside: dict[str, Any], key: str) -> str:
    """The key of a quantity as a mapping has it; where it has none, in millimetres, degrees or seconds."""
    return written_key(inside, key) or (None if key.endswith("_s") else twin_of(key)) or key


# The changes of steps, options and frames.


def _values(document: dict[str, Any], own: Scene, tried: Scene) -> Iterator[Value]:
    if own.bodies is not tried.bodies:
        raise _Unstated
    for number, (step, other) in enumerate(zip(own.task, tried.task, strict=True)):
        if step is not other:
            kind, stated = next((k, v) for k, v in document["task"][number].items() if k in StepDocument.model_fields)
            yield from _of_step(stated, ("task", number, kind), step, other)
    yield from _of_options(document, own, tried)
    for name, frame in tried.frames.items():
        if frame.law != own.frames[name].law:
            keys = ("frames", name, frame.law.kind)
            yield _number(document["frames"][name][frame.law.kind], keys, "speed_m_s", frame.law.numbers.speed)


def _of_step(stated: dict[str, Any], at: tuple[str | int, ...], step: Step, other: Step) -> Iterator[Value]:
    for field in fields(other):
        name, value, before = field.name, getattr(other, field.name), getattr(step, field.name)
        if value == before:
            continue
        if name == "window":
            yield from _of_window(stated, at, value)
        elif name in ("target", "to"):
            yield from _of_pose(stated[ENDS[str(at[2])]], (*at, ENDS[str(at[2])]), before, value)
        elif name == "grasp":
            yield _raised(stated, at, "grasp_m", value.z - before.z)
        elif name in LIFTS:
            lift = LIFTS[name]
            yield _number(stated.get(lift, {}), (*at, lift), "m", value)
        elif name == "path" and hasattr(value, "blend_m"):
            yield _number(stated, at, "blend_m", value.blend_m)
        else:
            yield _number(stated, at, name, value)
        if name == "speed_m_s":  # leads that are not stated follow from it
            yield from (_number(stated, at, key, getattr(other, key)) for key in LEADS if not written_key(stated, key))


def _of_window(stated: dict[str, Any], at: tuple[str | int, ...], window: Any) -> Iterator[Value]:
    """A window with other ends; one that is removed: the whole step without it."""
    left = {key: getattr(window, name) for name, key in WINDOWS.items()}
    if not any(left.values()):
        kept = [stated_as(stated, key) for key in left]
        yield at, {key: value for key, value in stated.items() if key not in kept}
    for si, ends in left.items():
        if ends is not None:
            key = stated_as(stated, si)
            yield (*at, key), [written_number(end, key) for end in ends]


def _of_pose(stated: object, at: tuple[str | int, ...], before: Any, value: Any) -> Iterator[Value]:
    if not isinstance(stated, dict):
        raise _Unstated
    if value.pitch != before.pitch:
        yield (*at, stated_as(stated, "pitch_rad")), "free"
    if value.pose != before.pose:
        yield _raised(stated, at, "at_m", value.pose.z - before.pose.z)


def _raised(stated: dict[str, Any], at: tuple[str | int, ...], si: str, by: float) -> Value:
    """A point that is higher in the frame that it is written in."""
    key = stated_as(stated, si)
    point = stated.get(key, [0.0, 0.0, 0.0])
    height = written_number(si_number(point[2], key) + by, key)
    return ((*at, key), [*point[:2], height]) if key not in stated else ((*at, key, 2), height)


def _of_options(document: dict[str, Any], own: Scene, tried: Scene) -> Iterator[Value]:
    stated = document.get("options", {})
    removed = set[str]()
    for field in fields(tried.options):
        name, value = field.name, getattr(tried.options, field.name)
        if value == getattr(own.options, name):
            continue
        if isinstance(value, Clearance):
            yield from _of_clearance(stated, own.options.clearance, value)
        elif value is None:
            removed.add(stated_as(stated, name))
        else:
            yield _number(stated, ("options",), name, value)
    if removed:
        yield ("options",), {key: each for key, each in stated.items() if key not in removed}


def _of_clearance(stated: dict[str, Any], before: Clearance, value: Clearance) -> Iterator[Value]:
    key = stated_as(stated, "clearance_m")

    def distances(*names: str) -> dict[str, Any]:
        return {
            name: written_number(far, key)
            for name, far in zip(("travel", "near"), value.distances(*names), strict=True)
        }

    if value.distances() != before.distances():
        yield ("options", key), distances()
    pairs = [(*rule.first, *rule.second) for rule in value.exceptions[len(before.exceptions) :]]
    if pairs:
        rules = [{"between": [one], "and": [other], key: distances(one, other)} for one, other in pairs]
        yield ("options", "clearance_exceptions"), [*stated.get("clearance_exceptions", ()), *rules]


def _number(stated: object, at: tuple[str | int, ...], name: str, value: float | str) -> Value:
    """A number, or a word, under the key that has it."""
    key = stated_as(stated if isinstance(stated, dict) else {}, name)
    return (*at, key), value if isinstance(value, str) else written_number(value, key)


# Whether the request with the values reads as the scene that was tried.


def _read_again(cell: Cell, changed: dict[str, Any]) -> Cell:
    own = cast("dict[str, Any]", cell.document)
    changes = {key: value for key, value in changed.items() if key not in own or value is not own[key]}
    return cell_of(changed, cell.request.changed(read_fields(RequestDocument, changes)))


def _is_tried(again: Scene, own: Scene, tried: Scene) -> bool:
    """Whether a scene has all that differs between its own scene and the one that was tried as that has it, and nothing
    else is moved by it."""
    options = all(
        _same(getattr(again.options, each.name), value)
        for each in fields(tried.options)
        if (value := getattr(tried.options, each.name)) != getattr(own.options, each.name)
    )
    return (
        options
        and _same(again.task, tried.task)
        and _same({name: frame.law for name, frame in again.frames.items()}, _laws(tried))
        and _same(again.start, tried.start)
        and _same(
            [(body.frame, body.pose) for body in again.bodies], [(body.frame, body.pose) for body in tried.bodies]
        )
    )


def _laws(scene: Scene) -> dict[str, Any]:
    return {name: frame.law for name, frame in scene.frames.items()}


def _same(one: Any, other: Any) -> bool:
    """Whether two facts are the same, but for rounding of their numbers."""
    if one is other:
        return True
    if isinstance(one, float | int) and isinstance(other, float | int):
        return one == other or abs(one - other) <= EXACT
    if isinstance(one, np.ndarray):
        return one.shape == other.shape and bool(np.all(np.abs(one - other) <= EXACT))
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_same(value, other[key]) for key, value in one.items())
    if is_dataclass(one) and type(one) is type(other):
        return all(_same(getattr(one, each.name), getattr(other, each.name)) for each in fields(one) if each.compare)
    return bool(one == other)

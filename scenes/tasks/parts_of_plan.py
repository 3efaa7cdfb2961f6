"""Whether the next task states of the parts of a plan what it has to, and nothing else than the plan.

The request of a plan has the shape of a part, its mass and its symmetry, not its kind. So a part that is not listed
would be picked as a part without a kind is, at its middle; and one that is listed has all of its kind.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from assur.scenes.faults import DocumentError, choices, fault, written_key
from assur.scenes.schema.normal import normal
from assur.scenes.tasks.request_of_task import GRASP

Document = dict[str, Any]
OF_KIND = ("shape", "mass_kg", "yaw_symmetry")
"""What a part has of its kind, if it does not state it, and a plan of the part."""


def check_same_part(kinds: Mapping[str, Document], task: Document, number: int, before: Document) -> None:
    """Raises `DocumentError` where a part that a task lists without a place has, of its kind, another shape, mass or
    symmetry than the plan has of it (`before`). What it states itself counts, but for its shape."""
    part = task["parts"][number]
    if part.get("kind") not in (None, *kinds):
        return  # refused where the part is read
    of_task, of_plan = _of_kind(kinds, part), _of_kind(kinds, before)
    for key in OF_KIND:
        if of_task.get(key) != of_plan.get(key) and (key == "shape" or written_key(part, key) is None):
            if key == "shape":
                allowed = f"the shape that {part['name']} has in the plan, or a place at which this part is seen"
                raise fault(task, ("parts", number, "kind" if "kind" in part else key), allowed)
            there, here = (repr(each.get(key, "none")) for each in (of_plan, of_task))
            allowed = f"a number, which must be given: the plan has {there}, the kind {here}"
            raise fault(task, ("parts", number, key), allowed)


def _of_kind(kinds: Mapping[str, Document], part: Document) -> Document:
    """What a part has of its kind or states itself, in SI."""
    kind, own = normal(kinds.get(part.get("kind", ""), {})), normal(part)
    return {"yaw_symmetry": 1} | {key: each[key] for each in (kind, own) for key in OF_KIND if key in each}


def check_kinds_of_picked(kinds: Mapping[str, Document], steps: object, known: Mapping[str, Document]) -> None:
    """Raises `DocumentError` for one of the `known` parts, which the task of these steps does not list, where a step
    picks it and a kind of its shape states the grasp. A part whose shape is that of no kind has none."""
    for field, name, own in _picked(steps):
        part = known.get(name, {})
        if "kind" in part or "shape" not in part:
            continue
        shape = normal(part["shape"])
        found = [kind for kind, of in kinds.items() if normal(of["shape"]) == shape and _states_grasp(of, own)]
        if found:
            others = f", of one of the kinds of its shape: {choices(found, found[0])}" if len(found) > 1 else ""
            allowed = (
                f"a part that `parts` list with its kind, which states the grasp and is not in the plan: "
                f"write parts: [{{name: {name}, kind: {found[0]}}}]{others}; its place is that of the plan"
            )
            raise DocumentError(field, name, allowed)


def _states_grasp(kind: Document, own: Document) -> bool:
    """Whether a pick has something of its grasp of the kind."""
    return any(written_key(kind, key) and not written_key(own, key) for key in GRASP)


def _picked(steps: object) -> Iterator[tuple[str, str, Document]]:
    """The field of each name of a part that is picked, the name, and the pick or the transfer. What has another form is
    refused where the steps are read."""
    for i, step in enumerate(steps if isinstance(steps, list) else ()):
        for key, own in step.items() if isinstance(step, dict) else ():
            if not isinstance(own, dict):
                continue
            if key == "pick" and isinstance(own.get("part"), str):
                yield f"steps[{i}].pick.part", own["part"], own
            if key == "transfer" and isinstance(own.get("parts"), list):
                names = [(k, name) for k, name in enumerate(own["parts"]) if isinstance(name, str)]
                yield from ((f"steps[{i}].transfer.parts[{k}]", name, own) for k, name in names)

"""Whether the parts of a plan that the next task picks are listed with their kind.

The request of a plan has the shape of a part, not its kind. So a part that is not listed would be picked as a part
without a kind is, at its middle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from assur.scenes.faults import DocumentError, choices, written_key
from assur.scenes.schema.normal import normal
from assur.scenes.tasks.request_of_task import GRASP

Document = dict[str, Any]


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

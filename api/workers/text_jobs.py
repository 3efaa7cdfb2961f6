"""The texts of scenarios, cells and tasks: what `POST /v1/scenes/parse` has a worker do."""

from __future__ import annotations

from typing import Any

from assur.api.workers.jobs import not_allowed, of_body
from assur.planner.errors import InputError
from assur.scenes.requests import cell_of
from assur.scenes.scenario import with_files
from assur.scenes.scenarios import CELLS, scenario_in
from assur.scenes.tasks.places import places_of
from assur.scenes.tasks.task_file import scenario_of_texts

TEXT = (
    'an object with the fields "text", a scenario in YAML, or "cell", a cell in YAML, or both, and, if it likes, "draw"'
)
"""What the body is."""


@of_body(TEXT, "build", "status")
def parse(document: dict[str, Any]) -> dict[str, Any]:
    """What the scenario in {"text": YAML} means: why it exists, and its request with what the shipped files hold that
    it names. With {"cell": YAML} the text is a task of that cell; without a text it is a cell that has no request yet.
    With {"draw": true} also the view of the cell, where the arm stands at its start,
    and where what it shows is written. All faults that show without
    planning are reported now, each with its line."""
    given = {"text": None, "cell": None, "draw": False, **document}
    if given.keys() != {"text", "cell", "draw"} or not {"text", "cell"} & document.keys():
        raise not_allowed(document, TEXT)
    for name in ("text", "cell"):
        if name in document and not isinstance(given[name], str):
            raise InputError(name, given[name], "a text")
    if not isinstance(given["draw"], bool):
        raise InputError("draw", given["draw"], "true or false")
    text, cell_text = (
        None if each is None else each.encode("utf-8", "surrogatepass") for each in (given["text"], given["cell"])
    )
    path = CELLS / "text"
    scenario = scenario_in(text or b"", path) if cell_text is None else scenario_of_texts(text, cell_text, path)
    with scenario.located():
        cell = cell_of(scenario.request, folder=scenario.folder)
        request = with_files(scenario.request, scenario.folder)
    found: dict[str, Any] = {"status": "cell", "about": scenario.about}
    found |= {} if text is None else {"status": "parsed", "request": request}
    if given["draw"]:
        from assur.scenes.view.document import view_of

        found["view"] = view_of(cell, None)
        found["places"] = places_of(scenario, given["text"], given["cell"])
        if text is None and "name" not in scenario.request["task"][0]["move"]:  # a cell without positions
            found["view"]["control_points"] = []
    return found

"""Plans that the planner has proved and the checker refuses: each is a failure, and its request is kept.

The checker refuses a plan in the search (a line of the census with stage `checker`; another plan may follow), or when
an answer is checked.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

Document = dict[str, Any]

SECOND = "second checker"
"""In place of a code: the first checker accepts the plan, and the second checker refuses its bundle."""


def codes_of(answer: Document, findings: list[Document] | None) -> list[str]:
    """The codes with which the checker refused plans in the search of an answer, and the answer itself."""
    searched = objections(answer, findings)["in_the_search"]
    return [str(each["facts"]["code"]) for each in searched] + [str(each["code"]) for each in findings or ()]


def objections(answer: Document, findings: list[Document] | None) -> Document:
    """Why the checker refuses an answer, and plans in its search."""
    lines = answer["census"]["lines"]
    return {"checker": findings, "in_the_search": [line for line in lines if line["stage"] == "checker"]}


def keep(folder: Path, name: str, request: Document, faults: Document) -> Path:
    """Writes the request of a case that failed as a file that can be planned, and what went wrong as a second file."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name.replace(', ', '-').replace(' ', '-').replace('/', '-')}.json"
    file.write_text(json.dumps(request, indent=1), encoding="utf-8")
    file.with_suffix(".faults.json").write_text(json.dumps(faults, indent=1, default=float), encoding="utf-8")
    return file

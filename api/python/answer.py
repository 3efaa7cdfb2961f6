"""An answer as an object: the mapping that its document is, with attributes for what is read most."""

from __future__ import annotations

import copy
import html
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from assur.planner.errors import AssurError, InputError

if TYPE_CHECKING:
    from assur.api.python.cell import Cell
    from assur.api.python.motion import Trajectory
    from assur.scenes.schema import answer as written

PLANNED, NOT_PLANNED = "planned", "not_planned"
MOST_HIGH_PX = 10_000
"""Height of the viewer in a notebook, at the most."""


class NotPlannedError(AssurError):
    """A part of a plan was read of an answer that has none. Read `answer.planned` first."""


class Answer(Mapping[str, Any]):
    """The answer to a request: ``answer["duration_s"]``, and the attributes below.

    The mapping itself has no setters. Its lists and dicts are those of the document, not copies: treat them as
    read-only, and change a `copy.deepcopy`.

    `assur.plan` and `assur.load_answer` make one. It can also be made of a document: ``Answer(json.load(file))``. Only
    what is read is verified; whether the plan is right is what `check` says. Attributes of a plan raise
    `NotPlannedError` where there is none. `save`, `report` and `show` need the `request` and raise `InputError` where
    it is not known.
    """

    def __init__(self, document: dict[str, Any], request: Mapping[str, Any] | None = None) -> None:
        """`request`: the plain document of the request that this answers, if it is known; a copy of it is kept.

        Raises `InputError` for what is no answer.
        """
        if not isinstance(document, dict):
            raise InputError("answer", document, "the document of an answer, a dict")
        status = document.get("status")
        if not isinstance(status, str) or status not in (PLANNED, NOT_PLANNED):
            raise InputError("answer.status", status, f"{PLANNED} or {NOT_PLANNED}: no answer has another")
        self._document = document
        self._request = None if request is None else copy.deepcopy(dict(request))
        self._of: tuple[dict[str, Any], dict[str, Any]] | None = None

    @classmethod
    def made(
        cls,
        document: dict[str, Any],
        request: dict[str, Any] | None,
        of: tuple[dict[str, Any], dict[str, Any]] | None = None,
    ) -> Answer:
        """An answer that keeps these documents themselves, which nobody changes. `of`: the cell and the task that make
        the request, if it is made of them."""
        answer = cls(document)
        answer._request, answer._of = request, of
        return answer

    @property
    def request(self) -> dict[str, Any] | None:
        """The request that this answers, as it was planned; None where it is not known. Change a copy, not this."""
        return self._request

    @property
    def document(self) -> dict[str, Any]:
        """The document itself, plain data that JSON can hold. Change a copy, not this."""
        return self._document

    @property
    def planned(self) -> bool:
        """Whether there is a plan."""
        return bool(self._document["status"] == PLANNED)

    @property
    def sentence(self) -> str:
        """Why there is no plan; empty where there is one."""
        return str(self._document.get("sentence", ""))

    @property
    def duration_s(self) -> float:
        """Duration of the motion, s."""
        return float(self._of_plan("duration_s"))

    @property
    def start_s(self) -> float:
        """When the motion begins, s of the request's clock."""
        return float(self._of_plan("start_s"))

    @cached_property
    def trajectory(self) -> Trajectory:
        """The motion as arrays of NumPy, in rad and m, with the maker's names, signs and zeros of the joints."""
        from assur.api.python.motion import Trajectory

        return Trajectory(self._of_plan("trajectory"))

    @property
    def arrivals(self) -> list[written.Arrival]:
        """Where and when each control point is met, in order."""
        return cast("list[written.Arrival]", self._of_plan("arrivals"))

    @property
    def legs(self) -> list[written.Leg]:
        """The parts of the motion, in order."""
        return cast("list[written.Leg]", self._of_plan("legs"))

    @property
    def margins(self) -> written.Margins:
        """What the plan leaves of its limits and distances."""
        return cast("written.Margins", self._of_plan("margins"))

    @property
    def assumptions(self) -> list[str]:
        """Every number that is estimated or second hand, in words."""
        if "assumptions" not in self and self._request is not None:
            from assur.scenes.requests import assumptions_of

            return assumptions_of(self._request)
        return cast("list[str]", self._said("assumptions"))

    @property
    def warnings(self) -> list[written.InputWarning]:
        """What of the request is probably not meant, and refuses nothing."""
        return cast("list[written.InputWarning]", self._said("warnings"))

    def next_task(
        self, steps: Sequence[object], *, parts: Sequence[object] = (), cell: Cell | Mapping[str, Any] | None = None
    ) -> dict[str, Any]:
        """The task with these steps that begins where this plan ends: clock, state of the robot, what the gripper
        holds, and where each part lies, with what the plan proves of how well it is known.

        `cell`: the cell in which it is planned; `cell.plan(**fields)` takes what is returned, for an `assur.Cell` of a
        cell file or of a request. Robot, frames and neighbours of the cell must be those of the plan. None: the cell of
        an answer of `assur.Cell` of a cell file; of any other answer, what is returned is a request, whose bodies have
        all parts. `parts` are added, but to a request. Everything else is as it was. The frames count as known at the
        new start as the cell states it; bodies on a frame whose speed is uncertain are known less well, for the time of
        the plan.

        Raises `InputError` where there is no plan or no request, for a plan that `assur check` does not accept, or
        whose certificate is not in full, and for another cell, at the field that differs.
        """
        from assur.api.python.calls import document_of
        from assur.scenes.faults import raised_as
        from assur.scenes.tasks.kept_cell import of_task
        from assur.scenes.tasks.next_task import checked_end, next_fields, next_request, next_values

        request, made = self._known_request(), {"steps": listed("steps", steps), "parts": listed("parts", parts)}
        document, task = (None, None) if self._of is None else self._of
        if cell is not None:
            document = document_of(cell)
        end = checked_end(request, self._document)
        if document is not None and "task" not in document:
            with raised_as(of_task):
                return next_fields(document, made, end, task)
        if parts:
            allowed = "none: the parts of a request are bodies; add them to those that are returned"
            raise InputError("parts", made["parts"], allowed)
        follows = next_request(end, made["steps"])
        return follows if document is None else next_values(document, follows, end)

    def save(self, path: str | Path, *, title: str = "", about: str = "") -> Path:
        """Writes request and answer into one file, which `assur.load_answer` reads, and `assur check`, `assur report`
        and `assur export` take; returns its path. `title`, `about`: what the cell is called, and why it exists.

        Raises `InputError`, also where the file would be too long to be read; `OSError` where it cannot be written.
        """
        from assur.api.python.saved import write

        return write(self, self._known_request(), Path(path), title, about)

    def report(self, path: str | Path, *, title: str = "plan", about: str = "") -> Path:
        """Writes the report, one page that plays this answer and says all of it, for any browser, without network.

        A plan with its certificate in full is checked again, and the page says what came out. Returns the path. Raises
        `InputError` for an answer that is not as an answer is; `OSError` where the file cannot be written.
        """

        out = Path(path)
        out.write_text(page_of(self._known_request(), self._document, title, about), encoding="utf-8")
        return out

    def show(self, *, height_px: int = 720, title: str = "plan") -> Shown:
        """The viewer for a notebook: make it the last value of a cell, or give it to ``display``.

        `height_px`: of the frame that it is in. Outside of a notebook nothing can show it, and a warning says to call
        `report`. Raises `InputError`, as `report` does.
        """

        if height_px not in range(1, MOST_HIGH_PX + 1):
            raise InputError("height_px", height_px, f"a whole number of pixels from 1 to {MOST_HIGH_PX}")
        shown = Shown(page_of(self._known_request(), self._document, title, ""), height_px)
        if not any(name in sys.modules for name in NOTEBOOKS):
            warnings.warn(f"no notebook is running here, so nothing is shown; {ELSEWHERE}", stacklevel=2)
        return shown

    def _known_request(self) -> dict[str, Any]:
        if self._request is None:
            allowed = "an answer of assur.plan or assur.load_answer, or Answer(document, request)"
            raise InputError("answer.request", None, allowed)
        return self._request

    def _of_plan(self, key: str) -> Any:
        if not self.planned:
            raise NotPlannedError(f"the answer has no {key}, for there is no plan: {self.sentence}")
        return self._said(key)

    def _said(self, key: str) -> Any:
        if key not in self._document:
            allowed = (
                "what the answer states: with `fields`, what they list; with `report: full` in the options, all of it; "
                "of a plan file that an export wrote, what the exported answer states"
            )
            raise InputError(f"answer.{key}", "nothing", allowed)
        return self._document[key]

    def __getitem__(self, key: str) -> Any:
        return self._document[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._document)

    def __len__(self) -> int:
        return len(self._document)

    def __repr__(self) -> str:
        stated = self._document  # with `fields`, an answer may have none of these
        if not self.planned:
            return f"<Answer: not planned. {stated.get('sentence', '')}".rstrip() + ">"
        lasts = f", {stated['duration_s']:.3f} s" if "duration_s" in stated else ""
        many = len(stated["arrivals"]) if "arrivals" in stated else None
        arrivals = "" if many is None else f", {many} arrival{'' if many == 1 else 's'}"
        return f"<Answer: planned{lasts}{arrivals}>"


NOTEBOOKS = ("IPython", "marimo")
"""What a notebook has loaded that shows `_repr_html_`."""
ELSEWHERE = "answer.report('report.html') writes the same page as a file that every browser opens"


def listed(name: str, values: object) -> list[dict[str, Any]]:
    """A list of mappings, which may be built of `assur.request`, as plain data. Raises `InputError` below the name of
    the argument."""
    from assur.api.python.calls import plain_request
    from assur.scenes.schema.normal import plain

    if isinstance(values, str | bytes) or not isinstance(values, Sequence):
        raise InputError(name, values, "a list")
    found: list[dict[str, Any]] = plain({name: [plain_request(each) for each in values]})[name]
    for i, each in enumerate(found):
        if not isinstance(each, dict):
            raise InputError(f"{name}[{i}]", each, "a mapping of fields")
    return found


class Shown:
    """The viewer of an answer, a page that needs no network. A notebook shows it where it is the last value of a cell,
    or where it is given to `display`."""

    def __init__(self, page: str, height_px: int) -> None:
        self._page, self._height_px = page, height_px

    def _repr_html_(self) -> str:
        # A frame with an origin of its own: what a request says reaches neither the notebook nor its kernel.
        return (
            f'<iframe srcdoc="{html.escape(self._page)}" sandbox="allow-scripts" title="assur" '
            f'style="width: 100%; height: {self._height_px}px; border: 0"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<the viewer of an answer: a notebook shows it; {ELSEWHERE}>"


def page_of(request: Mapping[str, Any], answer: Mapping[str, Any], title: str, about: str) -> str:
    """The report of an answer to a request, which says what the checker says. Raises `InputError` naming the field."""
    from assur.api.checked_report import checked_report
    from assur.scenes.requests import cell_of

    return checked_report(cell_of(dict(request)), dict(answer), title, about)[0]

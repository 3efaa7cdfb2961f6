"""An answer as an object: the mapping that its document is, with attributes for what is read most."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from assur.planner.errors import AssurError, InputError

if TYPE_CHECKING:
    from assur.api.python.motion import Trajectory
    from assur.scenes.schema import answer as written

PLANNED, NOT_PLANNED = "planned", "not_planned"


class NotPlannedError(AssurError):
    """Something of a plan was asked of an answer that has none. Ask `answer.planned` first."""


class Answer(Mapping[str, Any]):
    """The answer to a request, read-only: ``answer["duration_s"]``, and the attributes below.

    Made of a document, such as a plan that was saved: ``Answer(json.load(file))``. Only what is asked for is looked at;
    whether the plan is right is what `check` says. Attributes of a plan raise `NotPlannedError` where there is none.
    """

    def __init__(self, document: dict[str, Any]) -> None:
        """Raises `InputError` for what is no answer."""
        if not isinstance(document, dict):
            raise InputError("answer", document, "the document of an answer, a dict")
        if document.get("status") not in (PLANNED, NOT_PLANNED):
            raise InputError(
                "answer.status", document.get("status"), f"{PLANNED} or {NOT_PLANNED}: no answer has another"
            )
        self._document = document

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
        found: list[written.Arrival] = self._of_plan("arrivals")
        return found

    @property
    def legs(self) -> list[written.Leg]:
        """The parts of the motion, in order."""
        found: list[written.Leg] = self._of_plan("legs")
        return found

    @property
    def margins(self) -> written.Margins:
        """What the plan leaves of its limits and distances."""
        found: written.Margins = self._of_plan("margins")
        return found

    @property
    def assumptions(self) -> list[str]:
        """Every number that is estimated or second hand, in words."""
        found: list[str] = self["assumptions"]
        return found

    @property
    def warnings(self) -> list[written.InputWarning]:
        """What of the request is probably not meant, and refuses nothing."""
        found: list[written.InputWarning] = self["warnings"]
        return found

    def _of_plan(self, key: str) -> Any:
        if not self.planned:
            raise NotPlannedError(f"the answer has no {key}, for there is no plan: {self.sentence}")
        return self._document[key]

    def __getitem__(self, key: str) -> Any:
        return self._document[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._document)

    def __len__(self) -> int:
        return len(self._document)

    def __repr__(self) -> str:
        if not self.planned:
            return f"<Answer: not planned. {self.sentence}>"
        return f"<Answer: planned, {self.duration_s:.3f} s, {len(self.arrivals)} arrivals>"

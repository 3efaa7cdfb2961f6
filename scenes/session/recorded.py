"""A session whose calls are recorded, each with what it gave."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from assur.planner.errors import InputError
from assur.scenes.schema.normal import plain
from assur.scenes.session.session import NextMotion, RunningCell

if TYPE_CHECKING:
    from assur.scenes.session.committed import CommittedMotion
    from assur.scenes.session.reading import Coverage
    from assur.scenes.tasks.kept_cell import KeptCellFile

Document = dict[str, Any]
T = TypeVar("T")
ARGUMENTS = {
    "advance": ("to_s",),
    "see": ("name", "fields"),
    "gone": ("name",),
    "propose": ("steps", "at_s"),
    "commit": ("number",),
    "covered": ("reading",),
}
"""The calls of a session that are recorded, and what each is given; the first record is of the session itself. Its
``frames`` are those of its cell: in a long run another session goes on, whose conveyors are counted anew."""
FIRST, OF_FIRST = "session", ("start", "refuge", "planning_ms", "options")
MEASURED = ("elapsed_s", "first_s")
"""Times in an answer that are measured: a record has 0 there, so that the same calls have the same records."""


class Record(Protocol):
    """What takes the calls of a session, and the motion between them."""

    def called(self, event: Document) -> None:
        """A call: ``call``, ``clock_s``, ``arguments``, and the ``result``, or why it was ``refused``."""

    def moved(self, motion: CommittedMotion, from_s: float, to_s: float) -> None:
        """The clock was set from one time to another, s; the arm executed the committed motion."""


class Events:
    """A record that keeps the calls."""

    def __init__(self) -> None:
        self.events: list[Document] = []

    def called(self, event: Document) -> None:
        """As a record."""
        self.events.append(event)

    def moved(self, motion: CommittedMotion, from_s: float, to_s: float) -> None:
        """As a record: states follow from the plans."""


class Several:
    """A record that gives all to several records."""

    def __init__(self, *records: Record) -> None:
        self._records = records

    def called(self, event: Document) -> None:
        """As a record."""
        for each in self._records:
            each.called(event)

    def moved(self, motion: CommittedMotion, from_s: float, to_s: float) -> None:
        """As a record."""
        for each in self._records:
            each.moved(motion, from_s, to_s)


class RecordedCell(RunningCell):
    """A running cell that gives each call to a record, those that are refused as well."""

    def __init__(
        self,
        record: Record,
        kept: KeptCellFile,
        start: object,
        refuge: object,
        planning_ms: float,
        options: object = None,
    ) -> None:
        """As a running cell."""
        self._record = record
        super().__init__(kept, start, refuge, planning_ms, options)
        arguments = plain({"start": start, "refuge": refuge, "planning_ms": planning_ms, "options": options})
        first = self.committed.last.judged
        result = {"request": first.request, "answer": timeless(first.answer)}
        event = {"call": FIRST, "clock_s": self.clock_s, "arguments": arguments, "result": result}
        record.called({**event, "frames": kept.file.written.get("frames", {})})

    def advance(self, to_s: float) -> None:
        from_s, before = self.clock_s, self.committed
        self._call("advance", {"to_s": to_s}, lambda: RunningCell.advance(self, to_s), _nothing)
        self._record.moved(before, from_s, self.clock_s)

    def see(self, name: object, fields: Mapping[str, Any]) -> None:
        self._call("see", {"name": name, "fields": dict(fields)}, lambda: RunningCell.see(self, name, fields), _nothing)

    def gone(self, name: object) -> None:
        self._call("gone", {"name": name}, lambda: RunningCell.gone(self, name), _nothing)

    def propose(self, steps: Sequence[object], at_s: float | None = None) -> NextMotion:
        arguments = {"steps": list(steps), "at_s": at_s}
        return self._call("propose", arguments, lambda: RunningCell.propose(self, steps, at_s), _proposed)

    def commit(self, number: object) -> None:
        def committed(_: None) -> Document:
            last, of = self.committed.last, self.committed.last.judged
            return {"starts_s": last.starts_s, "request": of.request, "answer": timeless(of.answer)}

        self._call("commit", {"number": number}, lambda: RunningCell.commit(self, number), committed)

    def covered(self, reading: object) -> Coverage:
        return self._call("covered", {"reading": reading}, lambda: RunningCell.covered(self, reading), asdict)

    def _call(self, call: str, arguments: Document, give: Callable[[], T], result: Callable[[T], object]) -> T:
        event = {"call": call, "clock_s": self.clock_s, "arguments": plain(arguments)}
        try:
            found = give()
        except InputError as error:
            self._record.called({**event, "refused": str(error)})
            raise
        self._record.called({**event, "result": result(found)})
        return found


def timeless(answer: Document) -> Document:
    """An answer with 0 in place of the times that were measured."""
    return {**answer, **{key: 0.0 for key in MEASURED if key in answer}}


def _nothing(_: object) -> None:
    return None


def _proposed(made: NextMotion) -> Document:
    """What a proposal gives; its answer by its digest, because only the plans that are committed are executed."""
    answer = json.dumps(timeless(made.judged.answer), sort_keys=True)
    return {
        "id": made.number,
        "starts_s": made.starts_s,
        "base_ends_s": made.base_ends_s,
        "status": made.judged.answer["status"],
        "answer_sha256": hashlib.sha256(answer.encode()).hexdigest(),
    }

"""A log of a session is replayed: the same calls on a new session, and each result compared with that of the log."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.faults import NOTHING, dotted
from assur.scenes.schema.differences import first_difference
from assur.scenes.session.recorded import ARGUMENTS, FIRST, OF_FIRST, RecordedCell
from assur.scenes.tasks.kept_cell import KeptCellFile

if TYPE_CHECKING:
    from assur.scenes.session.committed import CommittedMotion

Document = dict[str, Any]
FORMS = {"fields": dict, "steps": list}
"""Arguments that a call takes apart; all others it examines itself."""


@dataclass(frozen=True)
class Replay:
    """How a log was replayed: `calls` that gave the same as in the log, and, where one did not, what differs first."""

    calls: int
    difference: str | None

    @property
    def same(self) -> bool:
        """Whether all of the log was given again."""
        return self.difference is None


class _Comparison:
    """Compares each call with the one that is expected."""

    def __init__(self) -> None:
        self.expected: Document = {}
        self.difference: str | None = None

    def called(self, event: Document) -> None:
        found = json.loads(json.dumps(event))
        if _text(found) != _text(self.expected):
            where = _differs(self.expected, found)
            self.difference = f"at {event['clock_s']:.6g} s: {where}"

    def moved(self, motion: CommittedMotion, from_s: float, to_s: float) -> None:
        """Nothing: states follow from the plans."""


def replay(path: Path) -> Replay:
    """Replays a log. It ends with the first call that gives something else. Raises `InputError` for a file that is no
    log of a session, and `OSError`."""
    from assur.scenes.session.log import read_log

    cell, events = read_log(path)
    comparison, running, calls = _Comparison(), None, 0
    for event in events:
        given, call = _arguments(event), event.get("call") if isinstance(event, dict) else None
        if given is None or (running is None and call != FIRST):
            raise InputError(
                "log", path.name, f"the log of a session; its call number {calls + 1} is none of a session"
            )
        comparison.expected = event
        try:
            if call == FIRST:
                kept = KeptCellFile({**cell, "frames": event["frames"]} if event.get("frames") else cell)
                running = RecordedCell(comparison, kept, **given)
            else:
                getattr(running, str(call))(**given)
        except InputError as error:
            if call == FIRST:
                comparison.difference = f"the session is refused: {error}"
        if comparison.difference is not None:
            return Replay(calls, comparison.difference)
        calls += 1
    if running is None:
        raise InputError("log", path.name, "the log of a session with one call at least")
    return Replay(calls, None)


def _arguments(event: object) -> dict[str, Any] | None:
    """The arguments of a call of a log; None where it is no call of a session."""
    if not isinstance(event, dict) or not isinstance(event.get("call"), str):
        return None
    names = OF_FIRST if event["call"] == FIRST else ARGUMENTS.get(event["call"])
    given = event.get("arguments")
    if names is None or not isinstance(given, dict) or given.keys() != set(names):
        return None
    return given if all(isinstance(given[key], form) for key, form in FORMS.items() if key in given) else None


def _differs(log: Document, again: Document) -> str:
    """The first place at which a call of a log and that of the replay differ, and the values there."""
    path = first_difference(again, log)
    one, other = (_at(each, path) for each in (log, again))
    where = dotted((log["call"], *path))
    if one is NOTHING or other is NOTHING:
        there, what = ("the replay", other) if one is NOTHING else ("the log", one)
        return f"{where} is only in {there}: {_short(what)}"
    return f"{where} is {_short(one)} in the log, and {_short(other)} in the replay"


def _at(document: Any, path: tuple[str | int, ...]) -> Any:
    """The value at a path of a document, or NOTHING."""
    for key in path:
        if isinstance(document, dict) and key not in document:
            return NOTHING
        document = document[key]
    return document


def _text(value: object) -> str:
    """A text that two values have if they are the same; NaN is the same as NaN."""
    return json.dumps(value, sort_keys=True)


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."

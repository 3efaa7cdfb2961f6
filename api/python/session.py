"""A session: the motions of a cell that runs, one after the other, each proved before it is executed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, cast

from assur.api.python.answer import Answer, listed
from assur.api.python.calls import plain_request
from assur.api.python.cell import Cell
from assur.planner.errors import InputError

if TYPE_CHECKING:
    from assur.scenes.schema.answer import Verdict
    from assur.scenes.session.judged import JudgedOutcome
    from assur.scenes.session.log import SessionLog
    from assur.scenes.session.reading import Coverage
    from assur.scenes.session.replay import Replay
    from assur.scenes.session.session import RunningCell


@dataclass(frozen=True)
class Proposal:
    """The next motion: from `starts_s` on, by the session's clock. `session.commit` takes its `id` up to `decide_by_s`.

    `base_ends_s`: when the steps that are meant have been done, and the way to the refuge begins; None without a plan.
    `answer`: the plan, or why there is none.
    """

    id: int
    starts_s: float
    decide_by_s: float
    base_ends_s: float | None
    answer: Answer = field(repr=False)
    _judged: JudgedOutcome = field(repr=False)

    @property
    def planned(self) -> bool:
        """Whether there is a plan."""
        return self.answer.planned

    def check(self) -> Verdict:
        """What the checker says of the answer and all that it states, the same as `assur.check`. The plan itself was
        judged when it was proposed."""
        from assur.scenes.requests import check_cell

        return cast("Verdict", check_cell(self._judged.cell, self._judged.answer))


@dataclass(frozen=True)
class CommittedPlan:
    """A plan of the committed motion: it is executed from `starts_s` to `until_s`. Where another one follows it is left
    then; the last one ends in the refuge, and `until_s` is until when standing there is proved."""

    starts_s: float
    until_s: float
    answer: Answer = field(repr=False)


class Session:
    """A cell that runs: a clock, the parts that are known, and one committed motion, which always ends at rest in a
    *refuge*, a named position of the cell.

    ``session = assur.Session(cell, start=..., refuge="home")``; then, again and again, `see` parts, `propose` steps,
    `commit` the proposal and `advance` the clock. Every motion is a plan of its own, which `assur.check` accepts, and
    begins in a state of the one before, also while the arm moves. The same calls give the same motions. A session is
    for one thread.
    """

    def __init__(
        self,
        cell: Cell | Mapping[str, Any],
        *,
        start: object,
        refuge: str,
        planning_ms: float = 20.0,
        options: object = None,
        log: str | PathLike[str] | None = None,
    ) -> None:
        """Plans the way from `start`, as a task has it, to the refuge; this motion is committed.

        `cell`: a cell file, or an `assur.Cell` of one. `planning_ms`: how long planning takes, on the session's clock;
        it is not measured. `options`: of every motion, where the cell does not state them. `log`: a file to which the
        session writes its log (MCAP), up to `close`. Raises `InputError` naming the argument or the field, also for a
        refuge that cannot be reached or is not safe, with the reason; `OSError` for a log that cannot be written.
        """
        from assur.scenes.session.session import RunningCell

        kept = cell if isinstance(cell, Cell) else Cell(cell)
        file = kept.file
        if file is None:
            raise InputError("cell", "a request", "a cell file: a request has no named positions, kinds and slots")
        first, given = plain_request(start), None if options is None else plain_request(options)
        self._document = kept.document
        self._log: SessionLog | None = None
        self._running: RunningCell
        if log is None:
            self._running = RunningCell(file, first, refuge, planning_ms, given)
            return
        from assur.scenes.session.log import SessionLog
        from assur.scenes.session.recorded import RecordedCell

        self._log = SessionLog(Path(log), kept.document)
        try:
            self._running = RecordedCell(self._log, file, first, refuge, planning_ms, given)
        except BaseException:
            self._log.close()
            raise

    @property
    def clock_s(self) -> float:
        """The time of the clock, s. The start states its first one."""
        return self._running.clock_s

    @property
    def proved_until_s(self) -> float:
        """Until when, s, the committed motion and standing in the refuge is proved, with the parts that it knows: for
        ``stay_safe_s`` of the options; infinite where nothing moves."""
        return self._running.proved_until_s

    @property
    def parts(self) -> tuple[str, ...]:
        """The names of the parts that are known, in the order in which they were seen first."""
        return self._running.parts

    @property
    def committed(self) -> tuple[CommittedPlan, ...]:
        """The plans of the committed motion, from the one at the clock on."""
        segments, now_s = self._running.committed.segments, self.clock_s
        there = [*[each for each in segments[:-1] if each.until_s > now_s], segments[-1]]
        return tuple(CommittedPlan(each.starts_s, each.until_s, self._answer(each.judged)) for each in there)

    def advance(self, to_s: float) -> None:
        """Sets the clock to a time, s. Raises `InputError` for a time before the clock's, and for one that no committed
        proof covers."""
        self._running.advance(to_s)

    def see(self, name: str, **fields: object) -> None:
        """A part is there: a new one, or one that is known, at another place.

        `fields`: those of a part of a task: ``kind`` or ``shape``, ``pose`` or ``slot``, ``uncertainty``. Of a part
        that is known, kind or shape may be left out. On a frame whose speed is uncertain the pose has an ``at_s``.
        Proposals that are made from then on know it; the committed motion does not. Raises `InputError` naming the
        field.
        """
        self._running.see(name, {key: plain_request(value) for key, value in fields.items()})

    def gone(self, name: str) -> None:
        """A part is no longer there. Raises `InputError` for one that is not known, and for one that the gripper holds
        or the committed motion handles from now on."""
        self._running.gone(name)

    def propose(self, steps: Sequence[object], *, at_s: float | None = None) -> Proposal:
        """The next motion: these steps, as a task has them (the base), and then the way to the refuge (the horizon).

        It begins in the state of the committed motion at `at_s`. None: where the base of the committed motion ends; if
        that is not ahead of clock and planning time, as soon as planning is over. Raises `InputError` naming the field,
        for `at_s` also where the motion may not be left: while the tool tracks a point, and beyond `proved_until_s`.
        """
        made = self._running.propose(listed("steps", steps), at_s)
        answer = self._answer(made.judged)
        return Proposal(made.number, made.starts_s, made.starts_s, made.base_ends_s, answer, made.judged)

    def commit(self, id: int | Proposal) -> None:  # noqa: A002 as a proposal names it
        """Makes a proposal the motion that is executed, from its start on; until then the one before remains.

        Raises `InputError` for one that is late, used, not planned, not of this session, or made before another one was
        committed.
        """
        self._running.commit(id.id if isinstance(id, Proposal) else id)

    def holds(self, reading: Mapping[str, Any]) -> Coverage:
        """Whether a reading lies within what the proof of the committed motion assumes: compared, without planning.

        `reading`: ``{"joints": {...}, "at_s": ...}``, the robot's own state; ``{"part": ..., "pose": {...}}``, a part
        that was seen; or ``{"frame": ..., "along_mm": ..., "speed_mm_s": ..., "at_s": ...}``, how far a conveyor has
        gone, and how fast it is. A time that is left out is the clock's. Joints may be off by the lag of the request,
        and late by its start tolerance; a part by its uncertainty, and by that of its frame since the plan began.
        Raises `InputError` naming the field.
        """
        return self._running.covered(plain_request(reading))

    def close(self) -> None:
        """Finishes the log: later calls are not in it. ``with assur.Session(...) as session:`` does it, too. A session
        without a log needs no closing."""
        if self._log is not None:
            self._log.close()
            self._log = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _answer(self, of: JudgedOutcome) -> Answer:
        return Answer.made(of.answer, of.request, (self._document, of.task))

    def __repr__(self) -> str:
        return f"<Session: {self.clock_s:.6g} s, {len(self.parts)} parts, proved until {self.proved_until_s:.6g} s>"


def replay(log: str | PathLike[str]) -> Replay:
    """Does what the log of a session has again, in a new session, and compares what each call gives.

    ``replay(log).same``: all of it is given again, the plans to the bit. `difference` says what is not. Raises
    `InputError` for a file that is no log of a session, and `OSError`.
    """
    from assur.scenes.session.replay import replay as again

    return again(Path(log))

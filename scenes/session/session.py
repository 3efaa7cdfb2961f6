"""A session: a clock, the parts that are known, and proposals of the motion that comes next."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from assur.planner.errors import InputError
from assur.scenes.bounds import LONG_S
from assur.scenes.faults import choices, documented, raised_as
from assur.scenes.schema.cell_file import TASK
from assur.scenes.schema.normal import normal, plain
from assur.scenes.session.committed import CommittedMotion, History, Segment, segment_of
from assur.scenes.session.judged import JudgedOutcome, judged
from assur.scenes.tasks.kept_cell import KeptCellFile, of_task

if TYPE_CHECKING:
    from assur.scenes.reading.cell import Surroundings
    from assur.scenes.session.reading import Coverage
    from assur.scenes.tasks.next_task import EndState

Document = dict[str, Any]
OF_SIGHTING = ("pose", "slot", "uncertainty")
"""Fields of a part that say where it is, and how well that is known."""
LONGEST_PLANNING_MS = 60_000.0
"""As long as the largest budget of a search."""


@dataclass(frozen=True, eq=False)
class Sighting:
    """A part as it was at `seen_s`, the time of its pose, or else that of the clock: its fields in a task."""

    part: Document
    seen_s: float


@dataclass(frozen=True, eq=False)
class NextMotion:
    """What was proposed: the outcome of planning a task from `starts_s` on, which is `judged`. `base_ends_s`: where the
    way to the refuge begins. `segment`: the plan. Both are None where there is none, and where the checker refuses
    it."""

    number: int
    starts_s: float
    base_ends_s: float | None
    judged: JudgedOutcome
    segment: Segment | None


class RunningCell:
    """A cell that is kept, a clock, the parts that are known, and one committed motion (docs/api.md, "A session")."""

    def __init__(
        self, kept: KeptCellFile, start: object, refuge: object, planning_ms: float, options: object = None
    ) -> None:
        """Plans the way from the start to the refuge, which is the committed motion. Raises `InputError` naming the
        argument, also where the refuge cannot be reached or is not safe."""
        kept.check()
        if not isinstance(refuge, str) or refuge not in kept.file.valid.positions:
            named = kept.file.valid.positions
            raise InputError("refuge", refuge, f"the name of a position of the cell: {choices(named, str(refuge))}")
        self._planning_s = number("planning_ms", planning_ms, 0.0, LONGEST_PLANNING_MS) / 1e3
        self._kept, self.refuge = kept, refuge
        given = {"start": start} if options is None else {"start": start, "options": options}
        self._first = plain({"schema": TASK, **given})
        made = self._planned(0, 0.0, {**self._first, "steps": self._with_refuge([])}, History())
        if made.segment is None:
            allowed = f"a position to which the arm can go from the start, to stand there: {made.judged.reason}"
            raise InputError("refuge", refuge, allowed)
        if made.segment.cell.scene.options.end != "rest":
            raise InputError("options.end", "moving", "rest: each motion of a session ends at rest in the refuge")
        self.committed = CommittedMotion(made.segment)
        self.clock_s = made.segment.starts_s
        self._known: dict[str, Sighting] = {}
        self._open: dict[int, NextMotion] = {}
        self._number = self._committed = 0
        """Of the last proposal, and of the one that was committed last."""

    @property
    def proved_until_s(self) -> float:
        """Until when the committed motion, and standing in the refuge, is proved; infinite: for ever."""
        return self.committed.last.proved_until_s

    @property
    def parts(self) -> tuple[str, ...]:
        """The names of the parts that are known."""
        return tuple(self._known)

    def advance(self, to_s: float) -> None:
        """Sets the clock. Raises `InputError` for a time that has passed, and for one up to which nothing is proved."""
        to_s = number("to_s", to_s, self.clock_s, LONG_S)
        if to_s > self.proved_until_s:
            until = f"up to {self.proved_until_s:.6g} s, until when standing in {self.refuge} is proved"
            raise InputError("to_s", to_s, f"{until}: propose and commit the next motion before")
        self.clock_s = to_s
        self.committed.forget(to_s)
        past = self.committed.at(to_s).history(to_s)
        for name in [name for name, time in past.leaves.items() if time <= to_s and self._moved(name, past)]:
            del self._known[name]

    def see(self, name: object, fields: Mapping[str, Any]) -> None:
        """A part is there, from now on at this place. `fields`: as a task lists them; those that are not given are as
        before, but for its place and its uncertainty. Raises `InputError` naming the field."""
        before = self._known.get(name) if isinstance(name, str) else None
        kept = {} if before is None else before.part
        for key in ("kind", "shape"):
            if before is not None and key in fields and normal(plain(fields[key])) != normal(before.part.get(key)):
                raise InputError(key, fields[key], f"that of the part that is known; call gone({name!r}) before")
        part = plain({**{key: value for key, value in kept.items() if key not in OF_SIGHTING}, **fields, "name": name})
        if not part.keys() & {"pose", "slot"}:
            raise InputError("pose", None, "a pose or a slot: where the part is")
        around = self._around(part)
        if self._holds(part["name"]):
            raise InputError("name", name, "a part that the gripper does not hold now")
        frame = around.frames.laws[around.places[part["name"]][0]]
        seen_s = around.bodies[-1].since_s
        if seen_s is None and frame.uncertainty.speed_m_s > 0.0:
            allowed = f"when the part was there: the speed of {frame.name} is uncertain, so it is known less well later"
            raise InputError("pose.at_s", None, allowed)
        if seen_s is not None and seen_s > self.clock_s:
            raise InputError("pose.at_s", seen_s, f"at most {self.clock_s:.6g} s, the time of the clock")
        if seen_s is not None and before is not None and seen_s < before.seen_s:
            raise InputError("pose.at_s", seen_s, f"{before.seen_s:.6g} s or later, when the part was seen last")
        self._known[part["name"]] = Sighting(part, self.clock_s if seen_s is None else seen_s)

    def gone(self, name: object) -> None:
        """A part is no longer there. Raises `InputError` for one that is not known, and for one that the committed
        motion holds or handles from now on."""
        if not isinstance(name, str) or name not in self._known:
            raise InputError("name", name, f"the name of a part that is known: {choices(self._known, str(name))}")
        for each in self.committed.segments:
            for arrival in each.arrivals:
                if self.clock_s < arrival.until <= each.until_s and each.cell.scene.task[arrival.step].part == name:
                    step = arrival.control_point
                    raise InputError("name", name, f"a part that no step of the committed motion handles: {step} does")
        if self._holds(name):
            raise InputError("name", name, "a part that the gripper does not hold now")
        del self._known[name]

    def propose(self, steps: Sequence[object], at_s: float | None = None) -> NextMotion:
        """The next motion: `steps`, then the way to the refuge. It begins in the state of the committed motion at
        `at_s` (None: where its base ends, if that is far enough ahead; else as soon as planning is over).

        Raises `InputError` naming the field: of the task, or `at_s`.
        """
        from assur.scenes.tasks.next_task import next_task, state_of

        ready_s = self.clock_s + self._planning_s
        if at_s is None:
            at_s = max(_base_ends(self.committed.last), ready_s)
        at_s = number("at_s", at_s, ready_s, LONG_S, f"when planning is over ({1e3 * self._planning_s:g} ms)")
        left = self.committed.at(at_s)
        found = state_of(left.cell, left.motion, left.legs, left.arrivals, left.of_legs, at_s)
        state = self._without_gone(found, left)
        before = left.history(at_s)
        parts = self._parts_at(state, before, at_s)
        task_before = left.judged.task
        written = {part["name"]: part for part in task_before.get("parts", ())}
        task = {"schema": TASK, "parts": parts, "steps": self._with_refuge(steps)}
        if "options" in self._first:
            task["options"] = self._first["options"]
        values = task_before.get("set", {})
        listed = [written[part["name"]] for part in parts if part["name"] in written]
        with raised_as(of_task):
            follows = next_task(self._kept.file, task, state, listed, values)
        follows["set"] = {**values, **follows["set"]}
        if not follows["set"]:
            del follows["set"]
        known = {name: time for name, time in before.handled.items() if name in self._known}
        leaves = {name: time for name, time in before.leaves.items() if name in known}
        made = self._planned(self._number + 1, at_s, follows, History(known, leaves))
        self._number += 1
        self._open[made.number] = made
        return made

    def _without_gone(self, state: EndState, left: Segment) -> EndState:
        """The state at which a plan is left, without how well parts are known that have gone since."""
        gone = {part["name"] for part in left.judged.task.get("parts", ())} - self._known.keys()
        return replace(state, uncertainty={name: each for name, each in state.uncertainty.items() if name not in gone})

    def commit(self, number: object) -> None:
        """Makes a proposal the motion from its start on. Raises `InputError` for one that is not known, was used, has
        no plan, was made from another motion than the one that is committed, or is late; `FaultError` for one in whose
        start the motion would jump."""
        if not isinstance(number, int) or isinstance(number, bool) or not 0 < number <= self._number:
            raise InputError("id", number, "the id of a proposal of this session")
        if number == self._committed:
            raise InputError("id", number, "a proposal that is not committed yet; each is committed once")
        made = self._open.get(number)
        if made is None:
            since = "another one was committed since, so propose again"
            raise InputError("id", number, f"a proposal made from the motion that is committed: {since}")
        if made.segment is None:
            raise InputError("id", number, f"a proposal with a plan; of this one: {made.judged.reason}")
        for name in [made.segment.cell.scene.task[each.step].part for each in made.segment.arrivals]:
            if name is not None and name not in self._known:
                raise InputError("id", number, f"a proposal that handles known parts: {name} is gone")
        if self.clock_s > made.starts_s:
            late = f"{self.clock_s - made.starts_s:.6g} s late, so propose again"
            raise InputError("id", number, f"a proposal up to its decide_by_s, {made.starts_s:.6g} s: {late}")
        self.committed.follow(made.segment)
        self._open.clear()
        self._committed = number

    def _planned(self, number: int, at_s: float, task: Document, before: History) -> NextMotion:
        """A proposal with the outcome of a task that begins at `at_s`."""
        made = judged(self._kept, task)
        segment = None if made.plan is None or made.reason else segment_of(made, made.plan, before)
        ends_s = None if segment is None else _base_ends(segment)
        return NextMotion(number, at_s, ends_s, made, segment)

    def _with_refuge(self, steps: Sequence[object]) -> list[object]:
        return [*plain({"steps": list(steps)})["steps"], {"move": {"to": self.refuge}}]

    def _around(self, part: Document) -> Surroundings:
        """Robot and surroundings with a part that is seen. Raises `InputError` at a field of the part."""
        task = {**self._first, "parts": [part], "steps": self._with_refuge([])}

        def field(field: str) -> str:
            return field.removeprefix("parts[0].").replace("parts[0]", "part")

        with raised_as(lambda error: documented(error).relocated(field)):
            return self._kept.surroundings(task)

    def covered(self, reading: object) -> Coverage:
        """Whether a reading lies within what the committed proof assumes; raises as `reading.covered`."""
        from assur.scenes.session.reading import covered

        return covered(self.committed, reading, self.clock_s)

    def _holds(self, name: str) -> bool:
        """Whether the gripper holds a part now."""
        return self.committed.at(self.clock_s).during(self.clock_s)[0].part == name

    def _moved(self, name: str, before: History) -> bool:
        """Whether the motion has handled a part since it was seen last."""
        return name in self._known and before.handled.get(name, -math.inf) > self._known[name].seen_s

    def _parts_at(self, state: EndState, before: History, at_s: float) -> list[Document]:
        """The parts that are known at an instant: without a place those that the motion has handled since they were
        seen, as they were seen all others; without those that were taken away by then."""
        found = []
        for name, seen in self._known.items():
            if not self._moved(name, before):
                found.append(seen.part)
            elif before.leaves.get(name, math.inf) > at_s and name not in state.gone:
                found.append({key: value for key, value in seen.part.items() if key not in OF_SIGHTING})
        return found


def _base_ends(made: Segment) -> float:
    """When the last step of a plan begins, which is the way to the refuge."""
    last = len(made.cell.scene.task) - 1
    return next((leg.t0 for leg in made.legs if leg.step == last), made.motion.end)


def number(field: str, value: object, least: float, most: float, why: str = "") -> float:
    """A finite number between two bounds. Raises `InputError` for anything else."""
    given = plain({field: value})[field]
    if isinstance(given, bool) or not isinstance(given, int | float) or not math.isfinite(given):
        raise InputError(field, value, "a finite number")
    if not least <= given <= most:
        bounds = f"{least:.6g} to {most:.6g}"
        raise InputError(field, value, f"{bounds}: {why}" if why else bounds)
    return float(given)

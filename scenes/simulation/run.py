"""One run: a session against the streams of its cell, with every motion planned, proved and checked."""

from __future__ import annotations

import heapq
import math
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from assur.planner.errors import FaultError, InputError
from assur.planner.model.outcome import TRACKING
from assur.scenes.session.recorded import RecordedCell
from assur.scenes.session.session import RunningCell
from assur.scenes.simulation.cell import SimulatedCell, stands_in
from assur.scenes.simulation.filling import PATIENCE_S, Filling, FreeSlot
from assur.scenes.simulation.tally import Cycle, Tally
from assur.scenes.streams.arrivals import ArrivingPart, arrivals

if TYPE_CHECKING:
    from assur.planner.selection.next_part import Choice
    from assur.scenes.session.committed import Segment
    from assur.scenes.session.recorded import Record
    from assur.scenes.session.session import NextMotion
    from assur.scenes.tasks.kept_cell import KeptCellFile

Document = dict[str, Any]
RETRY_S = 0.5
"""After so long a part that could not be planned is tried again, s."""
LONGEST_M = 5_000.0
"""After a conveyor has gone so far places on it are counted anew: a claim has places up to 10,000 m, m."""
RESERVE_S = 0.05
"""So long before standing is no longer proved the next motion is there, s."""


@dataclass(frozen=True)
class _Known:
    """A part that was seen, and its stream by its number."""

    part: ArrivingPart
    number: int

    @property
    def grid(self) -> str:
        """The slots to which it goes; none of a carrier."""
        return self.part.kind.to or ""


def coming_parts(cell: SimulatedCell, seed: int, until_s: float) -> list[_Known]:
    """The parts of all streams, in the order in which they are known. Raises `InputError` for a stream that brings
    nothing in that time."""
    coming = []
    for number, stream in enumerate(cell.streams):
        parts = arrivals(stream, seed, until_s)
        if not parts:
            allowed = f"so long that a part of each stream is known: with seed {seed} none of {stream.name} is"
            raise InputError("minutes", until_s / 60.0, allowed)
        coming += [(part.known_s, number, k, _Known(part, number)) for k, part in enumerate(parts)]
    return [each[-1] for each in sorted(coming, key=lambda each: each[:3])]


class Run:
    """A run of a cell with a seed, until `until_s`. `step` goes on to the next decision; `tally` has what happened."""

    def __init__(
        self, cell: SimulatedCell, seed: int, until_s: float, planning_ms: float, record: Record | None = None
    ) -> None:
        """`record` gets the calls of the session. Raises `InputError` for a stream that brings nothing in that time,
        and as `RunningCell`."""
        self._cell, self._until_s, self._planning_s = cell, until_s, planning_ms / 1e3
        coming = coming_parts(cell, seed, until_s)
        most_s = cell.stay_s / 4.0 - RESERVE_S
        if self._planning_s > most_s:
            allowed = f"at most {1e3 * most_s:.4g} ms: standing is proved for {cell.stay_s:g} s (options.stay_safe_s)"
            raise InputError("planning_ms", planning_ms, allowed)
        self.session, self._since_s = _begun(cell, planning_ms, record), 0.0
        self._planning_ms, self._record = planning_ms, record
        self._coming = deque(coming)
        self._leaving: list[tuple[float, str, bool]] = []
        """When a part is out of reach, or the exchange of a grid is over, s; its name; and whether it is a grid."""
        self._candidates: dict[str, _Known] = {}
        self._filling = Filling(cell)
        self._refused_s: dict[str, float] = {}
        self._taken: set[str] = set()
        self._cycle: Cycle | None = None
        picked = [each for each in self._coming if each.grid]
        ends = [(each.part, cell.streams[each.number]) for each in picked]
        self.tally = Tally([(part.name, part.passes_s(of.window_m[1], of.speed_m_s)) for part, of in ends])
        self._stand(first=True)  # from now on standing is proved against what is not seen, too

    @property
    def over(self) -> bool:
        return self.session.clock_s >= self._until_s

    def step(self) -> None:
        """To the next decision, or by one wait. Raises `FaultError` for a motion that the checker refuses."""
        if self._is_far:
            self._to(max(self.session.clock_s, self.session.committed.last.motion.end))
            self._count_anew()
        self._stand_ready()
        now_s = self.session.clock_s
        free_s = self._free_s()
        self._forget_missed(free_s)
        ready, later_s = self._ready()
        if not ready:
            refused = any(name in self._refused_s for name in self._candidates)
            self._wait("refused" if refused else "unseen" if self._candidates else "part", later_s)
            return
        ready, slots, slot_s = self._with_slots(free_s, ready)
        if not ready:
            self._wait("slot", min(later_s, slot_s))
            return
        choices = self._ranked(free_s, ready, slots)
        if not choices:
            self._wait("reach", later_s)
            return
        best_s = choices[0].waits_until_s - PATIENCE_S
        if best_s > free_s + RETRY_S:
            self._wait("part", min(later_s, best_s))
            return
        found = [(choice, *self._slot(choice)) for choice in choices]
        if all(slot is None for _, slot, _ in found):
            self._wait("slot", min(later_s, *[slot_s for _, _, slot_s in found]))
            return
        for choice, slot, _ in found:
            if slot is None:
                continue
            self._stand_ready()
            made = self._proposed(self._transfer(choice, slot))
            if made.segment is not None:
                self._commit(made, made.segment, choice, slot)
                return
            answer = made.judged.answer
            self.tally.refused(str(answer["reason"]), str(answer["sentence"]), self.session.clock_s)
            self._refused_s[choice.part] = self.session.clock_s + RETRY_S
        self.tally.waits(now_s, "refused")

    # What may be next.

    def _free_s(self) -> float:
        """When the next motion begins: where the base of the committed one ends, or when planning is over."""
        ready_s = self.session.clock_s + self._planning_s
        return ready_s if self._cycle is None else max(self._cycle.free_s, ready_s)

    def _ready(self) -> tuple[list[_Known], float]:
        """The parts that are clear of what is not seen and were not refused just now, and when the next one will
        be."""
        now_s, found, later_s = self.session.clock_s, list[_Known](), math.inf
        for each in self._candidates.values():
            clear_s = max(self._cell.clear_s(each.number, each.part), self._refused_s.get(each.part.name, -math.inf))
            if clear_s <= now_s:
                found.append(each)
            else:
                later_s = min(later_s, clear_s)
        return found, later_s

    def _with_slots(self, free_s: float, ready: list[_Known]) -> tuple[list[_Known], dict[str, int], float]:
        """The parts for which there is a slot if their cycles are as long as the mean one; the number of that slot in
        each grid; and when there may be one for the others."""
        ends_s, slots, later_s = free_s + self._cell.chooser.nominal_s, dict[str, int](), math.inf
        for grid in dict.fromkeys(each.grid for each in ready):
            slot, ready_s = self._filling.first(grid, self.session.clock_s, ends_s)
            if slot is None:
                later_s = min(later_s, ready_s)
            else:
                slots[grid] = slot.number
        return [each for each in ready if each.grid in slots], slots, later_s

    def _slot(self, choice: Choice) -> tuple[FreeSlot | None, float]:
        """The slot for a part that is put down within a mean cycle after it is met; and when there may be one, if there
        is none."""
        ends_s = choice.meets_s + self._cell.chooser.nominal_s
        return self._filling.first(self._candidates[choice.part].grid, self.session.clock_s, ends_s)

    def _ranked(self, free_s: float, ready: list[_Known], slots: dict[str, int]) -> tuple[Choice, ...]:
        place, slot = None, 0
        if self._cycle is not None and free_s <= self._cycle.free_s:
            place, slot = self._cycle.grid, self._cycle.slot
        known = [(self._cell.streams[each.number].name, each.part) for each in ready]
        q = self.session.committed.at(free_s).state(free_s)[0].tolist()
        return self._cell.chooser.ranked(free_s, place, slot, q, slots, known)

    def _transfer(self, choice: Choice, slot: FreeSlot) -> list[Document]:
        window = list(self._cell.streams[self._candidates[choice.part].number].window_m)
        return self._filling.steps(choice.part, window, slot)

    def _forget_missed(self, free_s: float) -> None:
        """Parts that have left their window are no longer candidates; they stay bodies while the arm reaches them."""
        for name, each in [*self._candidates.items()]:
            stream = self._cell.streams[each.number]
            if each.part.passes_s(stream.window_m[1], stream.speed_m_s) <= free_s:
                del self._candidates[name]
                self._refused_s.pop(name, None)

    # The next motion.

    def _proposed(self, steps: list[Document]) -> NextMotion:
        """The proposal of these steps, made against what is not seen now; the clock is then when planning is over.
        Raises `FaultError` for a search that the time of day ended."""
        session, now_s = self.session, self.session.clock_s
        for unseen in self._cell.unseen:
            session.see(unseen.name, unseen.fields(now_s))
        made = session.propose(steps, self._free_s() if steps else None)
        self.tally.plans += 1
        if made.judged.outcome.cut_by_clock:
            raise FaultError(f"at {now_s:.6g} s a search took longer than its budget: no result would be repeatable")
        self._events(now_s + self._planning_s)
        verdict = made.judged.verdict
        if verdict is not None and not verdict.ok:
            what = "; ".join(each.what for each in verdict.findings)
            raise FaultError(f"the checker refuses the motion that begins at {made.starts_s:.6g} s: {what}")
        if made.segment is not None:
            until_s = min(now_s + unseen.proved_s for unseen in self._cell.unseen)
            if made.segment.proved_until_s > until_s:
                raise FaultError(
                    f"a motion is proved until {made.segment.proved_until_s:.6g} s, what is not seen "
                    f"until {until_s:.6g} s"
                )
        return made

    def _follow(self, made: NextMotion, segment: Segment) -> None:
        """Commits a motion that the checker has accepted."""
        self.tally.checked += 1
        self.session.commit(made.number)
        self.tally.follows(segment)

    def _commit(self, made: NextMotion, segment: Segment, choice: Choice, slot: FreeSlot) -> None:
        self._follow(made, segment)
        del self._candidates[choice.part]
        self._refused_s.pop(choice.part, None)
        self._taken.add(choice.part)
        picked, placed = segment.arrivals[:2]
        own = [leg for leg in segment.legs if leg.step == placed.step]
        begins_s = next(leg.t0 for leg in own if leg.kind in TRACKING)
        ends_s = begins_s if made.base_ends_s is None else made.base_ends_s
        free_s = max(ends_s, placed.until + segment.cell.scene.execution.start_tolerance_s)
        cycle = choice.part, slot.grid, slot.number, made.starts_s, picked.until, placed.until, ends_s, free_s
        self._cycle = Cycle(*cycle)
        self.tally.cycles.append(self._cycle)
        exchanged_s = self._filling.put(slot, choice.part, placed.until)
        if exchanged_s is not None:
            heapq.heappush(self._leaving, (exchanged_s, slot.grid, True))
        decide_s = placed.until if exchanged_s == placed.until else begins_s
        self._to(min(max(decide_s, self.session.clock_s), self._until_s))

    # The clock.

    def _wait(self, reason: str, until_s: float) -> None:
        """To the next part that is seen, or to `until_s`: nothing can be done before."""
        now_s = self.session.clock_s
        self.tally.waits(now_s, reason)
        first_s = self._coming[0].part.known_s if self._coming else math.inf
        self._to(min(max(min(first_s, until_s), now_s + self._planning_s), self._until_s))

    def _stand_ready(self) -> None:
        """Standing is proved for long enough that a motion can be planned now."""
        self._to(self.session.clock_s)

    def _to(self, to_s: float) -> None:
        """Goes on to a time. Before standing is no longer proved the next stand in the refuge is."""
        more_s = 3.0 * self._planning_s + RESERVE_S
        while self.session.proved_until_s < to_s + more_s:
            self._events(max(self.session.clock_s, min(to_s, self.session.proved_until_s - more_s)))
            stands = self.session.clock_s >= self.session.committed.last.motion.end
            (self._count_anew if self._is_far and stands else self._stand)()
        if to_s > self.session.clock_s:
            self._events(to_s)

    @property
    def _is_far(self) -> bool:
        """Whether a conveyor has gone far since places on it were counted anew."""
        fastest = max(stream.speed_m_s for stream in self._cell.streams)
        return fastest * (self.session.clock_s - self._since_s) > LONGEST_M

    def _count_anew(self) -> None:
        """Another session goes on where the arm stands in the refuge: in the same cell, but the frames of the streams
        are stated for now. Until its first motion begins the arm stands where the session before has proved it."""
        before, self._since_s = self.session, self.session.clock_s
        listed = before.propose([], self._since_s + self._planning_s).judged.task
        start = {**listed["start"], "at_s": self._since_s}
        kept = self._cell.kept_from(self._since_s)
        self.session = _running(self._record, kept, start, self._cell.refuge, self._planning_ms)
        for part in listed["parts"]:
            seen = {key: value for key, value in part.items() if key != "name"}
            if "pose" in seen:
                seen["pose"] = self._riding(seen["pose"], before)
            self.session.see(part["name"], seen)
        self._stand()
        if self.session.committed.last.motion.start > before.proved_until_s:
            raise FaultError(f"at {before.proved_until_s:.6g} s standing in the refuge is no longer proved")

    def _riding(self, pose: Document, before: RunningCell) -> Document:
        """The pose of a part in a session `before`, with a time: that of the clock, if it has none and rides on the
        conveyor of a stream, because it was put down in a slot there."""
        speeds = {stream.frame: stream.speed_m_s for stream in self._cell.streams}
        if pose.get("frame") not in speeds or "at_s" in pose:
            return pose
        (x, *rest), since_s = pose["at_m"], self._since_s
        stated_s = before.committed.last.cell.scene.frames[pose["frame"]].law.numbers.at_time
        return {**pose, "at_m": [x + speeds[pose["frame"]] * (since_s - stated_s), *rest], "at_s": since_s}

    def _stand(self, *, first: bool = False) -> None:
        """Commits the way to the refuge alone. Raises `InputError` where standing there is not proved: the `first` time
        of a run beside what is not seen yet, and later beside what has come, or is known less well."""
        made = self._proposed([])
        if made.segment is None:
            beside = "what is not seen yet" if first else f"what is there at {made.starts_s:.6g} s"
            allowed = f"a position in which the arm can stand beside {beside}: {made.judged.reason}"
            raise InputError("refuge", self._cell.refuge, allowed)
        self._follow(made, made.segment)

    def _events(self, to_s: float) -> None:
        """What happens up to a time: parts are seen, others are out of reach of the arm, full grids are exchanged."""
        while True:
            seen_s = self._coming[0].part.known_s if self._coming else math.inf
            left_s = self._leaving[0][0] if self._leaving else math.inf
            if min(seen_s, left_s) > to_s:
                break
            if seen_s <= left_s:
                self._see(self._coming.popleft())
            else:
                self.session.advance(max(left_s, self.session.clock_s))
                _, name, is_grid = heapq.heappop(self._leaving)
                for part in self._filling.exchanged(name) if is_grid else self._left(name):
                    self.session.gone(part)
        self.session.advance(to_s)

    def _left(self, name: str) -> list[str]:
        """What leaves where a part of a stream is out of reach: itself, if it was not picked, and the parts in its
        slots."""
        if name in self._taken:
            self._taken.remove(name)
            return []
        self._candidates.pop(name, None)
        return [name, *self._filling.leaves(name)]

    def _see(self, each: _Known) -> None:
        part, stream = each.part, self._cell.streams[each.number]
        self.session.advance(max(part.known_s, self.session.clock_s))
        pose = {"frame": stream.frame, "at_m": [stream.seen_m, part.y_m, stream.at_m[2]], "yaw_rad": part.yaw_rad}
        self.session.see(part.name, {"kind": part.kind.name, "pose": {**pose, "at_s": part.seen_s}})
        if stream.brings_carriers:
            self._filling.comes(part, each.number)
        else:
            self._candidates[part.name] = each
            self.tally.known += 1
        leaves_s = part.passes_s(self._cell.leaves_m[each.number], stream.speed_m_s)
        heapq.heappush(self._leaving, (leaves_s, part.name, False))


def _running(
    record: Record | None, kept: KeptCellFile, start: Document, refuge: str, planning_ms: float
) -> RunningCell:
    """A session, whose calls `record` gets."""
    own = kept, start, refuge, planning_ms
    return RunningCell(*own) if record is None else RecordedCell(record, *own)


def _begun(cell: SimulatedCell, planning_ms: float, record: Record | None) -> RunningCell:
    """The session at the begin of a run. Raises `InputError` for a refuge in which the arm cannot stand."""
    with stands_in(cell.refuge, cell.kept.file.written):
        return _running(record, cell.kept, cell.start, cell.refuge, planning_ms)

"""The request that a cell and a task make together, and where each part of it was written."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Sequence

from assur.scenes.bounds import MAX_SLOTS
from assur.scenes.faults import DocumentError, Gathered, Refused, choices, dotted, located, written_key
from assur.scenes.schema.in_parts import Unread
from assur.scenes.schema.normal import normal
from assur.scenes.schema.read import read
from assur.scenes.schema.request import SCHEMA
from assur.scenes.schema.task_steps import TransferDocument
from assur.scenes.tasks.grids import counts, pose_of_slot
from assur.scenes.tasks.origins import OF_CELL, OF_TASK, Document, Joined, Origins, Path, within_document
from assur.scenes.units import si_key

AROUND = ("robot", "frames", "neighbours", "execution", "carry")
"""Fields of a cell that are fields of a request."""
MADE = ("bodies", "task")
"""Lists of a request that are made of those of a cell and a task."""
NO_START = (
    "the state at the start, which must be given; a task without it begins where a plan ends: with --continue of plan, "
    "check or report, or next_task of an answer; other commands take its plan file alone"
)
"""What a task without a start is refused with."""
SHOWN = 3
"""Parts that are named in a message, at most."""
ENDS = {"move": "to", "follow": "to", "place": "to", "trace": "start"}
"""Key of the pose of each step that has one: a position's name may be in its place."""
HANDLING = {"approach": {"m": 0.03}, "dwell_s": 0.1, "depart": {"m": 0.03}}
"""How a part is picked and placed where neither the step, the slots nor the kind state it."""
HANDLED, GRASP, REST = ("approach", "dwell_s", "depart"), ("grasp_m", "grasp_yaw_rad"), ("contact_with",)
"""Fields of picks and places that kinds or slots may state; of picks alone; of places alone."""


class RequestOfTask:
    """Makes one request. `cell` and `task` are as they were written, with `Unread` in place of the parts that their
    models refuse. `faults` has those parts; a value that is made of one of them, or has a fault itself, is `Unread`."""

    def __init__(self, cell: Document, task: Document, values: Origins, faults: Gathered) -> None:
        self.cell, self.task, self.faults, self._values = cell, task, faults, values
        self.origins: dict[Path, Path] = {}
        self.kinds: Document = cell.get("kinds", {})
        self.positions: Document = cell.get("positions", {})
        self.grids: Document = cell.get("slots", {})
        self.transfers = Counter[str]()
        self.parts: dict[str, Document] = {}
        self.slot_of: dict[str, tuple[str, int]] = {}
        """The slot in which a part lies, while the steps are read in order."""

    def made(self) -> Joined:
        """The request. Raises `DocumentError`."""
        cell, task = self.cell, self.task
        with located({OF_CELL: cell, OF_TASK: task}):
            for name, grid in self.grids.items():
                if not isinstance(grid, Unread) and math.prod(counts(grid)) > MAX_SLOTS:
                    self.faults.add(Refused(f"at most {MAX_SLOTS:,} slots in all"), OF_CELL, "slots", name, "count")
            for name in self.positions.keys() & self.grids.keys():
                self.faults.add(Refused("a name that no position has"), OF_CELL, "slots", name)
            request: Document = {"schema": SCHEMA}
            for key in AROUND:
                if key in cell:
                    request[key] = cell[key]
                    self.origins[key,] = OF_CELL, key
            request["bodies"] = self._bodies()
            request["start"] = self._start()
            request["options"] = self._options()
            request["task"] = self._steps()
            made = Joined(request, self.origins, self._values, cell, task)
            if self.faults.faults:
                from assur.scenes.reading.partly import faults_of

                for error in faults_of(request):
                    if error.field not in MADE:  # their lists have faults of their own, or are right when others are
                        self.faults.add(made.relocated(error))
                self.faults.settle()
        return made

    def _options(self) -> object:
        """Those of the cell and those of the task. None may be in both."""
        own, given = self.cell.get("options", {}), self.task.get("options", {})
        if isinstance(own, Unread) or isinstance(given, Unread):
            return Unread()
        for key in given:
            if written_key(own, (si_key(key) or (key,))[0]) is not None:
                self.faults.add(Refused("none: the cell states it, and `set` changes it"), OF_TASK, "options", key)
        self.origins["options",] = OF_TASK, "options"
        self.origins |= {("options", key): (OF_CELL, "options", key) for key in own}
        return {**own, **given}

    def _start(self) -> object:
        """The state at the begin; a position's name may be in place of the pose of the tool."""
        if "start" not in self.task:
            self.faults.add(Refused(NO_START), OF_TASK, "start")
            return Unread()
        start, where = self.task["start"], (OF_TASK, "start")
        self.origins["start",] = where
        if isinstance(start, Unread):
            return start
        if isinstance(start.get("tool"), str):
            start = {**start, "tool": self._position(start["tool"], (*where, "tool"), ("start", "tool"))}
        return dict(start)

    # Parts are bodies of the request, behind those of the cell.

    def _bodies(self) -> list[Document | Unread]:
        bodies = list(self.cell.get("bodies", ()))
        self.origins |= {("bodies", i): (OF_CELL, "bodies", i) for i in range(len(bodies))}
        for k, part in enumerate(self.task.get("parts", ())):
            at, where = ("bodies", len(bodies)), (OF_TASK, "parts", k)
            self.origins[at] = where
            if isinstance(part, Unread):
                bodies.append(part)
                continue
            self.parts[part["name"]] = part
            bodies.append(self._body(part, at, where))
        return bodies

    def _body(self, part: Document, at: Path, where: Path) -> Document:
        """A part as a body: what it does not state it has of its kind."""
        body = {key: value for key, value in part.items() if key not in ("kind", "slot")}
        kind = part.get("kind")
        if kind is not None and kind not in self.kinds:
            self.faults.add(Refused(f"one of the kinds: {choices(self.kinds, kind)}"), *where, "kind")
            body["shape"] = Unread()
        elif kind is not None and isinstance(self.kinds[kind], Unread):
            body["shape"] = Unread()
        elif kind is not None:
            for key in ("shape", "mass_kg", "yaw_symmetry", "uncertainty"):
                if key in self.kinds[kind] and key not in body:
                    body[key] = self.kinds[kind][key]
                    self.origins[(*at, key)] = OF_CELL, "kinds", kind, key
        if "slot" in part:
            ((grid, number),) = part["slot"].items()
            taken, number = self._taken(grid), int(number)
            pose = self._slot_pose(grid, number, (*where, "slot"))
            if number in taken:
                self.faults.add(Refused(f"a slot that is free: {self._stays(taken[number])}"), *where, "slot", grid)
            self.slot_of[part["name"]] = grid, number
            body["pose"] = pose
            self.origins[(*at, "pose")] = OF_CELL, "slots", grid
        return body

    def _taken(self, grid: str) -> dict[int, str]:
        """The slots of a grid in which a part lies now, and the part."""
        return {number: part for part, (name, number) in self.slot_of.items() if name == grid}

    def _stays(self, part: str) -> str:
        """That a part is in a slot, and, of one of a plan that is taken away later, until when."""
        at_s = self._values.carried.gone_at_s.get(part)
        if at_s is None:
            return f"{part} is in it"
        later = f"it is taken away at {at_s:.3f} s, after the end of the plan"
        return f"{part} is in it; {later}, so in this task it stays. A plan that ends later leaves the slot free"

    def _slot_pose(self, grid: str, number: object, where: Path) -> Document | Unread:
        """The pose of a slot; `Unread`, and a fault, where there is none."""
        if grid not in self.grids:
            self.faults.add(Refused(f"the name of slots: {choices(self.grids, grid)}"), *where)
            return Unread()
        if isinstance(self.grids[grid], Unread):
            return Unread()
        if "kind" in self.grids[grid]:
            allowed = "slots in a frame or relative to a body: those on a kind come with its parts, in `assur simulate`"
            self.faults.add(Refused(allowed), *where)
            return Unread()
        most = math.prod(counts(self.grids[grid]))
        if not (isinstance(number, int) and not isinstance(number, bool) and 1 <= number <= most):
            self.faults.add(Refused(f"the number of a slot, 1 to {most}"), *where, grid)
            return Unread()
        return pose_of_slot(normal(self.grids[grid]), number)

    def _position(self, name: str, where: Path, at: Path, grids: Collection[str] = ()) -> object:
        """The pose of a named position; `Unread`, and a fault, where there is none. `grids`: what the name could have
        been as well."""
        if name not in self.positions:
            kinds = "positions and slots" if grids else "positions"
            self.faults.add(Refused(f"one of the {kinds}: {choices([*self.positions, *grids], name)}"), *where)
            return Unread()
        self.origins[at] = OF_CELL, "positions", name
        return self.positions[name]

    # Steps: names of positions and slots become poses, and what a pick or a place leaves out it has of its kind and its
    # slots. A transfer is a pick and a place for each part.

    def _steps(self) -> list[Document | Unread]:
        steps: list[Document | Unread] = []
        for i, step in enumerate(self.task["steps"]):
            where = (OF_TASK, "steps", i)
            if isinstance(step, Unread):
                steps.append(step)
                continue
            kind = next(iter(step), "")
            own = step.get(kind)
            if kind == "transfer" and isinstance(own, dict):
                for key in [key for key in step if key != kind]:
                    self.faults.add(Refused("none: a step is one thing, and transfer stands alone"), *where, key)
                steps += self._transfer(own, (*where, kind), len(steps))
                continue
            at = ("task", len(steps))
            self.origins[at] = where
            if isinstance(own, dict):
                step = {**step, kind: self._step(kind, own, (*where, kind), (*at, kind))}
            steps.append(step)
        return steps

    def _transfer(self, own: Document, where: Path, count: int) -> Sequence[Document | Unread]:
        """A pick and a place for each part, in this order, to the next free slots."""
        try:
            with within_document(dotted(where)):
                stated: TransferDocument = read(TransferDocument, own)
        except DocumentError as error:
            self.faults.add(error)
            return [Unread(own)]
        steps: list[Document] = []
        for k, part in enumerate(stated.parts):
            if part in stated.parts[:k]:
                allowed = f"a part that is not in the list before; entry {stated.parts.index(part)} is this one"
                self.faults.add(Refused(allowed), *where, "parts", k)
                continue
            window = {key: own[key] for key in own if key.startswith("window_")}
            gone = {key: own[key] for key in own if key.startswith("gone_after_")}
            self.transfers[part] += 1
            name = part if self.transfers[part] == 1 else f"{part}-{self.transfers[part]}"
            for kind, more in (("pick", window), ("place", {"to": stated.to, **gone})):
                given = {"part": part, "name": f"{kind}-{name}", **more}
                at = ("task", count + len(steps))
                self.origins[at] = self.origins[(*at, kind)] = where
                self.origins[(*at, kind, "part")] = self.origins[(*at, kind, "name")] = (*where, "parts", k)
                self.origins |= {(*at, kind, key): (*where, key) for key in more if key != "to"}
                steps.append({kind: self._step(kind, given, where, (*at, kind))})
        return steps

    def _step(self, kind: str, own: Document, where: Path, at: Path) -> Document:
        """A step of a request. `where` it was written, and `at` which place it is in the request."""
        made, part = dict(own), own.get("part")
        end = ENDS.get(kind)
        grid = self._end(made, end, part, where, at) if end in made else None
        if kind in ("pick", "place") and isinstance(part, str):
            for source, origin in self._defaults(part, grid if kind == "place" else None):
                for key, value in source.items():
                    si = (si_key(key) or (key,))[0]
                    allowed = si in HANDLED or (kind == "pick" and si in GRASP) or (kind == "place" and si in REST)
                    if allowed and written_key(made, si) is None:
                        made[key] = value
                        self.origins[(*at, key)] = (*origin, key)
            made = {**{key: each for key, each in HANDLING.items() if written_key(made, key) is None}, **made}
            if kind == "pick":
                self.slot_of.pop(part, None)
                if written_key(made, "grasp_m") is None:
                    made["grasp_m"] = [0.0, 0.0, 0.0]
        return made

    def _defaults(self, part: str, grid: str | None) -> Sequence[tuple[Document, Path]]:
        """What a pick or a place may take its fields from, and where these are written: slots, kind, and ours."""
        kind = self.parts.get(part, {}).get("kind")
        found: list[tuple[Document, Path]] = []
        if grid is not None:
            found.append((self.grids[grid], (OF_CELL, "slots", grid)))
        if kind in self.kinds and not isinstance(self.kinds[kind], Unread):
            found.append((self.kinds[kind], (OF_CELL, "kinds", kind)))
        return found

    def _end(self, made: Document, end: str, part: object, where: Path, at: Path) -> str | None:
        """Puts a pose in place of a name of a position or of slots. Returns the name of the slots."""
        to, place = made[end], (*where, end)
        slot = to.get("slot") if isinstance(to, dict) else None
        if isinstance(to, str) and to in self.grids and isinstance(part, str):
            slot = self._next_slot(to, place)
        elif isinstance(to, str):
            made[end] = self._position(to, place, (*at, end), self.grids if isinstance(part, str) else {})
            return None
        if slot is None:
            return None
        if not (isinstance(slot, dict) and len(slot) == 1 and isinstance(next(iter(slot)), str)):
            self.faults.add(Refused("the name of slots and a number, as in {box: 3}"), *place, "slot")
            made[end] = Unread()
            return None
        ((grid, number),) = slot.items()
        if isinstance(to, dict):
            for key in [key for key in to if key != "slot"]:
                self.faults.add(Refused("none: a slot has its own pose"), *place, key)
            place = (*place, "slot")
        made[end] = pose = self._slot_pose(grid, number, place)
        if isinstance(pose, Unread):
            return None
        if isinstance(part, str):
            taken = self._taken(grid)
            if number in taken:
                self.faults.add(Refused(f"a slot that is free: {self._stays(taken[number])}"), *place)
            if written_key(made, "gone_after_s") is None:
                self.slot_of[part] = grid, number
        self.origins[(*at, end)] = OF_CELL, "slots", grid
        return str(grid)

    def _next_slot(self, grid: str, where: Path) -> Document:
        """The first free slot; any of slots that have a fault."""
        if isinstance(self.grids[grid], Unread):
            return {grid: 1}
        taken, many = self._taken(grid), math.prod(counts(self.grids[grid]))
        free = next((number for number in range(1, many + 1) if number not in taken), None)
        if free is None:
            gone = {part: f"{part} (until {at:.3f} s)" for part, at in self._values.carried.gone_at_s.items()}
            by = ", ".join([gone.get(part, part) for part in taken.values()][:SHOWN] + ["…"] * (len(taken) > SHOWN))
            free_by = "a part that is taken away (`gone_after_ms`) leaves its slot when it is gone"
            self.faults.add(Refused(f"slots with one that is free: all {many} are taken, by {by}; {free_by}"), *where)
        return {grid: free or 1}

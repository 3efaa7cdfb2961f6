"""The request that a cell file and a task file make together, and where each part of it was written.

The cell and the task stay as they were written, in their units; the request is made of their own values. So a fault of
the request is a fault at the place in the cell or the task from which the value came (`Joined.relocated`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_SLOTS
from assur.scenes.faults import (
    WHOLE,
    DocumentError,
    Gathered,
    Refused,
    choices,
    documented,
    dotted,
    located,
    written_key,
)
from assur.scenes.schema.cell_file import CellDocument, TaskDocument, TransferDocument
from assur.scenes.schema.normal import normal, plain
from assur.scenes.schema.read import read
from assur.scenes.schema.request import SCHEMA
from assur.scenes.set_values import GIVEN, Changed
from assur.scenes.tasks.grids import counts, pose_of_slot
from assur.scenes.units import si_key

Document = dict[str, Any]
Path = tuple[str | int, ...]
AROUND = ("robot", "frames", "neighbours", "execution", "carry")
"""Fields of a cell that are fields of a request."""
ENDS = {"move": "to", "follow": "to", "place": "to", "trace": "start"}
"""Key of the pose of each step that has one: a position's name may be in its place."""
HANDLING = {"approach": {"m": 0.03}, "dwell_s": 0.1, "depart": {"m": 0.03}}
"""How a part is picked and placed where neither the step, the slots nor the kind state it."""
HANDLED, GRASP, REST = ("approach", "dwell_s", "depart"), ("grasp_m", "grasp_yaw_rad"), ("contact_with",)
"""Fields of picks and places that kinds or slots may state; of picks alone; of places alone."""
OF_CELL, OF_TASK = "cell", "task"
"""First part of the fields of a fault: the document that it is in."""
OWN = ("start", "parts", "steps", "options")
"""Fields of a task whose values can be set there."""


class CellFile:
    """The document of a cell, read once for many tasks: valid by its model, and as it was `written`."""

    def __init__(self, document: object) -> None:
        """Raises `DocumentError` whose fields begin with `cell`."""
        with within_document(OF_CELL):
            self.written: Document = plain(document)
            self.valid: CellDocument = read(CellDocument, self.written)


def joined(cell: object, task: object, given: Mapping[str, object] | None = None) -> Joined:
    """The request of a task in a cell, a document or a `CellFile`. Raises `DocumentError` whose fields begin with
    `cell`, `task`, or `GIVEN`.

    `given`: values that are set last, by their paths. A path that begins with a field of `OWN` is one of the task, but
    for an option that the cell states; all others are paths of the cell.
    """
    origins = _Origins()
    with origins:
        with within_document(OF_TASK):
            asked = plain(task)
        with within_document(OF_CELL):
            written = cell.written if isinstance(cell, CellFile) else plain(cell)
        of_cell, of_task = shared(given or {}, written)
        if of_task and isinstance(asked, dict):
            asked = origins.changed(OF_TASK, asked, of_task, GIVEN)
        with within_document(OF_TASK):
            stated: TaskDocument = read(TaskDocument, asked)
        changed = written
        for values, mark in ((plain(stated.set), f"{OF_TASK}.set."), (of_cell, GIVEN)):
            if values and isinstance(changed, dict):
                changed = origins.changed(OF_CELL, changed, values, mark)
        if changed is not written or not isinstance(cell, CellFile):
            with within_document(OF_CELL):
                read(CellDocument, changed)
        return _Join(changed, asked, origins).made()


def shared(given: Mapping[str, object], cell: object) -> tuple[Document, Document]:
    """The values that are set in the cell, and those that are set in the task."""
    own = cell.get("options") if isinstance(cell, dict) else None
    stated = own if isinstance(own, dict) else {}
    of_cell: Document = {}
    of_task: Document = {}
    for path, value in given.items():
        first, _, rest = path.partition(".")
        key = rest.partition(".")[0]
        in_cell = first == "options" and written_key(stated, (si_key(key) or (key,))[0]) is not None
        (of_task if first.partition("[")[0] in OWN and not in_cell else of_cell)[path] = value
    return of_cell, of_task


class _Origins:
    """Where values of cell and task were set. A fault inside has its place there."""

    def __init__(self) -> None:
        self._changed: list[tuple[str, Changed]] = []

    def changed(self, name: str, document: Document, values: Document, mark: str) -> Document:
        """The document of that name with these values."""
        made = Changed(document, values, mark)
        self._changed.insert(0, (f"{name}.", made))
        return made.document

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, InputError) and self._changed:
            raise documented(error).relocated(self.field) from error

    def field(self, field: str) -> str:
        """The place of a field of the cell or the task."""
        for name, changed in self._changed:
            if field.startswith(name) and (origin := changed.origin(field.removeprefix(name))) is not None:
                return origin
        return field


class within_document:
    """A fault inside is one of the document of that name."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, InputError):
            raise documented(error).relocated(self._field) from error

    def _field(self, field: str) -> str:
        return self._name if field == WHOLE else f"{self._name}.{field}"


class Joined:
    """A `request`, and where its parts were written: `origins`, from the path of a part to its path in the cell or the
    task, which begins with `cell` or `task`."""

    def __init__(self, request: Document, origins: dict[Path, Path], values: _Origins, cell: Document) -> None:
        """`cell`: the document of the cell, with the values that were set in it."""
        self.request, self.cell, self._values, self._paths = request, cell, values, origins

    @cached_property
    def _origins(self) -> dict[str, str]:
        return {dotted(path): dotted(origin) for path, origin in self._paths.items()}

    def relocated(self, error: InputError) -> DocumentError:
        """A fault of the request as one of the cell or the task."""
        return documented(error).relocated(self.origin)

    def origin(self, field: str) -> str:
        """The field of the cell or the task from which a field of the request came."""
        head = field
        while head not in self._origins and head:
            head = head[: max(head.rfind("."), head.rfind("["), 0)]
        return self._values.field(self._origins[head] + field[len(head) :]) if head else field


class _Join:
    """Makes one request. `cell` and `task` are valid by their models and as they were written."""

    def __init__(self, cell: Document, task: Document, values: _Origins) -> None:
        self.cell, self.task, self.faults, self._values = cell, task, Gathered(), values
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
                if math.prod(counts(grid)) > MAX_SLOTS:
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
            self.faults.settle()
        return Joined(request, self.origins, self._values, cell)

    def _options(self) -> Document:
        """Those of the cell and those of the task. None may be in both."""
        own, given = self.cell.get("options", {}), self.task.get("options", {})
        for key in given:
            if written_key(own, (si_key(key) or (key,))[0]) is not None:
                self.faults.add(Refused("none: the cell states it, and `set` changes it"), OF_TASK, "options", key)
        self.origins["options",] = OF_TASK, "options"
        self.origins |= {("options", key): (OF_CELL, "options", key) for key in own}
        return {**own, **given}

    def _start(self) -> Document:
        """The state at the begin; a position's name may be in place of the pose of the tool."""
        if "start" not in self.task:
            self.faults.add(Refused("the state at the start, which must be given"), OF_TASK, "start")
            return {}
        start, where = self.task["start"], (OF_TASK, "start")
        self.origins["start",] = where
        if isinstance(start.get("tool"), str):
            start = {**start, "tool": self._position(start["tool"], (*where, "tool"), ("start", "tool"))}
        return dict(start)

    # Parts are bodies of the request, behind those of the cell.

    def _bodies(self) -> list[Document]:
        bodies = list(self.cell.get("bodies", ()))
        self.origins |= {("bodies", i): (OF_CELL, "bodies", i) for i in range(len(bodies))}
        for k, part in enumerate(self.task.get("parts", ())):
            at, where = ("bodies", len(bodies)), (OF_TASK, "parts", k)
            self.origins[at] = where
            self.parts[part["name"]] = part
            bodies.append(self._body(part, at, where))
        return bodies

    def _body(self, part: Document, at: Path, where: Path) -> Document:
        """A part as a body: what it does not state it has of its kind."""
        body = {key: value for key, value in part.items() if key not in ("kind", "slot")}
        kind = part.get("kind")
        if kind is not None and kind not in self.kinds:
            self.faults.add(Refused(f"one of the kinds: {choices(self.kinds, kind)}"), *where, "kind")
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
                self.faults.add(Refused(f"a slot that is free: {taken[number]} is in it"), *where, "slot", grid)
            self.slot_of[part["name"]] = grid, number
            if pose is not None:
                body["pose"] = pose
                self.origins[(*at, "pose")] = OF_CELL, "slots", grid
        return body

    def _taken(self, grid: str) -> dict[int, str]:
        """The slots of a grid in which a part lies now, and the part."""
        return {number: part for part, (name, number) in self.slot_of.items() if name == grid}

    def _slot_pose(self, grid: str, number: object, where: Path) -> Document | None:
        """The pose of a slot; None, and a fault, where there is none."""
        if grid not in self.grids:
            self.faults.add(Refused(f"the name of slots: {choices(self.grids, grid)}"), *where)
            return None
        most = math.prod(counts(self.grids[grid]))
        if not (isinstance(number, int) and not isinstance(number, bool) and 1 <= number <= most):
            self.faults.add(Refused(f"the number of a slot, 1 to {most}"), *where, grid)
            return None
        return pose_of_slot(normal(self.grids[grid]), number)

    def _position(self, name: str, where: Path, at: Path, grids: Collection[str] = ()) -> object:
        """The pose of a named position; any pose, and a fault, where there is none. `grids`: what the name could have
        been as well."""
        if name not in self.positions:
            kinds = "positions and slots" if grids else "positions"
            self.faults.add(Refused(f"one of the {kinds}: {choices([*self.positions, *grids], name)}"), *where)
            return {}
        self.origins[at] = OF_CELL, "positions", name
        return self.positions[name]

    # Steps: names of positions and slots become poses, and what a pick or a place leaves out it has of its kind and its
    # slots. A transfer is a pick and a place for each part.

    def _steps(self) -> list[Document]:
        steps: list[Document] = []
        for i, step in enumerate(self.task["steps"]):
            where = (OF_TASK, "steps", i)
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

    def _transfer(self, own: Document, where: Path, count: int) -> list[Document]:
        """A pick and a place for each part, in this order, to the next free slots."""
        with within_document(dotted(where)):
            stated: TransferDocument = read(TransferDocument, own)
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
        if kind in self.kinds:
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
            return None
        ((grid, number),) = slot.items()
        if isinstance(to, dict):
            for key in [key for key in to if key != "slot"]:
                self.faults.add(Refused("none: a slot has its own pose"), *place, key)
            place = (*place, "slot")
        pose = self._slot_pose(grid, number, place)
        if pose is None:
            return None
        if isinstance(part, str):
            taken = self._taken(grid)
            if number in taken:
                self.faults.add(Refused(f"a slot that is free: {taken[number]} is in it"), *place)
            if written_key(made, "gone_after_s") is None:
                self.slot_of[part] = grid, number
        made[end] = pose
        self.origins[(*at, end)] = OF_CELL, "slots", grid
        return str(grid)

    def _next_slot(self, grid: str, where: Path) -> Document:
        """The first free slot."""
        taken, many = self._taken(grid), math.prod(counts(self.grids[grid]))
        free = next((number for number in range(1, many + 1) if number not in taken), None)
        if free is None:
            self.faults.add(Refused(f"slots with one that is free: all {many} are taken"), *where)
        return {grid: free or 1}

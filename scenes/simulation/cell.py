"""A cell that is made ready to be simulated: what does not change from one run to the next."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws import kinds as laws
from assur.scenes.faults import NOTHING, Gathered, Refused, choices, fault, located, written_key
from assur.scenes.schema.read import read_fields
from assur.scenes.schema.request import OptionsDocument, RequestDocument
from assur.scenes.simulation.choice import Chooser, chooser_of
from assur.scenes.simulation.heights import check_heights
from assur.scenes.simulation.room import room_notes
from assur.scenes.simulation.unseen import Unseen, unseen_name, unseen_of
from assur.scenes.streams.stream import Stream, streams_of
from assur.scenes.tasks.kept_cell import KeptCellFile

if TYPE_CHECKING:
    from assur.scenes.reading.cell import Surroundings
    from assur.scenes.streams.arrivals import ArrivingPart

Document = dict[str, Any]
OF_RUN = ("streams", "selection", "refuge")
"""Fields of a cell that its tasks do not read."""
OPTIONS: Document = {"stop": "first", "max_candidates": 12, "report": "none"}
"""Options of each motion that a cell does not state."""
BUDGET_S = 60.0
"""The budget of each search, in place of that of the cell: a search ends by count, or the run by an error. A budget of
explanations is left out: its end, too, is a time of the clock."""
STAY_S, LEAST_STAY_S, MOST_STAY_S = 2.0, 0.5, 10.0
"""For how long standing in the refuge is proved where the cell does not state it; at least; and at most, s: a motion
and the standstill behind it have to end within `HORIZON_S`."""
FAR_M = 90.0
"""A point that no arm reaches, m from its base."""
AROUND_M = 0.2
"""By how much links reach beyond the reach of the flange, m."""


@dataclass(frozen=True, eq=False)
class SimulatedCell:
    """A cell with its streams, the choice of the next part, and what is not seen.

    `document`: the cell with its streams, and with the options of a run. `leaves_m`: x, in the frame of each stream,
    from which on nothing of the arm can reach its parts. `apart_m`: the clearance near control points. `stay_s`: how
    long standing is proved. `start`: that of a run, in the refuge. `heights`, `room`: notes about heights of parts, and
    room between them.
    """

    document: Document
    kept: KeptCellFile
    streams: tuple[Stream, ...]
    chooser: Chooser
    unseen: tuple[Unseen, ...]
    leaves_m: tuple[float, ...]
    apart_m: float
    stay_s: float
    refuge: str
    start: Document
    heights: tuple[str, ...]
    room: tuple[str, ...]

    def kept_from(self, at_s: float) -> KeptCellFile:
        """The same cell with the frames of its streams stated for a time, s. A part that is seen then has small
        coordinates in its frame, however long the conveyor has run."""
        written = self.kept.file.written
        frames = dict(written["frames"])
        for name in {stream.frame for stream in self.streams}:
            frames[name] = {key: _stated_at(value, at_s) for key, value in frames[name].items()}
        return KeptCellFile({**written, "frames": frames})

    def clear_s(self, number: int, part: ArrivingPart) -> float:
        """When a part of the stream with this number is clear of what is not seen, s."""
        x = self.unseen[number].clear_m + part.kind.radius_m + part.kind.off_m + self.apart_m
        return part.passes_s(x, self.streams[number].speed_m_s)


def simulated(document: Document) -> SimulatedCell:
    """The cell in a document. Raises `DocumentError` at its fields, for a cell that cannot run."""
    whole = KeptCellFile(document)
    valid = whole.file.valid
    options, stated = _options(whole)
    own = {key: value for key, value in whole.file.written.items() if key not in OF_RUN}
    kept = KeptCellFile({**own, "options": options})
    kept.check()
    faults = Gathered()
    with located(whole.file.written):
        around = _around(kept)
        streams = streams_of(valid, around.frames, faults)
        faults.settle()
        if all(stream.brings_carriers for stream in streams):
            raise Refused("at least one stream of parts to pick: without it there is nothing to simulate", "streams")
        for i, part in enumerate(() if around.given is None else around.given.tool.bodies):
            _check_name(part.name, streams, ("robot", "tool", "bodies", i, "name"))
        for i, body in enumerate(valid.bodies):
            _check_name(body.name, streams, ("bodies", i, "name"))
            if around.places[body.name][0] in {stream.frame for stream in streams}:
                raise Refused(
                    "a body that does not ride on the conveyor of a stream: what rides is a part", "bodies", i, "pose"
                )
        if valid.refuge is None or valid.refuge not in valid.positions:
            named = choices(valid.positions, str(valid.refuge or ""))
            raise Refused(f"the name of a position in which the arm may stand: {named}", "refuge")
        if around.given is None or "pitch" in around.given.robot.coordinates:
            raise Refused("an arm whose flange stays upright", "robot")
        start = _start(valid.positions[valid.refuge].document(), around)
        chooser = chooser_of(valid, stated, streams, around, valid.refuge)
        middle, reach_m = _reach(around)
        unseen, leaves = list[Unseen](), list[float]()
        for stream in streams:
            frame = around.frames.laws[stream.frame]
            at, off = frame.law.numbers.pose, frame.uncertainty
            along = (middle.x - at.x) * math.cos(at.yaw) + (middle.y - at.y) * math.sin(at.yaw)
            most = reach_m + stream.radius_m + off.position_m + AROUND_M
            unseen.append(unseen_of(stream, along - most, off.speed_m_s))
            leaves.append(along + most)
        start |= {} if chooser.elbow is None else {"elbow": chooser.elbow}
        with stands_in(valid.refuge, whole.file.written):
            heights = check_heights(kept, whole.file.written, streams, around.frames, start)
        room = tuple(room_notes(valid, streams, around.given.tool, stated.clearance_m.near))
    return SimulatedCell(
        {**whole.file.written, "options": options},
        kept,
        streams,
        chooser,
        tuple(unseen),
        tuple(leaves),
        stated.clearance_m.near,
        stated.stay_safe_s,
        valid.refuge,
        start,
        heights,
        room,
    )


@contextmanager
def stands_in(refuge: str, written: Document) -> Iterator[None]:
    """A fault of the start of a run inside is one of the refuge of the cell that is written so."""
    try:
        yield
    except InputError as error:
        if not error.field.startswith("start"):
            raise
        key = ("at_m",) if error.field.startswith("start.tool.at_") else ()
        raise fault(written, ("positions", refuge, *key), error.allowed) from error


def _check_name(name: str, streams: Sequence[Stream], where: tuple[str | int, ...]) -> None:
    """Raises `Refused`, at `where`, for a body that has the name of a part of a stream, or of what is not seen."""
    for stream in streams:
        if name == unseen_name(stream) or re.fullmatch(rf"{re.escape(stream.name)}-[0-9]+", name):
            raise Refused(f"a name that is none of the parts of the stream {stream.name}", *where)


def _stated_at(law: Any, at_s: float) -> Any:
    """The law of a frame that is where it is written at another time; what is no law stays."""
    if not isinstance(law, dict) or written_key(law, "speed_m_s") is None:
        return law
    return {**{key: value for key, value in law.items() if key not in ("at_s", "at_ms")}, "at_s": at_s}


def _options(whole: KeptCellFile) -> tuple[Document, OptionsDocument]:
    """The options of all motions, as they are written, and in SI."""
    own = dict(whole.file.written.get("options", {}))
    read_fields(RequestDocument, {"options": own})
    for key in ("budget_s", "explain_budget_s", "stay_safe_s"):
        written = written_key(own, key)
        given = own.pop(written, None) if written is not None else None
        if key == "stay_safe_s":
            value = (given or 0.0) / (1e3 if written == "stay_safe_ms" else 1.0)
            if given and not LEAST_STAY_S <= value <= MOST_STAY_S:
                allowed = f"{LEAST_STAY_S:g} to {MOST_STAY_S:g} s, or 0 for {STAY_S:g} s"
                raise InputError(f"options.{written}", given, allowed)
            own[key] = value or STAY_S
    made = {**OPTIONS, **own, "budget_s": BUDGET_S}
    return made, read_fields(RequestDocument, {"options": made})["options"]


def _around(kept: KeptCellFile) -> Surroundings:
    from assur.scenes.reading.cell import around, start_of_drift

    faults = Gathered()
    found = around(kept.alone, (None, start_of_drift(kept.alone, 0.0)), faults)
    faults.settle()
    return found


def _start(position: Document, around: Surroundings) -> Document:
    """The start of a run, in the refuge, but for the elbow."""
    tool = {key: position[key] for key in ("frame", "body", "at_m", "yaw_rad") if key in position}
    if around.given is not None and "yaw" in around.given.robot.coordinates:
        tool.setdefault("yaw_rad", 0.0)
    return {"tool": tool}


def _reach(around: Surroundings) -> tuple[Pose, float]:
    """The base of the arm, and how far from its axis anything that it carries can be, m: flange, tool, links."""
    given = around.given
    if given is None:
        raise InputError("robot", NOTHING, "a robot")
    robot, margins = given.robot, []
    for mode in range(len(robot.modes)):
        for x, y in ((FAR_M, 0.0), (-FAR_M, 0.0), (0.0, FAR_M), (0.0, -FAR_M)):
            far = laws.fixed(Pose(robot.base.x + x, robot.base.y + y)).motion(np.array(0.0))
            margins.append(float(robot.reach_margin(far, mode)))
    tool = max((body.radius for body in given.tool.bodies), default=0.0)
    links = max((body.body.radius for body in robot.bodies), default=0.0)
    return robot.base, FAR_M + max(margins) + max(tool, links)

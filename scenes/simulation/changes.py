"""Changes of a cell that may give it more parts a minute, as values that are set in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from assur.planner.model.scene import WORLD
from assur.planner.selection.names import RULES
from assur.scenes.faults import written_key
from assur.scenes.set_values import in_other_unit
from assur.scenes.simulation.cell import SimulatedCell
from assur.scenes.simulation.choice import AUTO
from assur.scenes.streams.stream import Stream
from assur.scenes.tasks.request_of_task import HANDLING
from assur.scenes.units import twin_of

Document = dict[str, Any]
SPEEDS = {"slower": 0.75, "faster": 1.25}
"""Of a conveyor: by what its speed is multiplied."""
MORE_OFTEN = 0.75
"""By what the time between two carriers is multiplied."""
FURTHER_M = (0.2, 0.4)
"""By how much a line at which parts are seen is moved upstream, m."""
DIGITS = 6
"""Behind the point, of numbers that are set."""


@dataclass(frozen=True)
class Change:
    """A change in words, and its values by their paths. Of changes with the same `question` the best one counts."""

    what: str
    values: Document
    question: str


def changes_of(cell: SimulatedCell, document: Document) -> Iterator[Change]:
    """What may be changed in the cell of this document. Whether the cell can run then is not tried."""
    chooser, options = cell.chooser, document.get("options", {})
    if len(chooser.robot.modes) > 1 and options.get("elbow") != AUTO:
        yield _change("the elbow is free", {"options.elbow": AUTO})
    for frame in dict.fromkeys(stream.frame for stream in cell.streams):
        speed_m_s = next(stream.speed_m_s for stream in cell.streams if stream.frame == frame)
        for key, law in document["frames"][frame].items():
            if not isinstance(law, dict) or written_key(law, "speed_m_s") is None:
                continue
            for word, factor in SPEEDS.items():
                path, speed = _path(f"frames.{frame}.{key}", law, "speed_m_s", factor * speed_m_s)
                yield _change(f"{frame} is {word}, with as many parts a minute", {path: speed})
    for stream in cell.streams:
        yield from _of_stream(stream, document["streams"][stream.name])
    if stops := dict(_stops(cell, document)):
        yield _change("no dwell", stops)
    for name in chooser.grids[:-1]:
        own = document["slots"][name]
        if own.get(written_key(own, "exchange_s") or "", 0.0) > 0.0:
            yield _change(f"a full {name} is replaced at once", dict([_path(f"slots.{name}", own, "exchange_s", 0.0)]))
    for rule in RULES:
        if rule != chooser.rule:
            yield Change(f"selection: {rule}", {"selection": rule}, "selection")
    for grid in chooser.grids[:-1]:
        if values := _on_other_side(grid, cell, document):
            yield _change(f"{grid} is on the other side of the belt", values)


def _change(what: str, values: Document) -> Change:
    return Change(what, values, what)


def _of_stream(stream: Stream, written: Document) -> Iterator[Change]:
    above = f"streams.{stream.name}"
    for further_m in FURTHER_M if stream.rows is None else ():
        seen_m = stream.seen_m - further_m
        values = dict([_path(f"{above}.seen", written["seen"], "at_m", seen_m)])
        if stream.at_m[0] > seen_m:  # parts come before they are seen
            values |= dict([_path(above, written, "at_m", [seen_m, *stream.at_m[1:]])])
        yield _change(f"{stream.name} is seen {1e3 * further_m:.0f} mm further upstream", values)
    time_s, key = (stream.mean_s, "mean_s") if stream.every_s is None else (stream.every_s, "every_s")
    if stream.brings_carriers and time_s is not None:
        values = dict([_path(above, written, key, MORE_OFTEN * time_s)])
        yield _change(f"{stream.name} comes more often, 4 in place of 3", values)
    if stream.mean_s is not None:  # one of both keys is there: all of the stream is set
        mean = str(written_key(written, "mean_s"))
        even = {name.replace("mean", "every") if name == mean else name: each for name, each in written.items()}
        yield _change(f"{stream.name} comes at even times", {above: even})
    elif stream.jitter_s > 0.0:
        yield _change(f"{stream.name} comes at even times", dict([_path(above, written, "jitter_s", 0.0)]))


def _stops(cell: SimulatedCell, document: Document) -> Iterator[tuple[str, object]]:
    """Dwells of the kinds and slots of the streams, which become 0."""
    picked = [stream for stream in cell.streams if not stream.brings_carriers]
    for name in dict.fromkeys(kind.name for stream in picked for kind in stream.kinds):
        own = document["kinds"][name]
        if own.get(written_key(own, "dwell_s") or "", HANDLING["dwell_s"]) > 0.0:
            yield _path(f"kinds.{name}", own, "dwell_s", 0.0)
    for name in cell.chooser.grids[:-1]:
        own = document["slots"][name]
        if own.get(written_key(own, "dwell_s") or "", 0.0) > 0.0:
            yield _path(f"slots.{name}", own, "dwell_s", 0.0)


def _on_other_side(grid: str, cell: SimulatedCell, document: Document) -> Document:
    """A grid moved straight across the line of the only conveyor whose parts go there, as far behind it as its middle
    was before it; bodies that carry it, or that its parts touch, too. Empty where one of them is not in the world."""
    from assur.planner.selection import columns as c

    chooser = cell.chooser
    feeding = [each for each in cell.streams if any(kind.to == grid for kind in each.kinds)]
    if len({stream.frame for stream in feeding}) != 1:
        return {}
    names = {stream.name for stream in feeding}
    lanes = [k for k, (name, _) in enumerate(chooser.lanes) if name in names]
    line, number = chooser.times.lane_points[lanes].mean(axis=0), chooser.grids.index(grid)
    many = int(chooser.times.places[number, c.PLACE_SLOTS])
    along = (line[:, -1] - line[:, 0]) / np.linalg.norm(line[:, -1] - line[:, 0])
    away = line[:, 0] - chooser.times.place_points[number, :, :many].mean(axis=1)
    shift_m = (2.0 * (away - along * (along @ away))).tolist()
    slots, values = document["slots"][grid], Document()
    if "kind" in slots:
        return {}
    carrier = slots.get("body")
    moved: list[tuple[str, Mapping[str, Any]]] = [(f"slots.{grid}", slots)] if carrier is None else []
    carriers = {*slots.get("contact_with", []), *([] if carrier is None else [carrier])}
    bodies = [body for body in document.get("bodies", []) if body["name"] in carriers]
    for path, pose in moved + [(f"bodies.{body['name']}.pose", body.get("pose", {})) for body in bodies]:
        if pose.get("body") is not None or pose.get("frame", WORLD) != WORLD:
            return {}
        key = written_key(dict(pose), "at_m")
        at_m: Any = [0.0, 0.0, 0.0] if key is None else pose[key] if key == "at_m" else in_other_unit(pose[key], key)
        at_m = [value + by for value, by in zip(at_m, [*shift_m, 0.0], strict=True)]
        values |= dict([_path(path, dict(pose), "at_m", at_m)])
    return values


def _path(above: str, written: Document, key: str, value: Any) -> tuple[str, object]:
    """The path of a quantity below `above`, and its value, both in the unit in which it is written there."""
    name = written_key(written, key) or twin_of(key) or key
    value = value if name == key else in_other_unit(value, key)
    return f"{above}.{name}", _rounded(value)


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    number = round(float(value), DIGITS)
    return int(number) if number.is_integer() else number

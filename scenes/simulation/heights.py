"""Heights of the parts of streams and of slots: what a plan would warn of, known before a run.

Parts lie in the middle of the window of their stream, in its first lane, and in the first slot of a grid. The conveyors
of streams are at rest, because a plan evaluates these warnings for what is at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from assur.planner.errors import InputError
from assur.planner.model.input_warning import WarningKind
from assur.planner.report.number_format import amount
from assur.scenes.faults import DocumentError, as_written, documented, dotted, raised_as
from assur.scenes.requests import cell_of
from assur.scenes.schema.cell_file import TASK
from assur.scenes.schema.normal import normal
from assur.scenes.tasks.grids import pose_of_slot
from assur.scenes.tasks.kept_cell import KeptCellFile
from assur.scenes.tasks.origins import OF_CELL, OF_TASK

if TYPE_CHECKING:
    from assur.scenes.reading.frames import Frames
    from assur.scenes.streams.stream import Stream

Document = dict[str, Any]
IN_AIR = (WarningKind.PART_FLOATS, WarningKind.RELEASED_IN_AIR, WarningKind.SUPPORT_OFF_PART)


class _Lying(NamedTuple):
    """A part of a kind where it lies; the step that puts it down there; the carrier on which it is, if any; and the
    field of the cell that states its height."""

    kind: str
    part: Document
    place: Document
    carriers: list[Document]
    field: tuple[str, ...]


def check_heights(
    kept: KeptCellFile, document: Document, streams: Sequence[Stream], frames: Frames, start: Document
) -> tuple[str, ...]:
    """Notes about parts that lie in the air, or inside a body, in the cell of a document; `start`: that of its runs.
    Raises `InputError` at a field of the cell with which no part can be put down."""
    written, found = kept.file.written, dict[str, None]()
    at_rest = dict(written["frames"])
    for stream in streams:
        at = frames.laws[stream.frame].law.numbers.pose
        at_rest[stream.frame] = {"fixed": {"at_m": [at.x, at.y, at.z], "yaw_rad": at.yaw}}
    cell = KeptCellFile({**written, "frames": at_rest})
    for lying in _lying(kept, streams):
        field = dotted(as_written(document, lying.field)[0])
        found |= {f"{field}: {note}": None for note in _notes(cell, lying, start)}
    return tuple(found)


def of_cell(error: InputError) -> DocumentError:
    """A fault of the request of a task as one of its cell; one of the start stays at `start`."""
    return documented(error).relocated(lambda field: field.removeprefix(f"{OF_CELL}.").removeprefix(f"{OF_TASK}."))


def _lying(kept: KeptCellFile, streams: Sequence[Stream]) -> Iterator[_Lying]:
    """The parts of each kind where they come, and in the slots to which they go."""
    grids, kinds = kept.file.valid.slots, kept.file.written["kinds"]
    carriers = {kind.name: stream for stream in streams for kind in stream.kinds if stream.brings_carriers}
    for stream in streams:
        for kind in stream.kinds:
            part = {"name": f"{stream.name}-1", "shape": kinds[kind.name]["shape"]}
            pose = _in_window(stream)
            yield _Lying(kind.name, {**part, "pose": pose}, {"to": pose}, [], ("streams", stream.name, "at_m"))
            if kind.to is None:
                continue
            grid, of = normal(grids[kind.to].document()), carriers.get(grids[kind.to].kind or "")
            pose, on = pose_of_slot(grid, 1), list[Document]()
            place: Document = {"to": {"slot": {kind.to: 1}}}
            if of is not None:
                carrier = f"{of.name}-1"
                on = [{"name": carrier, "shape": kinds[grid["kind"]]["shape"], "pose": _in_window(of)}]
                pose = {**pose, "body": carrier}
                place = {"to": pose, "contact_with": [carrier]}
            yield _Lying(kind.name, {**part, "pose": pose}, place, on, ("slots", kind.to, "at_m"))


def _in_window(stream: Stream) -> Document:
    """The pose of a part in the middle of its window: in the middle of the first lane and of its yaw, or as the first
    one of a table."""
    x, aside, yaw = (0.5 * sum(limits) for limits in (stream.window_m, stream.spread_m, stream.yaw_rad))
    y = stream.at_m[1] + stream.lanes_m[0] + aside
    if stream.rows is not None:
        y, yaw = stream.rows[0].y_m, stream.rows[0].yaw_rad
    return {"frame": stream.frame, "at_m": [x, y, stream.at_m[2]], "yaw_rad": yaw}


def _notes(cell: KeptCellFile, lying: _Lying, start: Document) -> Iterator[str]:
    """The warnings of a plan that picks a part where it lies, and puts it down there again."""
    from assur.planner.collision.proof import Prover
    from assur.planner.feasibility.hits import AtStart
    from assur.planner.feasibility.input_warnings import unusual_bodies, unusual_places, unusual_supports

    name = lying.part["name"]
    steps, parts = [{"pick": {"part": name}}, {"place": {"part": name, **lying.place}}], [*lying.carriers, lying.part]
    with raised_as(of_cell):
        made = cell.joined({"schema": TASK, "start": start, "parts": parts, "steps": steps})
    with raised_as(lambda error: of_cell(made.relocated(error))):
        scene = cell_of(made.request).scene
    prover = Prover(scene)
    at = AtStart(scene, prover)
    for each in (*unusual_bodies(scene, at), *unusual_places(scene, at), *unusual_supports(scene, prover, ())):
        other, by = next(body for body in each.bodies if body != name), amount(each.amount_m, "m")
        if each.kind is WarningKind.BODIES_OVERLAP:
            low, high = (
                1e3 * float(at.place(body)[2] + scene.index[body].body.heights[end])
                for body, end in ((name, 0), (other, 1))
            )
            depth = f"its lowest point is at z {low:.6g} mm, and the highest of {other} at {high:.6g} mm"
            yield f"{lying.kind} is more than {by} inside {other}, where no motion can take it or put it down: {depth}"
        if each.kind in IN_AIR:
            yield f"{lying.kind} is {by} from {other}, and rests on nothing"

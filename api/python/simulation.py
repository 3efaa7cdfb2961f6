"""How many parts a minute a cell takes: runs against its streams."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from os import PathLike
from pathlib import Path
from typing import Any

from assur.api.python.calls import document_of


def simulate(
    cell: object,
    *,
    minutes: float = 10.0,
    seed: int = 1,
    seeds: int = 1,
    planning_ms: float = 20.0,
    log: str | PathLike[str] | None = None,
    helps: bool = False,
) -> Mapping[str, Any]:
    """Runs a cell against its streams (docs/simulation.md), as fast as it can: ``["parts_per_minute"]``, with
    ``["interval"]`` over several seeds, and why it is not more (``["bottleneck"]``, ``["legs"]``, ``["waiting"]``).

    `cell`: the document of a cell file, or an `assur.Cell` of one. `minutes`: of each run, on its own clock. `seed`: of
    the first run; `seeds` runs have this seed and the numbers behind it. `planning_ms`: how long planning takes on that
    clock; it is not measured. `log`: a file for the log of the session of the first run (`assur.Session`). `helps`:
    then changes of the cell are tried, and ``["helps"]`` has what each gives. The same arguments give the same result.
    Every motion is planned, proved and checked. Raises `InputError` naming the argument, or the field of the cell;
    `OSError` for a log that cannot be written.
    """
    from assur.planner.errors import InputError
    from assur.scenes.schema.normal import plain
    from assur.scenes.simulation.helps import Helps
    from assur.scenes.simulation.simulate import Simulation

    if not isinstance(helps, bool):
        raise InputError("helps", helps, "True or False")
    made = Simulation(plain(document_of(cell)), minutes, seed, seeds, planning_ms)
    if log is None:
        made.run()
    else:
        from assur.scenes.session.log import SessionLog

        with closing(SessionLog(Path(log), made.cell.document)) as record:
            made.run(record=record)
    if not helps:
        return made.document
    trials = Helps(made)
    trials.run()
    return trials.document

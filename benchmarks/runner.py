"""Running a section: every item in a warm process of its group, each record kept as soon as it is there."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path
from typing import Any

from benchmarks.dialogue import Program, ProgramDied
from benchmarks.machine import ROOT, commit, machine, sources
from benchmarks.progress import Progress
from benchmarks.section import Document, Item, Records, Section, Summary

Ask = Callable[[str], Document]
Open = Callable[[Section, Document, str], Any]
"""From a section, its parameters and a group, a context manager that gives an `Ask`."""


@contextmanager
def process(section: Section, parameters: Document, group: str, log: Path | None = None) -> Iterator[Ask]:
    """The measuring process of a group. An item under which it dies gets a record that says so, and a new process."""
    command = [sys.executable, "-m", "benchmarks.measuring", section.name]
    opening = {"parameters": parameters, "group": group}
    alive: list[Program] = []

    def ask(item: str) -> Document:
        try:
            if not alive:
                alive.append(Program(command, folder=ROOT, opening=opening, log=log, start_s=section.limit_s))
            return alive[0].ask({"item": item}, section.limit_s)
        except ProgramDied as death:
            while alive:
                alive.pop().close()
            return {"findings": [f"the measuring process died: {death}"]}

    try:
        yield ask
    finally:
        while alive:
            alive.pop().close()


def measured(
    section: Section, parameters: Document, progress: Progress, ticked: Callable[[], None], opened: Open = process
) -> dict[str, Document]:
    """The records of all items, in their order; those that `progress` has, and the section keeps, are not measured
    again."""
    items = section.items(parameters)
    done = {name for name, record in progress.records.items() if not section.again(record)}
    for group, members in groupby(items, key=lambda item: item.group):
        left: Sequence[Item] = [item for item in members if item.name not in done]
        if left:
            with opened(section, parameters, group) as ask:
                for item in left:
                    progress.add(item.name, ask(item.name))
                    ticked()
    return {item.name: progress.records[item.name] for item in items}


def key(section: Section, parameters: Document, quick: bool) -> Document:
    """What a run is of: only the same is resumed."""
    return {
        "section": section.name,
        "sample": quick,
        "parameters": parameters,
        "sources": sources(),
        "machine": machine(),
    }


def result(section: Section, parameters: Document, quick: bool, records: Records, summary: Summary) -> Document:
    """The document that a section writes. `answers`: how many plans of ours were checked and rechecked, and the items
    that were not clean."""
    return {
        "schema": "assur-benchmark/1",
        "section": section.name,
        "about": section.about,
        "sample": quick,
        "date": datetime.now(UTC).date().isoformat(),
        **commit(),
        "machine": machine(),
        "pinned": section.one_core,
        "parameters": parameters,
        "answers": {
            "checked": sum(record.get("answers", 0) for record in records.values()),
            "not_clean": [name for name, record in records.items() if record.get("findings") != []],
        },
        "figures": [figure.document() for figure in summary.figures],
        "data": summary.data,
    }


def write(path: Path, document: Document) -> None:
    """A result on disk, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False)
    beside = path.with_suffix(".part")
    beside.write_text(text + "\n", encoding="utf-8")
    beside.replace(path)

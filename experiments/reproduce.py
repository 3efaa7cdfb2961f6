"""Runs experiments and writes, for each, NAME.png, NAME.svg, NAME.json and NAME.md."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from assur.experiments.experiment import Result
from assur.experiments.figures import write
from assur.planner.errors import FaultError, InputError


@dataclass(frozen=True, slots=True)
class Entry:
    """An experiment by its `name`, what in which `source` it reproduces, and its `title`; `module` holds it."""

    name: str
    source: str
    title: str

    @property
    def module(self) -> str:
        return f"{__package__}.{self.name.replace('-', '_')}"

    def run(self) -> Result:
        """Run it; modules are imported one by one, so that one experiment costs what it needs."""
        result = import_module(self.module).run()
        if not isinstance(result, Result):
            raise FaultError(f"{self.module}.run gives no Result")
        return result


ENTRIES = (
    Entry("dyad-timing", "000, figure 4", "The RRR dyad in four formulations: time of a solution"),
    Entry("spiral", "000, equation 16 and figure 6", "A SCARA along a helix, and a tool that dwells on it"),
    Entry("five-bar", "000, conclusions", "The RRR group in a parallel arm: workspace and both kinds of singularity"),
    Entry("modes", "000 figure 1, 001, 004", "Two assemblies, two solutions, one convention"),
    Entry("dh-chain", "001, sections 4 and 5", "The Denavit-Hartenberg chain of a SCARA, and back"),
    Entry("line-through-singularity", "002, singular configurations", "A straight line past a singular position"),
    Entry("elbow", "002, geometric method and singular configurations", "An elbow arm in closed form, and its det J"),
    Entry("polar", "002, transformation matrices (I) to (III)", "A polar arm by matrices, and its det J"),
    Entry("oblique-triangles", "003, equations 1 to 6", "Half-angle formulas of oblique triangles against the dyad"),
    Entry("rv-m1", "003, section 5", "Five axes by tool point, pitch and roll, and the family of pitches"),
    Entry("joint-move", "004, section 2", "A joint move with parabolic blends, and the same move by Ruckig"),
)
"""In the order of the sources."""


ALL = "all"


@dataclass(frozen=True)
class Reproduction:
    """One experiment that was run, the `number`-th of `count`: the files that it left, the `paragraph`, and how long it
    took."""

    entry: Entry
    paragraph: str
    files: tuple[Path, ...]
    elapsed_s: float
    number: int
    count: int


def chosen(name: str) -> tuple[Entry, ...]:
    """The experiments that a name means. Raises `InputError` for a name that is neither one of them nor `all`."""
    found = ENTRIES if name == ALL else tuple(entry for entry in ENTRIES if entry.name == name)
    if not found:
        raise InputError("NAME", name, f"{ALL}, {', '.join(entry.name for entry in ENTRIES)}")
    return found


def reproduce(name: str, folder: Path) -> Iterator[Reproduction]:
    """Run the experiment `name`, or `all`, one after the other, into `folder`, which is made if it is not there."""
    entries = chosen(name)
    if folder.exists() and not folder.is_dir():
        raise InputError("--out", str(folder), "a folder")
    folder.mkdir(parents=True, exist_ok=True)
    for number, entry in enumerate(entries, start=1):
        yield _one(entry, folder, number, len(entries))


def _one(entry: Entry, folder: Path, number: int, count: int) -> Reproduction:
    started = time.perf_counter()
    result = entry.run()
    stem = folder / entry.name
    figures = write(result.draw, result.size, stem)
    numbers = stem.with_name(f"{entry.name}.json")
    document = {"experiment": entry.name, "source": entry.source, "numbers": result.numbers}
    numbers.write_text(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
    words = stem.with_name(f"{entry.name}.md")
    parts = (f"## {entry.title}", f"Source {entry.source}.", result.paragraph, f"![{entry.name}]({entry.name}.svg)")
    words.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    elapsed_s = time.perf_counter() - started
    return Reproduction(entry, result.paragraph, (*figures, numbers, words), elapsed_s, number, count)

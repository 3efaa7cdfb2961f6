"""The table of the bars: each with the figure that was reached, from the results of all sections."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich.table import Table

Document = dict[str, Any]
Results = Mapping[str, Document]
"""Section → the document that it wrote."""

THREE = ("static", "moving bodies", "moving goal")
FOUR = (*THREE, "moving goal, velocity")
ORDER = " / ".join(FOUR)
NO_BAR = "none"


@dataclass(frozen=True, slots=True)
class Bar:
    """A line of the table: the figures of a section that stand in it, how many decimals, their unit."""

    title: str
    section: str
    figures: tuple[str, ...]
    bars: tuple[float | None, ...]
    decimals: int = 0
    unit: str = ""
    at_least: bool = False


def _each(text: str, sets: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{name}: {text}" for name in sets)


LONGER = "duration at 0.2 s over the best known"
BARS: tuple[Bar, ...] = (
    Bar("solved within 0.1 s", "sets", _each("solved within 0.1 s", FOUR), (93, 90, 92, None), 0, "%", True),
    Bar("solved within 1 s", "sets", _each("solved within 1 s", FOUR), (95, 95, 95, 92), 0, "%", True),
    Bar("first answer, median", "sets", _each("first answer, median", FOUR), (3, 3, 3, 3), 1, "ms"),
    Bar("first answer, 95 %", "sets", _each("first answer, 95 %", FOUR), (30, 30, 30, 30), 1, "ms"),
    Bar(
        "solved within 1 s, adaptivity off",
        "sets",
        _each("solved within 1 s, not adaptive", FOUR),
        (None, None, None, None),
        0,
        "%",
        True,
    ),
    Bar(
        "first answer, 95 %, adaptivity off",
        "sets",
        _each("first answer, 95 %, not adaptive", FOUR),
        (None, None, None, None),
        1,
        "ms",
    ),
    Bar(f"{LONGER}, median", "durations", _each(f"{LONGER}, median", FOUR), (1.05,) * 4, 3),
    Bar(f"{LONGER}, 95 %", "durations", _each(f"{LONGER}, 95 %", FOUR), (1.25,) * 4, 3),
    Bar("dyad, ours over the mended printed equations", "dyad", ("dyad: ours over the printed equations",), (0.4,), 2),
    Bar(
        "straight legs over Ruckig's joint move, median",
        "legs",
        ("straight legs over the joint move, median",),
        (1.1,),
        3,
    ),
    Bar("planning time, 10 to 1,000 bodies", "scaling", ("planning, 10 to 1,000 bodies",), (3,), 1, "times"),
    Bar("building the scene, 10 to 1,000 bodies", "scaling", ("building, 10 to 1,000 bodies",), (None,), 1, "times"),
    Bar(
        "planning time, 1 to 10 control points: via / move / pick",
        "scaling",
        tuple(f"planning, 1 to 10 control points ({kind})" for kind in ("via", "move", "pick")),
        (12, 12, 12),
        1,
        "times",
    ),
    Bar(
        "HTTP round trip minus planning, median", "service", ("HTTP round trip minus planning, median",), (3,), 1, "ms"
    ),
    Bar("two workers over one, requests per second", "service", ("two workers over one",), (1.8,), 2, "times", True),
)
"""The bars of this benchmark, and what stands beside them without one."""


@dataclass(frozen=True, slots=True)
class Line:
    """A bar in words: title, bar, what was reached, and whether."""

    title: str
    bar: str
    reached: str
    met: str


def lines(results: Results) -> Iterator[Line]:
    """The table, line by line; what was not measured says so, what was refused says so."""
    for bar in BARS:
        there = {figure["name"]: figure for figure in results.get(bar.section, {}).get("figures", [])}
        figures = [there.get(name) for name in bar.figures]
        wanted = [None if worth is None else f"{worth:g}" for worth in bar.bars]
        sense = "at least " if bar.at_least else "at most "
        one_for_all = wanted[:1] if len(set(wanted)) == 1 else wanted
        asked = sense + " / ".join(worth or NO_BAR for worth in one_for_all) if any(wanted) else ""
        told = " / ".join(_value(figure, bar) for figure in figures)
        unit = f" {bar.unit}" if bar.unit else ""
        yield Line(
            bar.title,
            asked + unit if asked else "",
            "not measured" if not any(figures) else told + unit,
            _met(figures, bar),
        )
    yield _clean(results)


def _value(figure: Document | None, bar: Bar) -> str:
    if figure is None:
        return "not measured"
    if figure["refused"] is not None or figure["value"] is None:
        return "refused"
    return f"{figure['value']:.{bar.decimals}f}"


def _met(figures: Sequence[Document | None], bar: Bar) -> str:
    said = []
    for figure, worth in zip(figures, bar.bars, strict=True):
        if worth is None:
            said.append(NO_BAR)
        elif figure is None or figure["value"] is None:
            said.append("?")
        else:
            good = figure["value"] >= worth if bar.at_least else figure["value"] <= worth
            said.append("yes" if good else "no")
    told = set(said) - {NO_BAR}
    if not told:
        return ""
    return told.pop() if len(told) == 1 else " / ".join(said)


def answers(results: Results) -> tuple[int, list[str]]:
    """How many plans were checked and rechecked, and the items that were not clean."""
    told = [document["answers"] for document in results.values()]
    return sum(one["checked"] for one in told), [name for one in told for name in one["not_clean"]]


def _clean(results: Results) -> Line:
    checked, bad = answers(results)
    title = "plans in which checker or recheck find anything"
    if not results:
        return Line(title, "at most 0", "not measured", "?")
    return Line(title, "at most 0", f"{len(bad)} of {checked:,}", "no" if bad else "yes")


def refused(results: Results) -> list[str]:
    """Every reason for which figures were refused, with their names."""
    by_reason: dict[str, list[str]] = {}
    for document in results.values():
        for figure in document["figures"]:
            if figure["refused"] is not None:
                by_reason.setdefault(figure["refused"], []).append(figure["name"])
    return [f"{why}: {'; '.join(names)}" for why, names in by_reason.items()]


def table(results: Results, said: str = "") -> Table:
    """The table as it is printed, `said` above it."""
    shown = Table("figure", "bar", "reached", "met", title=f"{said}sets in the order {ORDER}", show_lines=True)
    for line in lines(results):
        shown.add_row(line.title, line.bar, line.reached, line.met)
    return shown

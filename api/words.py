"""An answer in the words of the shop: lines and tables for people, from the same document that machines get.

Lengths in millimetres, times in seconds. Texts that came from a request are printed, never interpreted.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from api.problems import printable

WIDTH = 110
"""Columns where the output is not a terminal."""
CENSUS_LINES = 8
"""So many kinds of refusal are told; the document has them all."""

SAYS = {
    "OUT_OF_REACH": "the arm does not reach",
    "JOINT_LIMIT": "a joint would pass its limit",
    "NEAR_SINGULARITY": "the arm would be too near a singular pose",
    "NEAR_PARALLEL_SINGULARITY": "the motors would hardly hold the tool",
    "SELF_COLLISION": "the arm would hit itself",
    "BODY_COLLISION": "something would be hit",
    "START_IN_COLLISION": "the start is in collision",
    "CONTROL_POINT_IN_COLLISION": "a control point is in collision",
    "MOTION_LIMIT": "speed, acceleration or jerk would pass a limit",
    "CARRY_LIMIT": "the part could not be held so fast",
    "WINDOW_MISSED": "the window would be missed",
    "LAW_ENDS": "a frame's motion is not known for so long",
    "NOT_CERTIFIED": "the proof did not succeed",
    "TIMED_OUT": "the time was up",
}
"""Reasons as a shift leader says them."""
MARKS = {"vendor_config": " c", "third_party": " t", "disputed": " d", "estimated": " e"}
"""Marks behind a number of the catalogue that is not the maker's own word; `LEGEND` explains them."""
LEGEND = (
    "c: a maker's configuration file, perhaps a placeholder; t: second hand; d: disputed; e: estimated; "
    "else as its source says"
)
MILLI = {"m": ("mm", 1e3), "s": ("ms", 1e3)}


def console(*, stderr: bool = False) -> Console:
    """A console that prints texts as they are, as wide as the terminal or `WIDTH`."""
    made = Console(stderr=stderr, markup=False, highlight=False, emoji=False)
    if not made.is_terminal:
        made.width = WIDTH
    return made


def amount(value: float | None, unit: str) -> str:
    """A length in mm, a time in ms, anything else as it is; nothing for no number."""
    if value is None:
        return ""
    name, factor = MILLI.get(unit, (unit, 1.0))
    return f"{value * factor:.3g} {name}".rstrip()


def table(*columns: str) -> Table:
    """A table without a frame; the columns named with a leading ">" are numbers."""
    made = Table(box=None, pad_edge=False, header_style="bold")
    for name in columns:
        made.add_column(name.removeprefix(">"), justify="right" if name.startswith(">") else "left", overflow="fold")
    return made


def row(made: Table, *cells: object) -> None:
    """Adds a row; texts are printed as they are."""
    made.add_row(*(Text(printable(str(cell), 400)) for cell in cells))


def catalogue(robots: list[dict[str, Any]]) -> Table:
    """The robots, a row per joint, each number marked with its status."""
    made = table("robot", "joint", ">range", ">speed", ">acceleration", ">jerk")
    for robot in robots:
        name = robot["model"]
        for joint in robot["joints"]:
            lower, upper = joint["lower"], joint["upper"]
            extent = f"{lower['value']:g} .. {upper['value']:g} {lower['unit']}{MARKS.get(lower['status'], '')}"
            rates = (joint[kind] for kind in ("velocity", "acceleration", "jerk"))
            row(made, name, joint["name"], extent, *(_rate(rate) for rate in rates))
            name = ""
    return made


def _rate(number: dict[str, Any]) -> str:
    unit = number["unit"].replace("_s3", "/s3").replace("_s2", "/s2").replace("_s", "/s")
    return f"{number['value']:g} {unit}{MARKS.get(number['status'], '')}"


def planned(answer: dict[str, Any]) -> Iterator[Table | str]:
    """What a planned answer says."""
    names = {arrival["step"]: arrival["control_point"] for arrival in answer["arrivals"]}
    legs = table("leg", ">from s", ">to s", "for", "")
    for leg in answer["legs"]:
        row(legs, leg["kind"], f"{leg['from_s']:.3f}", f"{leg['to_s']:.3f}", names.get(leg["step"], ""), leg["note"])
    yield legs
    yield ""
    arrivals = table("arrival", ">at s", ">x mm", ">y mm", ">z mm", ">along mm", ">window left s", "speed")
    for arrival in answer["arrivals"]:
        along, left = arrival["along_m"], arrival["window_left_s"]
        row(
            arrivals,
            arrival["control_point"],
            f"{arrival['time_s']:.3f}",
            *(f"{1e3 * x:.1f}" for x in arrival["at_m"]),
            "" if along is None else f"{1e3 * along:.1f}",
            "" if left is None else f"{left:.3f}",
            "matched" if arrival["matched"] else "",
        )
    yield arrivals
    yield ""
    margins = answer["margins"]
    bound = answer["lower_bound_s"]
    least = f"; no plan takes less than {bound:.3f} s" if bound else ""
    yield f"duration            {answer['duration_s']:.3f} s{least}"
    yield f"what binds          {margins['binds']}"
    nearest = margins["nearest"]
    yield "smallest clearance  " + (
        "nothing is near"
        if nearest is None
        else f"{1e3 * nearest['gap_m']:.2f} mm at {nearest['time_s']:.3f} s, "
        f"{' and '.join(nearest['bodies'])} ({nearest['phase']})"
    )


def not_planned(answer: dict[str, Any]) -> Iterator[Table | str]:
    """What a refused request says."""
    proved = "proved: no plan exists" if answer["proved"] else "not found, which is no proof that there is none"
    yield f"not planned         {answer['reason']} ({proved})"
    yield answer["sentence"]
    relaxation = answer["relaxation"]
    if relaxation is not None:
        yield (
            f"what would help     {relaxation['what']}: {relaxation['value']} "
            f"(then {relaxation['duration_s']:.3f} s; tried)"
        )
    elif answer["tried"]:
        yield f"what would not help {', '.join(answer['tried'])}"


def census(document: dict[str, Any]) -> Iterator[str]:
    """The census in sentences, most frequent refusal first."""
    yield f"{document['candidates']} candidates, {document['refused']} refused"
    lines = document["lines"]
    for line in lines[:CENSUS_LINES]:
        yield "  " + refusal(line)
    if len(lines) > CENSUS_LINES:
        yield f"  and {len(lines) - CENSUS_LINES} more kinds of refusal"


def refusal(line: dict[str, Any]) -> str:
    """One line of the census as a sentence: how many, why, by what, when, by how much."""
    words = [f"{line['count']} times {SAYS.get(line['reason'], line['reason'])}"]
    if line["bodies"]:
        words.append(f"({' and '.join(line['bodies'])})")
    interval = line.get("interval_s")
    if interval is not None and None not in interval:
        first, last = (f"{instant:.3f}" for instant in interval)
        words.append(f"at {first} s" if first == last else f"between {first} and {last} s")
    least, most = amount(line["least"], line["unit"]), amount(line["most"], line["unit"])
    if least:
        words.append(f"by {least}" if least == most else f"by {least} to {most}")
    words.append(f"[step {line['step'] + 1}, {line['stage']}]")
    if line["detail"] and not line["bodies"]:
        words.append(f": {line['detail']}")
    return " ".join(words).replace("] :", "]:")


def assumed(assumptions: list[str]) -> Iterator[str]:
    """What is assumed, without the sources: those are in the document and in `assur robots --json`."""
    if assumptions:
        yield ""
        yield "assumed, not known (sources: --json):"
        for assumption in assumptions:
            about, _, rest = assumption.partition(": ")
            yield f"  {about}: {rest.partition(': ')[0]}"


def everything(answer: dict[str, Any]) -> Iterator[Table | str]:
    """The whole answer for people, but for what the checker says."""
    yield from planned(answer) if answer["status"] == "planned" else not_planned(answer)
    yield ""
    yield from census(answer["census"])
    if answer["cut_by_clock"]:
        yield "The clock cut the search off; another run may find another plan."
    yield from assumed(answer["assumptions"])
    yield ""
    yield answer["notice"]

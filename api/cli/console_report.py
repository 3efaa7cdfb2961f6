"""An answer in the words of the shop: lines and tables for people, from the same document that machines get.

Lengths in millimetres, times in seconds. Texts that came from a request are printed, never interpreted.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from assur.api.cli.number_format import amount, number
from assur.api.problems import printable

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
BEFORE = ("control point", "inverse")
"""Stages that look at poses and times at which a point could be met; candidates are ways to those that are left."""
OF_UNIT = {"/s": "speed", "/s²": "acceleration", "/s³": "jerk"}
"""What a limit of this unit is one of."""
RESTING = 1e-9
"""A joint's velocity in rad/s or m/s up to which it is at rest, and a time in s up to which a knot is that of an
arrival: rounding of what is written down."""
SPENT = "the explain budget was spent"
"""Stands last among what was tried when there was no time for more; it is no change that was tried."""


class _Console(Console):
    def on_broken_pipe(self) -> None:
        """Leaves a closed pipe to the caller, who has an exit code for it; rich would end the process with 1."""
        raise BrokenPipeError


def console(*, stderr: bool = False) -> Console:
    """A console that prints texts as they are, as wide as the terminal or `WIDTH`. Raises `BrokenPipeError`."""
    made = _Console(stderr=stderr, markup=False, highlight=False, emoji=False)
    if not made.is_terminal:
        made.width = WIDTH
    return made


@contextmanager
def working(what: str) -> Iterator[None]:
    """Shows on standard error, if it is a terminal, that something is going on."""
    shown = console(stderr=True)
    if not shown.is_terminal:
        yield
        return
    with shown.status(f"{printable(what)} ..."):
        yield


def table(*columns: str) -> Table:
    """A table without a frame; the columns named with a leading ">" are numbers."""
    made = Table(box=None, pad_edge=False, header_style="bold")
    for name in columns:
        made.add_column(name.removeprefix(">"), justify="right" if name.startswith(">") else "left", overflow="fold")
    return made


def row(made: Table, *cells: object) -> None:
    """Adds a row; texts are printed as they are."""
    made.add_row(*(Text(printable(str(cell), 400)) for cell in cells))


def planned(answer: dict[str, Any]) -> Iterator[Table | str]:
    """What a planned answer says."""
    names = {arrival["step"]: arrival["control_point"] for arrival in answer["arrivals"]}
    legs = table("leg", ">from s", ">to s", "for", "")
    for leg in answer["legs"]:
        note = re.sub(r"\b(\d+) vias?\b", lambda m: f"by {m[1]} via{'' if m[1] == '1' else 's'}", leg["note"])
        row(legs, leg["kind"], f"{leg['from_s']:.3f}", f"{leg['to_s']:.3f}", names.get(leg["step"], ""), note)
    yield legs
    yield ""
    angles = ("yaw_rad", *(key for key in ("pitch_rad", "roll_rad") if key in answer["arrivals"][0]))
    head = ("arrival", ">at s", ">x mm", ">y mm", ">z mm", *(f">{key.removesuffix('_rad')} deg" for key in angles))
    arrivals = table(*head, ">along mm", ">window left s", "speed")
    for arrival in answer["arrivals"]:
        along, left, missed = arrival["along_m"], arrival["window_left_s"], arrival["missed_by"]
        beside = "" if missed is None else f"missed by {1e3 * missed['distance_m']:.1f} mm"
        row(
            arrivals,
            arrival["control_point"],
            f"{arrival['time_s']:.3f}",
            *(f"{1e3 * x:z.1f}" for x in arrival["at_m"]),
            *(f"{math.degrees(arrival[key]):z.1f}" for key in angles),
            "" if along is None else f"{1e3 * along:z.1f}",
            "" if left is None else f"{left:z.3f}",
            beside or _met(answer["trajectory"], arrival),
        )
    yield from (arrivals, "")
    margins = answer["margins"]
    bound = answer["lower_bound_s"]
    least = f"; no plan takes less than {bound:.3f} s" if bound else "; no bound is known"
    yield f"duration            {answer['duration_s']:.3f} s{least}"
    yield f"what binds          {margins['binds']}{'; the jerk is unbounded' * (margins['jerk'] == 'unbounded')}"
    nearest = margins["nearest"]
    yield "smallest clearance  " + (
        "nothing is near"
        if nearest is None
        else f"{1e3 * nearest['gap_m']:z.2f} mm at {nearest['time_s']:.3f} s, "
        f"{' and '.join(nearest['bodies'])} ({_phase(answer['legs'], nearest)})"
    )


def _met(trajectory: dict[str, Any], arrival: dict[str, Any]) -> str:
    """How a point was met: with its velocity, standing still where it does; nothing for what is flown by."""
    rates = (
        rate
        for time, rate in zip(trajectory["time_s"], trajectory["velocity"], strict=True)
        if abs(time - arrival["time_s"]) <= RESTING
    )
    if any(all(abs(x) <= RESTING for x in rate) for rate in rates):
        return "met, at rest"
    return "matched" if arrival["matched"] else ""


def _phase(legs: list[dict[str, Any]], nearest: dict[str, Any]) -> str:
    """In which leg the arm is nearest; behind the last one it stands still."""
    after = nearest["phase"] == "WAIT" and nearest["time_s"] >= legs[-1]["to_s"] and legs[-1]["kind"] != "WAIT"
    return "standstill after the end" if after else str(nearest["phase"])


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
        tried = [change for change in answer["tried"] if change != SPENT]
        spent = f"; {SPENT}" if SPENT in answer["tried"] else ""
        yield f"what would not help  {', '.join(tried) or 'nothing was tried'}{spent}"


def census(document: dict[str, Any], *, planned: bool) -> Iterator[str]:
    """The census in sentences, most frequent refusal first; `planned`: whether there is a plan after all."""
    refused = document["refused"]
    lines = [line for line in document["lines"] if line["stage"] not in BEFORE]
    before = [line for line in document["lines"] if line["stage"] in BEFORE]
    several = sum(line["count"] for line in lines) > refused
    note = "; a candidate may be refused for several bodies" if several else ""
    yield f"{document['candidates']} candidates, {refused} refused{note}"
    others = document["candidates"] - refused
    if others > 0 and not planned:
        yield f"the other {others} were not refused: each leads a part of the way, or was set aside for a quicker one"
    yield from _kinds(lines)
    if before:
        yield "poses and times at which the points could be met, looked at before any candidate:"
        yield from _kinds(before)


def _kinds(lines: list[dict[str, Any]]) -> Iterator[str]:
    for line in lines[:CENSUS_LINES]:
        yield "  " + refusal(line)
    if len(lines) > CENSUS_LINES:
        yield f"  and {len(lines) - CENSUS_LINES} more kinds of refusal"


def refusal(line: dict[str, Any]) -> str:
    """One line of the census as a sentence: how many, why, by what, when, by how much."""
    often = "once" if line["count"] == 1 else f"{line['count']} times"
    words = [f"{often} {_event(line['reason'], line['bodies'], line['unit'])}"]
    interval = line.get("interval_s")
    if interval is not None and None not in interval:
        first, last = (f"{instant:.3f}" for instant in interval)
        words.append(f"at {first} s" if first == last else f"between {first} and {last} s")
    least, most = amount(line["least"], line["unit"]), amount(line["most"], line["unit"])
    if least and line["unit"] == "1":
        words.append(_share(line["reason"], line["least"], line["most"]))
    elif least:
        words.append(f"by {least}" if least == most else f"by {least} to {most}")
    words.append(f"[step {line['step'] + 1}, {line['stage']}]")
    if line["detail"] and not line["bodies"]:
        words.append(f": {line['detail']}")
    return " ".join(words).replace("] :", "]:")


def _share(reason: str, least: float, most: float) -> str:
    """An amount without a unit: a margin that is short, or what is above a limit, in per cent of it."""
    margin = {"NEAR_PARALLEL_SINGULARITY": "parallel margin", "NEAR_SINGULARITY": "singularity margin"}.get(reason)
    ends = [number(x if margin else 100.0 * x, 3) for x in (least, most)]
    span = ends[0] if ends[0] == ends[1] else " to ".join(ends)
    return f"by {span} % of the limit" if margin is None else f"({margin} short by {span})"


def _event(reason: str, names: list[str], unit: str) -> str:
    """What happened, and to whom: `names` are bodies, or the joint where a joint is at its limit."""
    if reason in ("BODY_COLLISION", "SELF_COLLISION") and len(names) == 2:
        return f"{names[0]} would hit {names[1]}"
    if reason == "JOINT_LIMIT" and len(names) == 1:
        return f"{names[0]} would pass its limit"
    if reason == "MOTION_LIMIT" and (what := OF_UNIT.get(unit.removeprefix("rad").removeprefix("m"))):
        return f"the {what} of {' and '.join(names) or 'a joint'} would pass its limit"
    return SAYS.get(reason, reason) + (f" ({' and '.join(names)})" if names else "")


def assumed(assumptions: list[str]) -> Iterator[str]:
    """What is assumed, without the sources: those are in the document and in `assur robots --json`."""
    if assumptions:
        yield ""
        yield "assumed, not known (sources: --json):"
        for assumption in assumptions:
            yield "  " + ": ".join(assumption.split(": ")[:2])


def everything(answer: dict[str, Any]) -> Iterator[Table | str]:
    """The whole answer for people, but for what the checker says."""
    yield from planned(answer) if answer["status"] == "planned" else not_planned(answer)
    yield ""
    yield from census(answer["census"], planned=answer["status"] == "planned")
    if answer["cut_by_clock"]:
        yield "The clock cut the search off; another run may find another plan."
    yield from assumed(answer["assumptions"])
    yield ""
    yield answer["notice"]

"""An answer in the words of the shop: lines and tables for people, from the same document that machines get.

Lengths in millimetres, times in seconds. Texts that came from a request are printed, never interpreted.
"""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from assur.api.problems import printable
from assur.planner.report.number_format import amount
from assur.scenes.numbers import at_rest
from assur.scenes.schema.task import TAKEN_AWAY

WIDTH = 110
"""Columns where the output is not a terminal."""
CENSUS_LINES = 8
"""So many kinds of refusal are printed; the document has them all."""

BEFORE = ("control point", "inverse")
"""Stages that look at poses and times at which a point could be met; candidates are ways to those that are left."""
APART_M = 0.002
"""A larger distance of a part from tool or support is reported, m: jaws that are open are nearer."""


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


def rows(columns: Iterable[str], cells: Iterable[Iterable[object]]) -> Table:
    """A table with its rows."""
    made = table(*columns)
    for each in cells:
        row(made, *each)
    return made


def findings(verdict: dict[str, Any]) -> Table:
    """What a checker has found wrong."""
    found = ((each["what"], amount(each["amount"], each["unit"]), each["where"]) for each in verdict["findings"])
    return rows(("what is wrong", ">by", "where"), found)


def planned(answer: dict[str, Any]) -> Iterator[Table | str]:
    """What a planned answer says."""
    names = {arrival["step"]: arrival["control_point"] for arrival in answer["arrivals"]}
    legs = (
        (leg["kind"], f"{leg['from_s']:.3f}", f"{leg['to_s']:.3f}", names.get(leg["step"], ""), leg["note"])
        for leg in answer["legs"]
    )
    yield from (rows(("leg", ">from s", ">to s", "for", ""), legs), "")
    angles = ("yaw_rad", *(key for key in ("pitch_rad", "roll_rad") if key in answer["arrivals"][0]))
    wrist = answer["trajectory"]["joint_names"][-1] if answer["trajectory"]["joint_units"][-1] == "rad" else None
    head = ("arrival", ">at s", ">x mm", ">y mm", ">z mm", *(f">{key.removesuffix('_rad')} deg" for key in angles))
    head += ("mode", *([] if wrist is None else [f">{wrist} deg"]))
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
            arrival["mode"] or "",
            *([] if wrist is None else [f"{math.degrees(arrival['joints'][-1]):z.1f}"]),
            "" if along is None else f"{1e3 * along:z.1f}",
            "" if left is None else f"{left:z.3f}",
            beside or _met(answer["trajectory"], arrival),
        )
    yield from (arrivals, "")
    followed = [arrival for arrival in answer["arrivals"] if arrival["trace"]]
    if followed:
        paths = table("traced path", ">mm", ">mm/s from", ">to", ">off by mm at most")
        for arrival in followed:
            path = arrival["trace"]
            speeds = (f"{1e3 * path[key]:.2f}" for key in ("slowest_m_s", "fastest_m_s"))
            off = f"{1e3 * path['error_m']:.4f}"
            row(paths, arrival["control_point"], f"{1e3 * path['length_m']:.2f}", *speeds, off)
        yield from (paths, "")
    unsure = [arrival for arrival in answer["arrivals"] if (arrival["error"] or {}).get("position_m")]
    if unsure:
        errors = table("may be off", ">mm", ">yaw deg", "by cause, mm")
        for arrival in unsure:
            error = arrival["error"]
            causes = ", ".join(f"{each['cause']} {1e3 * each['position_m']:.2f}" for each in error["causes"])
            position, yaw = f"{1e3 * error['position_m']:.2f}", f"{math.degrees(error['yaw_rad']):.2f}"
            row(errors, arrival["control_point"], position, yaw, causes)
        yield from (errors, "")
    yield from _apart(answer["arrivals"])
    margins = answer.get("margins", {})
    bound = answer.get("lower_bound_s")
    least = f"; no plan takes less than {bound:.3f} s" if bound else "; no bound is known"
    yield f"duration            {answer['duration_s']:.3f} s{least if 'lower_bound_s' in answer else ''}"
    if "binds" in margins:
        yield f"what binds          {margins['binds']}{'; the jerk is unbounded' * (margins['jerk'] == 'unbounded')}"
    busiest, tool = margins.get("busiest"), margins.get("tool")
    if busiest is not None:
        to = f" to {names[busiest['step']]}" * (busiest["step"] in names)
        long = f"{1e3 * busiest['at_limit_s']:.0f} of {1e3 * (busiest['to_s'] - busiest['from_s']):.0f} ms"
        yield f"  most in           {busiest['kind']}{to} ({long}); {margins['helps']} would help"
    if tool is not None:
        yield (
            f"tool point          up to {tool['speed_m_s']:.2f} m/s at {tool['speed_at_s']:.3f} s, "
            f"{tool['acceleration_m_s2']:.1f} m/s² at {tool['acceleration_at_s']:.3f} s"
        )
    yield f"load                {'; '.join(_loads(answer['load']))}"
    nearest = margins.get("nearest")
    if nearest is not None:
        phase = _phase(answer["legs"], nearest)
        both = " and ".join(nearest["bodies"])
        yield f"smallest clearance  {1e3 * nearest['gap_m']:z.2f} mm at {nearest['time_s']:.3f} s, {both} ({phase})"
    elif "nearest" in margins:
        yield "smallest clearance  nothing is near"
    placed = margins.get("placed")
    for where, pairs in (
        ("  in travel", margins.get("travel_pairs", ())),
        ("  near a point", margins.get("near_pairs", ())),
        ("parts put down", [] if placed is None else [placed]),
    ):
        for pair in pairs:
            both = " and ".join(pair["bodies"])
            yield f"{where:<18}  {1e3 * pair['gap_m']:z.2f} mm at {pair['time_s']:.3f} s, {both}"


def _apart(arrivals: list[dict[str, Any]]) -> Iterator[Table | str]:
    """Parts that are taken, or put down, at a distance."""
    between = {"grip_m": "the tool and the part that it takes", "support_m": "the part and what it is put down on"}
    far = [(each, key) for each in arrivals for key in between if each.get(key, 0.0) > APART_M]
    if far:
        cells = ((each["control_point"], f"{1e3 * each[key]:.2f}", between[key]) for each, key in far)
        yield from (rows(("distance at", ">mm", "between"), cells), "")


def _met(trajectory: dict[str, Any], arrival: dict[str, Any]) -> str:
    """How a point was met: with its velocity, standing still where it does; nothing for what is flown by."""
    if at_rest(trajectory, arrival["time_s"]):
        return "met, at rest"
    return "matched" if arrival["matched"] else ""


def _loads(load: dict[str, Any]) -> Iterator[str]:
    """Each load once: mass, inertia, and the share of the acceleration where that is less than all."""
    printed = set[str]()
    for each in load["carried"]:
        inertia = "" if each["inertia_kgm2"] is None else f", {each['inertia_kgm2']:.3g} kg·m²"
        share = each["acceleration_share"]
        scaled = "" if share == 1.0 else f", acceleration and jerk {100 * share:.3g} %"
        what = "tool" if each["part"] is None else f"with {each['part']}"
        words = f"{what} {each['mass_kg']:.4g} kg{inertia}{scaled}"

        if words not in printed:
            printed.add(words)
            yield words


def _phase(legs: list[dict[str, Any]], nearest: dict[str, Any]) -> str:
    """In which leg the arm is nearest; after the last one it is at rest."""
    after = nearest["phase"] == "WAIT" and nearest["time_s"] >= legs[-1]["to_s"] and legs[-1]["kind"] != "WAIT"
    return "standstill after the end" if after else str(nearest["phase"])


def not_planned(answer: dict[str, Any]) -> Iterator[Table | str]:
    """What a refused request says."""
    proved = "proved: no plan exists" if answer["proved"] else "not proved: the search found none, but a plan may exist"
    yield f"not planned         {answer['reason']} ({proved})"
    yield answer["sentence"]
    relaxation = answer["relaxation"]
    if relaxation is not None:
        yield (
            f"what would help     {relaxation['what']}: {relaxation['value']} "
            f"(then {relaxation['duration_s']:.3f} s; tried)"
        )
        if relaxation.get("set"):
            values = (f"{path}={json.dumps(value)}" for path, value in relaxation["set"].items())
            yield "try                 " + " ".join(f"--set {shlex.quote(printable(each))}" for each in values)
    elif answer["tried"]:
        yield "what would not help, each tried by itself:"
        yield from _in_vain(answer["tried"])
        if answer["explain_budget_spent"]:
            yield "  the time for trying changes was over (explain_budget_s): others were not tried"
    elif answer["explain_budget_spent"]:
        yield "what would help     not known: the time for trying changes was over (state a larger explain_budget_s)"


CHANGED = {
    "window": "another window",
    "latest end": "a later end",
    "acceleration time": "another acceleration time",
    "elbow": "another elbow side",
    "pitch": "another pitch",
    "match": "no match of the velocity",
    "process speed": "a lower process speed",
    "blend": "a larger blend",
    "singularity margin": "a smaller singularity margin",
    "without": "leaving out a body or robot",
    "pair clearance": "less clearance of one pair",
    "clearance": "less clearance of all pairs",
    "budget": "a longer search",
    "heights": "a shorter approach or depart",
    "straight part": "a longer approach or depart",
    "point height": "a higher point",
    "place heights": "higher places",
    "contact tolerance": "a larger contact tolerance",
    "dwell": "a shorter dwell",
    "belt speed": "a slower belt",
}
"""What each kind of change changes."""


def _in_vain(tried: list[str]) -> Iterator[str]:
    """A line for each change, those of one kind together below the first, which says what is changed."""
    groups: dict[str, list[str]] = {}
    for change in tried:
        what, _, value = change.partition(": ")
        groups.setdefault(CHANGED.get(what, what), []).append(value)
    width = max(map(len, groups), default=0)
    for what, values in groups.items():
        for k, value in enumerate(values):
            yield f"  {'' if k else what:{width}}  {printable(value)}"


def census(document: dict[str, Any], *, planned: bool) -> Iterator[Table | str]:
    """The census, most frequent refusal first; `planned`: whether there is a plan after all."""
    refused = document["refused"]
    lines = [line for line in document["lines"] if line["stage"] not in BEFORE]
    before = [line for line in document["lines"] if line["stage"] in BEFORE]
    several = sum(line["count"] for line in lines) > refused
    note = "; a candidate may be refused for several bodies" if several and refused else ""
    count = document["candidates"]
    yield f"{count} {'candidate' if count == 1 else 'candidates'}, {refused} refused{note}"
    others = document["candidates"] - refused
    if others > 0 and not planned:
        one = others == 1
        many = "1 candidate was" if one else f"{others} candidates were"
        yield f"{many} not refused: {'it ends' if one else 'they end'} before the last step, or a quicker one was used"
    yield from _kinds(lines)
    if before:
        yield "why control points cannot be met at some times or poses, found before any candidate:"
        yield from _kinds(before)


def _kinds(lines: list[dict[str, Any]]) -> Iterator[Table | str]:
    if not lines:
        return
    made = table(">  times", ">step", "stage", "what", ">between s", ">short by")
    for line in lines[:CENSUS_LINES]:
        interval = line["interval_s"]
        span = (
            ""
            if interval is None or None in interval
            else " and ".join(dict.fromkeys(f"{instant:.3f}" for instant in sorted(interval)))
        )
        least, most = amount(line["least"], line["unit"]), amount(line["most"], line["unit"])
        by = least if least == most else f"{least} to {most}"
        row(made, line["count"], line["step"] + 1, line["stage"], line["detail"], span, by)
    yield made
    if len(lines) > CENSUS_LINES:
        more = len(lines) - CENSUS_LINES
        yield f"  and {more} more {'kind' if more == 1 else 'kinds'} of refusal"


def assumed(assumptions: list[str], *, details: bool) -> Iterator[str]:
    """How many numbers are assumed; with `details` each of them, without its source: that is in the document."""
    count = len(assumptions)
    if not count:
        return
    what = "assumption about the robot and the cell" if count == 1 else "assumptions about the robot and the cell"
    if not details:
        for part, _, when in (each.partition(f": {TAKEN_AWAY} ") for each in assumptions if TAKEN_AWAY in each):
            yield f"taken away          {part}, {when}"
        yield f"{count} {what} (--details lists {'it' if count == 1 else 'them'})"
        return
    yield f"{count} {what} (sources: --json):"
    for assumption in assumptions:
        yield "  " + ": ".join(assumption.split(": ")[:2])


def everything(answer: dict[str, Any], *, details: bool = False) -> Iterator[Table | str]:
    """The whole answer for people, but for what the checker says. `details`: with every assumption."""
    yield from planned(answer) if answer["status"] == "planned" else not_planned(answer)
    yield ""
    yield from census(answer["census"], planned=answer["status"] == "planned")
    if answer["cut_by_clock"]:
        longer = "" if answer["status"] == "planned" else " A larger budget_s gives it more time."
        yield f"The clock cut the search off; another run may find another plan.{longer}"
    for warning in answer.get("warnings", ()):
        yield f"warning             {warning['detail']}"
    yield from assumed(answer["assumptions"], details=details)
    yield ""
    yield answer["notice"]

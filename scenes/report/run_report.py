"""A page about a run: its log as the viewer plays it, what the arm did when, throughput and cycles."""

from __future__ import annotations

import html
import platform
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from assur.planner.errors import InputError
from assur.scenes.answer import NOTICE
from assur.scenes.report.assembly import page
from assur.scenes.report.report import card, lines, pairs, table
from assur.scenes.report.run_charts import Span, by_minutes, histogram, over_time
from assur.scenes.requests import cell_of
from assur.scenes.session.executed import LoggedPlan, executed_plans, worst
from assur.scenes.session.session import number
from assur.scenes.simulation import words
from assur.scenes.simulation.leg_times import LegTimes
from assur.scenes.view.run import ExecutedPlan, run_view

Document = dict[str, Any]
SHOWN_S = 60.0
"""So much of a run is played, s."""
DOES = {
    "run-pick": "to a part",
    "run-grip": "picks",
    "run-place": "to its place",
    "run-drop": "puts down",
    "run-home": "to the refuge",
    "run-wait": "waits",
}
"""What the arm does, by classes of the style."""
TRACKING = ("APPROACH", "FOLLOW", "DEPART")


def run_report(
    events: Iterable[Document],
    *,
    title: str,
    about: str,
    version: str,
    from_s: float = 0.0,
    found: Document | None = None,
    values: Mapping[str, object] | None = None,
) -> str:
    """The page as HTML. `events`: the calls of a log; `from_s`: since the start of the run, when what is played begins;
    `found`: the result of the simulation whose first run this is, if it is one, and `values` that were set in its cell,
    by their paths. Raises `InputError` for calls in which
    no motion was executed, and for a time behind the run."""
    plans, until_s = executed_plans(events)
    if not plans:
        raise InputError("log", "no motion", "the log of a session whose clock was advanced")
    starts_s = plans[0].starts_s
    begin_s = starts_s + number("from_s", from_s, 0.0, until_s - starts_s - 1e-6)
    played = [each for each in plans if each.until_s > begin_s and each.starts_s < begin_s + SHOWN_S]
    # behind 5 km of a conveyor its places are counted anew, and the view has one count
    played = [each for each in played if each.request.get("frames") == played[0].request.get("frames")]
    view = run_view([ExecutedPlan(cell_of(each.request), each.answer, each.starts_s, each.until_s) for each in played])
    placed = [time for plan in plans for time in plan.handled("place")]
    cycles = [(plan.until_s - plan.starts_s) for plan in plans if plan.handled("place")]
    figures = _figures(plans, placed, cycles, until_s - starts_s, found)
    cards = [card("About this cell", f"<p>{html.escape(about)}</p>", wide=True)] if about else []
    if values:
        cards.append(card("Values that were set in the cell", lines(words.set_options(values), ""), wide=True))
    cards += [
        card("The run", figures),
        card(f"What to know{_over(found)}", lines([*_known(found), _played(played, starts_s)], "")),
        card(
            "What the arm does, a line for each minute", by_minutes(_spans(plans), starts_s, until_s, DOES), wide=True
        ),
        card("Parts a minute, over a minute each", over_time(placed, starts_s, until_s), wide=True),
        card("Cycles, from the start of one plan with a place to that of the next", histogram(cycles), wide=True),
        card("Legs", _legs(plans, found), wide=True),
        *_helps(found),
        card("Versions", pairs([("assur", version), ("Python", platform.python_version()), ("NumPy", np.__version__)])),
        card("What this is not", f"<p>{html.escape(NOTICE)}</p>", wide=True),
    ]
    rate = 60.0 * len(placed) / (until_s - starts_s)
    head = (
        f'<span class="chip good">{rate:.1f} parts a minute</span><span class="chip">{until_s - starts_s:.0f} s</span>'
    )
    return page(title, head, '<div class="facts">' + "".join(cards) + "</div>", view)


def _figures(
    plans: Sequence[LoggedPlan],
    placed: Sequence[float],
    cycles: Sequence[float],
    lasts_s: float,
    found: Document | None,
) -> str:
    picked = sum(len(plan.handled("pick")) for plan in plans)
    moving = sum(end - begin for begin, end, what in _spans(plans) if what != "run-wait")
    rows = [
        ("simulated", f"{lasts_s:.1f} s"),
        ("parts a minute", f"{60.0 * len(placed) / lasts_s:.2f}"),
        ("picked, put down", f"{picked}, {len(placed)}"),
        *([] if found is None else [(key, str(found["runs"][0][key])) for key in ("known", "missed", "remaining")]),
        ("from one plan with a place to the next, mean and median", _both(cycles)),
        ("the arm moves", f"{100.0 * moving / lasts_s:.0f} % of the time"),
        ("worst error of a pick", words.pick_error({"worst_pick_error": worst(each.pick_error() for each in plans)})),
        ("plans, each proved", str(len(plans))),
    ]
    return pairs(rows)


def _both(cycles: Sequence[float]) -> str:
    return f"{np.mean(cycles):.3f} s, {np.median(cycles):.3f} s" if cycles else "–"


def _played(played: Sequence[LoggedPlan], starts_s: float) -> str:
    begin, end = played[0].starts_s - starts_s, played[-1].until_s - starts_s
    return (
        f"The viewer above plays {begin:.1f} s to {end:.1f} s of the run. A part that is first seen later is on its "
        f"conveyor from the beginning of the plan that has it."
    )


def _spans(plans: Sequence[LoggedPlan]) -> Iterator[Span]:
    """What the arm does, from when until when."""
    for plan in plans:
        for leg, kind, home in plan.legs():
            near = leg["kind"] in TRACKING
            what = {"pick": "run-grip" if near else "run-pick", "place": "run-drop" if near else "run-place"}.get(kind)
            if leg["kind"] == "WAIT":
                what = "run-wait"
            yield leg["from_s"], leg["to_s"], what or ("run-home" if home else "run-pick")


def _known(found: Document | None) -> list[str]:
    """What a simulation has found, over all of its runs, in sentences."""
    if found is None:
        return []
    waiting = [f"The arm {what}, {share}." for what, share in words.waits(found)]
    first = f"This page shows the run with seed {found['runs'][0]['seed']}."
    together = [words.of_all_runs(found), first] if len(found["runs"]) > 1 else []
    return [*together, found["bottleneck"], *waiting, *found["notes"]]


def _legs(plans: Sequence[LoggedPlan], found: Document | None) -> str:
    """How long the legs take; of a simulation what binds them, too."""
    times, lasts_s = LegTimes(), plans[-1].until_s - plans[0].starts_s
    for plan in plans:
        times.add_plan(plan)
    return _table(words.LEGS, words.legs({"legs": times.rows(lasts_s)} if found is None else found["runs"][0]))


def _helps(found: Document | None) -> list[str]:
    """What would help, if that was tried."""
    if found is None or "helps" not in found:
        return []
    tried = "<p>no change was tried</p>"
    if found["helps"]:
        tried = _table(words.TRIALS, words.trials(found["helps"])) + lines(words.changes(found["helps"]), "")
    return [card(f"What would help{_over(found)}", tried, wide=True)]


def _over(found: Document | None) -> str:
    """Over how many runs figures are, where these are more than the run of the page."""
    many = 1 if found is None else len(found["runs"])
    return f", over {many} runs" if many > 1 else ""


def _table(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    right = [title.startswith(">") for title in titles]
    return table([title.removeprefix(">") for title in titles], [[*zip(row, right, strict=True)] for row in rows])

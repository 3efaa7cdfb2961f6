"""The verdict on a trajectory that was made elsewhere, for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.table import Table

from assur.api.cli.console_report import row, table
from assur.planner.report.number_format import amount

PLAN_HINT = (
    "judged as one motion in travel: nothing is gripped or let go, and nothing may touch; --plan judges it with the "
    "legs of a plan"
)


def _off(states: list[dict[str, Any]]) -> str:
    """By how much which joints begin elsewhere, positions before speeds: 0.2 rad (j1)."""
    return ", ".join(f"{each['by']:.4g} {each['unit']} ({each['joint']})" for each in states)


def lines(name: str, verdict: dict[str, Any]) -> Iterator[Table | str]:
    """What a verdict says, the first violation before all findings."""
    said = "proved" if verdict["ok"] else "refused"
    yield (
        f"{name}: {said}, {verdict['points']} points from {verdict['start_s']:.6g} s, "
        f"{verdict['duration_s']:.6g} s long, up to {1e3 * verdict['start_tolerance_s']:.6g} ms late"
    )
    if verdict["judged_as"] == "travel":
        yield PLAN_HINT
    if verdict["begins_off"]:
        yield f"begins {_off(verdict['begins_off'])} from the start of the request"
    for note in verdict["notes"]:
        yield f"read: {note}"
    if verdict["ends_moving"]:
        yield "ends moving: nothing after its last point is proved"
    first = verdict["first"]
    if first is not None:
        by = "" if first["amount"] is None else f", by {amount(first['amount'], first['unit'])}"
        yield f"first violation     {first['time_s']:.6g} s: {first['what']}{by}"
    nearest = verdict["clearance"]
    if nearest is not None:
        bodies = " and ".join(nearest["bodies"])
        yield f"smallest clearance  {1e3 * nearest['gap_m']:.2f} mm at {nearest['time_s']:.3f} s, {bodies}"
    jerks = [
        f"{each['joint']} {amount(each['highest'], each['unit'])}, limit {amount(each['of_request'], each['unit'])}"
        for each in verdict["jerk"]
        if each["highest"] is not None
    ]
    yield f"highest jerk        {'; '.join(jerks) or 'no bound'}"
    if verdict["findings"]:
        found = table("what is wrong", ">by", "where")
        for finding in verdict["findings"]:
            row(found, finding["what"], amount(finding["amount"], finding["unit"]), finding["where"])
        yield ""
        yield found
    yield verdict["notice"]

"""The result of a simulation in words: what limits the parts a minute, waits, legs, and what would help."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Iterator, Mapping
from typing import Any

Document = dict[str, Any]
PARTS = ("known", "picked", "placed", "missed", "remaining")
"""Counts of parts: those that are known were picked, were missed, or remain."""
WAITS_FOR = {
    "part": "a part",
    "slot": "a free slot",
    "unseen": "a part to be clear of what is not seen yet",
    "bodies": "bodies to pass",
    "reach": "a part that it can reach in its window",
    "refused": "a part that can be planned",
    "planning": "the end of planning",
}
"""What the arm waits for, in words."""
MORE = {"slot": ": more carriers a minute, or more slots on each, would help"}
"""What would help where it waits for that."""
LEAST_SHARE, NOTABLE = 5e-4, 0.1
"""Least share of the time that is reported in words, and of a wait that counts as a limit."""
LEGS = ("leg", ">mean s", ">of the time", ">count", "bound most often by")
TRIALS = ("what would help, in parts a minute", ">with table times", ">proved", ">95 % interval", "")
"""Titles of the tables; columns that begin with ``>`` are numbers."""
ONE_SEED = "one seed: whether a difference is more than chance is not known; --seeds 5 gives an interval"


def bottleneck(found: Document) -> str:
    """What limits the parts a minute, in some sentences: plans that are refused, what the arm waits for while parts
    come, the leg that takes longest; and the parts that come, where none is missed."""
    legs = [row for row in found["legs"] if not row["leg"].startswith("wait")]
    if not legs:
        return "The arm was not moved."
    longest, refused, sentences = max(legs, key=lambda row: row["share"]), sum(found["refusals"].values()), []
    takes = f"the {longest['leg']} takes longest ({_percent(longest['share'])}){_bound(longest)}."
    if refused > found["placed"]:
        first = next(iter(found["refusals"]))
        sentences.append(f"{refused} of {found['plans']} motions could not be planned, most often for {first}.")
    waits = [(share, reason) for reason, share in found["waiting"].items() if reason != "part"]
    share, reason = max(waits, default=(0.0, ""))
    if share >= NOTABLE and found["missed"]:
        sentences.append(f"The arm waits for {WAITS_FOR[reason]} {_percent(share)} of the time{MORE.get(reason, '')}.")
    sentences.append(f"The arm moves {_percent(found['moving'])} of the time; {takes}")
    if found["picked"] and not found["missed"]:
        sentences.append("No part was missed: it takes all that come.")
    return " ".join(sentences)


def _bound(row: Document) -> str:
    """What binds most legs of a kind, as the end of a sentence; nothing of those that are no travel."""
    if not row["leg"].startswith("travel"):
        return ""
    if 2 * sum(row["binds"].values()) < row["count"]:
        return "; mostly no limit binds it: the arm has time to spare"
    return f"; {next(iter(row['binds']))} binds it"


def of_all_runs(found: Document) -> str:
    """The figures of several runs together, in a sentence."""
    runs, low_high = found["runs"], found["interval"]
    within = "" if low_high is None else " (95 % interval {:.1f} to {:.1f})".format(*low_high)
    parts = f"{found['picked']} of {found['known']} parts were picked, {found['missed']} were missed"
    return f"All {len(runs)} runs together: {found['parts_per_minute']:.1f} parts a minute{within}; {parts}."


def waits(found: Document) -> list[tuple[str, str]]:
    """What the arm waits for, and the share of the time."""
    shares = [(WAITS_FOR[reason], share) for reason, share in found["waiting"].items() if share >= LEAST_SHARE]
    return [(f"waits for {what}", share_of_time(share)) for what, share in shares]


def share_of_time(share: float) -> str:
    """A share of the time, in %."""
    return f"{100.0 * share:.1f} % of the time"


def legs(found: Document) -> Iterator[tuple[str, ...]]:
    """The rows of the table `LEGS`."""
    for row in found["legs"]:
        limit, often = next(iter(row["binds"].items()), ("", 0))
        bound = f"{limit} ({often} of {row['count']})" if limit else ""
        yield row["leg"], f"{row['mean_s']:.3f}", f"{100.0 * row['share']:.1f} %", f"{row['count']}", bound


def pick_error(found: Document) -> str:
    """The worst error of a pick that the proofs allow."""
    error = found["worst_pick_error"]
    return f"{1e3 * error['position_m']:.2f} mm, {math.degrees(error['yaw_rad']):.2f} deg"


def trials(helps: list[Document]) -> Iterator[tuple[str, ...]]:
    """The rows of the table `TRIALS`."""
    for trial in helps:
        low_high = "" if trial["interval"] is None else "{:+.1f} to {:+.1f} %".format(*trial["interval"])
        yield trial["what"], _signed(trial["table_percent"]), _signed(trial["percent"]), low_high, _shown(trial)


def set_options(values: Mapping[str, object]) -> list[str]:
    """Values of a cell, by their paths, as a shell takes the options that set them."""
    return [f"--set {shlex.quote(f'{path}={json.dumps(value)}')}" for path, value in values.items()]


def changes(helps: list[Document]) -> list[str]:
    """How each change that was tried is made."""
    return [f"{trial['what']}: {' '.join(set_options(trial['set']))}" for trial in helps]


def _shown(trial: Document) -> str:
    """What a trial has shown."""
    if trial["fault"] is not None:
        return f"ended with an error: {trial['fault']}"
    if trial["gain"] is None:
        return "table times only" if trial["percent"] is None else "one seed"
    if trial["gain"]:
        return "a gain"
    return "a loss" if trial["interval"][1] < 0.0 else "within chance"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"


def _signed(value: float | None) -> str:
    return "" if value is None else f"{value:+.1f} %"

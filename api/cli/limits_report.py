"""Limits that were found in a log, as tables for people, in SI as a robot's file may have them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.table import Table

from assur.api.cli.console_report import row, table
from assur.scenes.fitted_limits import RATES, in_words, kept

LEGEND = "unit: of positions; speed, acceleration and jerk are the same per s, s2 and s3; +-: the whole error"


def fitted(document: dict[str, Any]) -> Iterator[Table | str]:
    """What was found, a row per joint; then why what is missing is missing."""
    log, of_robot = document["log"], "robot" in document
    yield (
        f"{log['file']}: {log['rows']} rows, {log['duration_s']:.3f} s, usually {1e3 * log['step_s']:.3g} ms apart, "
        f"{document['positions']} positions"
    )
    yield from (f"read: {note}" for note in document["notes"])
    yield ""
    limits = [name for rate in RATES for name in (f">{rate}", *[">robot's"] * of_robot)]
    made = table("joint", "unit", ">speed reached", *limits, ">servo lag ms", ">encoder step", ">moves")
    for joint in document["joints"]:
        cells = []
        for rate in RATES:
            cells.append(in_words(joint[rate], unit=False))
            if of_robot:
                cells.append(f"{joint[rate]['of_robot']:.4g}")
        step, lag = joint["encoder_step"], joint["lag_s"]
        row(
            made,
            joint["name"],
            joint["unit"],
            f"{joint['velocity']['value']:.4g}",
            *cells,
            "" if lag is None else f"{1e3 * lag[0]:.2f} to {1e3 * lag[1]:.2f}",
            "" if step is None else f"{step['value']:.3g}",
            max(joint[rate]["moves"] for rate in RATES),
        )
    yield from (made, "", LEGEND)
    for joint in document["joints"]:
        for rate in RATES:
            if joint[rate]["sentence"] is not None:
                yield f"{joint['name']} {rate}: {joint[rate]['sentence']}"
    if of_robot:
        scales = ", ".join(f"{rate}: {scale:g}" for rate, scale in document["limits"].items())
        yield f"limits of a request with this robot: {scales or 'none, its own are not above what was found'}"
        yield from kept(document)

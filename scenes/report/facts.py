"""What a report says beside its viewer, as HTML: arrivals, margins, census, assumptions, proof, request and answer."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

Document = dict[str, Any]
Cell = tuple[str, bool]
"""Text of a cell, and whether it is a number."""
RESTING = 1e-9
"""A joint's velocity in rad/s or m/s up to which it is at rest, and a time in s up to which a knot is that of an
arrival."""
APART = {"grip_m": "tool to part mm", "support_m": "part to support mm"}
"""Distances that an arrival may have, and what they are called; there is no column where no arrival has one."""
RATES = ("velocity", "acceleration", "jerk")


def number(value: float | None, digits: int = 1, factor: float = 1.0) -> Cell:
    """A number with so many digits; null: a dash."""
    return ("–" if value is None else f"{factor * value:.{digits}f}", True)


def text(value: object) -> Cell:
    """Text as it is; null: nothing."""
    return ("" if value is None else str(value), False)


def degrees(value: float | None, digits: int = 1) -> Cell:
    """An angle in rad as degrees."""
    return number(value, digits, 180.0 / math.pi)


def millimetres(value: float | None, digits: int = 1) -> Cell:
    """A length in m as mm."""
    return number(value, digits, 1000.0)


def table(head: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """A table; columns of numbers stand to the right."""
    listed = [list(row) for row in rows]
    right = [any(is_number for _, is_number in column) for column in zip(*listed, strict=True)] or [False] * len(head)
    cells = "".join(_cell("th", name, right[k]) for k, name in enumerate(head))
    body = "".join(
        "<tr>" + "".join(_cell("td", value, right[k]) for k, (value, _) in enumerate(row)) + "</tr>" for row in listed
    )
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>"


def _cell(tag: str, value: str, right: bool) -> str:
    kind = ' class="number"' if right else ""
    return f"<{tag}{kind}>{html.escape(value)}</{tag}>"


def pairs(items: Iterable[tuple[str, str]]) -> str:
    """Names and what they are."""
    return "<dl>" + "".join(f"<dt>{html.escape(a)}</dt><dd>{html.escape(b)}</dd>" for a, b in items) + "</dl>"


def lines(items: Sequence[str], none: str) -> str:
    """A list; or what to say where there is nothing."""
    if not items:
        return f"<p class='faint'>{html.escape(none)}</p>"
    return "<ul>" + "".join(f"<li>{html.escape(item)}</li>" for item in items) + "</ul>"


def card(title: str, body: str, *, wide: bool = False) -> str:
    """A part of the page."""
    kind = "card wide" if wide else "card"
    return f'<section class="{kind}"><h2>{html.escape(title)}</h2>{body}</section>'


def arrivals(answer: Document) -> str:
    """Where and when each control point is met."""
    head = [
        "point",
        "at s",
        "until s",
        "x mm",
        "y mm",
        "z mm",
        "yaw °",
        "mode",
        "met",
        "window left s",
        "may be off mm",
    ]
    apart = [key for key in APART if any(each.get(key) is not None for each in answer["arrivals"])]
    head += [APART[key] for key in apart]
    rows = [
        [
            text(each["control_point"]),
            number(each["time_s"], 3),
            number(each["until_s"], 3),
            *(millimetres(x) for x in each["at_m"]),
            degrees(each["yaw_rad"]),
            text(each.get("mode")),
            text(_met(answer["trajectory"], each)),
            number(each["window_left_s"], 3),
            millimetres((each.get("error") or {}).get("position_m"), 2),
            *(millimetres(each.get(key), 2) for key in apart),
        ]
        for each in answer["arrivals"]
    ]
    return table(head, rows)


def _met(trajectory: Document, arrival: Document) -> str:
    """How a point is met: at rest, with its velocity, or in position alone."""
    missed = arrival.get("missed_by")
    if missed is not None and missed["distance_m"] > 0.0:
        return f"missed by {1000 * missed['distance_m']:.1f} mm"
    times = zip(trajectory["time_s"], trajectory["velocity"], strict=True)
    there = [rates for time, rates in times if abs(time - arrival["time_s"]) <= RESTING]
    if any(all(abs(rate) <= RESTING for rate in rates) for rates in there):
        return "at rest"
    return "with its velocity" if arrival["matched"] else "in position"


def margins(answer: Document) -> str:
    """What binds, the smallest clearance, and the peaks of each joint."""
    found = answer["margins"]
    tool, load = found["tool"], answer["load"]
    rows = [("what binds", found["binds"]), ("would help", found["helps"])]
    for name, near in (("smallest clearance", found["nearest"]), ("parts put down", found.get("placed"))):
        if near is not None:
            both = " and ".join(near["bodies"])
            rows.append((name, f"{1000 * near['gap_m']:.2f} mm at {near['time_s']:.3f} s, {both}"))
    if tool is not None:
        rows.append(("tool point", f"up to {tool['speed_m_s']:.2f} m/s and {tool['acceleration_m_s2']:.1f} m/s²"))
    if answer["lower_bound_s"] is not None:
        rows.append(("no plan takes less than", f"{answer['lower_bound_s']:.3f} s"))
    heaviest = max((each["mass_kg"] for each in load["carried"]), default=0.0)
    if heaviest > 0.0:
        rows.append(("heaviest load", f"{heaviest:.3g} kg"))
    peaks = [
        [text(peak["joint"]), *(number(peak[f"{rate}_ratio"], 0, 100.0) for rate in RATES)] for peak in found["peaks"]
    ]
    return pairs(rows) + "<h3>Peaks of the joints, % of their limits</h3>" + table(["joint", *RATES], peaks)


def census(answer: Document) -> str:
    """What became of the candidates."""
    found = answer["census"]
    said = f"<p>{found['candidates']} candidates, {found['refused']} refused</p>"
    if not found["lines"]:
        return said
    rows = [[number(each["count"], 0), text(each["reason"]), text(each["detail"])] for each in found["lines"]]
    return said + table(["count", "reason", "what"], rows)


def refusal(answer: Document, verdict: Document | None) -> str:
    """Why there is no plan, and what the checker says of it."""
    relaxation = answer["relaxation"]
    rows = [
        ("reason", answer["reason"]),
        ("why", answer["sentence"]),
        ("proved for all times and modes", "yes" if answer["proved"] else "no"),
    ]
    if verdict is not None and not verdict["ok"]:
        rows.append(("checker", "the refusal is wrong: " + "; ".join(each["what"] for each in verdict["findings"])))
    elif verdict is not None and answer["proved"]:
        rows.append(("checker", "the refusal is right: no plan exists"))
    if relaxation is not None:
        rows.append(("a change that is proposed", f"{relaxation['what']}: {relaxation['value']}"))
    if verdict is not None and verdict["not_checked"]:
        rows.append(("not checked", ", ".join(verdict["not_checked"])))
    return pairs(rows) + ("<h3>Tried</h3>" + lines(answer["tried"], "") if answer["tried"] else "")


def proof(answer: Document, verdict: Document | None) -> str:
    """The certificate, and what the checker says of it."""
    certificate = answer["certificate"]
    if verdict is None:
        said = "the plan was not checked: the answer holds only the digest of its certificate"
    elif verdict["ok"]:
        said = "the plan is right: everything that it promises holds against the model"
    else:
        said = "the plan is wrong: " + "; ".join(finding["what"] for finding in verdict["findings"])
    return pairs(
        [
            ("checker", said),
            ("certificate", certificate["digest"]),
            ("rows", str(certificate["rows"])),
            ("covers", ", ".join(certificate["covers"])),
        ]
    )


def whole(title: str, document: object) -> str:
    """A document in full, folded."""
    shown = html.escape(json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False))
    return f"<details><summary>{html.escape(title)}</summary><pre>{shown}</pre></details>"

"""A report of an answer: the page with the viewer, the tables, and what of the documents was left out."""

from __future__ import annotations

import base64
import binascii
import hashlib
import html
import json
import math
import platform
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from assur.planner.report.straight_parts import assumed
from assur.scenes.answer import NOTICE
from assur.scenes.numbers import at_rest
from assur.scenes.reading.cell import Cell
from assur.scenes.report.assembly import page
from assur.scenes.view.answer_form import answer_in
from assur.scenes.view.document import view_of

Document = dict[str, Any]
MOST_BYTES = 1_000_000
"""A report is below this; where it would not be, long lists of numbers in its documents are left out."""
ONLY_PROVED = (
    "This is a plan with its proof, as an export writes it. Other parts of the answer are not in it: margins, "
    "contacts, candidates, warnings. The assumptions are those of the request."
)
"""What is noted where there is no whole answer."""
SHORTER = (10_000, 1_000, 100, 10)
"""Lists of numbers longer than this are left out, the first of these that makes the report small enough."""


def report_of(cell: Cell, given: Document, *, title: str, about: str, verdict: Document | None, version: str) -> str:
    """The report as HTML. `verdict`: of the checker on the answer (None: it was not called); `version`: of assur.

    Raises `DocumentError` below "plan".
    """
    answer = answer_in(given, cell.scene)
    assumptions = answer.get("assumptions", assumed(cell.scene))
    view = view_of(cell, answer)
    rows = len(given.get("certificate", ())) > len(answer.get("certificate", ()))
    request, left_out = _shown(cell.document, answer, rows=rows)
    if "census" not in answer:
        left_out.append(ONLY_PROVED)
    head = _chips(answer, verdict)
    for longest in (None, *SHORTER):
        notes = list(left_out)
        both = [request, answer]
        if longest is not None:
            both = [_without_long_lists(each, longest) for each in both]
            notes.append(f"Lists of more than {longest} numbers in request and answer are replaced by their digests.")
        notes += [
            f"{each['body']} is drawn with {each['shown']} of its {each['triangles']} triangles; its corners are off "
            f"by up to {1000 * each['off_m']:.1f} mm in the picture. What is proved is proved of the whole shape."
            for each in view["reduced"]
        ]
        body = _facts(answer, assumptions, both[0], both[1], about, verdict, version, notes)
        made = page(title, head, body, view)
        if len(made.encode()) < MOST_BYTES:
            break
    return made


def _chips(answer: Document, verdict: Document | None) -> str:
    def chip(text: str, kind: str = "") -> str:
        return f'<span class="chip {kind}">{html.escape(text)}</span>'

    if answer["status"] != "planned":
        found = [chip("not planned", "bad"), chip(answer["reason"])]
        if answer["proved"]:
            found.append(chip("proved"))
        return "".join(found)
    times = answer["trajectory"]["time_s"]
    found = [chip("planned", "good"), chip(f"{times[-1] - times[0]:.3f} s")]
    if verdict is not None:
        found.append(chip("checked", "good") if verdict["ok"] else chip("the checker refuses it", "bad"))
    nearest = answer.get("margins", {}).get("nearest")
    if nearest is not None:
        found.append(chip(f"nearest {1000 * nearest['gap_m']:.1f} mm"))
    return "".join(found)


def _facts(
    answer: Document,
    assumptions: Sequence[str],
    request: object,
    shown: object,
    about: str,
    verdict: Document | None,
    version: str,
    notes: list[str],
) -> str:
    cards = []
    if about:
        cards.append(card("About this cell", f"<p>{html.escape(about)}</p>", wide=True))
    if answer["status"] == "planned":
        cards.append(card("Arrivals", arrivals(answer), wide=True))
        if "margins" in answer:
            cards.append(card("Margins", margins(answer)))
        cards.append(card("Proof", proof(answer, verdict)))
    else:
        cards.append(card("Why there is no plan", refusal(answer, verdict), wide=True))
    warnings = [each["detail"] for each in answer.get("warnings", ())]
    if warnings:
        cards.append(card("Warnings", lines(warnings, "")))
    if "census" in answer:
        cards.append(card("Candidates", census(answer), wide=len(answer["census"]["lines"]) > 0))
    cards.append(card("Assumptions", lines(assumptions, "none")))
    versions = [
        ("assur", version),
        ("documents", answer["schema"]),
        ("Python", platform.python_version()),
        ("NumPy", np.__version__),
        ("request", answer.get("request_digest", "")),
    ]
    if "seed" in answer:
        versions.append(("seed", str(answer["seed"])))
    left_out = lines(notes, "Nothing was left out of request and answer.")
    cards.append(card("Versions and what was left out", pairs(versions) + "<h3>Left out</h3>" + left_out))
    documents = whole("Request", request) + whole("Answer", shown)
    cards.append(card("Documents", documents, wide=True))
    cards.append(card("What this is not", f"<p>{html.escape(answer.get('notice', NOTICE))}</p>", wide=True))
    return '<div class="facts">' + "".join(cards) + "</div>"


def _shown(request: object, answer: Document, *, rows: bool) -> tuple[object, list[str]]:
    """The request as it stands in the report, and what was left out of it and of the answer, in words."""
    notes = list[str]()
    shown = _without_mesh_data(request, notes)
    if rows:
        notes.append(f"The {answer['certificate']['rows']} rows of the certificate: its digest stands for them.")
    return shown, notes


def _without_mesh_data(value: object, notes: list[str]) -> object:
    """A document with the content of meshes replaced by its digest."""
    if isinstance(value, dict):
        found = {key: _without_mesh_data(item, notes) for key, item in value.items()}
        if isinstance(value.get("data"), str) and "unit" in value:
            try:
                content = base64.b64decode(value["data"], validate=True)
            except (binascii.Error, ValueError):
                content = value["data"].encode()
            digest = hashlib.sha256(content).hexdigest()
            found["data"] = f"{len(content)} bytes, SHA-256 {digest}"
            notes.append(f"A mesh of {len(content)} bytes: its digest {digest[:12]}… and what is drawn stand for it.")
        return found
    return [_without_mesh_data(item, notes) for item in value] if isinstance(value, list) else value


def _without_long_lists(value: object, longest: int) -> object:
    """A document with lists of more than so many numbers, rows of numbers included, replaced by their digests."""
    if isinstance(value, dict):
        return {key: _without_long_lists(item, longest) for key, item in value.items()}
    if not isinstance(value, list):
        return value
    count = sum(len(item) if isinstance(item, list) else 1 for item in value)
    if count > longest and all(isinstance(item, int | float | list) for item in value):
        digest = hashlib.sha256(json.dumps(value).encode()).hexdigest()
        return f"{count} numbers, SHA-256 {digest}"
    return [_without_long_lists(item, longest) for item in value]


TableCell = tuple[str, bool]
"""Text of a cell, and whether it is a number."""
APART = {"grip_m": "tool to part mm", "support_m": "part to support mm"}
"""Distances that an arrival may have, and what they are called; there is no column where no arrival has one."""
RATES = ("velocity", "acceleration", "jerk")


def number(value: float | None, digits: int = 1, factor: float = 1.0) -> TableCell:
    """A number with so many digits; null: a dash."""
    return ("–" if value is None else f"{factor * value:.{digits}f}", True)


def text(value: object) -> TableCell:
    """Text as it is; null: nothing."""
    return ("" if value is None else str(value), False)


def degrees(value: float | None) -> TableCell:
    """An angle in rad as degrees."""
    return number(value, 1, 180.0 / math.pi)


def millimetres(value: float | None, digits: int = 1) -> TableCell:
    """A length in m as mm."""
    return number(value, digits, 1000.0)


def table(head: Sequence[str], rows: Iterable[Sequence[TableCell]]) -> str:
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
    if at_rest(trajectory, arrival["time_s"]):
        return "at rest"
    return "with its velocity" if arrival["matched"] else "in position"


def margins(answer: Document) -> str:
    """What binds, the smallest clearance, and the peaks of each joint, as far as the answer states them."""
    found = answer["margins"]
    tool, load = found.get("tool"), answer["load"]
    rows = [("what binds", found["binds"]), ("would help", found["helps"])] if "binds" in found else []
    for name, near in (("smallest clearance", found["nearest"]), ("parts put down", found.get("placed"))):
        if near is not None:
            both = " and ".join(near["bodies"])
            rows.append((name, f"{1000 * near['gap_m']:.2f} mm at {near['time_s']:.3f} s, {both}"))
    if tool is not None:
        rows.append(("tool point", f"up to {tool['speed_m_s']:.2f} m/s and {tool['acceleration_m_s2']:.1f} m/s²"))
    if answer.get("lower_bound_s") is not None:
        rows.append(("no plan takes less than", f"{answer['lower_bound_s']:.3f} s"))
    heaviest = max((each["mass_kg"] for each in load["carried"]), default=0.0)
    if heaviest > 0.0:
        rows.append(("heaviest load", f"{heaviest:.3g} kg"))
    if "peaks" not in found:
        return pairs(rows)
    peaks = [
        [text(peak["joint"]), *(number(peak[f"{rate}_ratio"], 0, 100.0) for rate in RATES)] for peak in found["peaks"]
    ]
    return pairs(rows) + "<h3>Peaks of the joints, % of their limits</h3>" + table(["joint", *RATES], peaks)


def census(answer: Document) -> str:
    """What became of the candidates."""
    found = answer["census"]
    counts = f"<p>{found['candidates']} candidates, {found['refused']} refused</p>"
    if not found["lines"]:
        return counts
    rows = [[number(each["count"], 0), text(each["reason"]), text(each["detail"])] for each in found["lines"]]
    return counts + table(["count", "reason", "what"], rows)


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
        result = "the plan was not checked: the answer holds only the digest of its certificate"
    elif verdict["ok"]:
        result = "the plan is right: everything that it promises holds against the model"
    else:
        result = "the plan is wrong: " + "; ".join(finding["what"] for finding in verdict["findings"])
    return pairs(
        [
            ("checker", result),
            ("certificate", certificate["digest"]),
            ("rows", str(certificate["rows"])),
            ("covers", ", ".join(certificate["covers"])),
        ]
    )


def whole(title: str, document: object) -> str:
    """A document in full, folded."""
    shown = html.escape(json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False))
    return f"<details><summary>{html.escape(title)}</summary><pre>{shown}</pre></details>"

"""A report of an answer: the page with the viewer, the tables, and what of the documents was left out."""

from __future__ import annotations

import base64
import binascii
import hashlib
import html
import json
import platform
from collections.abc import Sequence
from typing import Any

import numpy as np

from assur.planner.report.straight_parts import assumed
from assur.scenes.answer import NOTICE
from assur.scenes.reading.cell import Cell
from assur.scenes.report import facts
from assur.scenes.report.assembly import page
from assur.scenes.view.answer_form import answer_in
from assur.scenes.view.document import view_of

Document = dict[str, Any]
MOST_BYTES = 1_000_000
"""A report is below this; where it would not be, long lists of numbers in its documents are left out."""
ONLY_PROVED = (
    "This is a plan with its proof, as an export writes it. What the search and its answer said is not in it: margins, "
    "contacts, candidates, warnings. The assumptions are those of the request."
)
"""What is noted where there is no whole answer."""
SHORTER = (10_000, 1_000, 100, 10)
"""Lists of numbers longer than this are left out, the first of these that makes the report small enough."""


def report_of(cell: Cell, given: Document, *, title: str, about: str, verdict: Document | None, version: str) -> str:
    """The report as HTML. `verdict`: what the checker says of the answer (None: it was not asked); `version`: of assur.

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
        cards.append(facts.card("About this cell", f"<p>{html.escape(about)}</p>", wide=True))
    if answer["status"] == "planned":
        cards.append(facts.card("Arrivals", facts.arrivals(answer), wide=True))
        if "margins" in answer:
            cards.append(facts.card("Margins", facts.margins(answer)))
        cards.append(facts.card("Proof", facts.proof(answer, verdict)))
    else:
        cards.append(facts.card("Why there is no plan", facts.refusal(answer, verdict), wide=True))
    warnings = [each["detail"] for each in answer.get("warnings", ())]
    if warnings:
        cards.append(facts.card("Warnings", facts.lines(warnings, "")))
    if "census" in answer:
        cards.append(facts.card("Candidates", facts.census(answer), wide=len(answer["census"]["lines"]) > 0))
    cards.append(facts.card("Assumptions", facts.lines(assumptions, "none")))
    versions = [
        ("assur", version),
        ("documents", answer["schema"]),
        ("Python", platform.python_version()),
        ("NumPy", np.__version__),
        ("request", answer.get("request_digest", "")),
    ]
    if "seed" in answer:
        versions.append(("seed", str(answer["seed"])))
    said = facts.lines(notes, "Nothing was left out of request and answer.")
    cards.append(facts.card("Versions and what was left out", facts.pairs(versions) + "<h3>Left out</h3>" + said))
    documents = facts.whole("Request", request) + facts.whole("Answer", shown)
    cards.append(facts.card("Documents", documents, wide=True))
    cards.append(facts.card("What this is not", f"<p>{html.escape(answer.get('notice', NOTICE))}</p>", wide=True))
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

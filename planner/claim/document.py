"""A claim as a JSON document, a proof bundle, and back (docs/bundle.md). Indices in a document count within an arm, a
body or the whole, as its schema says; in tables they are rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assur.planner.claim import columns as c
from assur.planner.claim import forms
from assur.planner.claim.columns import Claim
from assur.planner.claim.forms import Document, object_of
from assur.planner.claim.labels import Labels

FORM = "assur-bundle/3"
Rows = list[list[float]]


def document_of(claim: Claim, labels: Labels) -> Document:
    """The document of a claim, whose rows are called as `labels` say."""
    rows: dict[str, Rows] = {name: each.tolist() for name, each in claim._asdict().items()}
    joints = int(claim.arms[0, c.ARM_JOINTS])
    found: Document = {
        "schema": FORM,
        "request_digest": labels.request_digest,
        "plan_digest": labels.plan_digest,
        "arms": [arm_document(rows, arm, *label) for arm, label in zip(rows["arms"], labels.arms, strict=True)],
        "frames": [frame_document(rows, k, name) for k, name in enumerate(labels.frames)],
        "bodies": [body_document(rows, body, name) for body, name in zip(rows["bodies"], labels.bodies, strict=True)],
        "phases": [_phase(rows, k, kind) for k, kind in enumerate(labels.phases)],
        "required": _required(claim, rows, joints),
    }
    for name, form in forms.SECTIONS.items():
        found[name] = [object_of(form, row, joints) for row in rows[name]]
        if name in forms.NAMED:
            for each, label in zip(found[name], getattr(labels, name), strict=True):
                each["name"] = label
    return found


def _span(rows: Rows, row: Sequence[float], first: int) -> Rows:
    """The rows that a row names by the columns `first` (where they begin) and `first + 1` (how many)."""
    begin, count = int(row[first]), int(row[first + 1])
    return rows[begin : begin + count]


def arm_document(rows: dict[str, Rows], arm: list[float], name: str, links: Sequence[str]) -> Document:
    """An arm, given as its row in `arms`, with its knots and links."""
    n, first, knots = int(arm[c.ARM_JOINTS]), int(arm[c.ARM_LINK]), _span(rows["knots"], arm, c.ARM_KNOT)
    states = {key: [row[at : at + n] for row in knots] for key, at in forms.STATES}

    def angle(row: float) -> Document | None:
        if row < 0.0:
            return None
        constant, *shares = rows["angles"][int(row)]
        return {"constant": constant, "joints": shares[:n]}

    def link(row: list[float], own: str) -> Document:
        parent, slides = int(row[c.LINK_PARENT]), row[c.LINK_SLIDE] >= 0.0
        return {
            "name": own,
            "parent": parent - first if parent >= 0 else -1,
            "slide": object_of(forms.SLIDE, row) if slides else None,
            **{key: angle(row[at]) for key, at in forms.TURNS},
            **object_of(forms.LINK, row),
        }

    of_arm = _span(rows["links"], arm, c.ARM_LINK)
    loop = []
    if arm[c.ARM_LOOP] >= 0.0:
        row = rows["loops"][int(arm[c.ARM_LOOP])]
        cranks = [int(crank) - first for crank in row[c.LOOP_CRANK : c.LOOP_LENGTH]]
        loop.append({"cranks": cranks, **object_of(forms.LOOP, row)})
    return {
        "name": name,
        "time": [row[c.KNOT_TIME] for row in knots],
        **states,
        "links": [link(row, own) for row, own in zip(of_arm, links, strict=True)],
        "loop": loop,
    }


def frame_document(rows: dict[str, Rows], number: int, name: str) -> Document:
    """A frame, by its number, with its law and what is uncertain of it."""
    row = rows["frames"][number]
    laws, link = _span(rows["laws"], row, c.FRAME_PIECE), int(row[c.FRAME_LINK])
    if row[c.FRAME_ARM] >= 0.0:
        link -= int(rows["arms"][int(row[c.FRAME_ARM])][c.ARM_LINK])
    displaced = [each for each in rows["displaced"] if each[c.DISPLACED_FRAME] == number]
    return {
        "name": name,
        "link": link,
        "edges": [*(law[c.LAW_BEGIN] for law in laws), *(law[c.LAW_END] for law in laws[-1:])],
        "acceleration": [[_powers(law, k) for k in range(4)] for law in laws],
        "waves": [object_of(forms.WAVE, wave) for wave in _span(rows["waves"], row, c.FRAME_WAVE)],
        "unknown": [object_of(forms.DISPLACED, each) for each in displaced],
        **object_of(forms.FRAME, row),
    }


def _powers(law: list[float], coordinate: int) -> list[float]:
    """The coefficients of a coordinate, without zeros behind the last that is none."""
    first = c.LAW_POWER + coordinate * c.MOST_POWERS
    powers = law[first : first + c.MOST_POWERS]
    while powers and powers[-1] == 0.0:
        powers.pop()
    return powers


def body_document(rows: dict[str, Rows], body: list[float], name: str) -> Document:
    """A body, given as its row in `bodies`, with its pieces."""
    pieces, triangles = [], _span(rows["triangles"], body, c.BODY_TRIANGLE)
    for number, row in enumerate(_span(rows["pieces"], body, c.BODY_PIECE), start=int(body[c.BODY_PIECE])):
        edges, first = int(row[c.PIECE_EDGES]), int(row[c.PIECE_VERTEX])
        own = [[int(x) - first for x in each[:3]] for each in triangles if each[c.TRIANGLE_PIECE] == number]
        pieces.append(
            {
                "edges": [row[at : at + 3] for at in range(c.PIECE_EDGE, c.PIECE_EDGE + 3 * edges, 3)],
                "vertices": _span(rows["vertices"], row, c.PIECE_VERTEX),
                "triangles": own,
                **object_of(forms.PIECE, row),
            }
        )
    return {"name": name, "pieces": pieces}


def _phase(rows: dict[str, Rows], number: int, kind: str) -> Document:
    put_down = [
        {"body": int(row[c.PUT_BODY]), "supports": _members(supports)}
        for row, supports in zip(rows["put_down"], rows["supports"], strict=True)
        if row[c.PUT_PHASE] == number
    ]
    return {
        "kind": kind,
        "seats": [int(seat) for seat in rows["seated"][number]],
        "unknown": _twos(rows["off"][number]),
        "shares": _twos(rows["shares"][number]),
        "contacts": [object_of(forms.CONTACT, row) for row in rows["contacts"] if row[c.CONTACT_PHASE] == number],
        "put_down": put_down,
        **object_of(forms.PHASE, rows["phases"][number]),
    }


def _twos(row: list[float]) -> list[list[float]]:
    """Of each thing its number in the first half of a row, and that in the second."""
    half = len(row) // 2
    return [list(both) for both in zip(row[:half], row[half:], strict=True)]


def _members(row: Sequence[float]) -> list[int]:
    return [k for k, chosen in enumerate(row) if chosen > 0.0]


def _required(claim: Claim, rows: dict[str, Rows], joints: int) -> Document:
    pairs = np.argwhere(np.triu(claim.self_pairs) > 0.0).tolist()
    exceptions = []
    for rule in rows["rules"]:
        half = (len(rule) - c.RULE_SIDE) // 2
        sides = [rule[c.RULE_SIDE : c.RULE_SIDE + half], rule[c.RULE_SIDE + half :]]
        # an empty list is every body
        first, second = ([] if all(side) else _members(side) for side in sides)
        exceptions.append({"first": first, "second": second, **object_of(forms.RULE, rule)})
    return {"self_pairs": pairs, "exceptions": exceptions, **object_of(forms.REQUIRED, rows["required"][0], joints)}

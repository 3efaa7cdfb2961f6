"""A claim as a JSON document, a proof bundle, and back (docs/bundle.md). Indices in a document count within an arm, a
body or the whole, as its schema says; in tables they are rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np

from assur.planner.claim import columns as c
from assur.planner.claim.answer import named_answer
from assur.planner.claim.columns import Claim
from assur.planner.claim.filling import SceneClaim, named_rows
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import Phase
from assur.planner.robots.robot import Robot

# The objects of a proof bundle that are rows of one table (docs/bundle.md): keys in the order of the columns.
#
# How many numbers a value has is stated here. What kind they are follows from what `columns.BOUNDS` allows.

Document = dict[str, Any]
Kind = Literal["number", "whole", "flag"]
JOINTS = 0
"""As `Key.many`: one number for each joint of the robot, in columns for `columns.MOST_JOINTS`."""


class Key(NamedTuple):
    """A key of an object. `many`: the value is a list of so many numbers; None: it is one. `kind`: None if `BOUNDS`
    has it. `open`: the list may be shorter, and columns that it leaves are -1. `empty`: the list is empty where that
    column is that number, 0 or 1."""

    name: str
    many: int | None = None
    kind: Kind | None = None
    open: bool = False
    empty: tuple[int, float] | None = None


class Field(NamedTuple):
    """A key, its first column and its kind."""

    key: Key
    column: int
    kind: Kind


Form = tuple[Field, ...]


def _form(table: str, first: int, *keys: str | Key) -> Form:
    """The fields of keys whose columns follow each other, from column `first` on. A name alone is one number."""
    found = list[Field]()
    for each in keys:
        key = Key(each) if isinstance(each, str) else each
        found.append(Field(key, first, key.kind or _kind(table, first)))
        first += 1 if key.many is None else key.many or c.MOST_JOINTS
    return tuple(found)


def _kind(table: str, column: int) -> Kind:
    for name, first, many, low, most in c.BOUNDS:
        if name == table and first <= column < first + many and isinstance(most, str):
            return "flag" if most == "flag" and low == 0 else "whole"
    return "number"


def object_of(form: Iterable[Field], row: Sequence[float], joints: int = 0) -> Document:
    """The object of a row, for a robot with so many joints."""
    return {field.key.name: _value(field, row, joints) for field in form}


def _value(field: Field, row: Sequence[float], joints: int) -> Any:
    key, column, kind = field
    values = row[column : column + (1 if key.many is None else key.many or joints)]
    if key.empty is not None and row[key.empty[0]] == key.empty[1]:
        return []
    plain: list[Any] = [x for x in values if x >= 0.0 or not key.open]
    if kind != "number":
        plain = [x > 0.0 if kind == "flag" else int(x) for x in plain]
    return plain[0] if key.many is None else plain


STATES = (("q", c.KNOT_Q), ("qd", c.KNOT_QD), ("qdd", c.KNOT_QDD))
LINK = (*_form("links", c.LINK_OFFSET, Key("offset", 3)), *_form("links", c.LINK_COUPLER, "coupler"))
SLIDE = _form("links", c.LINK_SLIDE, Key("joint", kind="whole"), Key("axis", 3))
TURNS = (("yaw", c.LINK_YAW), ("pitch", c.LINK_PITCH), ("roll", c.LINK_ROLL))
LOOP = _form("loops", c.LOOP_LENGTH, Key("lengths", 2), Key("couplers", 2), "side", "least")
FRAME = (
    *_form("frames", c.FRAME_ARM, "arm"),
    *_form("frames", c.FRAME_POSE, Key("pose", 4), Key("rate", 4)),
    *_form("frames", c.FRAME_SHIFT, Key("shift", 2), "yaw", "period", Key("step", 4)),
)
WAVE = _form("waves", 0, "coordinate", "amplitude", "rate", "phase")
DIRECTION = Key("direction", 3, empty=(c.DISPLACED_LEVEL, 1.0))
DISPLACED = _form("displaced", c.DISPLACED_DIRECTION, DIRECTION, "amount", "growth", "shared")
PIECE = _form("pieces", 0, Key("centre", 3), Key("axis", 3), "disc", "ball")
PHASE = _form("phases", 0, "t0", "t1", "near", "robot")
RULE = _form("rules", 0, "travel", "near")
LAG = Key("lag", JOINTS)
REQUIRED = _form("required", 0, "travel", "near", "until", "late", "since", "tool_from", LAG, "nearest", "placed")
SPAN, BODIES, PIECES = ("t0", "t1"), Key("bodies", 2), Key("pieces", 2, "whole")
POSES = (Key("tool", 4), Key("target", 4))
JERK = Key("jerk", JOINTS, empty=(c.LIMIT_JERKS, 0.0))
CONTACT = _form("contacts", c.CONTACT_BODY, BODIES, "depth")
ROW = (*SPAN, "s0", "s1", BODIES, PIECES, Key("normal", 3))
SECTIONS = {
    "seats": _form("seats", 0, "body", "link", "frame", Key("pose", 4)),
    "limits": (
        *_form("limits", 0, *SPAN),
        *_form("limits", c.LIMIT_SHARE, Key("shares", 4), Key("lower", JOINTS), Key("upper", JOINTS)),
        *_form("limits", c.LIMIT_VELOCITY, Key("velocity", JOINTS), Key("acceleration", JOINTS), JERK),
    ),
    "points": (
        *_form("points", 0, *SPAN, "frame", "link", *POSES, "middle", Key("height", 1, open=True), "position"),
        *_form("points", c.POINT_YAW, Key("yaw", 1, open=True), Key("rates", 2, open=True)),
    ),
    "rates": _form("rates", 0, *SPAN, "link", Key("point", 3), "frame", "order", "least", "most"),
    "axes": _form("axes", 0, *SPAN, "link", "place", Key("axis", 3), "other", Key("direction", 3), "low", "high"),
    "sums": _form("sums", 0, *SPAN, "order", Key("joints", JOINTS), "low", "high"),
    "guides": (
        *_form("guides", 0, *SPAN, "link", Key("tool", 3), Key("frames", 2), Key("from", 3), Key("to", 3)),
        *_form("guides", c.GUIDE_SHARE, Key("shares", 2), "most"),
    ),
    "distances": _form(
        "distances", 0, "time", "phase", BODIES, PIECES, "most", Key("weights", 4), Key("directions", 12)
    ),
    "errors": (
        *_form("errors", 0, "time", "phase", "frame", "link", *POSES, Key("off", 3)),
        *_form("errors", c.ERROR_ARM, "arm", "distance", "horizontal", "vertical", "yaw"),
    ),
    "rows": _form("rows", 0, *ROW),
    "gap_rows": _form("gap_rows", 0, *ROW),
}
"""The parts of a bundle that are a table, object by row."""
NAMED = ("points", "rates", "axes")
"""Those whose objects have a name."""


# Names of the rows of a claim for readers, and its request and plan. No proof depends on these.


class Labels(NamedTuple):
    """Digests, and a name for each row of the tables that these fields are called after: `arms` with those of their
    links."""

    request_digest: str
    plan_digest: str
    arms: tuple[tuple[str, tuple[str, ...]], ...]
    frames: tuple[str, ...]
    bodies: tuple[str, ...]
    phases: tuple[str, ...]
    points: tuple[str, ...]
    rates: tuple[str, ...]
    axes: tuple[str, ...]


def labels_of(base: SceneClaim, plan: Plan, phases: Sequence[Phase], claims: Claims = NOTHING) -> Labels:
    """The labels of the claim that `with_plan` makes of the same, and `with_answer` of what an answer states."""
    scene, named = base.scene, named_rows(base, plan, phases)
    for name, rows in named_answer(base, plan, phases, claims).items():
        named[name] += rows
    robots = scene.robot, *(robot for robot, _ in base.cell.others)
    return Labels(
        request_digest=scene.digest,
        plan_digest=plan.certificate.digest,
        arms=tuple(map(_arm, robots)),
        frames=tuple(scene.frames),
        bodies=tuple(base.cell.carriers.body),
        phases=tuple(str(phase.kind) for phase in phases),
        **{table: tuple(name for name, _ in rows) for table, rows in named.items()},
    )


def _arm(robot: Robot) -> tuple[str, tuple[str, ...]]:
    return robot.name, robot.links


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
    for name, form in SECTIONS.items():
        found[name] = [object_of(form, row, joints) for row in rows[name]]
        if name in NAMED:
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
    states = {key: [row[at : at + n] for row in knots] for key, at in STATES}

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
            "slide": object_of(SLIDE, row) if slides else None,
            **{key: angle(row[at]) for key, at in TURNS},
            **object_of(LINK, row),
        }

    of_arm = _span(rows["links"], arm, c.ARM_LINK)
    loop = []
    if arm[c.ARM_LOOP] >= 0.0:
        row = rows["loops"][int(arm[c.ARM_LOOP])]
        cranks = [int(crank) - first for crank in row[c.LOOP_CRANK : c.LOOP_LENGTH]]
        loop.append({"cranks": cranks, **object_of(LOOP, row)})
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
        "waves": [object_of(WAVE, wave) for wave in _span(rows["waves"], row, c.FRAME_WAVE)],
        "unknown": [object_of(DISPLACED, each) for each in displaced],
        **object_of(FRAME, row),
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
                **object_of(PIECE, row),
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
        "contacts": [object_of(CONTACT, row) for row in rows["contacts"] if row[c.CONTACT_PHASE] == number],
        "put_down": put_down,
        **object_of(PHASE, rows["phases"][number]),
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
        exceptions.append({"first": first, "second": second, **object_of(RULE, rule)})
    return {"self_pairs": pairs, "exceptions": exceptions, **object_of(REQUIRED, rows["required"][0], joints)}

"""The objects of a proof bundle that are rows of one table (docs/bundle.md): keys in the order of the columns.

How many numbers a value has is stated here. What kind they are follows from what `columns.BOUNDS` allows.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal, NamedTuple

from assur.planner.claim import columns as c

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

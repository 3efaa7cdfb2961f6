"""The tables of a proof bundle, as its writer had them. The form of the document is checked here; what its numbers may
be is for the checker of the claim (`columns.BOUNDS`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim import document as forms
from assur.planner.claim.columns import Claim
from assur.planner.claim.document import FORM, Document, Field, Kind, Labels
from assur.planner.errors import InputError
from assur.planner.robots.facts import known_between

Rows = dict[str, list[Sequence[float]]]
"""The rows of all tables by name."""
LARGEST_WHOLE = 2**53
"""Beyond this a double is no longer every whole number."""
OTHERS = ("schema", "request_digest", "plan_digest", "arms", "frames", "bodies", "phases", "required")


def read(document: object) -> tuple[Claim, Labels]:
    """The tables of a bundle, and what its rows are called. Raises `InputError` for a document of another form."""
    whole = member(document, (), *OTHERS, *forms.SECTIONS)
    if whole["schema"] != FORM:
        raise InputError("schema", whole["schema"], FORM)
    found: Rows = {name: [] for name in Claim._fields}
    arms = [_arm(found, each) for each in items(whole["arms"], "arms")]
    if not arms:
        raise InputError("arms", arms, "the robot first")
    joints, links = int(found["arms"][0][c.ARM_JOINTS]), int(found["arms"][0][c.ARM_LINKS])
    frames = [_frame(found, k, each) for k, each in enumerate(items(whole["frames"], "frames"))]
    names = [_body(found, each) for each in items(whole["bodies"], "bodies")]
    bodies = len(names)
    phases = [_phase(found, k, each, bodies, len(frames)) for k, each in enumerate(items(whole["phases"], "phases"))]
    pairs = _required(found, whole["required"], joints, links, bodies)
    labels: dict[str, list[str]] = {name: [] for name in forms.NAMED}
    for name, form in forms.SECTIONS.items():
        for each in items(whole[name], name):
            own = member(each, form, *(("name",) if name in forms.NAMED else ()))
            found[name].append(read_row(form, own, c.WIDTHS[name], joints))
            if name in forms.NAMED:
                labels[name].append(text(own["name"], "name"))
    widths = {**c.WIDTHS, "seated": bodies, "off": 2 * bodies, "shares": 2 * len(frames), "supports": bodies}
    widths["rules"] = c.RULE_SIDE + 2 * bodies
    tables = {name: _table(rows, widths[name]) for name, rows in found.items() if name != "self_pairs"}
    digests = [text(whole[key], key) for key in ("request_digest", "plan_digest")]
    named = [tuple(each) for each in (frames, names, phases, *labels.values())]
    return Claim(**tables, self_pairs=pairs), Labels._make((*digests, tuple(arms), *named))


def _table(rows: list[Sequence[float]], width: int) -> FloatArray:
    return np.array(rows, dtype=float).reshape(len(rows), width)


def _arm(found: Rows, given: object) -> tuple[str, tuple[str, ...]]:
    arm = member(given, (), "name", "time", "q", "qd", "qdd", "links", "loop")
    times = numbers(arm["time"], "time")
    states = [items(arm[key], key, len(times)) for key, _ in forms.STATES]
    n = len(items(states[0][0], "q")) if times else 0
    first, knot, start = len(found["links"]), len(found["knots"]), len(found["angles"])
    for t, *values in zip(times, *states, strict=True):
        found["knots"].append([t, *(x for each in values for x in numbers(each, "q", n, c.MOST_JOINTS))])
    known: dict[tuple[float, ...], int] = {}

    def angle(given: object) -> float:
        own = member(given, (), "constant", "joints")
        key = scalar("number", own["constant"], "constant"), *numbers(own["joints"], "joints", n, c.MOST_JOINTS)
        return known.setdefault(key, start + len(known))

    names = []
    for each in items(arm["links"], "links"):
        link = member(each, forms.LINK, "name", "parent", "slide", *(key for key, _ in forms.TURNS))
        row, parent = read_row(forms.LINK, link, c.LINK), int(scalar("whole", link["parent"], "parent"))
        row[c.LINK_PARENT], row[c.LINK_SLIDE] = parent + first if parent >= 0 else -1, -1.0
        if link["slide"] is not None:
            slide = read_row(forms.SLIDE, member(link["slide"], forms.SLIDE), c.LINK)
            row[c.LINK_SLIDE : c.LINK_YAW] = slide[c.LINK_SLIDE : c.LINK_YAW]
        upright = link["pitch"] is None and link["roll"] is None
        for key, column in forms.TURNS:
            row[column] = -1.0 if upright and key != "yaw" else angle(link[key])
        found["links"].append(row)
        names.append(text(link["name"], "name"))
    loop = -1
    for each in items(arm["loop"], "loop"):
        own = member(each, forms.LOOP, "cranks")
        row, cranks = read_row(forms.LOOP, own, c.LOOP), items(own["cranks"], "cranks", 2)
        row[c.LOOP_CRANK : c.LOOP_LENGTH] = [first + index(crank, len(names), "cranks") for crank in cranks]
        yaws = [int(found["links"][int(crank)][c.LINK_YAW]) for crank in row[c.LOOP_CRANK : c.LOOP_LENGTH]]
        row[c.LOOP_BETWEEN], loop = known_between(known, yaws, start), len(found["loops"])
        found["loops"].append(row)
    found["arms"].append([first, len(names), n, knot, len(times), start, len(known), loop])
    found["angles"] += known
    return text(arm["name"], "name"), tuple(names)


def _frame(found: Rows, number: int, given: object) -> str:
    frame = member(given, forms.FRAME, "name", "link", "edges", "acceleration", "waves", "unknown")
    row, link = read_row(forms.FRAME, frame, c.FRAME), scalar("whole", frame["link"], "link")
    if frame["arm"] >= 0:
        link += found["arms"][index(frame["arm"], len(found["arms"]), "arm")][c.ARM_LINK]
    edges = numbers(frame["edges"], "edges")
    pieces = items(frame["acceleration"], "acceleration", max(len(edges) - 1, 0))
    if len(edges) == 1:
        raise InputError("edges", edges, "none, or one more than pieces")
    waves, row[c.FRAME_LINK] = items(frame["waves"], "waves"), link
    row[c.FRAME_PIECE : c.FRAME_SHIFT] = len(found["laws"]), len(pieces), len(found["waves"]), len(waves)
    found["frames"].append(row)
    for t0, t1, piece in zip(edges, edges[1:], pieces, strict=False):
        powers = [numbers(each, "acceleration", room=c.MOST_POWERS) for each in items(piece, "acceleration", 4)]
        found["laws"].append([t0, t1, *(x for each in powers for x in each)])
    found["waves"] += [read_row(forms.WAVE, member(wave, forms.WAVE), c.WAVE) for wave in waves]
    for each in items(frame["unknown"], "unknown"):
        row = read_row(forms.DISPLACED, member(each, forms.DISPLACED), c.DISPLACED)
        row[c.DISPLACED_FRAME] = number
        found["displaced"].append(row)
    return text(frame["name"], "name")


def _body(found: Rows, given: object) -> str:
    body = member(given, (), "name", "pieces")
    begin, triangles = len(found["pieces"]), len(found["triangles"])
    for each in items(body["pieces"], "pieces"):
        piece = member(each, forms.PIECE, "edges", "vertices", "triangles")
        edges = [x for edge in items(piece["edges"], "edges") for x in numbers(edge, "edges", 3)]
        vertices, first, number = items(piece["vertices"], "vertices"), len(found["vertices"]), len(found["pieces"])
        row = read_row(forms.PIECE, piece, c.PIECE)
        row[c.PIECE_VERTEX : c.PIECE_EDGE] = first, len(vertices), len(edges) // 3
        row[c.PIECE_EDGE :] = numbers(edges, "edges", room=3 * c.MOST_EDGES)
        found["pieces"].append(row)
        found["vertices"] += [numbers(vertex, "vertices", 3) for vertex in vertices]
        for triangle in items(piece["triangles"], "triangles"):
            corners = [index(x, len(vertices), "triangles") for x in items(triangle, "triangles", 3)]
            found["triangles"].append([*(first + x for x in corners), number])
    counts = len(found["pieces"]) - begin, len(found["triangles"]) - triangles
    found["bodies"].append([begin, counts[0], triangles, counts[1]])
    return text(body["name"], "name")


def _phase(found: Rows, number: int, given: object, bodies: int, frames: int) -> str:
    phase = member(given, forms.PHASE, "kind", "seats", "unknown", "shares", "contacts", "put_down")
    found["phases"].append(read_row(forms.PHASE, phase, c.PHASE))
    found["seated"].append(numbers(phase["seats"], "seats", bodies, kind="whole"))
    for name, key, count in (("off", "unknown", bodies), ("shares", "shares", frames)):
        both = [numbers(each, key, 2) for each in items(phase[key], key, count)]
        found[name].append([each[k] for k in (0, 1) for each in both])
    for each in items(phase["contacts"], "contacts"):
        row = read_row(forms.CONTACT, member(each, forms.CONTACT), c.CONTACT)
        row[c.CONTACT_PHASE] = number
        found["contacts"].append(row)
    for each in items(phase["put_down"], "put_down"):
        own = member(each, (), "body", "supports")
        found["put_down"].append([number, scalar("whole", own["body"], "body")])
        found["supports"].append(_chosen(own["supports"], bodies, "supports"))
    return text(phase["kind"], "kind")


def _chosen(given: object, count: int, key: str) -> list[float]:
    """1 for each of `count` things whose number is in a list."""
    chosen = {index(k, count, key) for k in items(given, key)}
    return [float(k in chosen) for k in range(count)]


def _required(found: Rows, given: object, joints: int, links: int, bodies: int) -> FloatArray:
    """Adds what is required of the whole plan; the pairs of links that must keep apart."""
    required = member(given, forms.REQUIRED, "self_pairs", "exceptions")
    found["required"].append(read_row(forms.REQUIRED, required, c.REQUIRED, joints))
    for each in items(required["exceptions"], "exceptions"):
        rule = member(each, forms.RULE, "first", "second")
        both = [_chosen(rule[key], bodies, key) for key in ("first", "second")]
        sides = [side if any(side) else [1.0] * bodies for side in both]  # an empty list is every body
        found["rules"].append([*read_row(forms.RULE, rule, c.RULE_SIDE), *sides[0], *sides[1]])
    pairs = np.zeros((links, links))
    for pair in items(required["self_pairs"], "self_pairs"):
        i, k = (index(x, links, "self_pairs") for x in items(pair, "self_pairs", 2))
        pairs[i, k] = pairs[k, i] = 1.0
    return pairs


def read_row(form: Iterable[Field], document: Document, width: int, joints: int = 0) -> list[float]:
    """The row (width,) of an object; columns without a field are 0. Raises `InputError` for a value of another kind."""
    row = [0.0] * width
    for key, column, kind in form:
        value = document[key.name]
        if key.many is None:
            row[column] = scalar(kind, value, key.name)
            continue
        if key.empty is not None:
            row[key.empty[0]] = key.empty[1] if value == [] else 1.0 - key.empty[1]
            if value == []:
                continue
        count = key.many or joints
        found = numbers(value, key.name, None if key.open else count, kind=kind)
        if key.open and (len(found) > count or min(found, default=0.0) < 0.0):
            raise InputError(key.name, value, f"up to {count} numbers from 0 on")
        row[column : column + count] = [*found, *[-1.0] * (count - len(found))]
    return row


def scalar(kind: Kind, value: object, key: str) -> float:
    """A value as a number. Raises `InputError` for one of another kind, and for what is not finite."""
    if kind == "flag":
        if not isinstance(value, bool):
            raise InputError(key, value, "true or false")
        return float(value)
    if kind == "whole":
        if type(value) is not int or not -1 <= value <= LARGEST_WHOLE:
            raise InputError(key, value, "a whole number from -1 on")
        return float(value)
    if type(value) not in (int, float) or not -c.LIMITLESS <= value <= c.LIMITLESS:  # type: ignore[operator]
        raise InputError(key, value, "a finite number")
    return float(value)  # type: ignore[arg-type]


def numbers(value: object, key: str, count: int | None = None, room: int = 0, *, kind: Kind = "number") -> list[float]:
    """A list of numbers, `count` of them, filled up with zeros to `room`. Raises `InputError` otherwise."""
    found = [scalar(kind, x, key) for x in items(value, key, count)]
    if room and len(found) > room:
        raise InputError(key, len(found), f"up to {room} numbers")
    return [*found, *[0.0] * (room - len(found))]


def index(value: object, count: int, key: str) -> int:
    """The number of one of `count` things. Raises `InputError` otherwise."""
    if type(value) is not int or not 0 <= value < count:
        raise InputError(key, value, f"a whole number from 0 on, below {count}")
    return value


def items(value: object, key: str, count: int | None = None) -> list[Any]:
    """A list, of `count` items. Raises `InputError` otherwise."""
    if not isinstance(value, list) or (count is not None and len(value) != count):
        raise InputError(key, value, "a list" if count is None else f"a list of {count}")
    return value


def member(value: object, form: Iterable[Field], *others: str) -> Document:
    """An object with exactly the keys of a form and these others. Raises `InputError` otherwise."""
    keys = {*others, *(field.key.name for field in form)}
    if not isinstance(value, dict) or set(value) != keys:
        raise InputError("bundle", value, f"an object with the keys {', '.join(sorted(keys))}")
    return value


def text(value: object, key: str) -> str:
    """A text. Raises `InputError` otherwise."""
    if not isinstance(value, str):
        raise InputError(key, value, "a text")
    return value

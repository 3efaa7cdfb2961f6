"""The tables of a proof bundle. The form of the document is checked here; what its numbers may be is for the checker of
the claim (`columns.BOUNDS`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim import forms
from assur.planner.claim.chain import known_between
from assur.planner.claim.columns import Claim
from assur.planner.claim.document import FORM
from assur.planner.claim.fields import Document, Field, index, items, member, numbers, read_row, scalar, text
from assur.planner.claim.labels import Labels
from assur.planner.errors import InputError

Rows = dict[str, list[Sequence[float]]]
"""The rows of all tables by name."""
WHOLE = (
    *("schema", "request_digest", "plan_digest", "arms", "frames", "bodies", "seats", "phases", "required", "limits"),
    *("points", "pulls", "axes", "rows"),
)


def read(document: object) -> tuple[Claim, Labels]:
    """The tables of a bundle, and what its rows are called. Raises `InputError`, which names the field, for a document
    of another form."""
    whole = member(document, WHOLE, "bundle")
    if whole["schema"] != FORM:
        raise InputError("bundle.schema", whole["schema"], FORM)
    found: Rows = {name: [] for name in Claim._fields}
    arms = [_arm(found, each, where) for each, where in _each(whole, "arms")]
    if not arms:
        raise InputError("bundle.arms", arms, "the robot first")
    frames = [_frame(found, k, each, where) for k, (each, where) in enumerate(_each(whole, "frames"))]
    bodies = [_body(found, each, where) for each, where in _each(whole, "bodies")]
    for each, where in _each(whole, "seats"):
        found["seats"].append(read_row(forms.SEAT, member(each, _keys(forms.SEAT), where), c.SEAT, where))
    counts = len(bodies), len(frames)
    phases = [_phase(found, k, each, where, *counts) for k, (each, where) in enumerate(_each(whole, "phases"))]
    links, joints = int(found["arms"][0][c.ARM_LINKS]), int(found["arms"][0][c.ARM_JOINTS])
    _required(found, whole["required"], joints, len(bodies))
    for each, where in _each(whole, "limits"):
        found["limits"].append(_limit(each, joints, where))
    labels: dict[str, tuple[str, ...]] = {}
    for name, form in (("points", forms.POINT), ("pulls", forms.PULL), ("axes", forms.AXIS)):
        labels[name] = tuple(_named(found, name, form, each, where) for each, where in _each(whole, name))
    for each, where in _each(whole, "rows"):
        found["rows"].append(read_row(forms.ROW, member(each, _keys(forms.ROW), where), c.ROW, where))
    own = {
        "request_digest": text(whole["request_digest"], "bundle.request_digest"),
        "plan_digest": text(whole["plan_digest"], "bundle.plan_digest"),
        "arms": tuple(arms),
        "frames": tuple(frames),
        "bodies": tuple(bodies),
        "phases": tuple(phases),
    }
    widths = {**c.WIDTHS, "seated": counts[0], "off": 2 * counts[0], "shares": 2 * counts[1]}
    widths |= {"supports": counts[0], "rules": c.RULE_SIDE + 2 * counts[0]}
    pairs = _self_pairs(whole["required"]["self_pairs"], links)
    tables = {name: _table(rows, widths[name]) for name, rows in found.items() if name != "self_pairs"}
    return Claim(**tables, self_pairs=pairs), Labels(**own, **labels)  # type: ignore[arg-type]


def _table(rows: list[Sequence[float]], width: int) -> FloatArray:
    return np.array(rows, dtype=float).reshape(len(rows), width)


def _keys(form: Sequence[Field]) -> list[str]:
    return [field.key for field in form]


def _each(document: Document, key: str, where: str = "bundle") -> list[tuple[Any, str]]:
    """The items of a list, each with its place in the document."""
    return [(each, f"{where}.{key}[{k}]") for k, each in enumerate(items(document[key], f"{where}.{key}"))]


def _arm(found: Rows, given: object, where: str) -> tuple[str, tuple[str, ...]]:
    arm = member(given, ("name", "time", "q", "qd", "qdd", "links", "loop"), where)
    times = numbers(arm["time"], f"{where}.time")
    states = [items(arm[key], f"{where}.{key}", len(times)) for key, _ in forms.STATES]
    n = len(items(states[0][0], f"{where}.q[0]")) if times else 0
    first, knot, start = len(found["links"]), len(found["knots"]), len(found["angles"])
    for t, *values in zip(times, *states, strict=True):
        padded = [numbers(each, f"{where}.q", n, c.MOST_JOINTS) for each in values]
        found["knots"].append([t, *(x for each in padded for x in each)])
    known: dict[tuple[float, ...], int] = {}

    def angle(given: object, at: str) -> float:
        own = member(given, ("constant", "joints"), at)
        key = scalar("number", own["constant"], at), *numbers(own["joints"], at, n, c.MOST_JOINTS)
        return known.setdefault(key, start + len(known))

    names = []
    for each, at in _each(arm, "links", where):
        link = member(each, ("name", "parent", "slide", *(key for key, _ in forms.TURNS), *_keys(forms.LINK)), at)
        row = read_row(forms.LINK, link, c.LINK, at)
        parent = int(scalar("whole", link["parent"], f"{at}.parent"))
        row[c.LINK_PARENT] = parent + first if parent >= 0 else -1
        row[c.LINK_SLIDE] = -1.0
        if link["slide"] is not None:
            slide = read_row(forms.SLIDE, member(link["slide"], _keys(forms.SLIDE), at), c.LINK, f"{at}.slide")
            row[c.LINK_SLIDE : c.LINK_YAW] = slide[c.LINK_SLIDE : c.LINK_YAW]
        if (link["pitch"] is None) != (link["roll"] is None):
            raise InputError(f"{at}.roll", link["roll"], "a pitch and a roll, or null for both")
        for key, column in forms.TURNS:
            upright = key != "yaw" and link[key] is None
            row[column] = -1.0 if upright else angle(link[key], f"{at}.{key}")
        found["links"].append(row)
        names.append(text(link["name"], f"{at}.name"))
    loop = -1
    for each, at in _each(arm, "loop", where):
        own = member(each, ("cranks", *_keys(forms.LOOP)), at)
        row = read_row(forms.LOOP, own, c.LOOP, at)
        cranks = [first + index(crank, len(names), f"{at}.cranks") for crank in items(own["cranks"], at, 2)]
        row[c.LOOP_CRANK : c.LOOP_LENGTH] = cranks
        row[c.LOOP_BETWEEN] = known_between(known, [int(found["links"][k][c.LINK_YAW]) for k in cranks], start)
        loop = len(found["loops"])
        found["loops"].append(row)
    found["arms"].append([first, len(names), n, knot, len(times), start, len(known), loop])
    found["angles"] += known
    return text(arm["name"], f"{where}.name"), tuple(names)


def _frame(found: Rows, number: int, given: object, where: str) -> str:
    frame = member(given, ("name", "link", "edges", "acceleration", "waves", "unknown", *_keys(forms.FRAME)), where)
    row = read_row(forms.FRAME, frame, c.FRAME, where)
    link = scalar("whole", frame["link"], f"{where}.link")
    if frame["arm"] >= 0:
        link += found["arms"][index(frame["arm"], len(found["arms"]), f"{where}.arm")][c.ARM_LINK]
    edges = numbers(frame["edges"], f"{where}.edges")
    pieces = items(frame["acceleration"], f"{where}.acceleration", max(len(edges) - 1, 0))
    if len(edges) == 1:
        raise InputError(f"{where}.edges", edges, "none, or one more than pieces")
    waves = _each(frame, "waves", where)
    row[c.FRAME_LINK] = link
    row[c.FRAME_PIECE : c.FRAME_SHIFT] = len(found["laws"]), len(pieces), len(found["waves"]), len(waves)
    found["frames"].append(row)
    for t0, t1, piece in zip(edges, edges[1:], pieces, strict=False):
        powers = [numbers(each, f"{where}.acceleration", None, c.MOST_POWERS) for each in items(piece, where, 4)]
        found["laws"].append([t0, t1, *(x for each in powers for x in each)])
    for each, at in waves:
        found["waves"].append(read_row(forms.WAVE, member(each, _keys(forms.WAVE), at), c.WAVE, at))
    for each, at in _each(frame, "unknown", where):
        own = member(each, ("direction", *_keys(forms.DISPLACED)), at)
        row = read_row(forms.DISPLACED, own, c.DISPLACED, at)
        row[c.DISPLACED_FRAME], row[c.DISPLACED_LEVEL] = number, not own["direction"]
        if own["direction"] != []:
            row[c.DISPLACED_DIRECTION : c.DISPLACED_AMOUNT] = numbers(own["direction"], f"{at}.direction", 3)
        found["displaced"].append(row)
    return text(frame["name"], f"{where}.name")


def _body(found: Rows, given: object, where: str) -> str:
    body = member(given, ("name", "pieces"), where)
    begin, pieces = [len(found["pieces"]), len(found["triangles"])], _each(body, "pieces", where)
    for each, at in pieces:
        piece = member(each, ("edges", "vertices", "triangles", *_keys(forms.PIECE)), at)
        row = read_row(forms.PIECE, piece, c.PIECE, at)
        edges = [x for edge in items(piece["edges"], at) for x in numbers(edge, f"{at}.edges", 3)]
        vertices, first, number = items(piece["vertices"], at), len(found["vertices"]), len(found["pieces"])
        row[c.PIECE_VERTEX : c.PIECE_EDGE] = first, len(vertices), len(edges) // 3
        row[c.PIECE_EDGE :] = numbers(edges, f"{at}.edges", None, 3 * c.MOST_EDGES)
        found["pieces"].append(row)
        found["vertices"] += [numbers(vertex, f"{at}.vertices", 3) for vertex in vertices]
        for triangle in items(piece["triangles"], at):
            corners = [first + index(x, len(vertices), f"{at}.triangles") for x in items(triangle, at, 3)]
            found["triangles"].append([*corners, number])
    found["bodies"].append([begin[0], len(pieces), begin[1], len(found["triangles"]) - begin[1]])
    return text(body["name"], f"{where}.name")


def _phase(found: Rows, number: int, given: object, where: str, bodies: int, frames: int) -> str:
    keys = ("kind", "seats", "unknown", "shares", "contacts", "put_down", *_keys(forms.PHASE))
    phase = member(given, keys, where)
    found["phases"].append(read_row(forms.PHASE, phase, c.PHASE, where))
    seats = items(phase["seats"], f"{where}.seats", bodies)
    found["seated"].append([scalar("whole", seat, f"{where}.seats") for seat in seats])
    for name, key, count in (("off", "unknown", bodies), ("shares", "shares", frames)):
        both = [numbers(each, f"{where}.{key}", 2) for each in items(phase[key], f"{where}.{key}", count)]
        found[name].append([each[k] for k in (0, 1) for each in both])
    for each, at in _each(phase, "contacts", where):
        row = read_row(forms.CONTACT, member(each, _keys(forms.CONTACT), at), c.CONTACT, at)
        row[c.CONTACT_PHASE] = number
        found["contacts"].append(row)
    for each, at in _each(phase, "put_down", where):
        own = member(each, ("body", "supports"), at)
        found["put_down"].append([number, scalar("whole", own["body"], f"{at}.body")])
        found["supports"].append(_chosen(own["supports"], bodies, f"{at}.supports"))
    return text(phase["kind"], f"{where}.kind")


def _chosen(given: object, count: int, where: str) -> list[float]:
    """1 for each of `count` things whose number is in a list."""
    chosen = {index(k, count, where) for k in items(given, where)}
    return [float(k in chosen) for k in range(count)]


def _required(found: Rows, given: object, joints: int, bodies: int) -> None:
    where = "bundle.required"
    required = member(given, ("self_pairs", "lag", "exceptions", *_keys(forms.REQUIRED)), where)
    row = read_row(forms.REQUIRED, required, c.REQUIRED, where)
    row[c.REQUIRED_LAG :] = numbers(required["lag"], f"{where}.lag", joints, c.MOST_JOINTS)
    found["required"].append(row)
    for each, at in _each(required, "exceptions", where):
        rule = member(each, ("first", "second", *_keys(forms.RULE)), at)
        # an empty list is every body
        sides = [_chosen(rule[key] or list(range(bodies)), bodies, f"{at}.{key}") for key in ("first", "second")]
        found["rules"].append([*read_row(forms.RULE, rule, c.RULE_SIDE, at), *sides[0], *sides[1]])


def _self_pairs(given: object, links: int) -> FloatArray:
    pairs, where = np.zeros((links, links)), "bundle.required.self_pairs"
    for pair in items(given, where):
        i, k = (index(x, links, where) for x in items(pair, where, 2))
        pairs[i, k] = pairs[k, i] = 1.0
    return pairs


def _limit(given: object, joints: int, where: str) -> list[float]:
    limit = member(given, (*(key for key, _ in forms.JOINT_LIMITS), *_keys(forms.LIMIT)), where)
    row = read_row(forms.LIMIT, limit, c.LIMIT, where)
    row[c.LIMIT_JERKS] = limit["jerk"] != []
    for key, column in forms.JOINT_LIMITS:
        if limit[key] != [] or key != "jerk":
            row[column : column + c.MOST_JOINTS] = numbers(limit[key], f"{where}.{key}", joints, c.MOST_JOINTS)
    return row


def _named(found: Rows, name: str, form: Sequence[Field], given: object, where: str) -> str:
    """Adds a point, a pull or an axis; what it is called."""
    own = member(given, ("name", *_keys(form), *(("tool",) if name == "pulls" else ())), where)
    row = read_row(form, own, c.WIDTHS[name], where)
    if name == "pulls":
        row[c.PULL_TOOL : c.PULL_MOST] = numbers(own["tool"], f"{where}.tool", 4)[:3]
    found[name].append(row)
    return text(own["name"], f"{where}.name")

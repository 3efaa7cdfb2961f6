"""The tables of a claim from a proof bundle, with a check of the shape of the document only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim

Document = dict[str, Any]
FORM = "assur-bundle/2"


def read(bundle: Document) -> Claim:
    """The tables of a bundle. Raises `ValueError` for a document of another form."""
    try:
        return _read(bundle)
    except (KeyError, TypeError, IndexError) as error:
        raise ValueError(f"no bundle: {type(error).__name__} {error}") from error


def _read(bundle: Document) -> Claim:
    names = "schema request_digest plan_digest arms frames bodies seats phases required limits points pulls axes rows"
    keys(bundle, names)
    if bundle["schema"] != FORM:
        raise ValueError(f"schema {bundle['schema']!r:.40}")
    arms = _Arms()
    for arm in bundle["arms"]:
        arms.add(arm)
    joints = len(bundle["arms"][0]["q"][0])
    links, count = len(bundle["arms"][0]["links"]), len(bundle["bodies"])
    tables = {**arms.tables(), **_frames(bundle["frames"], arms), **_bodies(bundle["bodies"])}
    tables |= _phases(bundle["phases"], count, len(bundle["frames"]))
    tables |= _required(bundle["required"], count, links, joints)
    seats = [(k["body"], k["link"], k["frame"], *vector(k["pose"], 4)) for k in bundle["seats"]]
    return Claim(
        **tables,
        seats=table(seats, c.SEAT),
        limits=table([_limit(each, joints) for each in bundle["limits"]], c.LIMIT),
        points=table([_point(each) for each in bundle["points"]], c.POINT),
        pulls=table([_pull(each) for each in bundle["pulls"]], c.PULL),
        axes=table([_axis(each) for each in bundle["axes"]], c.AXIS),
        rows=table([_row(each) for each in bundle["rows"]], c.ROW),
    )


def keys(document: Document, names: str) -> None:
    """Raises `ValueError` if an object has other keys than these."""
    if set(document) != set(names.split()):
        raise ValueError(f"keys {sorted(set(document) ^ set(names.split()))!r:.80}")


def table(rows: Sequence[Sequence[float]], columns: int) -> FloatArray:
    """Rows as a table. Raises `ValueError` for rows of another length, and for what is no finite number."""
    found = np.zeros((len(rows), columns))
    for k, row in enumerate(rows):
        found[k] = vector(row, columns)
    return found


def vector(values: Sequence[float], count: int) -> Sequence[float]:
    """Finite numbers, so many. Raises `ValueError`."""
    if len(values) != count or not all(type(x) in (float, int, bool) and -1e300 <= x <= 1e300 for x in values):
        raise ValueError(f"{values!r:.60} are not {count} finite numbers")
    return values


def padded(values: Sequence[float], count: int, room: int = c.MOST_JOINTS) -> list[float]:
    """`count` numbers, and zeros up to `room`."""
    if count > room:
        raise ValueError(f"{count} joints; there is room for {room}")
    return [*vector(values, count), *[0.0] * (room - count)]


class _Arms:
    """FloatArrays of all arms."""

    def __init__(self) -> None:
        self.arms: list[list[float]] = []
        self.knots: list[list[float]] = []
        self.angles: list[tuple[float, ...]] = []
        self.links: list[list[float]] = []
        self.loops: list[list[float]] = []

    def tables(self) -> dict[str, FloatArray]:
        widths = {"arms": c.ARM, "knots": c.KNOT, "angles": c.ANGLE, "links": c.LINK, "loops": c.LOOP}
        return {name: table(getattr(self, name), width) for name, width in widths.items()}

    def add(self, arm: Document) -> None:
        """Adds an arm: its knots, the distinct angles of its links, its links and its loop."""
        keys(arm, "name time q qd qdd links loop")
        first, known, joints, angle = (
            len(self.links),
            dict[tuple[float, ...], int](),
            len(arm["q"][0]),
            len(self.angles),
        )
        states = zip(arm["time"], arm["q"], arm["qd"], arm["qdd"], strict=True)
        knots = [[t, *padded(q, joints), *padded(v, joints), *padded(a, joints)] for t, q, v, a in states]

        def angle_of(document: Document) -> int:
            keys(document, "constant joints")
            key = (document["constant"], *padded(document["joints"], joints))
            return known.setdefault(key, angle + len(known))

        for link in arm["links"]:
            keys(link, "name parent offset slide yaw pitch roll coupler")
            slide, tilts = link["slide"] or {"joint": -1, "axis": [0.0] * 3}, link["pitch"] is not None
            if tilts != (link["roll"] is not None):
                raise ValueError("a link has a pitch and a roll, or none of both")
            parent = link["parent"] + first if link["parent"] >= 0 else -1
            turns = [angle_of(link[key]) if link[key] is not None else -1 for key in ("yaw", "pitch", "roll")]
            self.links.append([parent, *link["offset"], slide["joint"], *slide["axis"], *turns, link["coupler"]])
        loop = -1
        for each in arm["loop"]:
            keys(each, "cranks lengths couplers side least")
            loop = len(self.loops)
            cranks = [k + first for k in each["cranks"]]
            if not all(first <= k < len(self.links) for k in cranks):
                raise ValueError("cranks are links")
            one, other = (list(known)[int(self.links[k][c.LINK_YAW]) - angle] for k in cranks)
            between = tuple(b - a for a, b in zip(one, other, strict=True))
            at = known.setdefault(between, angle + len(known))
            self.loops.append([*cranks, *each["lengths"], *each["couplers"], each["side"], each["least"], at])
        counts = [first, len(arm["links"]), joints, len(self.knots), len(knots), angle, len(known), loop]
        self.arms.append(counts)
        self.knots += knots
        self.angles += known


def _frames(frames: list[Document], arms: _Arms) -> dict[str, FloatArray]:
    rows, laws, waves, unknown = list[list[float]](), list[list[float]](), list[list[float]](), list[list[float]]()
    for f, frame in enumerate(frames):
        keys(frame, "name arm link pose rate edges acceleration waves shift yaw unknown")
        edges, pieces = frame["edges"], frame["acceleration"]
        if len(pieces) != max(len(edges) - 1, 0) or len(edges) == 1:
            raise ValueError("edges of a law and its pieces do not fit together")
        link = frame["link"]
        if frame["arm"] >= 0:
            link += int(arms.arms[frame["arm"]][c.ARM_LINK])
        span = [len(laws), len(pieces), len(waves), len(frame["waves"])]
        rows.append([frame["arm"], link, *frame["pose"], *frame["rate"], *span, *frame["shift"], frame["yaw"]])
        for t0, t1, each in zip(edges, edges[1:], pieces, strict=False):
            powers = [x for way in vector_of(each, 4) for x in padded(way, len(way), c.MOST_POWERS)]
            laws.append([t0, t1, *powers])
        for wave in frame["waves"]:
            keys(wave, "coordinate amplitude rate phase")
            waves.append([wave[key] for key in ("coordinate", "amplitude", "rate", "phase")])
        for each in frame["unknown"]:
            keys(each, "direction amount growth shared")
            level, way = not each["direction"], each["direction"] or [0.0] * 3
            unknown.append([f, level, *way, each["amount"], each["growth"], flag(each["shared"])])
    found = {
        "frames": (rows, c.FRAME),
        "laws": (laws, c.LAW),
        "waves": (waves, c.WAVE),
        "displaced": (unknown, c.DISPLACED),
    }
    return {name: table(*each) for name, each in found.items()}


def vector_of(values: list[Any], count: int) -> list[Any]:
    """A list of so many items. Raises `ValueError`."""
    if len(values) != count:
        raise ValueError(f"{len(values)} items in place of {count}")
    return values


def flag(value: object) -> float:
    """A truth value as a number. Raises `ValueError` for anything else."""
    if not isinstance(value, bool):
        raise ValueError(f"{value!r:.20} is not true or false")
    return float(value)


def _bodies(bodies: list[Document]) -> dict[str, FloatArray]:
    rows, pieces, vertices, triangles = (
        list[list[float]](),
        list[list[float]](),
        list[list[float]](),
        list[list[float]](),
    )
    for body in bodies:
        keys(body, "name pieces")
        first = len(pieces), len(triangles)
        for piece in body["pieces"]:
            keys(piece, "centre edges disc axis ball vertices triangles")
            edges = [x for edge in piece["edges"] for x in vector(edge, 3)]
            start, many = len(vertices), len(piece["vertices"])
            for corners in piece["triangles"]:
                if not all(0 <= corner < many for corner in corners):
                    raise ValueError(f"{corners!r:.40} are not all vertices")
                triangles.append([*(float(start + corner) for corner in vector(corners, 3)), float(len(pieces))])
            shape = [piece["disc"], piece["ball"], start, many, len(piece["edges"])]
            pieces.append([*piece["centre"], *piece["axis"], *shape, *padded(edges, len(edges), 3 * c.MOST_EDGES)])
            vertices += piece["vertices"]
        rows.append([first[0], len(body["pieces"]), first[1], len(triangles) - first[1]])
    given = {"bodies": (rows, c.BODY), "pieces": (pieces, c.PIECE), "vertices": (vertices, 3)}
    given["triangles"] = triangles, c.TRIANGLE
    return {name: table(*each) for name, each in given.items()}


def _phases(phases: list[Document], bodies: int, frames: int) -> dict[str, FloatArray]:
    rows, contacts, put, supports = list[list[float]](), list[list[float]](), list[list[float]](), list[list[float]]()
    for p, phase in enumerate(phases):
        keys(phase, "t0 t1 kind near robot seats unknown shares contacts put_down")
        rows.append([phase["t0"], phase["t1"], flag(phase["near"]), flag(phase["robot"])])
        contacts += [[p, *vector(each["bodies"], 2), each["depth"]] for each in phase["contacts"]]
        for each in phase["put_down"]:
            keys(each, "body supports")
            put.append([p, each["body"]])
            supports.append(members(each["supports"], bodies))
    off = [[x[k] for k in (0, 1) for x in (vector(y, 2) for y in phase["unknown"])] for phase in phases]
    shares = [[x[k] for k in (0, 1) for x in (vector(y, 2) for y in phase["shares"])] for phase in phases]
    return {
        "phases": table(rows, c.PHASE),
        "seated": table([phase["seats"] for phase in phases], bodies),
        "off": table(off, 2 * bodies),
        "shares": table(shares, 2 * frames),
        "contacts": table(contacts, c.CONTACT),
        "put_down": table(put, c.PUT),
        "supports": table(supports, bodies),
    }


def members(chosen: list[Any], count: int) -> list[float]:
    """1 for each of `count` bodies that is chosen. Raises `ValueError` for a body that does not exist."""
    if not all(isinstance(k, int) and 0 <= k < count for k in chosen):
        raise ValueError(f"{chosen!r:.40} are not all bodies")
    return [float(k in chosen) for k in range(count)]


def _required(must: Document, bodies: int, links: int, joints: int) -> dict[str, FloatArray]:
    keys(must, "travel near self_pairs until lag late since tool_from exceptions")
    pairs, rules = np.zeros((links, links)), list[list[float]]()
    for i, k in must["self_pairs"]:
        if not (0 <= i < links and 0 <= k < links):
            raise ValueError("pairs of links that do not exist")
        pairs[i, k] = pairs[k, i] = 1.0
    for rule in must["exceptions"]:
        keys(rule, "first second travel near")
        sides = [members(rule[key] or list(range(bodies)), bodies) for key in ("first", "second")]
        rules.append([rule["travel"], rule["near"], *sides[0], *sides[1]])
    row = [must[key] for key in ("travel", "near", "until", "late", "since", "tool_from")]
    return {
        "required": table([[*row, *padded(must["lag"], joints)]], c.REQUIRED),
        "rules": table(rules, c.RULE_SIDE + 2 * bodies),
        "self_pairs": pairs,
    }


def _limit(each: Document, joints: int) -> list[float]:
    keys(each, "t0 t1 lower upper velocity acceleration jerk shares")
    jerk = each["jerk"] or [0.0] * joints
    columns = [padded(x, joints) for x in (each["lower"], each["upper"], each["velocity"], each["acceleration"], jerk)]
    flat = [x for column in columns for x in column]
    return [each["t0"], each["t1"], float(bool(each["jerk"])), *vector(each["shares"], 4), *flat]


def _point(each: Document) -> list[float]:
    keys(each, "t0 t1 name frame link tool target middle height position yaw rates")
    height, yaw, rates = (
        [*each[key], *[-1.0] * (room - len(each[key]))] for key, room in (("height", 1), ("yaw", 1), ("rates", 2))
    )
    if min([*each["height"], *each["yaw"], *each["rates"], each["position"]]) < 0.0 or len(each["rates"]) > 1 + len(
        each["yaw"]
    ):
        raise ValueError("errors of a point")
    poses = [*vector(each["tool"], 4), *vector(each["target"], 4), each["middle"]]
    return [each["t0"], each["t1"], each["frame"], each["link"], *poses, *height, each["position"], *yaw, *rates]


def _pull(each: Document) -> list[float]:
    keys(each, "t0 t1 name link tool most share")
    return [each["t0"], each["t1"], each["link"], *vector(each["tool"], 4)[:3], each["most"], each["share"]]


def _axis(each: Document) -> list[float]:
    keys(each, "t0 t1 name link axis direction low high")
    ways = [*vector(each["axis"], 3), *vector(each["direction"], 3)]
    return [each["t0"], each["t1"], each["link"], *ways, each["low"], each["high"]]


def _row(each: Document) -> list[float]:
    keys(each, "t0 t1 s0 s1 bodies pieces normal")
    span = [each[key] for key in ("t0", "t1", "s0", "s1")]
    return [*span, *vector(each["bodies"], 2), *vector(each["pieces"], 2), *vector(each["normal"], 3)]

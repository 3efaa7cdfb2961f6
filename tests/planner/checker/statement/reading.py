"""Reads the tables of a claim from a proof bundle. The form of the bundle is not judged here."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim, table

Document = dict[str, Any]


def tables_of(bundle: Document) -> Claim:
    """The tables of a bundle."""
    count, joints = len(bundle["bodies"]), len(bundle["arms"][0]["q"][0])
    links = len(bundle["arms"][0]["links"])
    arms = _arms(bundle["arms"])
    required = bundle["required"]
    pairs = np.zeros((links, links))
    for i, k in required["self_pairs"]:
        pairs[i, k] = pairs[k, i] = 1.0
    everything = range(count)
    sides = [
        [_members(rule[key] or everything, count) for key in ("first", "second")] for rule in required["exceptions"]
    ]
    rules = [(rule["travel"], rule["near"], *a, *b) for rule, (a, b) in zip(required["exceptions"], sides, strict=True)]
    row = [required[key] for key in ("travel", "near", "until", "late", "since", "tool_from")]
    phases, put_down = (
        bundle["phases"],
        [(p, put) for p, phase in enumerate(bundle["phases"]) for put in phase["put_down"]],
    )
    flags: list[tuple[float, ...]] = [(phase["t0"], phase["t1"], phase["near"], phase["robot"]) for phase in phases]
    contacts = [(p, *each["bodies"], each["depth"]) for p, phase in enumerate(phases) for each in phase["contacts"]]
    return Claim(
        **arms,
        **_frames(bundle["frames"], arms["arms"]),
        **_bodies(bundle["bodies"]),
        seats=table("seats", [(each["body"], each["link"], each["frame"], *each["pose"]) for each in bundle["seats"]]),
        phases=table("phases", flags),
        seated=np.array([phase["seats"] for phase in phases], dtype=float),
        off=np.array([np.array(phase["unknown"]).T.ravel() for phase in phases]),
        shares=np.array([np.array(phase["shares"]).T.ravel() for phase in phases]),
        contacts=table("contacts", contacts),
        put_down=table("put_down", [(p, put["body"]) for p, put in put_down]),
        supports=np.array([_members(put["supports"], count) for _, put in put_down]).reshape(-1, count),
        rules=np.array(rules, dtype=float).reshape(-1, c.RULE_SIDE + 2 * count),
        self_pairs=pairs,
        required=table("required", [(*row, *_padded(required["lag"]))]),
        limits=table("limits", [_limit(each, joints) for each in bundle["limits"]]),
        points=table("points", [_point(each) for each in bundle["points"]]),
        pulls=table("pulls", [_pull(each) for each in bundle["pulls"]]),
        axes=table("axes", [_axis(each) for each in bundle["axes"]]),
        rows=table("rows", [_row(each) for each in bundle["rows"]]),
    )


def _padded(values: Any, room: int = c.MOST_JOINTS) -> list[float]:
    return [*values, *[0.0] * (room - len(values))]


def _members(chosen: Any, count: int) -> list[float]:
    return [float(k in chosen) for k in range(count)]


def _arms(arms: list[Document]) -> dict[str, Any]:
    """Links with the same angle have one row of it; the last row of a loop's arm is the angle between its cranks."""
    rows, knots, angles, links, loops = [], [], [], [], []  # type: ignore[var-annotated]
    for arm in arms:
        known: dict[tuple[float, ...], int] = {}
        first, start, loop = len(links), len(angles), -1

        def angle_of(each: Document | None, known: dict[tuple[float, ...], int] = known, start: int = start) -> int:
            key = () if each is None else (each["constant"], *_padded(each["joints"]))
            return -1 if each is None else known.setdefault(key, start + len(known))

        for link in arm["links"]:
            slide = link["slide"] or {"joint": -1, "axis": [0.0] * 3}
            turns = [angle_of(link[key]) for key in ("yaw", "pitch", "roll")]
            parent = link["parent"] + first if link["parent"] >= 0 else -1
            links.append((parent, *link["offset"], slide["joint"], *slide["axis"], *turns, link["coupler"]))
        for each in arm["loop"]:
            loop, cranks = len(loops), [k + first for k in each["cranks"]]
            one, other = (list(known)[links[k][c.LINK_YAW] - start] for k in cranks)
            between = known.setdefault(tuple(b - a for a, b in zip(one, other, strict=True)), start + len(known))
            loops.append((*cranks, *each["lengths"], *each["couplers"], each["side"], each["least"], between))
        own = zip(arm["time"], arm["q"], arm["qd"], arm["qdd"], strict=True)
        states = [(t, *_padded(q), *_padded(qd), *_padded(qdd)) for t, q, qd, qdd in own]
        counts = (first, len(arm["links"]), len(arm["q"][0]), len(knots), len(states), start, len(known), loop)
        rows.append(counts)
        knots += states
        angles += known
    tables = {"arms": rows, "knots": knots, "angles": angles, "links": links, "loops": loops}
    return {name: table(name, each) for name, each in tables.items()}


def _frames(frames: list[Document], arms: Any) -> dict[str, Any]:
    rows, laws, waves, displaced = [], [], [], []  # type: ignore[var-annotated]
    for f, frame in enumerate(frames):
        link = frame["link"] + (arms[frame["arm"], c.ARM_LINK] if frame["arm"] >= 0 else 0)
        span = (len(laws), len(frame["acceleration"]), len(waves), len(frame["waves"]))
        rows.append((frame["arm"], link, *frame["pose"], *frame["rate"], *span, *frame["shift"], frame["yaw"]))
        for t0, t1, each in zip(frame["edges"], frame["edges"][1:], frame["acceleration"], strict=False):
            laws.append((t0, t1, *(x for way in each for x in _padded(way, c.MOST_POWERS))))
        waves += [tuple(wave[key] for key in ("coordinate", "amplitude", "rate", "phase")) for wave in frame["waves"]]
        for each in frame["unknown"]:
            level, way = float(not each["direction"]), each["direction"] or [0.0] * 3
            displaced.append((f, level, *way, each["amount"], each["growth"], each["shared"]))
    tables = {"frames": rows, "laws": laws, "waves": waves, "displaced": displaced}
    return {name: table(name, each) for name, each in tables.items()}


def _bodies(bodies: list[Document]) -> dict[str, Any]:
    rows, pieces, vertices, triangles = [], [], [], []  # type: ignore[var-annotated]
    for body in bodies:
        rows.append(
            (len(pieces), len(body["pieces"]), len(triangles), sum(len(p["triangles"]) for p in body["pieces"]))
        )
        for piece in body["pieces"]:
            first, edges = len(vertices), [x for edge in piece["edges"] for x in edge]
            shape = (piece["disc"], piece["ball"], first, len(piece["vertices"]), len(piece["edges"]))
            triangles += [(*(first + k for k in each), len(pieces)) for each in piece["triangles"]]
            pieces.append((*piece["centre"], *piece["axis"], *shape, *_padded(edges, 3 * c.MOST_EDGES)))
            vertices += piece["vertices"]
    tables = {"bodies": rows, "pieces": pieces, "vertices": vertices, "triangles": triangles}
    return {name: table(name, each) for name, each in tables.items()}


def _limit(each: Document, joints: int) -> tuple[float, ...]:
    jerk = each["jerk"] or [0.0] * joints
    kinds = (each["lower"], each["upper"], each["velocity"], each["acceleration"], jerk)
    flat = [x for kind in kinds for x in _padded(kind)]
    return (each["t0"], each["t1"], float(bool(each["jerk"])), *each["shares"], *flat)


def _point(each: Document) -> tuple[float, ...]:
    height, yaw, rates = ([*each[key], -1.0, -1.0][:n] for key, n in (("height", 1), ("yaw", 1), ("rates", 2)))
    poses = [*each["tool"], *each["target"], each["middle"]]
    return (each["t0"], each["t1"], each["frame"], each["link"], *poses, *height, each["position"], *yaw, *rates)


def _pull(each: Document) -> tuple[float, ...]:
    return (each["t0"], each["t1"], each["link"], *each["tool"][:3], each["most"], each["share"])


def _axis(each: Document) -> tuple[float, ...]:
    return (each["t0"], each["t1"], each["link"], *each["axis"], *each["direction"], each["low"], each["high"])


def _row(each: Document) -> tuple[float, ...]:
    span = [each[key] for key in ("t0", "t1", "s0", "s1")]
    return (*span, *each["bodies"], *each["pieces"], *each["normal"])

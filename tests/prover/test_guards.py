"""Hand-made bundles, each right but for one thing, which the prover must see: one ball that slides along x, and a body
beside it."""

from __future__ import annotations

import pytest

from tests.prover.bundles import Document, shown

STILL = {"constant": 0.0, "joints": [0.0]}
POINT: Document = {
    "centre": [0.0] * 3, "edges": [], "disc": 0.0, "axis": [0.0, 0.0, 1.0], "ball": 0.0,
    "vertices": [], "triangles": [],
}  # fmt: skip


def ball(x: float, radius: float = 0.1) -> Document:
    return {**POINT, "centre": [x, 0.0, 0.0], "ball": radius}


def link(name: str, parent: int, slide: Document | None) -> Document:
    place = {"parent": parent, "offset": [0.0, 0.0, 0.0], "slide": slide}
    return {"name": name, **place, "yaw": STILL, "pitch": None, "roll": None, "coupler": -1}


def frame(name: str, **changes: object) -> Document:
    still = {"pose": [0.0] * 4, "rate": [0.0] * 4, "edges": [], "acceleration": [], "waves": []}
    known = {"shift": [0.0, 0.0], "yaw": 0.0, "unknown": [], "period": 0.0, "step": [0.0] * 4}
    return {"name": name, "arm": -1, "link": -1, **still, **known, **changes}


def body(name: str, *pieces: Document) -> Document:
    return {"name": name, "pieces": list(pieces)}


def row(first: int, second: int, *pieces: int, normal: tuple[float, float, float] = (1.0, 0.0, 0.0)) -> Document:
    span = {"t0": 0.0, "t1": 1.0, "s0": 0.0, "s1": 0.0}
    return {**span, "bodies": [first, second], "pieces": list(pieces or (0, 0)), "normal": list(normal)}


def sliding(*around: Document, rows: list[Document], least: float = 0.0, speed: float = 0.0) -> Document:
    """From 0 to 1 s a ball slides out from x = 0, with `speed`, and back again; `around` sit on the first frame."""
    bodies = [body("ball", ball(0.0)), *around]
    seats = [
        {"body": k, "link": 1 if k == 0 else -1, "frame": -1 if k == 0 else 0, "pose": [0.0] * 4}
        for k in range(len(bodies))
    ]
    phase = {
        "t0": 0.0, "t1": 1.0, "kind": "MOVE", "near": False, "robot": True, "seats": list(range(len(bodies))),
        "unknown": [[0.0, 0.0]] * len(bodies), "shares": [[0.0, 0.0]] * 2, "contacts": [], "put_down": [],
    }  # fmt: skip
    links = [link("base", -1, None), link("slide", 0, {"joint": 0, "axis": [1.0, 0.0, 0.0]})]
    arm = {
        "name": "arm", "time": [0.0, 1.0], "q": [[0.0], [0.0]], "qd": [[speed], [-speed]], "qdd": [[0.0], [0.0]],
        "links": links, "loop": [],
    }  # fmt: skip
    limit = {
        "t0": 0.0, "t1": 1.0, "lower": [-9.0], "upper": [9.0], "velocity": [99.0], "acceleration": [999.0],
        "jerk": [99999.0], "shares": [0.0] * 4,
    }  # fmt: skip
    required = {
        "travel": least, "near": least, "self_pairs": [], "until": 1.0, "lag": [0.0], "late": 0.0, "since": 0.0,
        "tool_from": 1, "exceptions": [], "nearest": -1.0, "placed": -1.0,
    }  # fmt: skip
    belt = frame("belt", edges=[-1.0, 2.0], acceleration=[[[], [], [], []]], rate=[0.0, 1.0, 0.0, 0.0])
    return {
        "schema": "assur-bundle/3", "request_digest": "sha256:" + "0" * 64, "plan_digest": "0" * 64, "arms": [arm],
        "frames": [frame("world"), belt],
        "bodies": bodies, "seats": seats, "phases": [phase], "required": required, "limits": [limit],
        "points": [], "rates": [], "axes": [], "sums": [], "guides": [], "distances": [], "errors": [], "rows": rows,
        "gap_rows": [],
    }  # fmt: skip


def test_what_comes_near_between_the_ends_of_a_row_is_seen() -> None:
    # with 2 m/s the ball comes out to 0.625 m; at both ends of the row it is at 0
    for x, right in ((0.9, True), (0.8, False), (0.5, False)):
        document = sliding(body("wall", ball(x)), rows=[row(0, 1)], speed=2.0)
        assert shown(document)[0] is right
    assert shown(sliding(body("wall", ball(0.5)), rows=[row(0, 1)]))[0]


@pytest.mark.parametrize(
    ("piece", "reach"),
    [
        (ball(0.5), 0.1),
        ({**ball(0.5, 0.0), "disc": 0.2}, 0.2),
        ({**ball(0.5, 0.0), "disc": 0.2, "axis": [1.0, 0.0, 0.0]}, 0.0),
        ({**ball(0.5, 0.0), "edges": [[0.1, 0.0, 0.0], [0.0, 3.0, 0.0], [0.05, 0.0, 0.1]]}, 0.15),
        ({**ball(0.5, 0.0), "vertices": [[0.5, 0.0, 0.0], [0.3, 1.0, 0.0], [0.6, -1.0, 2.0]]}, 0.2),
        (
            {
                **ball(0.5, 0.05),
                "vertices": [[0.5, 0.0, 0.0], [0.4, 1.0, 0.0]],
                "edges": [[0.03, 0.0, 0.0]],
                "disc": 0.02,
            },
            0.2,
        ),
    ],
)
def test_every_part_of_a_piece_counts(piece: Document, reach: float) -> None:
    gap = 0.5 - 0.1 - reach
    for pieces in ((0, 0), (0, -1), (-1, -1)):
        assert shown(sliding(body("wall", piece), rows=[row(0, 1, *pieces)], least=gap - 1e-12))[0]
        right, lines = shown(sliding(body("wall", piece), rows=[row(0, 1, *pieces)], least=gap + 1e-12))
        assert (right, lines[-1]) == (False, "claims that are not shown: 2")  # the row, and what it should cover


def test_a_normal_of_any_length_counts_by_its_direction() -> None:
    for n in ((1e-30, 0.0, 0.0), (7.0, 0.0, 0.0)):
        assert shown(sliding(body("wall", ball(0.5)), rows=[row(0, 1, normal=n)], least=0.299999))[0]
        assert not shown(sliding(body("wall", ball(0.5)), rows=[row(0, 1, normal=n)], least=0.300001))[0]


def test_all_pieces_must_be_covered() -> None:
    wall = body("wall", ball(0.5), ball(0.7))
    assert shown(sliding(wall, rows=[row(0, 1, 0, 0), row(0, 1, 0, 1)]))[0]
    assert shown(sliding(wall, rows=[row(0, 1, 0, -1)]))[0]
    assert not shown(sliding(wall, rows=[row(0, 1, 0, 0)]))[0]


def test_a_part_that_was_put_down_is_kept_clear_of_what_moves_by() -> None:
    document = sliding(body("part", ball(0.5)), body("post", ball(0.5)), rows=[row(0, 1), row(0, 2)])
    document["seats"][1].update(frame=1, pose=[0.0, 1.0, 0.0, 0.0])  # on the belt, from y = 1 to y = 2 m
    assert shown(document)[0]
    document["phases"][0]["put_down"] = [{"body": 1, "supports": []}]
    right, lines = shown(document)
    assert (right, lines[-1]) == (False, "claims that are not shown: 1")
    document["rows"].append(row(1, 2, normal=(0.0, -1.0, 0.0)))
    assert shown(document)[0]
    document["rows"].pop()
    document["phases"][0]["put_down"][0]["supports"] = [2]
    assert shown(document)[0]


def test_a_start_that_may_be_late_is_covered_for_every_lateness() -> None:
    # the belt brings the part from y = 1 to y = 2 m; a robot that is late meets it further on
    document = sliding(body("part", ball(0.0)), rows=[row(0, 1, normal=(0.0, 1.0, 0.0))], least=0.5)
    document["seats"][1].update(frame=1, pose=[0.0, 1.0, 0.0, 0.0])
    assert shown(document)[0]
    document["required"]["late"] = 0.5
    assert not shown(document)[0]
    document["rows"][0]["s1"] = 0.5
    assert shown(document)[0]
    document["rows"][0]["s1"] = 0.4
    document["rows"].append({**document["rows"][0], "s0": 0.4, "s1": 0.5})
    assert shown(document)[0]
    document["rows"][1]["s0"] = 0.41
    assert not shown(document)[0]


@pytest.mark.parametrize(("x", "right"), [(0.9, True), (0.6, False)])
def test_what_comes_near_for_some_lateness_only_is_seen(x: float, right: bool) -> None:
    # the part rests until 1 s and from 2 s on; in between it comes 0.5 m nearer, and goes back
    document = sliding(body("part", ball(0.0)), rows=[{**row(0, 1), "s1": 2.0}])
    document["required"].update(late=2.0, until=1e-3)
    document["arms"][0]["time"][1] = 1e-3
    for each in (document["phases"][0], document["limits"][0], document["rows"][0]):
        each["t1"] = 1e-3
    document["seats"][1].update(frame=1)
    still: list[list[float]] = [[], [], [], []]
    ways = [still, *([[a], [], [], []] for a in (-8.0, 8.0, -8.0)), still]
    moved = {"edges": [-1.0, 1.0, 1.25, 1.75, 2.0, 4.0], "acceleration": ways, "rate": [0.0] * 4}
    document["frames"][1].update(pose=[x, 0.0, 0.0, 0.0], **moved)
    assert shown(document)[0] is right


def test_touching_is_not_apart() -> None:
    """A point could go through a wall without thickness that it may touch from both sides."""
    wall = body("wall", {**POINT, "vertices": [[0.1, y, z] for y in (-1.0, 1.0) for z in (-1.0, 1.0)]})
    assert not shown(sliding(wall, rows=[row(0, 1)]))[0]
    wall["pieces"][0]["vertices"] = [[0.11, y, z] for _, y, z in wall["pieces"][0]["vertices"]]
    assert shown(sliding(wall, rows=[row(0, 1)]))[0]


@pytest.mark.parametrize(("lag", "right"), [(0.02, True), (0.2, False)])
def test_a_row_too_long_for_the_bound_of_lag_is_halved(lag: float, right: bool) -> None:
    # a ball at the end of a link of 1 m, which turns from straight at the wall to along it: at the wall no lag counts
    document = sliding(body("wall", ball(1.21)), rows=[row(0, 1)])
    document["arms"][0].update(q=[[0.0], [1.5]], qd=[[0.0], [0.0]])
    document["arms"][0]["links"][1].update(slide=None, yaw={"constant": 0.0, "joints": [1.0]})
    document["seats"][0]["pose"] = [1.0, 0.0, 0.0, 0.0]
    assert shown(document)[0]
    document["required"]["lag"] = [lag]
    assert shown(document)[0] is right

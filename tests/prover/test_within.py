"""Hand-made bundles with a ball at the origin, and meshes round it and elsewhere: which of both is within the other."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.prover import prove as prover
from tests.prover.bundles import Document, shown
from tests.prover.closed_surfaces import block, inwards, moved, three_walls, together
from tests.prover.test_guards import POINT, ball, body, row, sliding

FENCE = three_walls(0.6, 0.02, -0.2, 0.3)
CRATE = block((-0.5, -0.4, -0.3), (0.5, 0.6, 0.7))
ROOM = together(CRATE, inwards(block((-0.45, -0.35, -0.25), (0.45, 0.55, 0.65))))
WALL = together(CRATE, inwards(block((0.2, 0.2, 0.2), (0.45, 0.55, 0.65))))


def mesh(name: str, triangles: FloatArray) -> Document:
    """A body of which each triangle is a piece."""
    pieces = [{**POINT, "vertices": each.tolist(), "triangles": [[0, 1, 2]]} for each in triangles]
    return body(name, *pieces)


def rows_of(triangles: FloatArray) -> list[Document]:
    """A row for each triangle: along its normal it is apart from the ball at the origin."""
    found = []
    for k, (a, b, c) in enumerate(triangles):
        n = np.cross(b - a, c - a)
        found.append(row(0, 1, 0, k, normal=tuple((n * np.sign(n @ a)).tolist())))
    return found


def around(triangles: FloatArray) -> Document:
    """A ball at the origin, and a mesh that it does not touch."""
    return sliding(mesh("mesh", triangles), rows=rows_of(triangles))


def refused(document: Document, many: int = 1) -> bool:
    """Whether nothing else is missing than that one is outside of the other."""
    right, lines = shown(document)
    return not right and "not within the other" in lines[0] and lines[-1] == f"claims that are not shown: {many}"


@pytest.mark.parametrize(
    ("triangles", "right"),
    [
        (FENCE, True),  # which is open above and on one side
        (moved(FENCE, (0.0, -0.2, 0.0)), True),
        (CRATE, False),
        (inwards(CRATE), False),  # which side is called the outer one does not count
        (ROOM, True),  # the ball is in a cavity
        (inwards(ROOM), True),
        (WALL, False),  # the ball is beside the cavity, in the solid
        (together(CRATE, CRATE), False),
        (together(FENCE, moved(CRATE, (2.0, 0.0, 0.0))), True),
    ],
    ids=["fence", "moved fence", "crate", "crate turned", "room", "room turned", "wall", "crate twice", "two solids"],
)
def test_what_a_surface_encloses_belongs_to_its_body(triangles: FloatArray, right: bool) -> None:
    document = around(triangles)
    if right:
        told = shown(document)[1]
        assert (shown(document)[0], told["bodies from meshes, with what they enclose"]) == (True, 1)
    else:
        assert refused(document)


def test_pieces_without_a_surface_enclose_nothing() -> None:
    document = around(CRATE)
    for piece in document["bodies"][1]["pieces"]:
        piece["triangles"] = []
    right, told = shown(document)
    assert (right, told["bodies from meshes, with what they enclose"]) == (True, 0)


def test_of_a_mesh_on_the_arm_the_same_is_shown() -> None:
    for triangles, right in ((FENCE, True), (CRATE, False)):
        document = around(triangles)
        document["bodies"].reverse()  # the mesh is on the link, the ball on the frame
        document["rows"] = rows_of(triangles)
        for each in document["rows"]:
            each["pieces"].reverse()
            each["normal"] = [-x for x in each["normal"]]
        for each in (document["seats"][0], document["seats"][1]):
            each["pose"] = [0.1, 0.2, 0.3, 0.4]
        assert shown(document)[0] is right
        assert right or refused(document)


def test_each_piece_of_a_body_is_outside() -> None:
    document = around(CRATE)
    document["bodies"][0]["pieces"].insert(0, ball(3.0))  # outside, and apart from the crate
    for each in document["rows"]:
        each["pieces"][0] = 1
    document["rows"].append(row(0, 1, 0, -1, normal=(-1.0, 0.0, 0.0)))
    assert refused(document)
    document["bodies"][1] = mesh("mesh", FENCE)
    document["rows"] = [*rows_of(FENCE), document["rows"][-1]]
    for each in document["rows"][:-1]:
        each["pieces"][0] = 1
    assert shown(document)[0]


FORGED: dict[str, Callable[[list[Document]], object]] = {
    "a triangle is missing": lambda pieces: pieces[3].update(triangles=[]),
    "another one is missing": lambda pieces: pieces[-1].update(triangles=[]),
    "a triangle is turned": lambda pieces: pieces[5].update(triangles=[[0, 2, 1]]),
    "a triangle is there twice": lambda pieces: pieces[5].update(triangles=[[0, 1, 2], [0, 1, 2]]),
    "a triangle is a line": lambda pieces: pieces[0].update(triangles=[[0, 1, 1]]),
    "a corner is elsewhere by an ulp": lambda pieces: pieces[2]["vertices"].__setitem__(
        1, [math.nextafter(x, 9.0) for x in pieces[2]["vertices"][1]]
    ),
}


@pytest.mark.parametrize("what", FORGED)
@pytest.mark.parametrize("triangles", [FENCE, CRATE, ROOM], ids=["fence", "crate", "room"])
def test_a_surface_that_is_not_closed_is_no_surface(what: str, triangles: FloatArray) -> None:
    document = around(triangles)
    FORGED[what](document["bodies"][1]["pieces"])
    with pytest.raises(ValueError, match=r"^mesh: its surface is open at an edge that begins at \("):
        shown(document)


def test_the_surface_of_another_mesh_does_not_fit_the_pieces() -> None:
    document = around(CRATE)
    document["bodies"][1]["pieces"][0]["triangles"] = [[0, 1, 3]]
    with pytest.raises(ValueError, match="vertex 3 does not exist"):
        shown(document)
    # triangles elsewhere need pieces elsewhere: that is another body, and its rows are missing or wrong
    elsewhere = around(CRATE)
    elsewhere["bodies"][1] = mesh("mesh", moved(CRATE, (0.55, 0.0, 0.0)))
    assert not shown(elsewhere)[0]
    # a small surface beside the crate takes nothing from what the crate encloses
    more = around(together(CRATE, block((3.0, 3.0, 3.0), (3.1, 3.1, 3.1))))
    assert refused(more)


def test_where_a_body_is_put_into_a_mesh_between_two_phases_it_is_seen() -> None:
    document = around(CRATE)
    document["seats"].append({**document["seats"][1], "pose": [4.0, 0.0, 0.0, 0.0]})
    first, second = ({**document["phases"][0], **span} for span in ({"t1": 0.5}, {"t0": 0.5}))
    document["phases"] = [{**first, "seats": [0, 2]}, second]
    rows = [{**each, "t0": 0.5} for each in document["rows"]]
    away = {**row(0, 1, 0, -1), "t1": 0.5}
    document["rows"] = [away, *rows]
    assert refused(document)
    document["phases"][1]["seats"] = [0, 2]
    document["rows"] = [away, {**away, "t0": 0.5, "t1": 1.0}]
    assert shown(document)[0]


def test_what_is_within_after_a_contact_is_seen() -> None:
    document = around(CRATE)
    first, second = ({**document["phases"][0], **span} for span in ({"t1": 0.5}, {"t0": 0.5}))
    document["phases"] = [{**first, "contacts": [{"bodies": [0, 1], "depth": 1e-4}]}, second]
    document["rows"] = [{**each, **span} for each in document["rows"] for span in ({"t1": 0.5}, {"t0": 0.5})]
    assert refused(document)
    document["phases"][1]["contacts"] = document["phases"][0]["contacts"]
    assert shown(document)[0]  # of a pair that may touch it is not claimed (docs/bundle.md)


def test_a_time_difference_that_does_not_occur_shows_nothing() -> None:
    """The mesh is late by half a second: then it is round the ball. If it were on time, it would be far away."""
    document = around(CRATE)
    document["frames"][1].update(rate=[0.0, 0.8, 0.0, 0.0], shift=[0.5, 0.5])
    for each in (document["phases"][0], document["limits"][0], *document["rows"]):
        each["t1"] = 0.1
    document["arms"][0]["time"][1] = document["required"]["until"] = 0.1
    # at t = 0 s its frame is 0.8 m · (1 - 0.5) along y; in all of the phase the ball is inside
    document["seats"][1].update(frame=1, pose=[0.0, -0.4, 0.0, 0.0])
    for each in document["rows"]:
        each.update(s0=-0.5, s1=-0.5)
    assert refused(document)
    document["rows"].append({**row(0, 1, 0, -1, normal=(0.0, 1.0, 0.0)), "t1": 0.0, "s0": 1.9, "s1": 1.9})
    assert refused(document)


def test_triangles_count_as_work(monkeypatch: pytest.MonkeyPatch) -> None:
    document = around(FENCE)
    document["bodies"][0]["pieces"] = [ball(0.0)] * 300
    document["rows"] = []
    assert shown(document)[1][-1] == "claims that are not shown: 1"
    monkeypatch.setattr(prover, "WORK", 500)
    assert shown(document) == (False, ["more work than 500 intervals, pairs and pieces of motions"])

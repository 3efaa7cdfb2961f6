"""Hand-made claims with a ball at the origin, and meshes round it and elsewhere: whether one is within the other, by
both checkers."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from itertools import permutations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim.enclosure import open_body
from assur.planner.checker.claim.verdict import check_claim
from assur.planner.checker.verdict import Code
from assur.prover import prove as prover
from tests.forgeries.claims import read
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


def on_the_arm(triangles: FloatArray) -> Document:
    """The mesh is on the link, the ball on the frame."""
    document = around(triangles)
    document["bodies"].reverse()
    document["rows"] = rows_of(triangles)
    for each in document["rows"]:
        each["pieces"].reverse()
        each["normal"] = [-x for x in each["normal"]]
    for seat in document["seats"]:
        seat["pose"] = [0.1, 0.2, 0.3, 0.0]
    return document


def is_within(document: Document) -> bool:
    """Whether one of both is within the other, by both checkers, and nothing else is wrong."""
    findings, (right, lines) = check_claim(read(document)).findings, shown(document)
    assert {finding.code for finding in findings} <= {Code.CONTAINMENT}
    assert right is (not findings)
    assert right or ("not within the other" in lines[0] and lines[-1] == "claims that are not shown: 1")
    return not right


SURFACES = {
    "fence, which is open above and on one side": (FENCE, False),
    "fence elsewhere": (moved(FENCE, (0.0, -0.2, 0.0)), False),
    "crate": (CRATE, True),
    "crate, turned inside out": (inwards(CRATE), True),  # which side is called the outer one does not count
    "room with a cavity": (ROOM, False),
    "room, turned inside out": (inwards(ROOM), False),
    "ball in the solid beside a cavity": (WALL, True),
    "crate twice": (together(CRATE, CRATE), True),
    "fence and a crate elsewhere": (together(FENCE, moved(CRATE, (2.0, 0.0, 0.0))), False),
    "crate and a small block elsewhere": (together(CRATE, block((3.0, 3.0, 3.0), (3.1, 3.1, 3.1))), True),
}


@pytest.mark.parametrize("what", SURFACES)
@pytest.mark.parametrize("made", [around, on_the_arm])
def test_what_a_surface_encloses_belongs_to_its_body(made: Callable[[FloatArray], Document], what: str) -> None:
    triangles, within = SURFACES[what]
    document = made(triangles)
    assert is_within(document) is within
    assert within or shown(document)[1]["bodies from meshes, with what they enclose"] == 1


def test_pieces_without_a_surface_enclose_nothing() -> None:
    document = around(CRATE)
    for piece in document["bodies"][1]["pieces"]:
        piece["triangles"] = []
    assert not is_within(document)
    assert shown(document)[1]["bodies from meshes, with what they enclose"] == 0


def test_each_piece_of_a_body_is_outside() -> None:
    document = around(CRATE)
    document["bodies"][0]["pieces"].insert(0, ball(3.0))  # outside, and apart from the crate
    for each in document["rows"]:
        each["pieces"][0] = 1
    document["rows"].append(row(0, 1, 0, -1, normal=(-1.0, 0.0, 0.0)))
    assert is_within(document)
    document["bodies"][1] = mesh("mesh", FENCE)
    document["rows"] = [*rows_of(FENCE), document["rows"][-1]]
    for each in document["rows"][:-1]:
        each["pieces"][0] = 1
    assert not is_within(document)


OPEN: dict[str, Callable[[list[Document]], object]] = {
    "a triangle is missing": lambda pieces: pieces[3].update(triangles=[]),
    "another one is missing": lambda pieces: pieces[-1].update(triangles=[]),
    "a triangle is turned": lambda pieces: pieces[5].update(triangles=[[0, 2, 1]]),
    "a triangle is there twice": lambda pieces: pieces[5].update(triangles=[[0, 1, 2], [0, 1, 2]]),
    "a triangle is a line": lambda pieces: pieces[0].update(triangles=[[0, 1, 1]]),
    "a corner is elsewhere by an ulp": lambda pieces: pieces[2]["vertices"].__setitem__(
        1, [math.nextafter(x, 9.0) for x in pieces[2]["vertices"][1]]
    ),
}


@pytest.mark.parametrize("what", OPEN)
@pytest.mark.parametrize("triangles", [FENCE, CRATE, ROOM], ids=["fence", "crate", "room"])
def test_a_surface_that_is_not_closed_is_refused(what: str, triangles: FloatArray) -> None:
    document = around(triangles)
    OPEN[what](document["bodies"][1]["pieces"])
    findings = check_claim(read(document)).findings
    assert [(finding.code, finding.bodies) for finding in findings] == [(Code.SURFACE, (1,))]
    with pytest.raises(ValueError, match=r"^mesh: its surface is open at an edge that begins at \("):
        shown(document)


def test_a_triangle_of_a_corner_that_is_not_there_is_refused() -> None:
    document = around(CRATE)
    document["bodies"][1]["pieces"][0]["triangles"] = [[0, 1, 3]]
    with pytest.raises(ValueError, match="vertex 3 does not exist"):
        shown(document)


def in_two_phases(document: Document) -> None:
    """The claim of one phase is that of two."""
    spans = ({"t1": 0.5}, {"t0": 0.5})
    document["phases"] = [{**copy.deepcopy(document["phases"][0]), **span} for span in spans]
    document["rows"] = [{**each, **span} for each in document["rows"] for span in spans]


def test_where_a_body_is_put_into_a_mesh_between_two_phases_it_is_seen() -> None:
    document = around(CRATE)
    document["seats"].append({**document["seats"][1], "pose": [4.0, 0.0, 0.0, 0.0]})
    in_two_phases(document)
    document["phases"][0]["seats"] = [0, 2]
    away = {**row(0, 1, 0, -1), "t1": 0.5}
    document["rows"] = [away, *(each for each in document["rows"] if each["t0"] == 0.5)]
    assert is_within(document)
    assert [finding.when for finding in check_claim(read(document)).findings] == [0.5]
    document["phases"][1]["seats"] = [0, 2]
    document["rows"] = [away, {**away, "t0": 0.5, "t1": 1.0}]
    assert not is_within(document)


def test_what_is_within_after_a_contact_is_seen() -> None:
    document = around(CRATE)
    in_two_phases(document)
    contacts = [{"bodies": [0, 1], "depth": 1e-4}]
    document["phases"][0]["contacts"] = contacts
    assert is_within(document)
    document["phases"][1]["contacts"] = contacts
    assert not is_within(document)  # of a pair that may touch it is not claimed (docs/bundle.md)


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
    assert is_within(document)
    document["rows"].append({**row(0, 1, 0, -1, normal=(0.0, 1.0, 0.0)), "t1": 0.0, "s0": 1.9, "s1": 1.9})
    assert not shown(document)[0]
    assert not check_claim(read(document)).accepted


def test_triangles_count_as_work(monkeypatch: pytest.MonkeyPatch) -> None:
    document = around(FENCE)
    document["bodies"][0]["pieces"] = [ball(0.0)] * 300
    document["rows"] = []
    assert shown(document)[1][-1] == "claims that are not shown: 1"
    monkeypatch.setattr(prover, "WORK", 500)
    assert shown(document) == (False, ["more work than 500 intervals, pairs and pieces of motions"])


def test_the_open_one_of_several_bodies_is_named() -> None:
    walls = [mesh(name, surface) for name, surface in (("one", CRATE), ("two", FENCE), ("three", CRATE))]
    document = sliding(*walls, rows=[])
    assert open_body(read(document)) == -1
    for number in (3, 2):
        document["bodies"][number]["pieces"][0]["triangles"] = []
        assert open_body(read(document)) == number


def test_a_zero_of_either_sign_is_the_same_corner() -> None:
    document = around(block((0.0, -0.4, -0.3), (0.5, 0.6, 0.7)))
    for piece in document["bodies"][1]["pieces"][::2]:
        piece["vertices"] = [[-0.0 if x == 0.0 else x for x in vertex] for vertex in piece["vertices"]]
    assert open_body(read(document)) == -1


def test_a_point_on_the_surface_is_not_shown_to_be_outside() -> None:
    """Of a pair with distance 0 in a phase of no length no row is needed: its winding number alone decides."""
    document = around(moved(CRATE, (0.5, -0.1, -0.2)))
    first = copy.deepcopy(document["phases"][0])
    document["phases"] = [{**first, "t1": 0.0}, first]
    for each in document["rows"]:
        each["t0"] = 0.0
    assert Code.CONTAINMENT in {finding.code for finding in check_claim(read(document)).findings}


def test_the_winding_number_is_that_of_random_points() -> None:
    """A point is enclosed by a tetrahedron if it is on the inner side of its four planes."""
    rng, seen = np.random.default_rng(2), {True: 0, False: 0}
    while min(seen.values()) < 15:
        corners = rng.normal(size=(4, 3))
        corners -= corners.mean(0) * rng.uniform(0.5, 1.6)
        sides = []
        for a, b, e, d in ((0, 1, 2, 3), (0, 3, 1, 2), (1, 3, 2, 0), (2, 3, 0, 1)):
            normal = np.cross(corners[b] - corners[a], corners[e] - corners[a])
            sides.append(np.sign(normal @ (corners[d] - corners[a])) == np.sign(-normal @ corners[a]))
        faces = np.array([corners[list(each)] for each in ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))])
        if min(abs(np.linalg.norm(face, axis=1)).min() for face in faces) < 0.3:
            continue
        document = around(faces)
        document["bodies"][0]["pieces"][0]["ball"] = 0.0
        found = Code.CONTAINMENT in {finding.code for finding in check_claim(read(document)).findings}
        assert found is all(sides)
        seen[found] += 1


def test_permutations_of_corners_leave_a_surface_as_it_is() -> None:
    """Even permutations of the corners of a triangle are the same triangle; odd ones turn it."""
    for order in permutations(range(3)):
        document = around(CRATE)
        document["bodies"][1]["pieces"][0]["triangles"] = [list(order)]
        even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        assert (open_body(read(document)) == -1) is even

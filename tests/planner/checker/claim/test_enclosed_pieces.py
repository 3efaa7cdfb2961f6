"""Of a mesh the claim checker judges as the prover does what is enclosed: hand-made claims of a ball and a mesh."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from itertools import permutations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim.enclosure import open_body
from assur.planner.checker.claim.verdict import ClaimVerdict, check_claim
from assur.planner.checker.verdict import Code
from tests.planner.checker.claim.forgeries import Document, read
from tests.prover.bundles import shown
from tests.prover.closed_surfaces import block, inwards, moved, three_walls, together
from tests.prover.test_guards import row, sliding
from tests.prover.test_within import around, mesh, rows_of

FENCE = three_walls(0.6, 0.02, -0.2, 0.3)
CRATE = block((-0.5, -0.4, -0.3), (0.5, 0.6, 0.7))
ROOM = together(CRATE, inwards(block((-0.45, -0.35, -0.25), (0.45, 0.55, 0.65))))
WALL = together(CRATE, inwards(block((0.2, 0.2, 0.2), (0.45, 0.55, 0.65))))
SURFACES = {
    "fence": (FENCE, True),
    "crate": (CRATE, False),
    "crate, turned inside out": (inwards(CRATE), False),
    "room with a cavity": (ROOM, True),
    "ball in the solid beside a cavity": (WALL, False),
    "crate twice": (together(CRATE, CRATE), False),
    "fence and a crate elsewhere": (together(FENCE, moved(CRATE, (2.0, 0.0, 0.0))), True),
}


def verdict_of(document: Document) -> ClaimVerdict:
    return check_claim(read(document))


def codes(document: Document) -> list[Code]:
    return [finding.code for finding in verdict_of(document).findings]


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


@pytest.mark.parametrize("what", SURFACES)
@pytest.mark.parametrize("made", [around, on_the_arm])
def test_what_a_surface_encloses_belongs_to_its_body(made: Callable[[FloatArray], Document], what: str) -> None:
    triangles, right = SURFACES[what]
    document = made(triangles)
    assert codes(document) == ([] if right else [Code.CONTAINMENT])
    assert shown(document)[0] is right


def test_pieces_without_a_surface_enclose_nothing() -> None:
    document = around(CRATE)
    for piece in document["bodies"][1]["pieces"]:
        piece["triangles"] = []
    assert codes(document) == []


def test_a_body_that_gets_into_a_mesh_between_two_phases_is_found() -> None:
    document = around(CRATE)
    document["seats"].append({**document["seats"][1], "pose": [4.0, 0.0, 0.0, 0.0]})
    first, second = ({**document["phases"][0], **span} for span in ({"t1": 0.5}, {"t0": 0.5}))
    document["phases"] = [{**first, "seats": [0, 2]}, second]
    away = {**row(0, 1, 0, -1), "t1": 0.5}
    document["rows"] = [away, *({**each, "t0": 0.5} for each in document["rows"])]
    verdict = verdict_of(document)
    assert [(finding.code, finding.when) for finding in verdict.findings] == [(Code.CONTAINMENT, 0.5)]
    document["phases"][1]["seats"] = [0, 2]
    document["rows"] = [away, {**away, "t0": 0.5, "t1": 1.0}]
    assert codes(document) == []


def test_after_a_contact_it_is_shown_again_and_during_a_contact_it_is_not_claimed() -> None:
    document = around(CRATE)
    first, second = ({**document["phases"][0], **span} for span in ({"t1": 0.5}, {"t0": 0.5}))
    document["phases"] = [{**first, "contacts": [{"bodies": [0, 1], "depth": 1e-4}]}, second]
    document["rows"] = [{**each, **span} for each in document["rows"] for span in ({"t1": 0.5}, {"t0": 0.5})]
    assert codes(document) == [Code.CONTAINMENT]
    document["phases"][1]["contacts"] = document["phases"][0]["contacts"]
    assert codes(document) == []


def test_a_mesh_that_may_be_late_is_evaluated_where_it_then_is() -> None:
    """The mesh is late by half a second, and then it is round the ball. If it were on time, it would be far away."""
    document = around(CRATE)
    document["frames"][1].update(rate=[0.0, 0.8, 0.0, 0.0], shift=[0.5, 0.5])
    for each in (document["phases"][0], document["limits"][0], *document["rows"]):
        each["t1"] = 0.1
    document["arms"][0]["time"][1] = document["required"]["until"] = 0.1
    document["seats"][1].update(frame=1, pose=[0.0, -0.4, 0.0, 0.0])
    for each in document["rows"]:
        each.update(s0=-0.5, s1=-0.5)
    assert codes(document) == [Code.CONTAINMENT]


OPEN: dict[str, Callable[[list[Document]], object]] = {
    "a triangle is missing": lambda pieces: pieces[3].update(triangles=[]),
    "a triangle is turned": lambda pieces: pieces[5].update(triangles=[[0, 2, 1]]),
    "a triangle is present twice": lambda pieces: pieces[5].update(triangles=[[0, 1, 2], [0, 1, 2]]),
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
    verdict = verdict_of(document)
    assert [(finding.code, finding.bodies) for finding in verdict.findings] == [(Code.SURFACE, (1,))]


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
    assert Code.CONTAINMENT in codes(document)


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
        found = Code.CONTAINMENT in codes(document)
        assert found is all(sides)
        seen[found] += 1


def test_permutations_of_corners_leave_a_surface_as_it_is() -> None:
    """Even permutations of the corners of a triangle are the same triangle; odd ones turn it."""
    for order in permutations(range(3)):
        document = around(CRATE)
        document["bodies"][1]["pieces"][0]["triangles"] = [list(order)]
        even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        assert (open_body(read(document)) == -1) is even

"""Arms that work within the box of a mesh, or carry one: their plans before both checkers; and how meshes are cut."""

from __future__ import annotations

import base64
import copy
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.nearest import depth
from assur.planner.geometry.shapes import Body, Piece
from assur.planner.geometry.surface import IN_M
from assur.prover import prove as prover
from assur.scenes.bundle import bundle_document
from assur.scenes.meshes.cover import cover
from assur.scenes.requests import check_document, plan_document
from tests.prover.bundles import Document, body_document, shown
from tests.prover.closed_surfaces import block, inwards, moved, open_below, three_walls, together
from tests.scenes.meshes.solids import SOLIDS, binary_stl, surface

CUP = {"name": "cup", "shape": {"cylinder": {"radius_m": 0.012, "height_m": 0.1}}, "at_m": [0, 0, -0.05]}
TO = {"move": {"to": {"at_m": [0.3, 0.25, 0.2]}}}


def mesh(triangles: FloatArray) -> Document:
    """A mesh in a request."""
    return {"mesh": {"data": base64.b64encode(binary_stl(triangles)).decode(), "format": "stl", "unit": "m"}}


def request(bodies: list[Document], *, tool: tuple[Document, ...] = (), **changes: Any) -> Document:
    return {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0, 0, -0.1], "bodies": [CUP, *tool]}},
        "start": {"joints": {"j1_rad": -0.23, "j2_rad": 1.87, "j3_m": 0.3, "j4_rad": 0.0}},
        "bodies": bodies,
        "task": [TO],
        "options": {"stop": "first", "budget_s": 30, "clearance_m": {"travel": 0.002, "near": 0.0005}},
        **changes,
    }


def body(name: str, triangles: FloatArray, **pose: Any) -> Document:
    return {"name": name, "shape": mesh(triangles), "pose": {"at_m": [0, 0, 0], **pose}}


FENCE = three_walls(0.6, 0.02, 0.0, 0.4)
PORTAL = open_below(moved(three_walls(0.7, 0.05, -0.2, 0.2), (0.0, -0.3, 0.0)))
ROOM = together(block((-1.0, -1.0, -0.3), (1.0, 1.0, 1.5)), inwards(block((-0.9, -0.9, -0.2), (0.9, 0.9, 1.4))))
FORK = open_below(moved(three_walls(0.05, 0.01, -0.01, 0.01), (0.0, 0.1, 0.0)))
RAIL = {"name": "rail", "shape": {"box": {"size_m": [0.3, 0.01, 0.06]}}, "pose": {"at_m": [0.35, 0.25, 0.15]}}
TURNS = {"table": {"dial": {"at_m": [0, 0, 0], "speed_rad_s": 0.5}}}
TURNING = {"table": {"turntable": {"at_m": [0.0, 0.0, 0.0], "rate_rad_s": 0.5}}}
LID = {
    "pick": {
        "part": "lid",
        "grasp_m": [0.055, 0, 0.02],
        "approach": {"m": 0.02},
        "dwell_s": 0.05,
        "depart": {"m": 0.04},
    }
}
TABLE = {"name": "table", "shape": {"box": {"size_m": [0.3, 0.3, 0.02]}}, "pose": {"at_m": [0.3, 0.2, 0.04]}}
PEG = {"name": "peg", "shape": {"box": {"size_m": [0.03, 0.03, 0.02]}}, "pose": {"at_m": [0.3, 0.2, 0.06]}}
CASES = {
    "a fence": request([body("fence", FENCE, at_m=[0.1, 0, 0])]),
    "a portal": request([body("portal", PORTAL)]),
    "a tray": request(
        [body("tray", 2e-3 * SOLIDS["tray"], at_m=[0.32, 0.2, 0.06])],
        start={"joints": {"j1_rad": -0.0731, "j2_rad": 1.7513, "j3_m": 0.16, "j4_rad": 0.0}},
        task=[{"move": {"to": {"at_m": [0.35, 0.15, 0.05]}}}],
    ),
    "a room": request([body("room", ROOM)]),
    "a fence that turns": request([body("fence", FENCE, frame="table")], frames=TURNING),
    "a fork on the arm, over a rail": request(
        [RAIL],
        tool=({"name": "fork", "shape": mesh(FORK), "at_m": [0, 0, -0.05]},),
        start={"joints": {"j1_rad": 0.0814, "j2_rad": 1.3736, "j3_m": 0.31, "j4_rad": 0.1158}},
        task=[{"move": {"to": {"at_m": [0.3, 0.25, 0.2], "yaw_rad": 1.5708}}}],
    ),
    "a part that is lifted off a peg": request(
        [TABLE, PEG, body("lid", three_walls(0.06, 0.02, 0.0, 0.02), at_m=[0.3, 0.2, 0.05])], task=[LID, TO]
    ),
}


@cache
def planned(name: str) -> tuple[Document, Document]:
    """The answer, and the bundle of its plan."""
    answer = plan_document(CASES[name])
    assert answer["status"] == "planned", answer
    return answer, bundle_document(CASES[name], answer)


@pytest.mark.parametrize("name", CASES)
def test_both_checkers_accept_a_plan_within_the_box_of_a_mesh(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    answer, bundle = planned(name)
    assert check_document(CASES[name], answer)["ok"]
    within_box, rounds = list[bool](), prover.rounds

    def seen(points: list[Any], triangles: list[Any], place: list[Any]) -> Any:
        within_box.append(all(min(x[k] for x in points) < place[k] < max(x[k] for x in points) for k in range(3)))
        return rounds(points, triangles, place)

    monkeypatch.setattr(prover, "rounds", seen)
    right, told = shown(bundle)
    assert right, told
    assert told["bodies from meshes, with what they enclose"] == 1
    assert any(within_box)


def pieces_of(bundle: Document) -> list[Document]:
    """The pieces of the mesh of a bundle, which has one."""
    (found,) = (body["pieces"] for body in bundle["bodies"] if any(piece["triangles"] for piece in body["pieces"]))
    return list(found)


@pytest.mark.parametrize("name", CASES)
def test_a_forged_surface_is_refused(name: str) -> None:
    _, right = planned(name)
    many = [len(piece["triangles"]) for piece in pieces_of(right)]
    assert len(many) > 1
    for k, size in enumerate(many):
        for change in ("missing", "turned", "of another mesh"):
            bundle = copy.deepcopy(right)
            piece = pieces_of(bundle)[k]
            if change == "missing":
                piece["triangles"].pop(size // 2)
            elif change == "turned":
                piece["triangles"][0].reverse()
            else:
                other = planned("a room" if name != "a room" else "a fence")[1]
                piece["triangles"] = pieces_of(other)[k % len(pieces_of(other))]["triangles"]
            with pytest.raises(ValueError, match=r"its surface is open|does not exist"):
                shown(bundle)


def test_a_room_without_its_inner_surface_is_a_block_round_the_arm() -> None:
    bundle = copy.deepcopy(planned("a room")[1])
    for piece in pieces_of(bundle):
        inner = [max(map(abs, vertex[:2])) < 0.95 and -0.25 < vertex[2] < 1.45 for vertex in piece["vertices"]]
        piece["triangles"] = [each for each in piece["triangles"] if not all(inner[k] for k in each)]
    right, lines = shown(bundle)
    assert not right
    assert all("nothing shows that one is not within the other" in line for line in lines[:-1])
    # all bodies of the robot
    assert lines[-1] == f"claims that are not shown: {sum(seat['link'] >= 0 for seat in bundle['seats'])}"


def test_a_mesh_that_is_put_round_the_arm_is_seen() -> None:
    """Rows and all else are right; the fence is a block that is larger than the arm."""
    bundle = copy.deepcopy(planned("a fence")[1])
    block_ = surface(block((-5.0, -5.0, -5.0), (5.0, 5.0, 5.0)), scale=1.0)
    corners = block_.corners
    (at,) = (k for k, body in enumerate(bundle["bodies"]) if body["name"] == "fence")
    bundle["bodies"][at]["pieces"] += [
        {**pieces_of(bundle)[0], "vertices": each.tolist(), "triangles": [[0, 1, 2]]} for each in corners
    ]
    right, lines = shown(bundle)
    assert not right
    assert any("nothing shows that one is not within the other" in line for line in lines)


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("noise_mm", [0.0, 0.7])
def test_a_surface_that_is_cut_is_closed_and_the_same(name: str, noise_mm: float) -> None:
    rng = np.random.default_rng(8)
    vertices, number = np.unique(SOLIDS[name].reshape(-1, 3), axis=0, return_inverse=True)
    corners = (vertices + noise_mm * rng.uniform(-1.0, 1.0, vertices.shape))[number].reshape(-1, 3, 3)
    given = surface(corners)
    covered = cover(given)
    assert covered.surface is not None
    turn, at = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3)
    turn *= np.sign(np.linalg.det(turn))
    pieces = tuple(Piece(piece.shape, at + turn @ piece.position, turn @ piece.rotation) for piece in covered.pieces)
    moved_to = given.vertices @ turn.T + at
    moved_to.flags.writeable = False
    document = body_document(Body(name, pieces, (moved_to, given.faces)))
    for piece, own in zip(document["pieces"], pieces, strict=True):
        assert min(depth(own, np.array(vertex))[0] for vertex in piece["vertices"]) >= -2 * IN_M
    found = prover.surface(document)  # which refuses it if it is open
    cut = np.array(found["vertices"])[np.array(found["triangles"])]
    whole = moved_to[given.faces]
    areas = [0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1).sum() for x in (cut, whole)]
    volumes = [np.einsum("ti,ti->", x[:, 0], np.cross(x[:, 1], x[:, 2])) / 6 for x in (cut, whole)]
    assert areas[0] == pytest.approx(areas[1], rel=1e-9)
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-6)
    assert len(cut) >= len(whole)

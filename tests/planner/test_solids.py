"""Units of the bodies of a cell: what stands for what, and what is asked against what."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.bodies import COVER, MOST, Arrangement, Bodies
from assur.planner.collision.pairs import PairTables
from assur.planner.collision.proof import Prover
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Piece, box, cylinder, support
from assur.planner.kernels.solids import CENTRE, FIRST, HALF, REQUIRED, ROTATION, SECOND
from assur.planner.laws import turntable
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from tests.planner.cells import CUP, Around, arm, block, cell, frame, go, mesh_box, solid, stands
from tests.planner.convex import anywhere, grid_aligned
from tests.planner.second_solids import carriers


def asked_pairs(scene: Scene, solids: Arrangement) -> tuple[IntArray, IntArray]:
    """The pairs of units that are asked on a way between two points."""
    way = Phase(0.0, 1.0, LegKind.MOVE, 0)
    pairs = PairTables(scene, solids.bodies)(solids, way).rows
    return pairs[:, FIRST].astype(np.int64), pairs[:, SECOND].astype(np.int64)


def centre(solids: Arrangement, unit: int) -> FloatArray:
    """Centre (3,) of a unit in its carrier."""
    return solids.rows[unit, CENTRE : CENTRE + 3]


def axes(solids: Arrangement, unit: int) -> FloatArray:
    """Axes (3, 3) of a unit in its carrier."""
    return solids.rows[unit, ROTATION : ROTATION + 9].reshape(3, 3)


def scene_of_all() -> Scene:
    bodies = (
        stands("post", cylinder(0.02, 0.2), 0.3, 0.3, 0.1),
        Around(mesh_box("bin", 0.2, 0.2, 0.1), "world", Pose(-0.3, 0.3, 0.05)),
        Around(solid("wedge", block(0.1, 0.05, 0.05, (0.05, 0.0, 0.0))), "dial", Pose(0.1, 0.0, 0.0, 1.0)),
        stands("part", box(0.02, 0.02, 0.02), 0.2, -0.2, 0.01),
    )
    dial = frame("dial", turntable(Pose(0.3, -0.3, 0.05), 1.0, valid=(0.0, 5.0)))
    return cell(go(0.3, 0.0), bodies=bodies, frames=(dial,), robot=arm(column=0.08), tool=CUP)


@given(st.lists(st.one_of(grid_aligned(), anywhere()), min_size=1, max_size=4), st.integers(0, 10**6))
def test_a_bounding_box_holds_all_pieces_and_little_more(pieces: list[Piece], seed: int) -> None:
    body = Body("body", (*pieces, pieces[0]))  # one primitive alone has no box
    solids = Bodies(cell(go(0.3, 0.0), bodies=(Around(body),), robot=arm(bare=True)))(AT_START)
    root = int(solids.roots[solids.number["body"]])
    half, middle = solids.rows[root, HALF : HALF + 3], centre(solids, root)
    assert np.array_equal(axes(solids, root), np.eye(3))
    n = np.random.default_rng(seed).normal(size=(50, 3))
    for direction in (*np.eye(3), *-np.eye(3), *n):
        highest = max(support(piece, direction) for piece in pieces)
        assert highest <= middle @ direction + half @ np.abs(direction) + 1e-12
    for axis in (*np.eye(3), *-np.eye(3)):
        assert middle @ axis + half @ np.abs(axis) - max(support(piece, axis) for piece in pieces) <= 2e-9


def test_a_primitive_is_one_unit_and_everything_else_has_its_box_first() -> None:
    scene = scene_of_all()
    solids = Bodies(scene)(AT_START)
    units = {
        name: [int(solids.piece[i]) for i in range(len(solids.body)) if solids.names[solids.body[i]] == name]
        for name in solids.names
    }
    assert units["post"] == [0]
    assert units["bin"] == [COVER, 0, 1, 2, 3, 4, 5]
    assert units["wedge"] == [COVER, 0]
    for number, name in enumerate(solids.names):
        root = solids.roots[number]
        assert solids.names[solids.body[root]] == name
        assert solids.piece[root] == units[name][0]
        assert [int(solids.piece[i]) for i in solids.pieces(number)] == [p for p in units[name] if p != COVER]
        assert all(solids.body[i] == number for i in solids.pieces(number))


def test_where_a_law_is_not_known_nothing_is_known() -> None:
    scene = scene_of_all()
    where = carriers(scene, np.zeros((2, 4)), np.array([1.0, 6.0]))
    dial = 5 + list(scene.frames).index("dial")
    assert np.isfinite(where.position[0]).all()
    assert np.isnan(where.position[1, dial]).all()
    assert np.isnan(where.rotation[1, dial][:2, :2]).all()


def test_every_body_of_the_arm_is_asked_against_every_body_around_and_its_own_as_the_robot_says() -> None:
    scene = scene_of_all()
    solids = Bodies(scene)(AT_START)
    a, b = asked_pairs(scene, solids)
    found = [(solids.names[solids.body[x]], solids.names[solids.body[y]]) for x, y in zip(a, b, strict=True)]
    around = [body.name for body in scene.bodies]
    link = {each.body.name: scene.robot.links[each.link] for each in scene.robot.bodies} | {"cup": "flange"}
    wanted = set(itertools.product(link, around))
    own = {frozenset(two) for two in itertools.combinations(link, 2)}
    own = {two for two in own if frozenset(link[name] for name in two) in set(map(frozenset, scene.robot.self_pairs))}
    assert own
    assert len(found) == len(set(found))
    assert {frozenset(two) for two in found} == {frozenset(two) for two in wanted} | own
    # whole bodies are asked: by their only piece or by their box
    assert set(a) | set(b) <= set(solids.roots)
    assert solids.of_robot[solids.body[a]].all()


def test_pairs_are_kept_for_all_plans_of_a_cell_with_the_start_of_each() -> None:
    scene = scene_of_all()
    later = replace(scene, start=replace(scene.start, time=scene.start.time + 1.0))
    phase = Phase(0.0, 1.0, LegKind.MOVE, 0)
    first, second = Prover(scene), Prover(later)
    one, other = first.pairs_of(phase), second.pairs_of(phase)
    assert one.rows is other.rows
    anew = PairTables(later, second.arrangement)(second.of(phase), phase, later.start.time)
    assert all(map(np.array_equal, other.errors, anew.errors))
    assert [each.errors[2][0] for each in (one, other)] == [scene.start.time, later.start.time]
    # other distances are other pairs
    wide = replace(scene, options=replace(scene.options, clearance=replace(scene.options.clearance, travel_m=0.1)))
    assert Prover(wide).pairs_of(phase).rows[0, REQUIRED] == 0.1
    # a plan keeps its own where they are dropped meanwhile
    for k in range(MOST + 2):
        Prover(replace(scene, start=replace(scene.start, time=float(k)))).pairs_of(phase)
    assert Prover(scene).pairs is not first.pairs
    assert first.pairs_of(replace(phase, kind=LegKind.WAIT)) is one

"""Solids of a URDF's links are contained in the bodies of the robot that is imported, whatever links carry them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.geometry.containment import winding_number
from assur.planner.geometry.shapes import Hull, Piece, Primitive
from assur.scenes.conventions import converted
from assur.scenes.meshes.load import triangles_of
from assur.scenes.meshes.solid_cover import solid_cover
from assur.scenes.meshes.surface import closed_surface
from assur.scenes.urdf.importing import ImportedRobot, write
from assur.scenes.urdf.solids import Covering
from assur.scenes.urdf.tree import turned
from tests.scenes.meshes.solids import SOLIDS, binary_stl, on_triangles, surface
from tests.scenes.urdf.made import RIGHT, Files, J, box, flange_by_library, mesh, urdf

NONE = np.empty((0, 3, 3))


def outside(points: FloatArray, pieces: list[Piece]) -> float:
    """How far points (k, 3) are outside of the nearest piece at most, m; at most 0 if each is in one."""
    best = np.full(len(points), np.inf)
    for piece in pieces:
        local = (points - piece.position) @ piece.rotation
        shape = piece.shape
        if isinstance(shape, Hull):
            planes = ConvexHull(shape.vertices).equations
            best = np.minimum(best, (local @ planes[:, :3].T + planes[:, 3]).max(1))
            continue
        assert isinstance(shape, Primitive)
        away = np.abs(local) - np.array(shape.half)
        if shape.disc:
            away = np.stack([np.hypot(local[:, 0], local[:, 1]) - shape.disc, away[:, 2]], axis=1)
        best = np.minimum(best, away.max(1) - shape.ball)
    return float(best.max())


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("most", [1, 3, 8])
def test_few_hulls_contain_a_solid_with_what_it_encloses(name: str, most: int) -> None:
    solid = surface(SOLIDS[name], turn=0.3, tilt=0.2)
    cover = solid_cover(solid, NONE, 0.005, most)
    assert 1 <= len(cover.hulls) <= most
    pieces = [Piece(hull) for hull in cover.hulls]
    assert outside(on_triangles(solid.corners, 3000, seed=1), pieces) <= 1e-9
    low, high = solid.vertices.min(0), solid.vertices.max(0)
    spread = np.random.default_rng(2).uniform(low, high, (3000, 3))
    enclosed = spread[winding_number((solid.vertices, solid.faces), spread) > 0.5]
    assert len(enclosed) > 100
    assert outside(enclosed, pieces) <= 1e-9


def test_more_hulls_are_nearer_to_the_solid_and_triangles_beside_it_are_contained_too() -> None:
    solid = surface(SOLIDS["tray"])
    one, many = solid_cover(solid, NONE, 0.004, 1), solid_cover(solid, NONE, 0.004, 12)
    assert many.excess_m < 0.5 * one.excess_m
    assert many.excess_m <= 0.004
    beside = np.array([[[0.2, 0.0, 0.0], [0.3, 0.0, 0.0], [0.2, 0.1, 0.0]]])
    assert outside(beside.reshape(-1, 3), [Piece(hull) for hull in solid_cover(solid, beside, 0.004, 8).hulls]) <= 1e-9


def furthest(
    files: Files,
    found: ImportedRobot,
    link: str,
    points: FloatArray,
    names: str,
    reader: Callable[..., FloatArray] = flange_by_library,
) -> float:
    """How far points of a URDF's link, which another reader places, get out of the bodies called `names` at random
    states, m."""
    arm = write(found, files.folder / "robot.yaml").built()
    robot = arm.robot(Pose(), arm.limits)
    count = len(arm.conventions)
    q = np.random.default_rng(3).uniform(-1.5, 1.5, (12, count))
    lift = [i for i, joint in enumerate(arm.conventions) if joint.kind == "prismatic"]
    q[:, lift] = np.abs(q[:, lift]) / 20 + 0.01
    theirs = reader(files.urdf, found.report["base"], link, [joint["urdf"] for joint in found.report["joints"]], q)
    positions, rotations = robot.placements(converted(q, arm.conventions))
    riders = [body for body in robot.bodies if body.body.name.startswith(names)]
    assert riders
    worst = -np.inf
    for k in range(len(q)):
        world = points @ theirs[k, :3, :3].T + theirs[k, :3, 3]
        pieces = []
        for rider in riders:
            turn, at = rotations[k, rider.link], positions[k, rider.link]
            pieces += [Piece(p.shape, at + turn @ p.position, turn @ p.rotation) for p in rider.body.pieces]
        worst = max(worst, outside(world, pieces))
    return float(worst)


BOX = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.02, 0.02) for z in (-0.03, 0.03)])
ORIGIN = ((0.05, 0.02, -0.1), (0.3, -0.4, 0.5))
MESH = mesh("star.stl", "0.001 0.001 0.001", *ORIGIN)
SHAPE = box(0.1, 0.04, 0.06, *ORIGIN)
LEVEL = (0.0, 1.0, 0.0)


def arms(shape: str) -> dict[str, tuple[str, str]]:
    """URDFs with a solid on one link, and which; names are the orders of their axes."""

    def scara(order: str, at: int, tip: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> str:
        turns = iter([(0.1, 0.02, 0.2), (0.3, 0, 0), (0.2, 0.1, 0)])
        joints = []
        for i, kind in enumerate(order):
            solid = shape if i + 1 == at else ""
            if kind == "p":
                joints.append(J("prismatic", (0, 0, 0.1), ends=(0.0, 0.2), shape=solid))
            else:
                joints.append(J("revolute", next(turns), (0, 0, 0.4), shape=solid))
        return urdf(*joints, J("fixed", (0, 0, -0.1), tip), base=shape if at == 0 else "")

    found = {
        f"{order}, link {at}": (scara(order, at), f"l{at}")
        for order in ("rrpr", "rprr", "prrr", "rrrp")
        for at in range(5)
    }
    found |= {f"rrpr, tool frame down, link {at}": (scara("rrpr", at, (2 * RIGHT, 0, 0)), f"l{at}") for at in (1, 3, 4)}
    for at in range(6):
        joints = [
            J("revolute", (0.1, 0.05, 0.1), (0, 0, 0.3)),
            J("revolute", (0, 0.05, 0.2), axis=LEVEL),
            J("revolute", (0, 0, 0.25), axis=LEVEL),
            J("revolute", (0.16, -0.05, 0), axis=(0, -1, 0)),
            J("revolute", (0.03, 0, 0), axis=(-1, 0, 0)),
        ]
        if at:
            joints[at - 1] = J(**{**joints[at - 1].__dict__, "shape": shape})
        found[f"five axes, link {at}"] = (
            urdf(*joints, J("fixed", (0.05, 0, 0)), base=shape if at == 0 else ""),
            f"l{at}",
        )
    return found


@pytest.mark.parametrize("name", arms(SHAPE))
def test_a_box_is_in_the_bodies_of_its_link_in_every_position(name: str, tmp_path: Path) -> None:
    text, link = arms(SHAPE)[name]
    files = Files(tmp_path).write(text)
    found = files.imported()
    roll, pitch, yaw = ORIGIN[1]
    turn = turned("z", yaw) @ turned("y", pitch) @ turned("x", roll)
    corners = BOX @ turn.T + ORIGIN[0]
    far = furthest(files, found, link, corners, link)
    assert far <= 1e-9
    if not any("upright cylinders" in remark for remark in found.report["remarks"]):
        assert far >= -1e-9  # a primitive is itself: its corners are its corners


MESHES = ("rrpr, link 1", "rrpr, tool frame down, link 4", "prrr, link 1", "rprr, link 2", "five axes, link 3")


@pytest.mark.parametrize("name", MESHES)
def test_a_mesh_is_in_the_bodies_of_its_link_in_every_position(name: str, tmp_path: Path) -> None:
    text, link = arms(MESH)[name]
    files = Files(tmp_path).write(text)
    (tmp_path / "star.stl").write_bytes(binary_stl(SOLIDS["star"]))
    found = files.imported(covering=Covering(0.005, 6, open_hull=False))
    roll, pitch, yaw = ORIGIN[1]
    turn = turned("z", yaw) @ turned("y", pitch) @ turned("x", roll)
    corners = triangles_of((tmp_path / "star.stl").read_bytes(), "stl") * 1e-3
    points = on_triangles(corners, 500, seed=4) @ turn.T + ORIGIN[0]
    assert furthest(files, found, link, points, link) <= 1e-9


OPEN = ("rrpr, link 3", "rrpr, link 4", "rrpr, tool frame down, link 4", "prrr, link 4", "rrrp, link 3")


@pytest.mark.parametrize("name", OPEN)
def test_an_open_mesh_that_is_revolved_is_taken_as_its_convex_hull(name: str, tmp_path: Path) -> None:
    low = [[[0, 0, 0], [60, 0, 0], [0, 60, 0]], [[0, 0, 0], [-60, 0, 0], [0, -60, 0]]]
    up = np.array([0.0, 0.0, 100.0])
    small, high = np.array(low) / 20 + up, np.array(low) + 2 * up
    sheets = np.concatenate([low, high, small])  # sheets with nothing between them
    text, link = arms(mesh("star.stl", "0.001 0.001 0.001"))[name]
    files = Files(tmp_path).write(text)
    (tmp_path / "star.stl").write_bytes(binary_stl(sheets))
    found = files.imported(covering=Covering(0.005, 6, open_hull=True))
    assert any("upright cylinders" in remark for remark in found.report["remarks"])
    weights = np.random.default_rng(6).dirichlet(np.ones(len(sheets) * 3), 2000)
    between = weights @ sheets.reshape(-1, 3) * 1e-3
    corners = sheets.reshape(-1, 3) * 1e-3
    edges = np.concatenate([(1 - t) * corners[:6] + t * corners[6:12] for t in np.linspace(0, 1, 21)])
    assert furthest(files, found, link, np.concatenate([between, edges]), link) <= 1e-7


def test_a_mirrored_mesh_is_turned_outside_out(tmp_path: Path) -> None:
    text = arms(MESH)["rrpr, link 1"][0].replace('scale="0.001 0.001 0.001"', 'scale="0.001 -0.001 0.001"')
    files = Files(tmp_path).write(text)
    (tmp_path / "star.stl").write_bytes(binary_stl(SOLIDS["bracket"]))
    assert files.imported().report["covers"][0]["hulls"] == 2


def test_vertices_that_are_almost_equal_close_a_mesh_and_its_own_triangles_are_contained(tmp_path: Path) -> None:
    noisy = SOLIDS["star"] + np.random.default_rng(5).uniform(-1e-3, 1e-3, SOLIDS["star"].shape)
    (tmp_path / "star.stl").write_bytes(binary_stl(noisy))
    with pytest.raises(Exception, match="open edges"):
        closed_surface(noisy, 1e-3)
    text, link = arms(mesh("star.stl", "0.001 0.001 0.001"))["rrpr, link 2"]
    files = Files(tmp_path).write(text)
    found = files.imported()
    corners = triangles_of((tmp_path / "star.stl").read_bytes(), "stl") * 1e-3
    assert furthest(files, found, link, on_triangles(corners, 500, seed=4), link) <= 1e-9


SRDF = '<robot name="a"><group name="arm"><chain base_link="l0" tip_link="l4"/></group>{}</robot>'


def srdf(folder: Path, *pairs: tuple[str, str]) -> Path:
    off = "".join(f'<disable_collisions link1="{a}" link2="{b}" reason="Never"/>' for a, b in pairs)
    (folder / "a.srdf").write_text(SRDF.format(off))
    return folder / "a.srdf"


def pairs_of(folder: Path, *off: tuple[str, str]) -> set[str]:
    solid = box(0.02, 0.02, 0.02)
    text = urdf(
        J("revolute", (0, 0, 0.2), shape=solid),
        J("revolute", (0.3, 0, 0), shape=solid),
        J("prismatic", (0.2, 0, 0), ends=(0.0, 0.2)),
        J("revolute", shape=solid),
        base=solid,
    )
    files = Files(folder).write(text)
    given = srdf(folder, *off) if off else None
    return {"-".join(pair) for pair in files.imported(srdf=given).report["self_pairs"]}


def test_pairs_that_an_srdf_disables_are_left_out_and_those_of_the_tool_stay(tmp_path: Path) -> None:
    tool = {"base-flange", "link1-flange", "link2-flange"}
    assert pairs_of(tmp_path) == {"base-link2", "base-quill", "link1-quill"} | tool
    joined = (("l0", "l1"), ("l1", "l2"), ("l2", "l4"))
    assert pairs_of(tmp_path, *joined) == {"base-link2", "base-quill", "link1-quill"} | tool
    assert pairs_of(tmp_path, *joined, ("l0", "l2"), ("l1", "l4")) == {"base-quill"} | tool
    assert pairs_of(tmp_path, *joined[1:], ("l0", "l2"), ("l1", "l4")) == {"base-link1", "base-quill"} | tool
    every = (*joined, ("l0", "l2"), ("l1", "l4"), ("l0", "l4"))
    assert pairs_of(tmp_path, *every) == tool


def test_links_without_collision_shapes_are_told(tmp_path: Path) -> None:
    plain = urdf(J("revolute", (0, 0, 0.2)), J("revolute", (0.3, 0, 0)), J("prismatic", (0.2, 0, 0), ends=(0.0, 0.2)))
    files = Files(tmp_path).write(plain.replace('<link name="l1">', '<link name="l1"><visual/>'))
    remarks = files.remarks
    assert any(remark.startswith("no collision shape, only a visual one: l1;") for remark in remarks)
    assert any(remark.startswith("no link has a collision shape: NOTHING") for remark in remarks)

"""The parts of the statement checker: formulas of laws, forward kinematics and surfaces, each against the product's own
numbers, which are computed in another way; and what it may import."""

from __future__ import annotations

import ast
import math
import tomllib
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from assur.planner import kernel_cache
from assur.planner.arrays import FloatArray
from assur.planner.checker.statement import arms, laws, solids
from assur.planner.checker.statement.holding import Handling
from assur.planner.geometry.shapes import box
from assur.planner.laws import (
    Change,
    Law,
    Pose,
    conveyor,
    fixed,
    indexer,
    keyframes,
    linear,
    oscillation,
    swing,
    turntable,
)
from assur.planner.laws.law import PoseUncertainty
from assur.planner.model.execution import Execution
from assur.planner.model.outcome import Planned
from assur.planner.pipeline import plan
from tests.architecture.source_tree import ROOT, Source, imports
from tests.planner.cells import cell, frame, go, stands
from tests.scenes.robots_of_every_family import ROBOTS, built

AT = Pose(0.3, -0.2, 0.1, 0.7)
CHANGES = (Change(0.5, 0.1, 2.0, 30.0), Change(1.2, 0.4, 0.5, math.inf), Change(3.0, -0.2, 1.0, 1.5))
POSES = (Pose(0.0, 0.1, 0.2, 0.0), Pose(0.3, 0.0, 0.1, 1.0), Pose(0.2, -0.1, 0.0, -0.5), Pose(0.0, 0.1, 0.2, math.tau))
TIMES = (-1.0, 0.3, 1.1, 2.0)
LAWS: tuple[Law, ...] = (
    fixed(AT),
    linear(AT, (0.1, -0.2, 0.05), 0.4),
    conveyor(AT, 0.25, at_time=0.3),
    conveyor(AT, 0.25, CHANGES, at_time=0.7),
    conveyor(AT, 0.25, tuple(Change(0.1 * k, 0.25, 1.0, 1.0) for k in range(20))),
    turntable(AT, 0.5, 0.02, CHANGES, at_time=-0.2),
    indexer(AT, 0.4, 0.3, 0.2, "turn", 0.1),
    indexer(AT, 0.4, 0.3, 0.0, "travel", 0.1),
    keyframes(TIMES, POSES, "natural"),
    keyframes(TIMES, POSES, "clamped"),
    keyframes(TIMES, POSES, "periodic"),
    swing(AT, 0.3, 1.5, 0.2),
    oscillation(AT, (0.0, 3.0, 4.0), 0.1, 1.5, 0.2),
)


@pytest.mark.parametrize("law", LAWS, ids=[f"{law.kind} {k}" for k, law in enumerate(LAWS)])
def test_the_formula_of_a_law_is_its_motion(law: Law) -> None:
    first, last = max(laws.known(law)[0], -4.0), min(laws.known(law)[1], 6.0)
    times = np.linspace(first, last, 301)
    formula = laws.formula_of(law, first, last)
    places = formula.place(times)
    for coordinate, amplitude, rate, phase in formula.sines:
        places[:, coordinate] += amplitude * np.sin(rate * times + phase)
    motion = law.motion(times)
    assert np.abs(places[:, :3] - motion.p).max() < 1e-12
    assert np.abs(places[:, 3] - motion.yaw).max() < 1e-12
    for time in times[::50].tolist():
        assert np.abs(np.array(laws.place_at(law, time)) - places[np.searchsorted(times, time)]).max() < 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_the_formula_of_a_random_law_is_its_motion(seed: int) -> None:
    rng = np.random.default_rng(seed)
    begin, changes = 0.0, list[Change]()
    for speed, a, j in rng.uniform((-0.5, 0.5, 1.0), (0.5, 5.0, 90.0), (4, 3)).tolist():
        changes.append(Change(begin, speed, a, j if rng.random() < 0.7 else math.inf))
        begin += 1.0 / a + 2.0 * math.sqrt(1.0 / j) + a / j + rng.random()
    times = np.cumsum(rng.uniform(0.05, 0.7, 6))
    poses = [Pose(*each) for each in rng.uniform(-1.0, 1.0, (5, 4)).tolist()]
    closed = (*poses, Pose(poses[0].x, poses[0].y, poses[0].z, poses[0].yaw + math.tau * int(rng.integers(-1, 2))))
    random: list[Law] = [conveyor(AT, 0.2, tuple(changes), at_time=float(rng.uniform(-2.0, 5.0)))]
    random += [keyframes(times, closed, ends) for ends in ("natural", "clamped", "periodic")]
    for law in random:
        first, last = max(laws.known(law)[0], -3.0), min(laws.known(law)[1], 9.0)
        at = np.linspace(first, last, 101)
        motion = law.motion(at)
        off = laws.formula_of(law, first, last).place(at) - np.column_stack([motion.p, motion.yaw])
        assert np.abs(off).max() < 1e-11


@pytest.mark.parametrize("law", LAWS, ids=[f"{law.kind} {k}" for k, law in enumerate(LAWS)])
def test_a_formula_names_its_degree_and_where_its_pieces_end(law: Law) -> None:
    """A polynomial of its degree through some instants of a piece is the formula at others."""
    first, last = max(laws.known(law)[0], -2.0), min(laws.known(law)[1], 4.0)
    formula = laws.formula_of(law, first, last)
    cuts = sorted({first, last, *(t for t in formula.ends if first < t < last)})
    for begin, end in pairwise(cuts):
        nodes = np.linspace(-1.0, 1.0, formula.degree + 1) if formula.degree else np.zeros(1)
        middle, half = (begin + end) / 2.0, (end - begin) / 2.0 * (1.0 - 1e-9)
        others = np.linspace(-0.97, 0.93, 11)
        powers = np.polyfit(nodes, formula.place(middle + half * nodes), formula.degree)
        through = np.stack([np.polyval(powers[:, k], others) for k in range(4)], axis=1)
        assert np.abs(through - formula.place(middle + half * others)).max() < 1e-9


@pytest.mark.parametrize("name", ROBOTS)
def test_the_textbook_has_links_where_the_robot_has_them(name: str) -> None:
    robot, rng = built(name).robot, np.random.default_rng(3)
    q = robot.limits.lower + rng.random((50, len(robot.joints))) * (robot.limits.upper - robot.limits.lower)
    position, rotation = robot.placements(q)
    links = [arms.textbook(robot, each) for each in q.tolist()]
    closes = [k for k, own in enumerate(links) if math.isfinite(sum(own[-1][0]))]
    assert len(closes) > 10
    for k in closes:
        for link, (place, angles) in enumerate(links[k]):
            turned = np.transpose([arms.rotated(angles, axis) for axis in np.eye(3).tolist()])
            assert np.abs(place - position[k, link]).max() < 1e-12
            assert np.abs(turned - rotation[k, link]).max() < 1e-12


def tetrahedron() -> FloatArray:
    """The four triangles of a tetrahedron, seen from outside."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(corners[np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])])


def cut(triangle: FloatArray, share: float = 0.4) -> FloatArray:
    """A triangle in two parts, by a line through its first corner."""
    a, b, c = triangle
    middle = b + share * (c - b)
    return np.array([[a, b, middle], [a, middle, c]])


def test_triangles_that_are_cut_cover_a_mesh() -> None:
    mesh = tetrahedron()
    assert solids._uncovered(mesh, np.concatenate([mesh[1:], cut(mesh[0])])) == 0
    assert solids._uncovered(mesh, np.concatenate([*map(cut, mesh)])[::-1]) == 0
    assert solids._uncovered(mesh, np.roll(mesh, 1, axis=1)) == 0


@pytest.mark.parametrize("what", ["missing", "twice", "turned", "beside", "larger", "part missing", "another mesh"])
def test_triangles_that_do_not_cover_a_mesh_are_counted(what: str) -> None:
    mesh = tetrahedron()
    parts = np.concatenate([mesh[1:], cut(mesh[0])])
    stated = {
        "missing": mesh[1:],
        "twice": np.concatenate([mesh, mesh[:1]]),
        "turned": np.concatenate([mesh[1:], mesh[:1, ::-1]]),
        "beside": np.concatenate([mesh[1:], mesh[:1] + 1e-6]),
        "larger": np.concatenate([mesh[1:], 1.001 * mesh[:1]]),
        "part missing": parts[:-1],
        "another mesh": 2.0 * mesh,
    }[what]
    assert solids._uncovered(mesh, stated) > 0


def forbidden() -> tuple[set[str], set[str]]:
    """What the import rule of the statement checker forbids, and what it allows of that."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    (own,) = (each for each in contracts if each.get("source_modules") == ["assur.planner.checker.statement"])
    return set(own["forbidden_modules"]), {line.split(" -> ")[1] for line in own["ignore_imports"]}


def wrong_imports(modules: tuple[Source, ...]) -> list[str]:
    """Imports that the rule forbids."""
    names, allowed = forbidden()
    return [
        f"{source.path}:{line} {name}"
        for source in modules
        for name, line in imports(source.tree)
        if any(f"{name}.".startswith(f"{each}.") for each in names)
        and not any(f"{each}.".startswith(f"{name}.") or f"{name}.".startswith(f"{each}.") for each in allowed)
    ]


EXACTLY: dict[str, tuple[bool, dict[str, Any]]] = {
    "nothing": (True, {"bodies": (stands("box", box(0.1, 0.1, 0.1), y=-0.5),), "frames": (frame("seat", fixed(AT)),)}),
    "a body": (
        False,
        {"bodies": (stands("box", box(0.1, 0.1, 0.1), y=-0.5, uncertainty=PoseUncertainty(position_m=1e-3)),)},
    ),
    "a frame": (False, {"frames": (frame("seat", fixed(AT), 1e-3),)}),
    "a lag": (False, {"execution": Execution((0.0, 0.001, 0.0, 0.0))}),
    "the start": (False, {"execution": Execution(start_tolerance_s=0.01)}),
}


@pytest.mark.parametrize("what", EXACTLY)
def test_one_thing_that_is_uncertain_makes_a_request_uncertain(what: str) -> None:
    is_exact, options = EXACTLY[what]
    scene = cell(go(0.3, 0.3), **options)
    found = plan(scene)
    assert isinstance(found, Planned)
    assert Handling(scene, found.plan).is_exact is is_exact


def test_the_statement_checker_imports_nothing_that_derives_the_same_facts() -> None:
    paths = sorted((ROOT / "planner" / "checker" / "statement").glob("*.py"))
    texts = [(path.stem, path.read_text(encoding="utf-8")) for path in paths]
    assert len(texts) > 10
    assert wrong_imports(tuple(Source(name, name, text, ast.parse(text)) for name, text in texts)) == []
    assert {"assur.planner.model.attachments", "assur.planner.model.phases"} <= set(forbidden()[0])


@pytest.mark.parametrize(
    "text",
    [
        "from assur.planner.model.phases import phases",
        "from assur.planner.model import phases",
        "from assur.planner.claim.filling import claim_of",
        "from assur.planner.frames import Conveyor",
        "from assur.planner.kernels.links import KIND",
        "import assur.planner.compiled",
    ],
)
def test_an_import_that_is_forbidden_is_reported(text: str) -> None:
    assert wrong_imports((Source("assur.planner.checker.statement.x", "x", text, ast.parse(text)),)) != []


def test_sources_that_do_not_count_as_those_of_kernels_have_none() -> None:
    """Who changes them need not compile anything."""
    for room in kernel_cache.PLAIN:
        texts = [path.read_text(encoding="utf-8") for path in (ROOT / "planner" / room).rglob("*.py")]
        assert texts
        assert all("@kernel" not in text and "numba" not in text for text in texts)

"""One door to each native library, and through no door what is known to lie, hang or crash."""

from __future__ import annotations

import ast

import pytest

from tests.architecture.source_tree import BESIDE, PRODUCT, Source, dotted, imports, names, sources, uses

DOORS = {
    "numba": ("assur.planner.compiled",),
    "fcl": ("assur.planner.collision.fcl_entry",),
    "ruckig": ("assur.planner.timing",),
    "trimesh": ("assur.scenes.meshes",),
    "fastapi": ("assur.api",),
    "pydantic": ("assur.scenes", "assur.request", "assur.api"),
    "yaml": ("assur.scenes.text.yaml_text",),
    "defusedxml": ("assur.scenes.urdf.xml_text", "assur.scenes.meshes.load"),
    "typer": ("assur.api",),
    "httpx": ("assur.api.python.client",),
}
"""Library → the modules (with what is below them) that may import it in the product."""

NO_WORLD = frozenset(
    {"os", "sys", "pathlib", "io", "shutil", "tempfile", "subprocess", "logging", "json", "yaml", "random"}
    | {"socket", "http", "urllib", "requests", "httpx"}
)
"""What the planner may not import: it opens no file, knows no HTTP, reads no environment, and is not random."""

COMPILER = ("assur.planner.compiled", "assur.planner.kernel_cache")
"""The modules of the planner that may name a folder: that of the compiled kernels."""

BANNED = {
    "fcl.distance": "over-estimates for aligned primitives",
    "fcl.continuousCollide": "misses collisions",
    "fcl.DistanceRequest": "signed distance aborts the process",
    "fcl.ContinuousCollisionRequest": "misses collisions",
    "fcl.DynamicAABBTreeCollisionManager": "stale poses, swallowed exceptions",
    "fcl.Plane": "segfaults against some shapes",
    "fcl.Halfspace": "segfaults against some shapes",
    "fcl.Ellipsoid": "shallow collisions are missed",
    "fcl.BVHModel": "hollow, and a bad index segfaults",
    "trimesh.load_remote": "reads an address",
    "trimesh.collision": "keeps ghosts of objects that moved",
    "concurrent.futures.ProcessPoolExecutor": "broken for good by one crash",
    "yaml.load": "builds objects",
    "pickle.loads": "builds objects",
    "eval": "",
    "exec": "",
}
"""Dotted names that no module of the product uses, and why."""

BANNED_NAMES = {
    "enable_signed_distance": "aborts or hangs the process",
    "intermediate_positions": "sends the motion to a cloud service",
    "per_section_max_velocity": "belongs to waypoints, which go to a cloud service",
    "gjk_solver_type": "lands in another field of the request",
}
"""Names that no module of the product has, as an attribute or keyword."""

EXCEPT = {
    "pickle.loads": "assur.api.workers.end",  # between the web process and its own workers
    "enable_signed_distance": "benchmarks.judge.solids",  # that of coal, which is not in the product
}
"""Where a banned name is allowed all the same."""


def doors_forced(modules: tuple[Source, ...]) -> list[str]:
    """Where a library is imported elsewhere than at its door."""
    return [
        f"{source.path}:{line} imports {name}"
        for source in modules
        for name, line in imports(source.tree)
        if (doors := DOORS.get(name.partition(".")[0])) is not None
        and not any(source.name == door or source.name.startswith(door + ".") for door in doors)
    ]


def banned_uses(modules: tuple[Source, ...]) -> list[str]:
    """Where a banned name is used."""
    found = []
    for source in modules:
        found += [
            f"{source.path}:{line} {name}: {BANNED[name]}"
            for name, line in uses(source.tree)
            if name in BANNED and EXCEPT.get(name) != source.name
        ]
        found += [
            f"{source.path}:{node.lineno} {node.func.id}: {BANNED[node.func.id]}"
            for node in ast.walk(source.tree)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in BANNED
        ]
        found += [
            f"{source.path}:{line} {name}: {BANNED_NAMES[name]}"
            for name, line in names(source.tree)
            if name in BANNED_NAMES and EXCEPT.get(name) != source.name
        ]
    return found


def loads_of_names(modules: tuple[Source, ...]) -> list[str]:
    """Where trimesh is given anything but bytes of a stated format: it takes a string for a path or an address."""
    return [
        f"{source.path}:{node.lineno}"
        for source in modules
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Call)
        and dotted(node.func).startswith("trimesh.load")
        and not (
            node.args
            and isinstance(node.args[0], ast.Call)
            and dotted(node.args[0].func) == "io.BytesIO"
            and any(keyword.arg == "file_type" for keyword in node.keywords)
        )
    ]


def worldly(modules: tuple[Source, ...]) -> list[str]:
    """Where the outside world is touched: files, environment, network, logs."""
    found = []
    for source in modules:
        found += [
            f"{source.path}:{line} imports {name}"
            for name, line in imports(source.tree)
            if name.partition(".")[0] in NO_WORLD
        ]
        found += [
            f"{source.path}:{node.lineno} calls {node.func.id}"
            for node in ast.walk(source.tree)
            if isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in ("open", "print", "input")
        ]
    return found


def made_up(name: str, text: str) -> tuple[Source, ...]:
    """A module that is not there, to show the rules something that they must refuse."""
    return (Source(name, name.replace(".", "/") + ".py", text, ast.parse(text)),)


def test_each_native_library_has_one_door() -> None:
    assert doors_forced(sources(*PRODUCT)) == []


def test_nothing_that_lies_hangs_or_crashes_is_called() -> None:
    assert banned_uses(sources(*PRODUCT, "benchmarks")) == []


def test_trimesh_gets_bytes_with_their_format_and_never_a_name() -> None:
    assert loads_of_names(sources(*PRODUCT)) == []


def test_the_planner_opens_no_file_knows_no_http_and_reads_no_environment() -> None:
    assert worldly(tuple(source for source in sources("planner") if source.name not in COMPILER)) == []


ASKING = ("benchmarks.judge.product", "benchmarks.judged_sessions")
"""What of the judge asks the product for answers, or for the logs of runs."""


def shared_with_the_product(found: tuple[Source, ...]) -> list[str]:
    """Imports of the product by the judge and what makes random requests, but for where it asks for answers."""
    return [
        f"{source.path}:{line} imports {name}"
        for source in found
        if source.name.startswith(("benchmarks.judge", "benchmarks.random_requests")) and source.name not in ASKING
        for name, line in imports(source.tree)
        if name.startswith("assur")
    ]


def test_the_judge_shares_no_code_with_what_it_judges() -> None:
    assert shared_with_the_product(sources(*BESIDE)) == []


def test_a_judge_that_imports_the_planner_is_found() -> None:
    text = "def f():\n    from assur.planner.kernels import gjk"
    found = shared_with_the_product(made_up("benchmarks.judge.motion", text))
    assert "benchmarks/judge/motion.py:2 imports assur.planner.kernels" in found


def test_the_service_is_seen_from_outside_by_what_puts_it_under_harm() -> None:
    inside = [
        f"{source.path}:{line} imports {name}"
        for source in sources(*BESIDE)
        if source.name.startswith("benchmarks.soak_service") and source.name != "benchmarks.soak_service.throughput"
        for name, line in imports(source.tree)
        if name.startswith("assur")
    ]
    assert inside == []


def test_the_recheck_shares_no_code_with_what_it_rechecks() -> None:
    shared = [
        f"{source.path}:{line} imports {name}"
        for source in sources(*BESIDE)
        if source.name in ("benchmarks.recheck", "benchmarks.problem_set", "benchmarks.translation")
        for name, line in imports(source.tree)
        if name.startswith(("assur", "benchmarks.run"))
    ]
    assert shared == []


@pytest.mark.parametrize(
    "text",
    [
        "import fcl",
        "import numpy as np, fcl",
        "from fcl import collide",
        "def f():\n    import fcl",
        "import importlib\nimportlib.import_module('fcl.fcl')",
        "from ruckig import Ruckig",
    ],
)
def test_an_import_beside_the_door_is_found(text: str) -> None:
    assert len(doors_forced(made_up("assur.planner.search.candidates", text))) >= 1
    assert len(doors_forced(made_up("assur.planner.collisions_of_others", text))) >= 1


def test_an_import_at_the_door_is_not_found() -> None:
    assert doors_forced(made_up("assur.planner.collision.fcl_entry", "import fcl")) == []
    assert doors_forced(made_up("assur.planner.timing.profile", "import ruckig")) == []


@pytest.mark.parametrize(
    "text",
    [
        "import fcl\nfcl.distance(a, b)",
        "from fcl import distance",
        "from fcl import continuousCollide as cc",
        "request = fcl.DistanceRequest(enable_signed_distance=True)",
        "input.intermediate_positions = [[0.0]]",
        "eval('1')",
    ],
)
def test_a_banned_call_is_found_under_each_of_its_spellings(text: str) -> None:
    assert len(banned_uses(made_up("assur.planner.collision.fcl_entry", text))) >= 1


@pytest.mark.parametrize("call", ["load('x.stl')", "load(io.BytesIO(b''))", "load_mesh(name, file_type='stl')"])
def test_a_mesh_loaded_by_name_or_without_its_format_is_found(call: str) -> None:
    assert len(loads_of_names(made_up("assur.scenes.meshes", f"import io, trimesh\ntrimesh.{call}"))) == 1
    good = "import io, trimesh\ntrimesh.load(io.BytesIO(content), file_type='stl')"
    assert loads_of_names(made_up("assur.scenes.meshes", good)) == []


@pytest.mark.parametrize(
    "text", ["import os", "from pathlib import Path", "open('x')", "import urllib.request", "print(1)"]
)
def test_a_planner_that_touches_the_world_is_found(text: str) -> None:
    assert len(worldly(made_up("assur.planner.legs", text))) >= 1

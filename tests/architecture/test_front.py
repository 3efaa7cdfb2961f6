"""`import assur`: quick, with every name that it promises, and with none of the libraries behind them."""

from __future__ import annotations

import ast
import subprocess
import sys

import pytest

import assur
from tests.architecture.source_tree import FRONT, ROOT, sources

HEAVY = {"fcl", "httpx", "llvmlite", "numba", "numpy", "pydantic", "ruckig", "scipy", "trimesh", "yaml"}


def loaded_after(program: str) -> set[str]:
    """The libraries that are loaded after `program` ran in a new process."""
    report = "\nimport sys\nprint('loaded', *sorted({name.partition('.')[0] for name in sys.modules}))"
    run = subprocess.run([sys.executable, "-c", program + report], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = set(run.stdout.splitlines()[-1].split())
    assert "loaded" in loaded
    return loaded & HEAVY


def test_importing_loads_no_library() -> None:
    assert loaded_after("import assur") == set()
    assert loaded_after("import assur; dir(assur); assur.InputError; assur.ServiceError") == set()


def test_neither_the_compiler_nor_pydantic_is_loaded_by_calls_and_clients_that_are_not_used_yet() -> None:
    assert loaded_after("import assur; assur.plan, assur.check, assur.load, assur.robots, assur.Answer") == set()
    assert loaded_after("import assur; assur.Client, assur.AsyncClient") == {"httpx", "numpy"}


def test_what_is_loaded_is_seen() -> None:
    assert {"numba", "pydantic"} <= loaded_after("import assur, assur.request, assur.planner.compiled")


def test_completion_lists_every_name_and_each_is_there() -> None:
    assert set(assur.__all__) <= set(dir(assur))
    assert [name for name in assur.__all__ if getattr(assur, name, None) is None] == []
    assert {"plan", "check", "load", "robots", "Client"} <= set(assur.__all__)
    assert assur.request.Request.__module__ == "assur.request"
    assert isinstance(assur.__version__, str)


def test_type_checkers_are_told_of_the_same_names() -> None:
    (front,) = (source for source in sources(FRONT) if source.name == "assur")
    told = {
        alias.name
        for node in ast.walk(front.tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for line in node.body
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
    }
    assert told == set(assur.__all__)


def test_a_name_that_is_not_there_is_refused() -> None:
    with pytest.raises(AttributeError, match="module 'assur' has no attribute 'plann'"):
        assur.plann  # type: ignore[attr-defined]  # noqa: B018


def test_a_client_without_its_library_says_what_to_install() -> None:
    missing = """
import sys
sys.modules["httpx"] = None  # as where it is not installed
import assur
try:
    assur.Client
except ModuleNotFoundError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", missing], cwd=ROOT, capture_output=True, text=True, check=True)
    assert "pip install 'assur[client]'" in run.stdout

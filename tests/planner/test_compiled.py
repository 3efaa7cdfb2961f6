"""Kernels: one signature each, indices that are checked, and compiled code that is found again or missed loudly."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from numba.core.errors import NumbaError

from assur.planner import compiled
from assur.planner.errors import FaultError
from assur.planner.kernel_cache import VARIABLE
from assur.scenes.kernels import load
from tests.architecture.source_tree import PRODUCT, Source, dotted, sources

THIRD = """
from assur.planner.compiled import compiled_now, kernel

@kernel("float64(float64[::1], int64)")
def part(x, k):
    if k < 0:
        raise IndexError("negative")
    return x[k] / x[0]
"""
PROBE = """
import sys
sys.path.insert(0, {folder!r})
import a_kernel, numpy
assert a_kernel.part(numpy.array([2.0, 1.0]), 1) == 0.5
print(a_kernel.compiled_now())
"""


PAIR = """
from assur.planner.compiled import kernel

@kernel("float64(float64)")
def inner(x):
    return x + 1.0

@kernel("float64(float64)")
def outer(x):
    return inner(x) * 2.0
"""
TWO_THREADS = """
import sys, threading
sys.path.insert(0, {folder!r})
import a_pair

from assur.planner import compiled

found = []
plain = compiled.compile_extra

def compiles(*arguments):
    if other.ident is None:
        other.start()
        other.join(0.5)  # numba's lock is held here: the other thread waits for it, with whatever else it holds
    return plain(*arguments)

compiled.compile_extra = compiles
other = threading.Thread(target=lambda: found.append(a_pair.inner(1.0)), daemon=True)
first = threading.Thread(target=lambda: found.append(a_pair.outer(1.0)), daemon=True)
first.start()
first.join(50.0)
other.join(5.0)
print(sorted(found), flush=True)
"""


def ran(program: str, cache: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, VARIABLE: str(cache), **variables}
    return subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)


@pytest.fixture
def program(tmp_path: Path) -> str:
    (tmp_path / "a_kernel.py").write_text(THIRD)
    return PROBE.format(folder=str(tmp_path))


def test_every_kernel_has_one_signature_and_takes_no_other() -> None:
    load()
    called = {name: compiled.KERNELS[name] for name in compiled.entries()}
    assert {name: made.signatures for name, made in called.items() if len(made.signatures) != 1} == {}
    assert [name for name, made in called.items() if made._can_compile] == []


def test_a_kernel_refuses_what_plain_python_refuses_and_another_type() -> None:
    @compiled.kernel("float64(float64[::1], int64)")
    def part(x: np.ndarray, k: int) -> float:
        if k < 0:
            raise IndexError("negative")
        return float(x[k] / x[0])

    x = np.array([2.0, 1.0])
    assert part(x, 1) == 0.5
    for k in (2, -1):
        with pytest.raises(IndexError):
            part(x, k)
    with pytest.raises(ZeroDivisionError):
        part(np.zeros(2), 1)
    x.flags.writeable = False
    with pytest.raises(TypeError):
        part(x, 1)
    del compiled.KERNELS[f"{__name__}.part"]


def test_a_kernel_that_makes_arrays_has_to_say_so_and_most_make_none() -> None:
    def silent(x: np.ndarray) -> float:
        return float(np.empty(len(x)).size)

    def said(x: np.ndarray) -> float:
        return float(np.empty(len(x)).size)

    with pytest.raises(NumbaError):
        compiled.kernel("float64(float64[::1])")(silent)(np.zeros(3))
    del compiled.KERNELS[f"{__name__}.silent"]
    assert compiled.kernel("float64(float64[::1])", allocates=True)(said)(np.zeros(3)) == 3.0
    del compiled.KERNELS[f"{__name__}.said"]
    load()
    assert sum(not made.targetoptions["_nrt"] for made in compiled.KERNELS.values()) > 0.7 * len(compiled.KERNELS)


def uses(source: Source) -> set[str]:
    """Names of the kernels that a module uses outside kernels, wherever it imports them."""
    names = {node.name: f"{source.name}.{node.name}" for node in source.tree.body if isinstance(node, ast.FunctionDef)}
    kernels = set(map(names.get, names)) & set(compiled.KERNELS)
    for node in ast.walk(source.tree):
        if isinstance(node, ast.ImportFrom):
            names |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    others = [node for node in source.tree.body if names.get(getattr(node, "name", "")) not in kernels]
    read = {dotted(node) for statement in others for node in ast.walk(statement) if isinstance(node, ast.expr)}
    parts = [name.partition(".") for name in read if name]
    return {names.get(first, "") + dot + rest for first, dot, rest in parts} & set(compiled.KERNELS)


def test_every_kernel_that_the_product_calls_from_python_is_compiled_beforehand() -> None:
    load()
    used = set[str]().union(*map(uses, sources(*PRODUCT)))
    assert used == set(compiled.entries())
    assert len(used) < 0.25 * len(compiled.KERNELS)


@pytest.mark.parametrize(("option", "kept"), [("", {"outer"}), (", entry=True", {"inner", "outer"})])
def test_a_kernel_that_kernels_call_is_compiled_beforehand_only_if_it_says_so(
    option: str, kept: set[str], tmp_path: Path
) -> None:
    (tmp_path / "a_pair.py").write_text(PAIR.replace('(float64)")', f'(float64)"{option})', 1))
    program = f"""
import sys
sys.path.insert(0, {str(tmp_path)!r})
import a_pair
from assur.planner import compiled
compiled.load_defined()
print(*compiled.compiled_now(), a_pair.outer(1.0))
"""
    for names in (sorted(f"a_pair.{name}" for name in kept), []):
        assert ran(program, tmp_path / "kept").stdout.split() == [*names, "4.0"]
    assert {path.name.split("-")[0] for path in (tmp_path / "kept").rglob("*.nbc")} == {f"a_pair.{k}" for k in kept}


def test_what_was_compiled_once_is_found_by_the_next_process(program: str, tmp_path: Path) -> None:
    first, second = ran(program, tmp_path / "kept"), ran(program, tmp_path / "kept")
    assert (first.stdout.strip(), second.stdout.strip()) == ("['a_kernel.part']", "[]"), first.stderr + second.stderr


def test_code_for_another_processor_is_not_taken_for_ones_own(program: str, tmp_path: Path) -> None:
    generic = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    assert ran(program, tmp_path / "kept").stdout.strip() == "['a_kernel.part']"
    assert ran(program, tmp_path / "kept", **generic).stdout.strip() == "['a_kernel.part']"


def test_plain_python_needs_no_compiled_code(program: str, tmp_path: Path) -> None:
    assert ran(program, tmp_path / "kept", NUMBA_DISABLE_JIT="1").stdout.strip() == "[]"
    assert not (tmp_path / "kept").exists()


def test_a_kernel_that_is_missing_where_nothing_can_be_written_is_an_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "a file").write_text("a folder cannot be made in a file")
    monkeypatch.setattr(compiled, "folder", lambda: tmp_path / "a file" / "kept")

    @compiled.kernel("float64(float64)")
    def twice(x: float) -> float:
        return 2 * x

    for _ in range(2):
        with pytest.raises(FaultError, match="cannot be written"):
            twice(1.0)
    del compiled.KERNELS[f"{__name__}.twice"]


def test_a_kernel_is_compiled_when_it_is_first_called_and_otherwise_as_a_part_of_those_that_call_it() -> None:
    @compiled.kernel("float64(float64)")
    def half(x: float) -> float:
        return x / 2

    @compiled.kernel("float64(float64)")
    def quarter(x: float) -> float:
        return half(half(x))

    names = [f"{__name__}.half", f"{__name__}.quarter"]
    one, other = (compiled.KERNELS.pop(name) for name in names)
    assert (len(one.signatures), len(other.signatures)) == (0, 0)
    assert quarter(8) == 2.0  # a whole number is converted, at the first call, too
    assert (len(one.signatures), len(other.signatures)) == (0, 1)
    assert half(3.0) == 1.5
    assert len(one.signatures) == 1


@pytest.mark.parametrize("arguments", [(), (np.zeros(2),), (np.zeros(2), 0, 0), (np.zeros((2, 2)), 0), ("text", 0)])
def test_the_first_call_refuses_other_arguments_as_every_call_does(arguments: tuple[object, ...]) -> None:
    @compiled.kernel("float64(float64[::1], int64)")
    def at(x: np.ndarray, k: int) -> float:
        return float(x[k])

    del compiled.KERNELS[f"{__name__}.at"]
    fixed = np.ones(2)
    fixed.flags.writeable = False
    for wrong in (arguments, (fixed, 0), (np.ones(4)[::2], 0)):
        with pytest.raises(TypeError):
            at(*wrong)  # type: ignore[arg-type]
    assert at(np.ones(2), 1) == 1.0


def test_threads_that_call_a_kernel_first_at_the_same_time_get_its_result() -> None:
    @compiled.kernel("float64(float64)")
    def thrice(x: float) -> float:
        return 3 * x

    del compiled.KERNELS[f"{__name__}.thrice"]
    with ThreadPoolExecutor(8) as threads:
        assert list(threads.map(thrice, [float(x) for x in range(64)])) == [3.0 * x for x in range(64)]


def test_two_threads_may_be_first_to_call_a_kernel_and_one_that_it_calls(tmp_path: Path) -> None:
    (tmp_path / "a_pair.py").write_text(PAIR)
    assert ran(TWO_THREADS.format(folder=str(tmp_path)), tmp_path / "kept").stdout.strip() == "[2.0, 4.0]"

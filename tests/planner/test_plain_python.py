"""Kernels compute the same as plain Python as they do compiled, on the inputs that real requests give them."""

from __future__ import annotations

import copy
import json
import os
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from assur.planner import compiled
from assur.planner.checker.claim.verdict import check_claim
from assur.scenes.bundle import bundle_document
from assur.scenes.kernels import load
from assur.scenes.requests import check_document, plan_document, shipped
from benchmarks.problem_set import read_problem_set
from benchmarks.translation import Terms, request
from tests.planner.claim.reading import read

ROOT = Path(__file__).parents[2]

SHOWN = ("five-bar", "rv-m1", "elbow-arm", "polar-arm", "two-robots", "demo", "full-dial", "fast-belt", "crowded")
"""Scenarios with every family of arms and nearly every time law."""
RELATIVE, ABSOLUTE = 1e-12, 1e-15
CANDIDATES = 12
"""Budget of each request, a count."""


class Recorder:
    """Stands in for a kernel: calls it, and keeps arguments and results of some calls."""

    def __init__(self, name: str, kernel: Any) -> None:
        self.name, self.kernel = name, kernel
        self.calls: list[tuple[tuple[Any, ...], Any, tuple[Any, ...]]] = []
        self.open = True
        """Whether the next call is kept: one for each scenario."""

    def __call__(self, *arguments: Any) -> Any:
        if not self.open:
            return self.kernel(*arguments)
        self.open = False
        before = copied(arguments, {})
        result = self.kernel(*arguments)
        self.calls.append((before, copy.deepcopy(result), copied(arguments, {})))
        return result


def copied(argument: Any, memory: dict[int, Any]) -> Any:
    """A copy of an argument. Arrays share memory in the copies as they do in what is copied: `memory` has the copies of
    arrays that own it, by identity."""
    if isinstance(argument, tuple):
        parts = [copied(part, memory) for part in argument]
        return type(argument)(*parts) if hasattr(argument, "_fields") else tuple(parts)
    if not isinstance(argument, np.ndarray):
        return copy.deepcopy(argument)
    owner = argument
    while isinstance(owner.base, np.ndarray):
        owner = owner.base
    if not owner.flags.c_contiguous:
        return argument.copy()
    own = memory.setdefault(id(owner), owner.copy())
    offset = argument.ctypes.data - owner.ctypes.data
    return np.ndarray(argument.shape, argument.dtype, own, offset, argument.strides)


@contextmanager
def recorded() -> Iterator[dict[str, Recorder]]:
    """Every kernel that Python calls replaced by a recorder, wherever a module of the product holds it, kernels' own
    modules included; and every other kernel, which is a part of these, by its plain Python."""
    recorders = {name: Recorder(name, made) for name, made in compiled.KERNELS.items() if made.overloads}
    by_identity: dict[int, Any] = {}
    for name, made in compiled.KERNELS.items():
        by_identity[id(made)] = recorders.get(name, made.py_func)
    replaced = []
    for module in [module for name, module in sys.modules.items() if name.startswith("assur.")]:
        for attribute, value in vars(module).items():
            if id(value) in by_identity:
                replaced.append((module, attribute, value))
    for module, attribute, value in replaced:
        setattr(module, attribute, by_identity[id(value)])
    try:
        yield recorders
    finally:
        for module, attribute, value in replaced:
            setattr(module, attribute, value)


def scenarios() -> dict[str, dict[str, Any]]:
    """Shipped scenarios, each with a small budget by count."""
    found = {}
    for name in SHOWN:
        document = copy.deepcopy(shipped(name).request)
        options = document.setdefault("options", {})
        for key in ("budget_s", "budget_ms", "explain_budget_s", "explain_budget_ms"):
            options.pop(key, None)
        options |= {"budget_s": 60.0, "max_candidates": CANDIDATES, "stop": "first", "report": "full"}
        found[name] = document
    return found


def same(one: Any, other: Any) -> bool:
    """Whether two results agree to rounding; NaN and infinities at the same places."""
    if isinstance(one, tuple):
        return len(one) == len(other) and all(same(a, b) for a, b in zip(one, other, strict=True))
    if one is None or other is None:
        return one is other
    a, b = np.asarray(one, dtype=np.complex128), np.asarray(other, dtype=np.complex128)
    # beside the largest number of the array a small one has the rounding of the large ones
    size = float(np.abs(a[np.isfinite(a)]).max(initial=0.0))
    return bool(np.isclose(a, b, rtol=RELATIVE, atol=ABSOLUTE + RELATIVE * size, equal_nan=True).all())


def test_every_kernel_is_the_same_as_plain_python_on_what_requests_give_it() -> None:
    load()
    with recorded() as recorders:
        compared: dict[str, int] = defaultdict(int)
        differing = []
        for name, document in scenarios().items():
            for recorder in recorders.values():
                recorder.open = True
            answer = plan_document(document)
            if answer["status"] == "planned":
                assert check_document(document, answer)["ok"], name
                claim, _ = read(bundle_document(document, answer))
                assert check_claim(claim).accepted, name
            for kernel, recorder in recorders.items():
                for before, result, after in recorder.calls[compared[kernel] :]:
                    compared[kernel] += 1
                    arguments = copied(before, {})
                    plain = recorder.kernel.py_func(*arguments)
                    if not (same(plain, result) and same(tuple(arguments), after)):
                        differing.append((kernel, name))
    assert differing == []
    # the others are not called by these scenarios: tests/planner/kernels has them
    assert len([kernel for kernel in recorders if compared[kernel]]) >= 0.8 * len(recorders)


PLAIN = """
import json, sys
from assur.planner.compiled import KERNELS
from assur.scenes.kernels import load
from assur.scenes.requests import plan_document
load()
assert not any(hasattr(kernel, "py_func") for kernel in KERNELS.values())
for name, request in json.load(sys.stdin).items():
    answer = plan_document(request, certificate="digest")
    print(json.dumps([name, answer["status"], answer.get("reason"), answer.get("duration_s")]))
"""


PROBLEMS = ROOT / "benchmarks" / "problems"


def problems(count: int) -> dict[str, dict[str, Any]]:
    """Requests of the benchmark's sets, `count` of each, with a small budget by count."""
    found = {}
    for name in ("static", "moving_bodies", "moving_goal"):
        chosen = read_problem_set(PROBLEMS / f"{name}.json")
        for problem in chosen.problems[:count]:
            asked = request(problem, chosen.limits, Terms(budget_s=60.0, match="velocity"))
            asked["options"] |= {"max_candidates": CANDIDATES}
            found[problem["id"]] = asked
    return found


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_fifty_requests_come_out_the_same_without_the_compiler() -> None:
    asked = problems(17)
    assert len(asked) >= 50
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    ran = subprocess.run(
        [sys.executable, "-c", PLAIN],
        input=json.dumps(asked),
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    plain = {name: rest for name, *rest in map(json.loads, ran.stdout.splitlines())}
    for name, document in asked.items():
        answer = plan_document(document, certificate="digest")
        status, reason, duration = plain[name]
        assert (answer["status"], answer.get("reason")) == (status, reason), name
        assert (answer.get("duration_s") is None) == (duration is None), name
        assert duration is None or abs(answer["duration_s"] - duration) <= 1e-9, name

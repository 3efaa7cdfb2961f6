"""What the product imports is what `pyproject.toml` declares: a fresh environment has all of it, and nothing idle."""

from __future__ import annotations

import re
import sys
import tomllib
from importlib.metadata import packages_distributions

from tests.architecture.source_tree import BESIDE, PRODUCT, ROOT, imports, sources

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = ("plot", "client", "xacro", "dae", "proof", "log")
"""Extras of the product; whoever calls what needs one that is not there is told its name."""
ELSEWHERE = {"pycollada", "xacrodoc"}
"""Extras that trimesh imports, and that a process of its own does."""
PEERS = ("benchmarks/peers/ompl_rrtconnect.py", "benchmarks/peers/mplib_planner.py", "benchmarks/peers/toppra_legs.py")
"""Programs that are not run in the environment of the project."""
GENERATED = {"scara-models"}
"""Modules that a test has made."""
BROUGHT = {"pydantic-core": "pydantic", "annotated-types": "pydantic"}
"""Imported, but chosen by the library that is declared: they are made for each other, release by release."""


def _plain(requirement: str) -> str:
    """The name of a requirement as an index writes it."""
    return re.sub(r"[-_.]+", "-", re.split(r"[<>=!~\[; ]", requirement)[0]).lower()


def _imported(*packages: str) -> dict[str, str]:
    """Distribution → a place where it is imported."""
    owners = packages_distributions()
    found = {}
    for source in sources(*packages):
        for module, line in imports(source.tree):
            top = module.partition(".")[0]
            if top not in sys.stdlib_module_names and top not in ("assur", *BESIDE):
                for owner in owners.get(top, [top]):
                    name = _plain(owner)
                    if name in GENERATED:
                        continue
                    found[BROUGHT.get(name, name)] = f"{source.path}:{line}"
    return found


def _declared(*extras: str) -> set[str]:
    """What is installed with these extras, by name."""
    optional = PROJECT["optional-dependencies"]
    return {_plain(each) for each in [*PROJECT["dependencies"], *(each for name in extras for each in optional[name])]}


def test_every_library_that_the_product_imports_is_declared() -> None:
    declared = _declared(*EXTRAS)
    extra = {name: where for name, where in _imported(*PRODUCT).items() if name not in declared}
    assert extra == {}


def test_every_library_that_is_declared_is_imported() -> None:
    assert _declared(*EXTRAS) - set(_imported(*PRODUCT)) == ELSEWHERE


def test_every_library_that_tests_and_benchmarks_import_comes_with_their_extra() -> None:
    assert f"assur[{','.join(sorted(EXTRAS))}]" in PROJECT["optional-dependencies"]["test"]
    imported, declared = _imported(*BESIDE), _declared("test", *EXTRAS)
    # the tests of reports run where there is a browser, with an extra of their own
    of_browser = {name for name in _declared("browser") if imported.get(name, "").startswith("tests/browser/")}
    extra = {name: where for name, where in imported.items() if name not in declared | of_browser}
    # the peers' programs run in an environment of their own: tests/benchmarks/test_peers.py holds them to it
    assert {name: where for name, where in extra.items() if not where.startswith(PEERS)} == {}
    assert set(extra) <= {"ompl", "mplib", "toppra"}

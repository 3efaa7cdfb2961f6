"""What the pages name is there: links, files, modules, settings, constants, reasons; the drawing is its program's."""

from __future__ import annotations

import re
import tomllib
from dataclasses import fields
from importlib import import_module

import pytest

from assur.api.web.settings import PREFIX, Settings
from tests.docs.pages import PAGES, ROOT, anchors, prose, spans, text

OF_TESTS = {"ASSUR_HYPOTHESIS", "ASSUR_MAKER_ROBOTS"}
"""Variables that the tests read and the service never sees: their names are its own only by prefix."""
SOURCES = "\n".join(
    path.read_text(encoding="utf-8")
    for package in ("planner", "scenes", "api", "experiments", "prover", "benchmarks", "docs")
    for path in sorted((ROOT / package).rglob("*.py"))
)
CONSTANT = re.compile(r"\b[A-Z][A-Z0-9]+(?:_[A-Z0-9]+)+\b")
IMAGE_OR_LINK = re.compile(r"\]\(([^)\s]+)\)")


def broken_links(page: str, content: str) -> list[str]:
    """Links of a page to files or headings that are not there."""
    found = []
    for target in IMAGE_OR_LINK.findall(content):
        if target.startswith(("https://", "http://")):
            continue
        name, _, fragment = target.partition("#")
        there = (ROOT / page).parent / name if name else ROOT / page
        relative = str(there.resolve().relative_to(ROOT)) if there.exists() else ""
        if not relative or (fragment and fragment not in anchors(relative)):
            found.append(target)
    return found


@pytest.mark.parametrize("page", PAGES)
def test_every_link_leads_somewhere(page: str) -> None:
    assert broken_links(page, prose(page)) == []


def test_a_link_to_nowhere_is_found() -> None:
    wrong = "[a](docs/nowhere.md) [b](docs/api.md#no-such-heading) [c](docs/api.md#the-answer)"
    assert broken_links("README.md", wrong) == ["docs/nowhere.md", "docs/api.md#no-such-heading"]


def test_every_page_is_reached_from_readme() -> None:
    seen, ahead = set(), ["README.md"]
    while ahead:
        page = ahead.pop()
        seen.add(page)
        for target in IMAGE_OR_LINK.findall(prose(page)):
            there = (ROOT / page).parent / target.partition("#")[0]
            if there.suffix == ".md" and there.is_file():
                name = str(there.resolve().relative_to(ROOT))
                if name not in seen:
                    ahead.append(name)
    assert set(PAGES) - seen == set()


def test_the_index_of_the_pages_lists_each_once() -> None:
    listed = re.findall(r"^\d+\. \[[^\]]+\]\(([^)]+)\)", prose("docs/README.md"), re.MULTILINE)
    names = [str((ROOT / "docs" / target).resolve().relative_to(ROOT)) for target in listed]
    own = {
        page for page in PAGES if not page.startswith("docs/decisions/") and page not in {"README.md", "docs/README.md"}
    }
    assert len(set(names)) == len(names)
    assert set(names) >= own


def settings_not_there(content: str) -> set[str]:
    known = {PREFIX + field.name.upper() for field in fields(Settings)} | OF_TESTS
    return set(re.findall(rf"\b{PREFIX}[A-Z0-9_]+\b", content)) - known


def constants_not_there(content: str) -> set[str]:
    return {name for name in CONSTANT.findall(content) if not re.search(rf"\b{name}\b", SOURCES)}


@pytest.mark.parametrize("page", PAGES)
def test_every_setting_that_is_named_exists(page: str) -> None:
    assert settings_not_there(text(page)) == set()


@pytest.mark.parametrize("page", PAGES)
def test_every_constant_and_reason_that_is_named_exists(page: str) -> None:
    content = re.sub(rf"\b{PREFIX}[A-Z0-9_]+\b", "", text(page))
    assert constants_not_there(content) == set()


def test_a_name_that_does_not_exist_is_found() -> None:
    assert settings_not_there("`ASSUR_WORKERS` and `ASSUR_WORKER`") == {"ASSUR_WORKER"}
    assert constants_not_there("GRID_S, OUT_OF_BEACH") == {"OUT_OF_BEACH"}


MADE = "out/"
"""What commands write goes here; it is there or not."""


def paths_not_there(names: list[str]) -> list[str]:
    """Of code spans that are paths of this repository, those that are not there."""
    paths = [name for name in names if re.fullmatch(r"[\w.-]+(/[\w.-]+)+", name)]
    known = [path for path in paths if (ROOT / path.split("/")[0]).is_dir() and not path.startswith(MADE)]
    return [path for path in known if not (ROOT / path).exists()]


@pytest.mark.parametrize("page", PAGES)
def test_every_path_that_is_named_exists(page: str) -> None:
    assert paths_not_there(spans(page)) == []


def modules_not_there(names: list[str]) -> list[str]:
    """Of code spans that are dotted names of ours, those that cannot be imported."""
    found = []
    for name in names:
        match = re.fullmatch(r"((?:assur|benchmarks)(?:\.\w+)+)(?:\(.*\))?", name)
        if match is None:
            continue
        *parts, last = match.group(1).split(".")
        try:
            import_module(match.group(1))
        except ModuleNotFoundError:
            if not hasattr(import_module(".".join(parts)), last):
                found.append(name)
    return found


@pytest.mark.parametrize("page", PAGES)
def test_every_dotted_name_of_ours_can_be_imported(page: str) -> None:
    assert modules_not_there(spans(page)) == []


def test_a_path_and_a_module_that_do_not_exist_are_found() -> None:
    assert paths_not_there(["docs/api.md", "docs/nowhere.md", "application/json"]) == ["docs/nowhere.md"]
    assert modules_not_there(["assur.scenes.load(name)", "assur.scenes.requests", "assur.scenes.lode"]) == [
        "assur.scenes.lode"
    ]


def test_the_changelog_has_a_section_for_this_version() -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert re.search(rf"^## {re.escape(version)}\b", text("CHANGELOG.md"), re.MULTILINE)


def test_the_pages_say_proved_and_what_it_is_not() -> None:
    everything = " ".join("\n".join(text(page) for page in PAGES).split())
    assert "certified safe" not in everything.lower()
    for page in ("README.md", "docs/guarantees.md", "docs/service.md"):
        said = " ".join(text(page).split())
        assert "proved against the model" in said.replace("**", "").lower(), page
        assert "ISO 10218" in said, page
        assert "ISO 13849" in said, page


def test_every_test_that_a_claim_is_held_by_is_where_the_page_says() -> None:
    named = [name for name in spans("docs/sources.md") if re.fullmatch(r"test_\w+\.py", name)]
    assert len(set(named)) >= 5
    assert [name for name in named if not (ROOT / "tests" / "experiments" / name).is_file()] == []

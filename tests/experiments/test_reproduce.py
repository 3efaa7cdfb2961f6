"""The command `assur reproduce`: what it writes, what it refuses, and that plotting stays out of everything else."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from assur.experiments import figures
from assur.experiments.experiment import Drawing, paragraphs
from assur.experiments.reproduce import ENTRIES, chosen, reproduce
from assur.planner.errors import FaultError, InputError
from tests.architecture.source_tree import PRODUCT, ROOT, imports, sources
from tests.experiments.results import result

NAMES = [entry.name for entry in ENTRIES]


def steady(numbers: dict[str, Any]) -> Any:
    """The numbers but for timings, as JSON has them."""
    return json.loads(json.dumps({key: value for key, value in numbers.items() if key != "timings"}, allow_nan=False))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_an_experiment_leaves_two_figures_a_paragraph_and_the_same_numbers_as_before(name: str, tmp_path: Path) -> None:
    before = result(name)
    (done,) = reproduce(name, tmp_path / "new" / "folder")
    png, svg, numbers, words = done.files
    assert [path.name for path in done.files] == [f"{name}.{kind}" for kind in ("png", "svg", "json", "md")]
    assert png.read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    width = float((ET.parse(svg).getroot().get("width") or "").removesuffix("pt"))
    assert width == pytest.approx(72 * before.size[0])
    document = json.loads(numbers.read_text(encoding="utf-8"))
    assert (document["experiment"], document["source"]) == (name, done.entry.source)
    assert steady(document["numbers"]) == steady(before.numbers)
    assert ("timings" in document["numbers"]) == (name == "dyad-timing")
    text = words.read_text(encoding="utf-8")
    assert done.paragraph in text
    assert f"({name}.svg)" in text
    assert done.paragraph == before.paragraph or name == "dyad-timing"
    assert re.search(r"\bnan\b", done.paragraph) is None


HEADS = ("Claim", "Measured", "Verdict", "Mended")
LONGEST = 110
"""Words of a paragraph that one still reads."""


def amiss(told: str) -> list[str]:
    """What of the paragraphs of an experiment is not as `paragraphs` promises: heads in order, short, panels named."""
    parts = told.split("\n\n")
    heads = tuple(re.findall(r"^\*\*(\w+)\.\*\* ", told, re.MULTILINE))
    found = [] if heads in (HEADS, HEADS[:3]) else [f"heads {heads}"]
    found += [f"{part[:20]}: {len(part.split())} words" for part in parts if len(part.split()) > LONGEST]
    return found if re.search(r"[Pp]anels? \([a-h]\)", told) else [*found, "no panel"]


@pytest.mark.parametrize("name", NAMES)
def test_what_is_told_is_claim_measurement_verdict_and_what_is_mended(name: str) -> None:
    assert amiss(result(name).paragraph) == []


def test_one_long_block_that_names_no_panel_is_found() -> None:
    assert amiss(f"**Claim.** {'word ' * LONGEST}") == [
        "heads ('Claim',)",
        f"**Claim.** word word: {LONGEST + 1} words",
        "no panel",
    ]
    assert amiss(paragraphs("a", "panel (a)", "c")) == []


def test_a_figure_drawn_again_has_the_same_bytes(tmp_path: Path) -> None:
    drawn = result("modes")
    for folder in ("first", "second"):
        (tmp_path / folder).mkdir()
        figures.write(drawn.draw, drawn.size, tmp_path / folder / "modes")
    for kind in ("png", "svg"):
        first, second = (tmp_path / folder / f"modes.{kind}" for folder in ("first", "second"))
        assert first.read_bytes() == second.read_bytes()


def test_a_figure_with_a_title_that_leaves_the_page_is_refused(tmp_path: Path) -> None:
    def draw(figure: Drawing) -> None:
        figure.subplots().set_title("a title as long as this one does not fit above axes of two inches")

    with pytest.raises(FaultError, match="leaves its page"):
        figures.write(draw, (2.0, 2.0), tmp_path / "cut")
    assert list(tmp_path.iterdir()) == []


def test_all_means_every_experiment_and_a_name_means_itself() -> None:
    assert chosen("all") == ENTRIES
    assert len(set(NAMES)) == len(NAMES)
    for entry in ENTRIES:
        assert chosen(entry.name) == (entry,)


def test_each_of_all_is_told_as_it_is_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    two = tuple(entry for entry in ENTRIES if entry.name in ("modes", "polar"))
    monkeypatch.setattr("assur.experiments.reproduce.ENTRIES", two)
    told = []
    for done in reproduce("all", tmp_path):
        told.append((done.entry, done.number, done.count))
        assert len(list(tmp_path.iterdir())) == 4 * done.number
    assert told == [(two[0], 1, 2), (two[1], 2, 2)]


def test_an_unknown_experiment_and_a_folder_that_is_a_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="spiral"):
        list(reproduce("spirals", tmp_path))
    taken = tmp_path / "taken"
    taken.write_text("")
    with pytest.raises(InputError, match="--out"):
        list(reproduce("modes", taken))


@pytest.mark.slow
def test_the_command_prints_what_it_found_and_names_the_experiments_to_one_who_errs(tmp_path: Path) -> None:
    def assur(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "assur.api.command_line", "reproduce", *arguments, "--out", str(tmp_path)]
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)

    ran = assur("modes")
    assert ran.returncode == 0, ran.stderr
    assert result("modes").paragraph in ran.stdout
    assert {path.name for path in tmp_path.iterdir()} == {f"modes.{kind}" for kind in ("png", "svg", "json", "md")}
    wrong = assur("mode")
    assert wrong.returncode == 2
    assert "line-through-singularity" in wrong.stderr


def test_without_matplotlib_one_is_told_of_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(InputError, match="extra `plot`"):
        list(reproduce("modes", tmp_path))


@pytest.mark.slow
def test_matplotlib_has_one_door() -> None:
    doors = {s.name for s in sources(*PRODUCT) for name, _ in imports(s.tree) if name.partition(".")[0] == "matplotlib"}
    assert doors == {"assur.experiments.figures"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "program",
    [
        "from assur.api.web.app import create_app\ncreate_app()",
        "import assur.api.command_line",
        "from assur.experiments.reproduce import ENTRIES\n[e for e in ENTRIES if e.name == 'modes'][0].run()",
    ],
)
def test_nothing_but_a_figure_loads_matplotlib(program: str) -> None:
    report = f"{program}\nimport sys\nprint('matplotlib' in sys.modules)"
    ran = subprocess.run([sys.executable, "-c", report], cwd=ROOT, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.strip() == "False"


def test_experiments_are_found_by_the_name_under_which_they_are_installed() -> None:
    assert all(find_spec(entry.module) is not None for entry in ENTRIES)
    assert {entry.module.rsplit(".", 1)[0] for entry in ENTRIES} == {"assur.experiments"}

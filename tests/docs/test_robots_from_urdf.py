"""What docs/robots.md shows of an import, refused or warned about, is what the command prints for the page's files."""

from __future__ import annotations

from pathlib import Path

import pytest

from assur.api.cli.border import BAD_INPUT, RIGHT
from tests.api.test_command_line import run
from tests.docs.pages import save_files, text

PAGE = "docs/robots.md"
UPPER, ELBOW = '<origin xyz="0.15 0 0.03"/>', 'lower="-2.5" upper="2.5"'


def shown(head: str) -> list[str]:
    """The indented lines of the page that begin so."""
    return [line.strip() for line in text(PAGE).splitlines() if line.startswith(f"    {head}")]


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    save_files(PAGE, tmp_path)
    return tmp_path / "small.urdf"


def imported(urdf: Path, *more: str) -> tuple[int, str, str]:
    return run("robots", "import", str(urdf), "--out", str(urdf.parent / "out.yaml"), *more)


def changed(urdf: Path, old: str, new: str) -> None:
    before = urdf.read_text()
    assert old in before
    urdf.write_text(before.replace(old, new))


def test_without_limits_the_lines_are_printed_that_the_page_shows(urdf: Path) -> None:
    code, _, errors = imported(urdf)
    assert code == BAD_INPUT
    lines = shown("assur: small.urdf: joint")
    assert len(lines) == 2
    assert set(lines) < set(errors.splitlines())


def test_an_attribute_that_is_not_known_is_refused_as_the_page_shows(urdf: Path) -> None:
    changed(urdf, UPPER, UPPER.replace("/>", ' rpyy="0 0 1"/>'))
    code, _, errors = imported(urdf, "--joint-limits", str(urdf.parent / "joint_limits.yaml"))
    assert code == BAD_INPUT
    (line,) = shown("assur: small.urdf: line")
    assert errors.splitlines()[0] == line


def test_degrees_are_warned_about_as_the_page_shows(urdf: Path) -> None:
    changed(urdf, ELBOW, 'lower="-145" upper="145"')
    code, output, _ = imported(urdf, "--joint-limits", str(urdf.parent / "joint_limits.yaml"))
    assert code == RIGHT
    (line,) = shown("warning:")
    assert line in " ".join(output.split())

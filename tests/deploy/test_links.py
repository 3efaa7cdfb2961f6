"""The build backend makes the links in `src/assur`, on Windows too, as far as this can be shown elsewhere. None of them
is in git or in the image."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from benchmarks import commits
from deploy.packaging.backend import FOLDERS, ROOT, link
from tests.deploy.test_image import instructions


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A source tree without links."""
    root = tmp_path / "tree"
    (root / "src" / "assur").mkdir(parents=True)
    for name in FOLDERS:
        (root / name).mkdir()
    return root


def links(tree: Path) -> dict[str, str]:
    """Name → target, of all links in `src/assur`."""
    return {path.name: str(path.readlink()) for path in (tree / "src" / "assur").iterdir() if path.is_symlink()}


RELATIVE = {name: f"../../{name}" for name in FOLDERS}


def test_links_are_relative_so_that_the_tree_can_be_moved(tree: Path) -> None:
    link(tree)
    assert links(tree) == RELATIVE
    moved = tree.rename(tree.with_name("moved"))
    for name in FOLDERS:
        assert (moved / "src" / "assur" / name).samefile(moved / name)


def test_a_link_that_is_right_stays_and_one_to_another_place_is_replaced(tree: Path) -> None:
    link(tree)
    places = [tree / "src" / "assur" / name for name in FOLDERS]
    before = [place.lstat().st_ino for place in places]
    link(tree)
    assert [place.lstat().st_ino for place in places] == before
    (tree / "elsewhere").mkdir()
    for place, target in zip(places[:2], ("elsewhere", "nowhere"), strict=True):
        place.unlink()
        place.symlink_to(tree / target)
    link(tree)
    assert links(tree) == RELATIVE


@pytest.mark.parametrize("is_folder", [True, False])
def test_what_is_not_a_link_is_not_removed(tree: Path, is_folder: bool) -> None:
    place = tree / "src" / "assur" / FOLDERS[1]
    if is_folder:
        place.mkdir()
        (place / "work.py").write_text("", encoding="utf-8")
    else:
        place.write_text(f"../../{FOLDERS[1]}", encoding="utf-8")
    with pytest.raises(FileExistsError, match=f"{FOLDERS[1]} is not a link: move it away"):
        link(tree)
    assert (place / "work.py").exists() if is_folder else place.is_file()


def test_a_tree_that_lacks_a_folder_gets_no_dangling_link(tree: Path) -> None:
    (tree / "scenes").rmdir()
    with pytest.raises(FileNotFoundError, match="scenes is missing"):
        link(tree)
    assert "scenes" not in links(tree)


def test_on_windows_junctions_are_made_which_have_absolute_targets(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The call that Windows has is replaced; test_mypy_accepts_the_call_that_windows_has checks its name and types."""

    def create_junction(target: str, place: str) -> None:
        assert Path(target).is_absolute()
        assert not os.path.lexists(place)
        Path(place).symlink_to(target)

    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setitem(sys.modules, "_winapi", SimpleNamespace(CreateJunction=create_junction))
    link(tree)
    link(tree)
    assert links(tree) == {name: str(tree / name) for name in FOLDERS}
    moved = tree.rename(tree.with_name("moved"))
    link(moved)  # they led to the place before
    assert links(moved) == {name: str(moved / name) for name in FOLDERS}


def mypy_of_windows(program: Path) -> subprocess.CompletedProcess[str]:
    command = (sys.executable, "-m", "mypy", "--config-file=", "--platform", "win32", "--ignore-missing-imports")
    cache = program.parent / "cache"
    return subprocess.run(
        [*command, "--cache-dir", cache, program], cwd=program.parent, capture_output=True, text=True, check=False
    )


def test_mypy_accepts_the_call_that_windows_has(tmp_path: Path) -> None:
    text = (ROOT / "deploy" / "packaging" / "backend.py").read_text(encoding="utf-8")
    assert text.count("CreateJunction(str(folder") == 1
    program, wrong = tmp_path / "program.py", tmp_path / "wrong.py"
    program.write_text(text, encoding="utf-8")
    assert mypy_of_windows(program).returncode == 0
    # a file of its own: mypy takes one of the same size and the same second for unchanged
    wrong.write_text(text.replace("CreateJunction(str(folder", "CreateJunction(len(folder"), encoding="utf-8")
    assert 'Argument 1 to "CreateJunction" has incompatible type "int"' in mypy_of_windows(wrong).stdout


def committed(tree: Path) -> dict[str, str]:
    """Path → mode, of all that `git add` takes of a tree."""
    for arguments in (["init", "--quiet"], ["add", "--all"]):
        subprocess.run(["git", *arguments], cwd=tree, capture_output=True, check=True)
    listed = subprocess.run(["git", "ls-files", "--stage"], cwd=tree, capture_output=True, text=True, check=True)
    return {line.split("\t")[1]: line.split()[0] for line in listed.stdout.splitlines()}


def test_git_ignores_the_links_that_are_made(tree: Path) -> None:
    modules = {f"src/assur/{path.name}": "100644" for path in (ROOT / "src" / "assur").iterdir() if path.is_file()}
    for name in modules:
        (tree / name).write_text("", encoding="utf-8")
    link(tree)
    assert committed(tree) == modules | {f"src/assur/{name}": "120000" for name in FOLDERS}
    shutil.rmtree(tree / ".git")
    shutil.copy(ROOT / ".gitignore", tree)
    assert committed(tree) == modules | {".gitignore": "100644"}


def test_the_sources_of_a_commit_can_be_imported(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The benchmark measures commits with links in git, and commits without."""
    for name in FOLDERS:
        (tree / name / "__init__.py").write_text("", encoding="utf-8")
    link(tree)
    committed(tree)
    monkeypatch.setattr(commits, "ROOT", tree)
    author = ("-c", "user.name=a", "-c", "user.email=a@example.org")
    for with_links in (True, False):
        if not with_links:
            (tree / "deploy").mkdir()
            shutil.copytree(ROOT / "deploy" / "packaging", tree / "deploy" / "packaging")
            shutil.copy(ROOT / ".gitignore", tree)
            subprocess.run(["git", "rm", "-r", "--quiet", "--cached", "src"], cwd=tree, check=True)
            (tree / "src" / "assur" / "__init__.py").write_text("", encoding="utf-8")
            committed(tree)
        subprocess.run(["git", *author, "commit", "--quiet", "--message", "a"], cwd=tree, check=True)
        with commits.sources("HEAD") as folder:
            for name in FOLDERS:
                assert (folder / "src" / "assur" / name / "__init__.py").samefile(folder / name / "__init__.py")
    assert not any(mode == "120000" for mode in committed(tree).values())


def test_the_image_copies_no_link() -> None:
    copies = [rest.split()[:-1] for name, rest in instructions() if name == "COPY" and "--from" not in rest]
    copied = {ROOT / path for paths in copies for path in paths}
    assert {ROOT / name for name in FOLDERS} <= copied
    assert [place for top in copied for place in (top, *top.rglob("*")) if place.is_symlink()] == []
    front = ROOT / "src" / "assur"
    assert {place for place in copied if place.is_relative_to(ROOT / "src")} == {
        p for p in front.iterdir() if p.is_file()
    }

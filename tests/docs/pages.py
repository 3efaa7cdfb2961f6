"""README and docs, taken apart: code blocks, commands with their output, links, names in code spans."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = ("README.md", "CHANGELOG.md", *sorted(str(p.relative_to(ROOT)) for p in (ROOT / "docs").rglob("*.md")))
"""Every page that is written for readers of the project."""
ENVIRONMENT = {
    **{name: value for name, value in os.environ.items() if not name.startswith("ASSUR_")},
    "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT)]),
    "COLUMNS": "110",
}
"""In which what the pages show is run."""
HOST = "http://127.0.0.1:8000"
"""Where the pages say that the service is; what they show is sent to a service of the tests."""

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SAVED = re.compile(r"[Ss]ave as `([\w.-]+)`:\s*\Z")


@dataclass(frozen=True, slots=True)
class Block:
    """A code block: its `page`, the `line` it begins at, its `language`, its `text`, and the file to save it as."""

    page: str
    line: int
    language: str
    text: str
    saved: str | None


@dataclass(frozen=True, slots=True)
class Command:
    """A line after ``$`` with the lines that it is shown to print."""

    page: str
    line: str
    output: tuple[str, ...]

    @property
    def program(self) -> str:
        return self.line.split()[0]


@cache
def text(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


@cache
def blocks(page: str) -> tuple[Block, ...]:
    """The code blocks of a page, in order."""
    whole, found = text(page), []
    for match in FENCE.finditer(whole):
        saved = SAVED.search(whole[: match.start()])
        line = whole.count("\n", 0, match.start()) + 1
        found.append(Block(page, line, match.group(1), match.group(2), saved.group(1) if saved else None))
    return tuple(found)


def of_language(*languages: str) -> list[Block]:
    """The blocks of all pages in these languages."""
    return [block for page in PAGES for block in blocks(page) if block.language in languages]


def commands(page: str) -> Iterator[Command]:
    """The commands of a page's ``console`` blocks, in order."""
    for block in blocks(page):
        if block.language == "console":
            for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
                line, *output = part.splitlines()
                yield Command(page, line, tuple(output))


def prose(page: str) -> str:
    """A page without its fenced blocks."""
    return FENCE.sub("", text(page))


def spans(page: str) -> list[str]:
    """What stands between backticks in the prose of a page."""
    return re.findall(r"`([^`\n]+)`", prose(page))


def save_files(page: str, folder: Path) -> None:
    """Writes every block that the page says to save."""
    for block in blocks(page):
        if block.saved is not None:
            (folder / block.saved).write_text(block.text, encoding="utf-8")


def anchors(page: str) -> set[str]:
    """The fragments that headings of a page can be reached by, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}

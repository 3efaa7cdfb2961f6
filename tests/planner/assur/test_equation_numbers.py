"""Every equation number that the code cites is on the page."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "kinematics.md"


def test_every_equation_that_the_code_cites_is_on_the_page() -> None:
    page = PAGE.read_text(encoding="utf-8")
    stated = set(re.findall(r"\((K\d+|S1)\)", page))
    cited: dict[str, str] = {}
    for folder in ("assur", "kernels", "robots", "frames"):
        for path in sorted((ROOT / "planner" / folder).glob("*.py")):
            cited.update(dict.fromkeys(re.findall(r"\bK\d+\b", path.read_text(encoding="utf-8")), path.name))
    assert {f"K{i}" for i in range(1, 9)} <= set(cited)
    assert {number: path for number, path in cited.items() if number not in stated} == {}


def test_the_equations_of_the_page_are_numbered_without_a_gap() -> None:
    numbers = [int(n) for n in re.findall(r"\(K(\d+)\)\s*$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)]
    assert numbers == list(range(1, len(numbers) + 1))

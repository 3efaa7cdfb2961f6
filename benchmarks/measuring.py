"""``python -m benchmarks.measuring SECTION``: the process in which a section is measured.

It is told parameters and group on its first line, keeps to one core if the section does, warms up, and then answers an
item a line with its record. `benchmarks.bench` starts it; by hand it is of little use.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from contextlib import ExitStack

from benchmarks.dialogue import Document, answer_lines
from benchmarks.machine import pin
from benchmarks.sections.all_of_them import by_name


def main(name: str) -> None:
    section = by_name(name)
    with ExitStack() as stack:

        def prepare() -> tuple[Document, Callable[[Document], Document]]:
            pinned = pin() if section.one_core else "not pinned: it measures several processes"
            told = json.loads(sys.stdin.readline())
            measure = stack.enter_context(section.measuring(told["parameters"], told["group"]))

            def answer(question: Document) -> Document:
                try:
                    return measure(question["item"])
                except Exception as error:  # noqa: BLE001 - a fault in one item is its record, and refuses its figure
                    return {"findings": [f"fault: {type(error).__name__}: {error}"]}

            return {"pinned": pinned}, answer

        answer_lines(prepare)


if __name__ == "__main__":
    main(sys.argv[1])

"""The sections in the order in which they run."""

from __future__ import annotations

from benchmarks.section import Section
from benchmarks.sections import dyad, sets

SECTIONS: tuple[Section, ...] = (sets.SECTION, dyad.SECTION)


def by_name(name: str) -> Section:
    """The section of a name; `KeyError` if there is none."""
    return {section.name: section for section in SECTIONS}[name]

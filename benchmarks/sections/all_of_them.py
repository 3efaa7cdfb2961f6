"""The sections in the order in which they run."""

from __future__ import annotations

from benchmarks.section import Section
from benchmarks.sections import durations, dyad, legs, scaling, service, sets, side_by_side

SECTIONS: tuple[Section, ...] = (
    sets.SECTION,
    durations.SECTION,
    dyad.SECTION,
    legs.SECTION,
    scaling.SECTION,
    service.SECTION,
    side_by_side.SECTION,
)


def by_name(name: str) -> Section:
    """The section of a name; `KeyError` if there is none."""
    return {section.name: section for section in SECTIONS}[name]

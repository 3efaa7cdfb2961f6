"""Missing and unsuitable items of a robot's description, reported all at once: where, what, and what to supply."""

from __future__ import annotations

from dataclasses import dataclass

from assur.planner.errors import InputError

MOST_LACKS = 60
"""Number of items that are reported; more would add nothing new."""


@dataclass(frozen=True, slots=True)
class Defect:
    """Something that is missing or unsuitable: where it is, what is there, and what to do about it."""

    where: str
    what: str
    supply: str

    def __str__(self) -> str:
        return f"{self.where}: {self.what}; {self.supply}"


class ImportRefused(InputError):
    """No robot file can be made from the description. `lacks`: all that is known to be missing or unsuitable."""

    def __init__(self, name: str, lacks: list[Defect]) -> None:
        first, *rest = lacks
        more = "" if not rest else f" (and {len(rest)} more)"
        super().__init__(f"{name}, {first.where}", first.what, first.supply + more)
        self.name, self.lacks = name, tuple(lacks[:MOST_LACKS])

    def __reduce__(self) -> tuple[type[ImportRefused], tuple[str, list[Defect]]]:  # type: ignore[override]
        return type(self), (self.name, list(self.lacks))


class OfNoFamily(ImportRefused):
    """The arm of a description is of no family of ours."""


class Unsuitable(Exception):
    """A kinematic chain that is not of a family, or a solid that cannot be covered: the one thing that is wrong."""

    def __init__(self, where: str, what: str, supply: str) -> None:
        super().__init__(where, what, supply)
        self.lack = Defect(where, what, supply)

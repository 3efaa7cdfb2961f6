"""Names of joints in files, which may have a namespace or the name of an arm before those of the robot: `line3_j1`,
`robot/j1`."""

from __future__ import annotations

from collections.abc import Collection

SEPARATORS = "/_.-:"


def matched(given: list[str], known: Collection[str]) -> tuple[list[str], str] | None:
    """The robot's joint for each of the names `given`, all different, and the one prefix that all of them have before
    it ("": none). None: they are no such names, or in more than one way."""
    if len(set(given)) < len(given) or not given:
        return None
    if all(name in known for name in given):
        return given, ""
    found = [prefix for prefix in _prefixes(given[0], known) if _all_have(prefix, given, known)]
    if len(found) != 1:
        return None
    return [name.removeprefix(found[0]) for name in given], found[0]


def _prefixes(name: str, known: Collection[str]) -> list[str]:
    ends = [joint for joint in known if len(name) > len(joint) and name.endswith(joint)]
    return [name[: -len(joint)] for joint in ends if name[-len(joint) - 1] in SEPARATORS]


def _all_have(prefix: str, given: list[str], known: Collection[str]) -> bool:
    return all(name.startswith(prefix) and name.removeprefix(prefix) in known for name in given)


def listed(names: Collection[str]) -> str:
    """Names as an error repeats them."""
    return ", ".join(names) or "none"

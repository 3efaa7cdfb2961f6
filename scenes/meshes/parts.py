"""Work in parts: it may be interrupted between two of them and continued later, with the same result."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Generic, TypeVar

T = TypeVar("T")
Parts = Generator[None, None, T]
"""Work that yields between two of its parts, and returns its result."""


class InParts(Generic[T]):
    """Work, and how far it has come."""

    def __init__(self, parts: Parts[T]) -> None:
        self._parts = parts

    def run(self, out_of_time: Callable[[], bool]) -> T | None:
        """The result of the work. None if `out_of_time`, which is called before each part, ended it before: then call
        `run` again. Raises what the work raises."""
        while not out_of_time():
            try:
                next(self._parts)
            except StopIteration as done:
                found: T = done.value
                return found
        return None


def at_once(parts: Parts[T]) -> T:
    """The result of work in parts, done without interruption."""
    while True:
        try:
            next(parts)
        except StopIteration as done:
            found: T = done.value
            return found

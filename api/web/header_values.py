"""Values of a header among the pairs of a request or of a response, whose names are in small letters."""

from __future__ import annotations

from collections.abc import Iterable

Pairs = Iterable[tuple[bytes, bytes]]


def values_of(headers: Pairs, name: bytes) -> list[str]:
    """The values of the header `name`, in small letters, one for each time that it is there."""
    return [value.decode("latin-1") for key, value in headers if key == name]

"""What a test does is refused: at a field, in words, and in a line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from assur.planner.errors import InputError

ANY = object()


@contextmanager
def refused_at(
    at: str, said: str = "", *, match: str = "", line: int | None = None, value: object = ANY
) -> Iterator[None]:
    """The block raises an `InputError` whose field is `at`, with `said` in what it says is allowed, and a message that
    the pattern `match` finds. `line`: where in a file that is; `value`: what stands there."""
    with pytest.raises(InputError, match=match or None) as caught:
        yield
    assert caught.value.field == at
    assert said in caught.value.allowed
    assert line is None or getattr(caught.value, "line", None) == line
    assert value is ANY or caught.value.value == value

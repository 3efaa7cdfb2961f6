"""Words of an answer in Python are text, as they are in JSON."""

from __future__ import annotations

import pytest

from tests.scenes.cells.answers import answer


def words_of(value: object) -> list[str]:
    """All text in a document."""
    if isinstance(value, dict):
        return [word for item in value.values() for word in words_of(item)]
    if isinstance(value, list | tuple):
        return [word for item in value for word in words_of(item)]
    return [value] if isinstance(value, str) else []


@pytest.mark.parametrize("name", ["transfer", "heavy-casting-refused"])
def test_words_of_an_answer_in_python_are_plain_text(name: str) -> None:
    """Enumerations print otherwise than they are read, and YAML refuses them."""
    found = words_of(answer(name))
    assert len(found) > 10
    assert {type(word) for word in found} == {str}

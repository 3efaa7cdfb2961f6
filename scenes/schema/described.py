"""What each field of a document means, for its schema: the sentence in `fields.yaml`, and the unit of the key."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from assur.scenes.text.yaml_text import parse_yaml
from assur.scenes.units import SI_UNITS, TWIN_UNITS, si_key, unit_of

FILE = Path(__file__).with_name("fields.yaml")
OTHER_UNITS = {"kg": "kg", "kgm2": "kg·m²"}
"""Units that no key converts."""


def unit_in_words(key: str) -> str | None:
    """The unit that a key bears, as it is written in a sentence: m/s² of `acceleration_m_s2`; None: it bears none."""
    unit = unit_of(key, TWIN_UNITS) or unit_of(key, SI_UNITS)
    if unit is None:
        return OTHER_UNITS.get(key.rpartition("_")[2])
    base, _, per = unit.partition("_")
    return base + ("" if not per else "/s" + {"s": "", "s2": "²", "s3": "³"}[per])


def description(model: type, key: str) -> str:
    """The sentence about a field of a model, under its key in either unit, and the unit. Raises `KeyError` where
    `fields.yaml` has none."""
    converted = si_key(key)
    name = key if converted is None else converted[0]
    for each in _lineage(model):
        sentence = _sentences().get(each, {}).get(name)
        if sentence is not None:
            unit = unit_in_words(key)
            return sentence if unit is None else f"{sentence} In {unit}."
    raise KeyError(f"{model.__name__}.{name} has no sentence in {FILE.name}")


def describe(schema: dict[str, Any], model: type) -> None:
    """Gives each property of the schema of a model its description."""
    for key, field in schema.get("properties", {}).items():
        field["description"] = description(model, key)


@cache
def _sentences() -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = parse_yaml(FILE.read_bytes())[0]
    return found


def _lineage(model: type) -> Iterator[str]:
    """Names of a model and of the models that it inherits fields from, nearest first. A TypedDict knows its bases."""
    bases = getattr(model, "__orig_bases__", ())
    if issubclass(model, dict):
        yield model.__name__
        for base in bases:
            if isinstance(base, type) and issubclass(base, dict):
                yield from _lineage(base)
    else:
        yield from (each.__name__ for each in model.__mro__)

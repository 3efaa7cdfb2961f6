"""Writes the planner's facts as documents of `schema.answer`, field by field, and reads them again.

A field has a name in the facts, and a key with its unit in documents; `NAMES` lists the names that differ. A kind of
facts without a form of its own is described by its fields (`schema.answer.FACTS`).
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import fields, is_dataclass
from enum import StrEnum
from functools import cache
from math import isfinite
from operator import attrgetter, methodcaller
from types import NoneType
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np

from assur.planner.checker.verdict import Finding
from assur.planner.model import outcome
from assur.planner.model.arrival_error import Share
from assur.planner.model.input_warning import InputWarning
from assur.planner.model.load import Carried
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene
from assur.planner.model.witness import Witness
from assur.planner.report.refusal_words import because
from assur.scenes.numbers import interval, number, optional
from assur.scenes.schema import answer as document
from assur.scenes.schema.normal import LEAVES
from assur.scenes.schema.read import options_of

Fact = TypeVar("Fact")

FORMS: dict[Any, Any] = {
    outcome.Arrival: document.Arrival,
    outcome.BestCandidate: document.BestCandidate,
    outcome.Busiest: document.Busiest,
    outcome.Certificate: document.Certificate,
    outcome.Clearances: document.Clearances,
    outcome.Contact: document.Contact,
    outcome.JointPeak: document.Peak,
    outcome.Leg: document.Leg,
    outcome.Margins: document.Margins,
    outcome.Missed: document.Missed,
    outcome.Nearest: document.Nearest,
    outcome.Relaxation: document.Relaxation,
    outcome.Route: document.Route,
    outcome.ToolPeaks: document.ToolPeaks,
    outcome.Traced: document.Traced,
    Carried: document.Carried,
    Finding: document.Finding,
    InputWarning: document.InputWarning,
    Share: document.ErrorShare,
}
"""Kinds of facts, and the form of each in an answer."""
NAMES = {
    "acceleration_at_s": "acceleration_time",
    "acceleration_m_s2": "acceleration",
    "acceleration_share": "share",
    "at_s": "at",
    "from_s": "t0",
    "pitch_rad": "pitch",
    "roll_rad": "roll",
    "shift0_s": "shift0",
    "shift1_s": "shift1",
    "speed_at_s": "speed_time",
    "speed_m_s": "speed",
    "t0_s": "t0",
    "t1_s": "t1",
    "time_s": "time",
    "to_s": "t1",
    "tool_acceleration_limit_m_s2": "tool_acceleration_limit",
    "tool_acceleration_m_s2": "tool_acceleration",
    "until_s": "until",
    "yaw_offset_rad": "yaw_offset",
}
"""Key of a document → name of the field in the facts."""
PLAIN = LEAVES - {float}
"""Types of values that are written unchanged."""


@cache
def _columns(kind: Any) -> tuple[tuple[str, str, bool], ...]:
    """The keys that a fact of this kind has in a document, its own name of each, and whether null is allowed there."""
    if kind not in FORMS:
        return tuple((each.name, each.name, False) for each in fields(kind))
    hints = get_type_hints(FORMS[kind])
    return tuple((key, NAMES.get(key, key), NoneType in options_of(hint)) for key, hint in hints.items())


def written(value: object) -> Any:
    """A fact, or what is in one, as plain data that JSON can hold. Raises `FaultError` for a number that is not finite
    where there must be one."""
    kind: Any = type(value)
    return value if kind in PLAIN else _writer(kind)(value)


@cache
def _writer(kind: Any) -> Callable[[Any], Any]:
    """What writes values of this type, which is none of `PLAIN`."""
    if issubclass(kind, float):
        return number
    if issubclass(kind, tuple | list):
        return lambda value: [
            item if (of := type(item)) in PLAIN or (of is float and isfinite(item)) else written(item) for item in value
        ]
    if issubclass(kind, StrEnum):
        return attrgetter("_value_")
    if issubclass(kind, np.ndarray | np.generic):
        return methodcaller("tolist")
    return document_of if is_dataclass(kind) else lambda value: value


def document_of(fact: object, **own: object) -> Any:
    """A fact in its form. `own`: by their keys, fields that the fact has not, or has in another frame or convention."""
    kind: Any = type(fact)
    found = {}
    for key, name, null in _columns(kind):
        value: Any = own[key] if key in own else getattr(fact, name)
        of = type(value)
        if not (of in PLAIN or (of is float and isfinite(value))):
            value = optional(value) if null and isinstance(value, float) else written(value)
        found[key] = value
    return found


def refusal_document(scene: Scene, refusal: Refusal, witness: Witness | None) -> document.Refusal:
    """The leading refusal, with what proves it."""
    amount = None if refusal.amount is None else refusal.amount.value
    return {**refused_document(scene, refusal), "amount": amount, "witness": written(witness)}


def refused_document(scene: Scene, refusal: Refusal) -> document.Refused:
    """What a refusal is about, its facts, and the same for people."""
    return {
        "stage": written(refusal.stage),
        "reason": written(refusal.reason),
        "step": int(refusal.step),
        "bodies": list(refusal.bodies),
        "joint": refusal.joint,
        "frame": refusal.frame,
        "interval_s": interval(refusal.interval),
        "unit": None if refusal.amount is None else refusal.amount.unit,
        "facts": written(refusal.facts),
        "detail": because(scene, refusal),
    }


def fact_of(kind: type[Fact], item: Any, **own: Any) -> Fact:
    """The fact that a document states, whose form was read before; `own`: what of it is read apart, by its own names.
    What the document leaves out is what the fact has then."""
    given = {
        name: read(item[key]) for key, name, read in _readers(cast(Hashable, kind)) if key in item and name not in own
    }
    return kind(**given, **own)


@cache
def _readers(kind: Any) -> tuple[tuple[str, str, Callable[[Any], Any]], ...]:
    """The keys of a document that a fact of this kind is read of, its own name of each, and what reads the value."""
    hints = get_type_hints(kind)
    return tuple((key, name, _reader(hints[name])) for key, name, _ in _columns(kind) if name in hints)


@cache
def _reader(hint: Any) -> Callable[[Any], Any]:
    """What makes of a value of a document what is in facts at this type."""
    options = options_of(hint)
    form = next((each for each in options if each in FORMS), None)
    word = next((each for each in options if isinstance(each, type) and issubclass(each, StrEnum)), None)
    listed = next((each for each in options if get_args(each)), None)
    first, *others = (None,) if listed is None else get_args(listed)

    def read(value: Any) -> Any:
        if isinstance(value, dict):
            return value if form is None else fact_of(form, value)
        if isinstance(value, list):
            if get_origin(listed) is np.ndarray:
                return np.array(value, dtype=get_args(others[0])[0])
            return tuple(map(_reader(first), value))
        return value if word is None or value is None else word(value)

    return read

"""What a refusal is about, its facts and what proves it, as plain data that JSON can hold."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from enum import StrEnum
from typing import TypeVar, cast

from assur.planner.model.proofs.witness import Witness
from assur.planner.model.refusal import Facts, Refusal
from assur.planner.model.scene import Scene
from assur.planner.report.sentence import because
from assur.scenes.numbers import interval
from assur.scenes.schema import answer as document

Word = TypeVar("Word", bound=StrEnum)


def refusal_document(scene: Scene, refusal: Refusal, witness: Witness | None) -> document.Refusal:
    """The leading refusal, with what proves it."""
    return {
        **refused_document(scene, refusal),
        "amount": None if refusal.amount is None else refusal.amount.value,
        "witness": None if witness is None else cast(Witness, _plain(witness)),
    }


def refused_document(scene: Scene, refusal: Refusal) -> document.Refused:
    """What a refusal is about, its facts, and the same for people."""
    return {
        "stage": word(refusal.stage),
        "reason": word(refusal.reason),
        "step": int(refusal.step),
        "bodies": list(refusal.bodies),
        "joint": refusal.joint,
        "frame": refusal.frame,
        "interval_s": interval(refusal.interval),
        "unit": None if refusal.amount is None else refusal.amount.unit,
        # as the dataclass is described in the schema, and as JSON has it
        "facts": cast(Facts, _plain(refusal.facts)),
        "detail": because(scene, refusal),
    }


def word(value: Word) -> Word:
    """The word of an enumeration as plain text, as readers, JSON and YAML have it."""
    return cast(Word, value.value)


def _plain(value: object) -> object:
    if isinstance(value, StrEnum):
        return value.value
    if is_dataclass(value):
        return {each.name: _plain(getattr(value, each.name)) for each in fields(value)}
    return [_plain(item) for item in value] if isinstance(value, tuple) else value

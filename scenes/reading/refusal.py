"""A refusal out of its document: the facts and the witness that the checker judges, and what else it states."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, get_args

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError

from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Census
from assur.planner.model.refusal import (
    Bodies,
    Facts,
    FrameName,
    JointName,
    Quantity,
    Refusal,
    Separation,
    Subject,
)
from assur.planner.model.scene import Scene
from assur.planner.model.witness import Witness
from assur.planner.report.checker_first import beginning
from assur.planner.report.refusal_table import KINDS
from assur.planner.report.sentence import sentence
from assur.scenes.answer_facts import refusal_document
from assur.scenes.faults import Refused, located, within
from assur.scenes.reading.claims import check_notes, untrue_repeats
from assur.scenes.reading.plan import PLAN
from assur.scenes.schema import answer as document
from assur.scenes.schema.checked import present
from assur.scenes.schema.read import TYPES, read_written

SEARCH = (
    "best_candidate",
    "census",
    "cut_by_clock",
    "elapsed_s",
    "explain_budget_spent",
    "relaxation",
    "tried",
    "warnings",
)
"""Fields of an answer without a plan about the search, its times, and what may help, which is a proposal: only their
form is checked."""
CHECKED = ("schema", "status", "reason", "proved", "sentence", "refusal")
"""... and those that the checker evaluates. All but the first must be there."""
NOT_PROVED = ("reason", "refusal", "sentence")
"""What a refusal that is not proved states about the search."""
SUBJECTS: dict[str, Callable[[Any], Subject]] = {"bodies": Bodies, "joint": JointName, "frame": FrameName}
"""Fields that say what a refusal is about."""
ABOUT = {"nothing": "nothing", "body": "one body", "pair": "two bodies", "joint": "a joint", "frame": "a frame"}
"""Subjects in words."""


@dataclass(frozen=True, slots=True)
class ReadRefusal:
    """What an answer without a plan states: whether it is proved, its refusal and witness, and `findings`: what is
    wrong and needs no checker to see. `not_checked`: the fields of the answer whose form alone is checked."""

    proved: bool
    refusal: Refusal | None
    witness: Witness | None
    findings: tuple[Finding, ...]
    not_checked: tuple[str, ...]


def refusal_of(answer: object, scene: Scene) -> ReadRefusal:
    """The refusal in an answer without a plan. Raises `DocumentError` below "plan"."""
    with located({PLAN: answer}), within(PLAN):
        if not isinstance(answer, dict):
            raise Refused("an answer")
        for key in answer:
            if key not in document.NotPlannedAnswer.__annotations__:
                raise Refused("no such field: an answer without a plan has none of this name", key)
        kept = {key: value for key, value in answer.items() if key in CHECKED}
        item: dict[str, Any] = read_written(_checked(), kept, kept, (PLAN,))
        check_notes(answer, document.NotPlannedAnswer, SEARCH)
        found = untrue_repeats(answer, scene)
        reason = item["refusal"]
        if reason is None:
            if item["proved"]:
                found += (Finding(Code.REFUSAL, "the answer says that it is proved, and not what", where="proved"),)
            return ReadRefusal(item["proved"], None, None, found, _unchecked(answer, None, proved=item["proved"]))
        with within("refusal"):
            refusal, witness = _refusal(reason, scene), _typed(Witness, reason.get("witness"), "witness")
        found += _untrue(item, reason, refusal, witness, scene, _checker_first(answer))
        return ReadRefusal(item["proved"], refusal, witness, found, _unchecked(answer, refusal, proved=item["proved"]))


@cache
def _checked() -> Any:
    """The form of the fields `CHECKED`; facts and witness of the refusal are read apart."""
    keys = tuple(key for key in document.Refusal.__annotations__ if key != "witness")
    bodies = Annotated[list[document.Text], Field(max_length=2)]
    apart = ("bodies", bodies), ("facts", dict[str, Any]), ("witness", dict[str, Any] | None)
    refusal = document.partial(document.Refusal, None, keys, apart)
    return document.partial(document.NotPlannedAnswer, CHECKED, CHECKED[1:], (("refusal", refusal | None),))


def _unchecked(answer: dict[str, Any], refusal: Refusal | None, *, proved: bool) -> tuple[str, ...]:
    """The fields of an answer that are not checked."""
    fields = list(SEARCH)
    if not proved:
        fields += NOT_PROVED
    elif refusal is not None and isinstance(refusal.facts, Separation):
        if refusal.facts.touching:  # how deep bodies overlap is stated, not shown
            fields += ["refusal.amount", "refusal.facts.gap_m"]
        fields += ["refusal.facts.least_m"]
    return present(answer, sorted(fields))


def _untrue(
    item: dict[str, Any],
    given: dict[str, Any],
    refusal: Refusal,
    witness: Witness | None,
    scene: Scene,
    first: str,
) -> tuple[Finding, ...]:
    """What an answer states in words or twice, and its facts do not. `first`: with what the sentence of a search
    begins."""
    own: dict[str, Any] = dict(refusal_document(scene, refusal, witness))
    words, proved = sentence(scene, refusal, None, Census(0, 0), cut=False), item["proved"]
    begins = item["sentence"].startswith(first + words.removesuffix("."))
    is_true = {"reason": item["reason"] is refusal.reason} | {f"refusal.{key}": own[key] == given[key] for key in given}
    is_true["sentence"] = item["sentence"] == words if proved else begins
    found = [
        Finding(Code.CLAIM, f"{where} is not what the facts of the refusal say", where=where)
        for where, true in is_true.items()
        if not true
    ]
    if witness is not None and not proved:
        found.append(Finding(Code.CLAIM, "a refusal that is not proved has no witness", where="refusal.witness"))
    return tuple(found)


def _checker_first(answer: dict[str, Any]) -> str:
    """How the sentence of a search must begin whose census states that the checker refused plans; nothing: it states
    none."""
    lines = ((line["count"], line["facts"]) for line in answer.get("census", {}).get("lines", ()))
    return beginning([(count, facts["code"], facts["what"]) for count, facts in lines if facts["kind"] == "refuted"])


def _refusal(given: dict[str, Any], scene: Scene) -> Refusal:
    if not 0 <= given["step"] < len(scene.task):
        raise Refused(f"a step of the task, from 0 to {len(scene.task) - 1}", "step")
    facts = _typed(Facts, given["facts"], "facts")
    amount, unit = given["amount"], given["unit"]
    subject = _subject(given, facts)
    kind = KINDS[type(facts)]
    for key, allowed in (("reason", kind.reasons), ("unit", kind.units)):
        if given[key] is not None and given[key] not in allowed:
            raise Refused(f"{' or '.join(allowed) or 'none'}, as for all facts of the kind {facts.kind}", key)
    return Refusal(
        stage=given["stage"],
        reason=given["reason"],
        step=given["step"],
        subject=subject,
        interval=_interval(given["interval_s"]),
        amount=None if amount is None or unit is None else Quantity(amount, unit),
        facts=facts,
    )


def _subject(given: dict[str, Any], facts: Any) -> Subject | None:
    """What a refusal is about: as many bodies as its facts are about, a joint, a frame, or nothing."""
    stated = [key for key in SUBJECTS if given[key] not in (None, [])]
    if len(stated) > 1:
        raise Refused(f"nothing in addition to {stated[0]}: only one of bodies, joint and frame", stated[1])
    allowed, key = KINDS[type(facts)].about, stated[0] if stated else "bodies"
    about = ("nothing", "body", "pair")[len(given["bodies"])] if key == "bodies" else key
    if about not in allowed:
        words = " or ".join(ABOUT[each] for each in allowed)
        raise Refused(f"{words}, as for all facts of the kind {facts.kind}", key)
    if not stated:
        return None
    return SUBJECTS[key](tuple(given[key]) if key == "bodies" else given[key])


def _interval(given: list[float | None] | None) -> tuple[float, float] | None:
    """An interval whose ends are null where they are infinite."""
    if given is None:
        return None
    low, high = given
    return -math.inf if low is None else low, math.inf if high is None else high


def _typed(kind: Any, given: object, key: str) -> Any:
    """Facts or a witness as typed facts; null is none. Raises `Refused` for what is none."""
    if given is None:
        return None
    try:
        return _adapter(kind).validate_json(json.dumps(given), strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        if first["type"] in ("union_tag_invalid", "union_tag_not_found"):
            kinds = (each.__dataclass_fields__["kind"].default for each in get_args(kind))
            raise Refused(f"one of {', '.join(kinds)}", key, "kind") from None
        allowed = TYPES.get(
            first["type"], f"what {'a witness of this kind has' if key == 'witness' else 'facts of this kind have'}"
        )
        raise Refused(allowed, key, *first["loc"][1:]) from None  # the place begins with the kind


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(Annotated[kind, Field(discriminator="kind")], config=ConfigDict(allow_inf_nan=False))

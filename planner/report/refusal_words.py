"""The words of a refusal: its facts as people read them, and what a template of `refusal_table` makes of them."""

from __future__ import annotations

import re
from collections.abc import Hashable
from dataclasses import MISSING, fields
from functools import cache
from typing import Any, cast

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.model.phases import CONTACT_M
from assur.planner.model.refusal import (
    BeyondRange,
    Carrying,
    ForbiddenYaw,
    LawEnds,
    OnPath,
    Overload,
    Reason,
    Refusal,
    Separation,
    Singular,
)
from assur.planner.model.scene import Pick, Place, Scene, Trace, Window
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.report.number_format import amount, different_lengths, position
from assur.planner.report.refusal_table import PARTS, SENTENCES, Row

UNITS = {"_m_s": "m/s", "_m": "m", "_rad": "rad", "_s": "s"}
"""The units that names of facts end with."""
CODES = ("obstacle", "miss", "of", "rule", "rate", "path_part")
"""Facts that are codes."""
UNNAMED = {"joint": "a joint", "frame": "a frame", "rate": "velocity, acceleration or jerk"}
"""What is written for what a refusal does not name."""
ON_ARRIVAL = frozenset({Miss.CLOSED_ON_ARRIVAL, Miss.NO_MEETING_LEFT, Miss.OUTSIDE})
"""Misses of what ends the time for a meeting: the window, or the latest end where there is no window."""
POSITIONS = {
    "stretched": "the arm would be stretched",
    "folded": "the arm would be folded",
    "indeterminate": "the tool would be on the shoulder's axis",
    "aligned": "the tool would be over the base axis",
}
"""Singular positions, by their codes."""
LEAST_M = 1e-7
"""Less than this of a distance is rounding, m."""
BY_ROUNDING = ", which differ by rounding only"
"""Written behind two lengths that no digits tell apart."""

Words = dict[str, str]
PIECES = re.compile(r"[\[\]]|\{\w+\}|[^\[\]{}]+")


def because(scene: Scene, refusal: Refusal) -> str:
    """What would happen, or what is missing: a sentence without its step and its full stop."""
    words = words_of(scene, refusal)
    codes = {refusal.stage, refusal.reason, *[words.get(name, "") for name in CODES]}
    codes |= set() if refusal.amount is None else {refusal.amount.unit}
    place = _first("on_path", codes, words) if "path" in words else None
    found = _first(type(refusal.facts), codes, words)
    if found is None:
        raise FaultError(f"a refusal has no sentence: {refusal}")
    return (place or "") + found


def _parsed(template: str) -> list[Any]:
    """The text and the names of a template, each name in a tuple; what is in [] is a list of its own."""
    levels: list[list[Any]] = [[]]
    for piece in PIECES.findall(template):
        if piece == "[":
            levels.append([])
        else:
            inner = levels.pop() if piece == "]" else (piece[1:-1],) if piece[0] == "{" else piece
            levels[-1].append(inner)
    return levels[0]


def _rows(rows: tuple[Row, ...]) -> list[tuple[frozenset[str], list[Any]]]:
    pairs = (row if isinstance(row, tuple) else (row,) for row in rows)
    return [(frozenset(codes), _parsed(template)) for template, *codes in pairs]


ROWS = {key: _rows(rows) for table in (SENTENCES, PARTS) for key, rows in table.items()}
"""Codes and parsed templates of each kind of facts, and of each part."""


def _first(key: type | str, codes: set[str], words: Words) -> str | None:
    """The first template that is for these codes and has all its words, filled; None: there is none."""
    for needed, pieces in ROWS.get(key, ()):
        if needed <= codes and (found := _filled(pieces, codes, words)) is not None:
            return found
    return None


def _filled(pieces: list[Any], codes: set[str], words: Words) -> str | None:
    """A template with its words; None: a word outside of [] is not known."""
    found = ""
    text: str | None
    for piece in pieces:
        kind = type(piece)
        if kind is str:
            text = piece
        elif kind is list:
            text = _filled(piece, codes, words) or ""
        else:
            (name,) = piece
            text = words[name] if name in words else _first(name, codes, words)
        if text is None:
            return None
        found += text
    return found


def words_of(scene: Scene, refusal: Refusal) -> Words:
    """All words that templates may have of a refusal: each fact that is known and is not the default of its field, by
    its name, what the refusal is about, and what is computed of both."""
    facts, short = refusal.facts, refusal.amount
    words = {**UNNAMED, "robot": scene.robot.name, "last_joint": scene.robot.joints[-1].name}
    words |= dict(zip(("first", "second"), refusal.bodies, strict=False))
    words |= {key: name for key, name in (("joint", refusal.joint), ("frame", refusal.frame)) if name is not None}
    if short is not None:
        words["short"] = f"{amount(100 * short.value, '1')} %" if short.unit == "1" else amount(short.value, short.unit)
    unit = "1" if isinstance(facts, Singular | Carrying) else "" if short is None or short.unit == "1" else short.unit
    for name, default in _defaults(cast(Hashable, type(facts))):
        value = getattr(facts, name)
        if value not in (None, "") and (default is MISSING or value != default):
            words |= _fact(name, value, unit)
    return words | _on_path(scene, refusal) | _computed(scene, refusal)


@cache
def _defaults(kind: Any) -> list[tuple[str, object]]:
    """The facts of a kind, and what each is where it is not stated."""
    return [(each.name, each.default) for each in fields(kind) if each.name != "kind"]


@cache
def _unit(name: str) -> str | None:
    """The unit with which the name of a fact ends."""
    return next((unit for end, unit in UNITS.items() if name.rstrip("_01").endswith(end)), None)


def _fact(name: str, value: object, unit: str) -> Words:
    """A fact in words, by its name: a number with its unit, each of a pair by itself. `unit`: of a number whose name
    states none; empty: it is not known, and the number is left out."""
    if isinstance(value, tuple):
        return {key: word for k, item in enumerate(value) for key, word in _fact(f"{name}_{k}", item, unit).items()}
    if isinstance(value, bool):
        return {name: ""} if value else {}
    if not isinstance(value, float | int):
        return {name: str(value)}
    own = _unit(name)
    is_position = name in ("value", "limit") and unit in ("m", "rad")
    shown = position(value, unit) if is_position else amount(value, own or unit)
    return {name: shown} if own or unit else {}


def _on_path(scene: Scene, refusal: Refusal) -> Words:
    """Where on a path it happens: how far along it, and at which point of its frame."""
    facts, step = refusal.facts, scene.task[refusal.step]
    if not isinstance(facts, OnPath) or facts.path_m is None or facts.path_at_m is None:
        return {}
    at = f"[{', '.join(f'{1e3 * x:z.1f}' for x in facts.path_at_m)}]"
    words = {"path": "", "before": amount(-facts.path_m, "m"), "at": at}
    words |= {} if step.target is None else {"target": step.target.frame}
    return words | ({"behind": amount(facts.path_m - step.path.length, "m")} if isinstance(step, Trace) else {})


def _computed(scene: Scene, refusal: Refusal) -> Words:
    """Words that are computed of the facts of one kind."""
    match refusal.facts:
        case BeyondRange(arch_top_m=float(top)) if refusal.amount is not None and refusal.amount.unit == "m":
            return {"arch_most": amount(top - refusal.amount.value, "m")}
        case Singular() as facts:
            crossed = {"crossed": ""} if facts.margin is None or facts.margin < 0 else {}
            positions = " or ".join(POSITIONS.get(name, name) for name in facts.positions)
            return crossed | ({"names": " or ".join(facts.positions), "positions": positions} if positions else {})
        case ForbiddenYaw() as facts:
            return {name: position(getattr(facts, name), "rad") for name in ("first_rad", "last_rad", "yaw_rad")}
        case Overload() as facts if refusal.amount is not None and facts.part is not None and facts.limit > facts.tool:
            return {"spare": amount(facts.limit - facts.tool, refusal.amount.unit)}
        case WindowMissed() as facts:
            step = scene.task[refusal.step]
            closed = step.window != Window()
            late = facts.miss in ON_ARRIVAL and not closed and scene.options.latest_end_s is not None
            closing = "for the window" if closed else "to meet the point while it can be met"
            words = {"what": "part" if isinstance(step, Pick | Place) else "point", "closing": closing}
            return words | ({"late": ""} if late else {}) | _carried(scene, refusal, facts)
        case LawEnds() as facts:
            words = {"needed": _instant(facts.needed_s)}
            if facts.known_s is not None:
                ends = zip(("from", "to"), facts.known_s, strict=True)
                words["known"] = " ".join(f"{word} {end:g} s" for word, end in ends if end is not None)
            if facts.tracked_s is not None:
                words["begin"] = _instant(facts.needed_s - facts.tracked_s)
                words |= {} if facts.tracked_s > 0.0 else {"at_once": ""}
            return words
        case Separation() as facts:
            return _separation(facts) | _resting(scene, refusal, facts.gap_m)
        case _:
            return {}


def _carried(scene: Scene, refusal: Refusal, facts: WindowMissed) -> Words:
    """The speed of the conveyor that carries a point away from its window, mm/s; nothing where the speed changes. A
    point that is never in its window moves away from it, or stands still."""
    step = scene.task[refusal.step]
    moved = any(isinstance(each, Pick | Place) and each.part == step.part for each in scene.task[: refusal.step])
    if facts.miss is not Miss.NEVER_INSIDE or (step.target is None and (moved or step.part is None)):
        return {}
    law = scene.frames[scene.index[str(step.part)].frame if step.target is None else step.target.frame].law
    if law.way is None or np.isfinite(law.changes_until) or law.numbers.speed == 0.0:
        return {}
    return {"carried": f"{1e3 * law.numbers.speed:g}"}


def _instant(time: float) -> str:
    """An instant, to the millisecond."""
    return f"{round(time, 3) + 0.0:g} s"


def _separation(facts: Separation) -> Words:
    """How near two bodies are, what is required, and what that is made of; what would help."""
    gap, required, words = facts.gap_m, facts.required_m, Words()
    pressed = facts.clearance_m if facts.rule == "contact" else None
    if pressed is not None:
        words["allowed"] = amount(-pressed, "m")
    if gap is not None and required is not None:
        unknown = required - (facts.clearance_m or 0.0)
        words |= {"unknown": amount(unknown, "m")} if unknown > LEAST_M else {}
        if pressed is not None:
            words["pressed"], words["allowed"] = one, other = different_lengths(unknown - gap, -pressed)
        elif gap < -LEAST_M:
            words["overlap"], words["required"] = one, other = amount(-gap, "m"), amount(required, "m")
        else:
            words["gap"], words["required"] = one, other = different_lengths(max(gap, 0.0), required)
        words["alike"] = BY_ROUNDING if one == other else ""
    if facts.least_m is not None:
        words["enough"] = f"{float(np.ceil(facts.least_m * 1e4 - 1e-6)) / 10:g} mm"
    return words


def _resting(scene: Scene, refusal: Refusal, gap: float | None) -> Words:
    """The part that is to rest on the body in its way, and that body. A body that may be touched may not be pressed:
    where the part is in it, that would not help."""
    step = scene.task[refusal.step]
    if refusal.reason is not Reason.CONTROL_POINT_IN_COLLISION or not isinstance(step, Pick | Place):
        return {}
    if step.part not in refusal.bodies:
        return {}
    other = next((name for name in refusal.bodies if name != step.part), None)
    if other not in scene.index or (gap is not None and gap < -CONTACT_M - step.contact_tolerance_m):
        return {}
    return {"resting": step.part, "other": other}

"""Requests that are wrong, strange, or slightly other than those that are shipped: mutant number n of a seed is always
the same.

A mutant is made of a shipped scenario with a small budget. Most mutations change one to three places of the document;
some change its text, for what they put there is not JSON, or not a document.
"""

from __future__ import annotations

import copy
import json
import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

Document = dict[str, Any]
Mutation = Callable[[random.Random, Document, Sequence[Document]], Any]
"""Changes a document in place, or returns a new one, or its text."""

BUDGETS_S = (0.01, 0.06)
LONGER_BUDGET_S = 0.2
LONGER_SHARE = 0.1
MILD_SHARE = 0.3
"""Of all mutants, those that are meant to stay legal."""
FEW_CANDIDATES = 20
BOUNDS = (0, -0.0, -1, 1, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 2, 60, 360, 1e3, 1e4, 1e5, 1e6, 1e9, 1e100, 1e300, 1.7e308)
BOUNDS_OF_COUNTS = (2**31 - 1, 2**31, 2**53, 2**53 + 1, 2**63, 2**64, -(2**53), 10**30)
DENORMALS = (5e-324, -5e-324, 1e-320, 2.2250738585072014e-308, 1e-310)
RAW = (
    "NaN",
    "Infinity",
    "-Infinity",
    "1e999",
    "-1e999",
    "1e-999",
    "0x10",
    "007",
    "+1",
    ".5",
    "1.",
    "1_000",
    "1e",
    "--1",
)
"""Put into the text as they are; few of them are JSON."""
STRANGE = (
    "", " ", "\x00", "\u202e", "\u200b", "\ufeff", "é" * 50, "e\u0301", "\U0001f916", "\ud800", "İ", "ß", "ﬀ",
    "a" * 10_000, "../demo", "/etc/hostname", "demo\n", "__proto__", "\x1b[31m", "{}", "null", "%00", "'; --", "𝟙", "١",
)  # fmt: skip
OTHER_TYPES: tuple[Any, ...] = (
    None,
    True,
    False,
    0,
    1.5,
    "",
    "1",
    "text",
    [],
    {},
    [[]],
    [0],
    [None],
    {"": None},
    {"at_m": 1},
)
DEPTHS = (40, 64, 100, 200, 500, 1000, 2000)
TWINS = {"m": ("mm", 1e3), "rad": ("deg", 180 / math.pi), "s": ("ms", 1e3)}
HOLE = "raw text stands here"


@dataclass(frozen=True)
class Mutant:
    """A body, the mutation that made it, and the scenario that it was made of."""

    number: int
    kind: str
    scenario: str
    body: bytes


def mutant(seed: int, number: int, scenarios: dict[str, Document]) -> Mutant:
    """Mutant `number` of `seed`, of the scenarios by name."""
    rng = random.Random(f"{seed}/{number}")
    name = rng.choice(sorted(scenarios))
    document = hurried(rng, scenarios[name])
    others = [scenarios[each] for each in sorted(scenarios)]
    kinds = MILD if rng.random() < MILD_SHARE else WRONG
    kind = rng.choice(sorted(kinds))
    found: Any = document
    for _ in range(rng.choice((1, 1, 1, 2, 3)) if kind not in OF_TEXT else 1):
        changed = kinds[kind](rng, found, others)
        found = found if changed is None else changed
        if not isinstance(found, dict) or not found:
            break
    body = found if isinstance(found, bytes) else text_of(found)
    return Mutant(number, kind, name, body)


def hurried(rng: random.Random, document: Document) -> Document:
    """A scenario with a budget of its own, so that it is cheap."""
    found = copy.deepcopy(document)
    options = {key: value for key, value in found.get("options", {}).items() if "budget" not in key}
    longer = rng.random() < LONGER_SHARE
    options["budget_s"] = LONGER_BUDGET_S if longer else round(rng.uniform(*BUDGETS_S), 4)
    options["max_candidates"] = rng.randint(1, FEW_CANDIDATES)
    if rng.random() < 0.5:
        options["stop"] = "first"
    found["options"] = options
    return found


def text_of(document: Any) -> bytes:
    """A document as a body; a lone surrogate is escaped, as JSON's writers do."""
    return json.dumps(document, ensure_ascii=True).encode()


Place = tuple[str | int, ...]
NAMING = frozenset({"name", "frame", "part", "to", "robot", "model", "at", "body", "with", "contact_with"})
"""Keys with names of the document below them."""


def every_place(document: Any, below: Place = ()) -> list[Place]:
    """All places but the root, in the order in which they are written."""
    found: list[Place] = []
    keys = document if isinstance(document, dict) else range(len(document)) if isinstance(document, list) else ()
    for key in keys:
        found.append((*below, key))
        found += every_place(document[key], (*below, key))
    return found


def value_at(document: Any, place: Place) -> Any:
    """The value at a place."""
    for key in place:
        document = document[key]
    return document


def put(document: Any, place: Place, value: Any) -> None:
    """Puts a value at a place whose parent is there."""
    value_at(document, place[:-1])[place[-1]] = value


def removed(document: Any, place: Place) -> None:
    """Removes the value at a place."""
    del value_at(document, place[:-1])[place[-1]]


def numbers_in(document: Any) -> list[Place]:
    """The places of numbers; truth values are none."""
    return [place for place in every_place(document) if type(value_at(document, place)) in (int, float)]


def names_in(document: Any) -> list[Place]:
    """The places of text below a key that holds a name."""
    return [place for place in _texts(document) if any(key in NAMING for key in place)]


def _one(rng: random.Random, places: Sequence[Place]) -> Place | None:
    return rng.choice(places) if places else None


def _replaced(places: Callable[[Document], list[Place]], value: Callable[[random.Random, Any], Any]) -> Mutation:
    """Replaces the value at one of these places by one that is made from it."""

    def change(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
        place = _one(rng, places(document))
        if place:
            put(document, place, value(rng, value_at(document, place)))

    return change


def _texts(document: Document) -> list[Place]:
    return [place for place in every_place(document) if isinstance(value_at(document, place), str)]


def _times(document: Document) -> list[Place]:
    """Windows, dwells, waits, but for the budget."""
    places = [place for place in numbers_in(document) if any(str(key).endswith(("_s", "_ms")) for key in place)]
    return [place for place in places if place[-1] != "budget_s"]


def _bound(rng: random.Random, _: Any) -> Any:
    return rng.choice(BOUNDS + BOUNDS_OF_COUNTS) * rng.choice((1, 1, -1))


def _ulp(rng: random.Random, here: Any) -> float:
    """One unit in the last place away from a bound, or from the value there."""
    centre = rng.choice((float(here), float(rng.choice(BOUNDS))))
    return math.nextafter(centre, rng.choice((-math.inf, math.inf)))


def _strange_text(rng: random.Random, here: Any) -> str:
    strange = rng.choice(STRANGE)
    return rng.choice((strange, str(here) + strange))


def _delete(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    place = _one(rng, every_place(document))
    if place:
        removed(document, place)


def _duplicate(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    lists = [place for place in every_place(document) if isinstance(value_at(document, place), list)]
    place = _one(rng, [place for place in lists if value_at(document, place)])
    if place:
        items = value_at(document, place)
        times = rng.choice((1, 1, 2, 50))
        items.extend([copy.deepcopy(rng.choice(items)) for _ in range(times)])


def _key_twice(rng: random.Random, document: Document, __: Sequence[Document]) -> bytes:
    text = text_of(document).decode()
    keys = sorted({place[-1] for place in every_place(document) if isinstance(place[-1], str)})
    key = json.dumps(rng.choice(keys))
    at = text.find(f"{key}: ")
    return (
        (text[:at] + f"{key}: {rng.choice(('1', 'null', '{}'))}, " + text[at:]).encode() if at >= 0 else text.encode()
    )


def _raw(rng: random.Random, document: Document, __: Sequence[Document]) -> bytes:
    place = _one(rng, numbers_in(document))
    if place:
        put(document, place, HOLE)
    return text_of(document).replace(json.dumps(HOLE).encode(), rng.choice(RAW).encode())


def _strange_key(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    place = _one(rng, [place for place in every_place(document) if isinstance(place[-1], str)])
    if place:
        value = value_at(document, place)
        removed(document, place)
        put(
            document, (*place[:-1], rng.choice((rng.choice(STRANGE), str(place[-1]) + "x", str(place[-1])[:-1]))), value
        )


def _swap_names(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    places = names_in(document)
    if len(places) > 1:
        one, other = rng.sample(places, 2)
        first, second = value_at(document, one), value_at(document, other)
        put(document, one, second)
        put(document, other, first)


def _move(rng: random.Random, document: Document, others: Sequence[Document]) -> None:
    """A subtree of another scenario, below the same key if there is one."""
    other = rng.choice(others)
    place, from_there = _one(rng, every_place(document)), every_place(other)
    if place:
        alike = [each for each in from_there if each[-1] == place[-1] and rng.random() < 0.9]
        put(document, place, copy.deepcopy(value_at(other, rng.choice(alike or from_there))))


def _twin(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    """A key of SI as its twin or the other way round; the number is converted, or not, or both keys are there."""
    found = []
    for place in every_place(document):
        key = place[-1]
        stem, _, unit = key.rpartition("_") if isinstance(key, str) else ("", "", "")
        for si, (twin, scale) in TWINS.items():
            if stem and unit in (si, twin):
                found.append((place, f"{stem}_{twin if unit == si else si}", scale if unit == si else 1 / scale))
    if found:
        place, key, scale = rng.choice(found)
        value = value_at(document, place)
        how = rng.choice(("right", "not converted", "both"))
        scaled = value if how == "not converted" else _scaled(value, scale)
        if how != "both":
            removed(document, place)
        put(document, (*place[:-1], key), scaled)


def _scaled(value: Any, scale: float) -> Any:
    if isinstance(value, list):
        return [_scaled(item, scale) for item in value]
    return value * scale if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def _deep(rng: random.Random, document: Document, __: Sequence[Document]) -> bytes:
    place = _one(rng, every_place(document))
    if place:
        put(document, place, HOLE)
    levels = rng.choice(DEPTHS)
    opening, closing = rng.choice((("[", "]"), ('{"a": ', "}"), ('{"frame": ', "}")))
    return text_of(document).replace(json.dumps(HOLE).encode(), (opening * levels + "1" + closing * levels).encode(), 1)


def _flip(rng: random.Random, document: Document, __: Sequence[Document]) -> bytes:
    text = bytearray(text_of(document))
    for _ in range(rng.choice((1, 1, 2, 8))):
        text[rng.randrange(len(text))] ^= 1 << rng.randrange(8)
    return bytes(text)


def _cut(rng: random.Random, document: Document, __: Sequence[Document]) -> bytes:
    text = text_of(document)
    return text[: rng.randrange(len(text))]


def _jitter(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    """Some numbers a little larger or smaller: most requests stay legal, and many can be planned."""
    share = rng.choice((0.001, 0.01, 0.1))
    for place in numbers_in(document):
        value = value_at(document, place)
        if isinstance(value, float) and rng.random() < 0.3 and place[0] != "options":
            put(document, place, value * (1 + rng.uniform(-share, share)))


def _seed(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    document["options"]["seed"] = rng.randrange(1 << 31)


def _without_a_body(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    bodies = document.get("bodies")
    if isinstance(bodies, list) and bodies:
        bodies.pop(rng.randrange(len(bodies)))


def _other_order(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    for key in ("bodies", "task"):
        if isinstance(document.get(key), list) and (key == "bodies" or rng.random() < 0.2):
            rng.shuffle(document[key])


def _options(rng: random.Random, document: Document, __: Sequence[Document]) -> None:
    changes: list[Document] = [
        {"elbow": rng.choice(("auto", "keep", "left", "right"))},
        {"stop": rng.choice(("first", "budget"))},
        {"clearance_m": rng.choice((0, 0.001, 0.01, 0.05))},
        {"stay_safe_s": rng.choice((0, 0.5, 5, 100, 1e5))},
        {"max_candidates": rng.choice((1, 2, 1000))},
        {"timing": rng.choice(("jerk_limited", "parabolic_blend"))},
        {"explain_budget_s": rng.choice((0, 0.02, 0.1))},
    ]
    for change in rng.sample(changes, 2):
        document["options"].update(change)


WRONG: dict[str, Mutation] = {
    "delete": _delete,
    "duplicate": _duplicate,
    "key twice": _key_twice,
    "type": _replaced(every_place, lambda rng, _: copy.deepcopy(rng.choice(OTHER_TYPES))),
    "bound": _replaced(numbers_in, _bound),
    "ulp": _replaced(numbers_in, _ulp),
    "denormal": _replaced(numbers_in, lambda rng, _: rng.choice(DENORMALS)),
    "raw text": _raw,
    "unicode": _replaced(_texts, _strange_text),
    "strange key": _strange_key,
    "swapped names": _swap_names,
    "moved subtree": _move,
    "unit twin": _twin,
    "nesting": _deep,
    "byte flips": _flip,
    "cut off": _cut,
}
MILD: dict[str, Mutation] = {
    "jitter": _jitter,
    "seed": _seed,
    "without a body": _without_a_body,
    "other order": _other_order,
    "options": _options,
    "later": _replaced(_times, lambda rng, here: here * rng.choice((2, 10, 100, 1e4))),
}
OF_TEXT = frozenset({"key twice", "raw text", "nesting", "byte flips", "cut off"})
"""Mutations after which there is no document any more."""

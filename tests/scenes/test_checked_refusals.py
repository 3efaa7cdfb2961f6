"""The checker proves what an answer without a plan calls proved, and finds every lie in it."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.model.outcome import Census
from assur.planner.report.refusal_table import KINDS
from assur.planner.report.sentence import sentence
from assur.scenes.answer_facts import refusal_document
from assur.scenes.reading.refusal import ABOUT, NOT_PROVED, SEARCH, refusal_of
from assur.scenes.requests import cell_of, check_cell, check_document, plan_document, view_document
from tests.changed import GONE, changed
from tests.scenes.refused_cells import PROVED, cell, follow, go, options

Document = dict[str, Any]
Place = tuple[str | int, ...]
FAR = 1.0
"""By so much numbers of a witness are moved, m, rad or s."""
WITNESS_KINDS = {"hindered", "met", "openings", "orbit", None}


@cache
def _answer(name: str) -> str:
    return json.dumps(plan_document(PROVED[name][0]))


def answer(name: str) -> Document:
    """The answer to the impossible request of a name, a document of its own."""
    found: Document = json.loads(_answer(name))
    return found


def fitted(request: Document, forged: Document) -> Document:
    """A forged answer whose words and repeats fit what it says now: the forger knows how they are made."""
    scene = cell_of(request).scene
    forged["request_digest"] = scene.digest
    try:
        told = refusal_of(forged, scene)
    except InputError:
        return forged
    if told.refusal is not None:
        own = refusal_document(scene, told.refusal, told.witness)
        forged["refusal"]["detail"] = own["detail"]
        forged["sentence"] = sentence(scene, told.refusal, None, Census(0, 0), cut=False)
        forged["reason"] = told.refusal.reason.value
    return forged


def refused(request: Document, forged: Document) -> bool:
    """Whether the checker has something against an answer, or cannot even read it."""
    try:
        return not check_cell(cell_of(request), forged)["ok"]
    except InputError:
        return True


def leaves(value: object, at: Place = ()) -> Iterator[tuple[Place, object]]:
    """All numbers, texts and truth values of a document, and where they are."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*at, key))
    elif isinstance(value, list):
        for k, item in enumerate(value):
            yield from leaves(item, (*at, k))
    else:
        yield at, value


def places(witness: Document) -> set[tuple[str, str]]:
    """Where which bodies meet: with points that are as deep in other cells such a witness is true there, too."""
    return {(way["place"], *sorted(way["bodies"])) for way in witness["ways"]}


@pytest.mark.parametrize("name", PROVED)
def test_each_kind_of_proof_has_its_witness_and_the_checker_accepts_it(name: str) -> None:
    request, _, reason, kind = PROVED[name]
    given = answer(name)
    assert (given["status"], given["reason"], given["proved"]) == ("not_planned", reason, True), given["sentence"]
    witness = given["refusal"]["witness"]
    assert (None if witness is None else witness["kind"]) == kind
    verdict = check_document(request, given)
    assert (verdict["ok"], verdict["findings"]) == (True, [])
    assert verdict["request_digest"] == given["request_digest"]
    more = set(verdict["not_checked"]) - set(SEARCH)
    assert more <= {"refusal.amount", "refusal.facts.gap_m", "refusal.facts.least_m"}
    assert not more or given["reason"].endswith("COLLISION")


def test_every_kind_of_witness_is_among_them() -> None:
    assert {kind for *_, kind in PROVED.values()} == WITNESS_KINDS
    assert len({reason for _, _, reason, _ in PROVED.values()}) == 12


@pytest.mark.parametrize("name", PROVED)
def test_the_same_refusal_of_a_request_that_has_a_plan_is_a_lie(name: str) -> None:
    _, possible, _, _ = PROVED[name]
    assert plan_document(possible)["status"] == "planned"
    assert refused(possible, fitted(possible, answer(name)))


@pytest.mark.parametrize("name", PROVED)
def test_no_number_or_name_of_a_refusal_can_be_another_one(name: str) -> None:
    """Every leaf of the refusal, its witness aside, is changed, and all words are made to fit."""
    request, given = PROVED[name][0], answer(name)
    not_checked = check_document(request, given)["not_checked"]
    tried = 0
    for at, value in leaves({key: item for key, item in given["refusal"].items() if key != "witness"}):
        if ".".join(("refusal", *map(str, at))) in not_checked or (
            at == ("interval_s", 0) and given["refusal"]["unit"] is None
        ):
            continue
        if isinstance(value, bool):
            others: list[object] = [not value]
        elif isinstance(value, int | float):
            others = [value + 0.01, -value - 0.02]
        elif isinstance(value, str):
            others = [f"{value}x", "BODY_COLLISION" if at == ("reason",) else "elsewhere"]
        else:
            others = [0.125]
        for other in others:
            forged = changed(given, {("refusal", *at): other})
            assert refused(request, forged), (at, other)
            if at != ("detail",):
                assert refused(request, fitted(request, forged)), (at, other)
            tried += 1
    assert tried > 15


@pytest.mark.parametrize("name", [name for name, (*_, kind) in PROVED.items() if kind is not None])
def test_no_number_or_name_of_a_witness_can_be_another_one(name: str) -> None:
    request, given = PROVED[name][0], answer(name)
    for at, value in leaves(given["refusal"]["witness"]):
        other: object = f"{value}x" if isinstance(value, str) else (not value if isinstance(value, bool) else FAR)
        if isinstance(value, int | float) and not isinstance(value, bool):
            other = value + FAR
        assert refused(request, changed(given, {("refusal", "witness", *at): other})), (at, value)


@pytest.mark.parametrize("name", PROVED)
def test_a_proof_is_not_left_out_cut_short_or_taken_from_elsewhere(name: str) -> None:
    request, _, _, kind = PROVED[name]
    given = answer(name)
    for other in PROVED:
        witness = answer(other)["refusal"]["witness"]
        same_pair = (
            witness and witness["kind"] == kind == "met" and places(witness) == places(given["refusal"]["witness"])
        )
        if other != name and witness != given["refusal"]["witness"] and not same_pair:
            assert refused(request, changed(given, {"refusal.witness": witness})), other
    if kind is not None:
        for none in (None, GONE):
            assert refused(request, changed(given, {"refusal.witness": none}))
    if kind in ("hindered", "met"):
        for k, way in enumerate(given["refusal"]["witness"]["ways"]):
            same = [each for each in given["refusal"]["witness"]["ways"]
                    if (each["mode"], each["turn_rad"]) == (way["mode"], way["turn_rad"])]  # fmt: skip
            if len(same) == 1:
                assert refused(request, changed(given, {f"refusal.witness.ways[{k}]": GONE}))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("sentence", "No plan exists; certified safe."),
        ("reason", "OUT_OF_REACH"),
        ("notice", "Certified safe under ISO 10218."),
        ("assumptions", ["none"]),
        ("seed", 7),
        ("request_digest", "0" * 64),
        ("proved", False),
        ("refusal", None),
        ("schema", "assur/2"),
        ("approved_by", "nobody"),
    ],
)
def test_nothing_else_that_an_answer_says_can_be_another_thing(key: str, value: object) -> None:
    request = PROVED["a block at a point"][0]
    forged = {**answer("a block at a point"), key: value}
    assert refused(request, forged)


def test_what_was_only_searched_for_cannot_be_called_proved() -> None:
    wall = {"name": "wall", "shape": {"box": {"size_mm": [20, 1600, 1200]}}, "pose": {"at_mm": [-160, 0, 0]}}
    request = cell(go(-350, 100, 200, None), bodies=[wall], options=options(max_candidates=30))
    given = plan_document(request)
    assert (given["status"], given["proved"]) == ("not_planned", False)
    verdict = check_document(request, given)
    assert verdict["ok"]
    assert set(verdict["not_checked"]) == {*SEARCH, *NOT_PROVED} - {key for key in SEARCH if given.get(key) is None}
    assert "best_candidate" in verdict["not_checked"]
    assert refused(request, {**given, "proved": True})
    assert refused(request, fitted(request, {**copy.deepcopy(given), "proved": True}))
    assert refused(request, {**given, "sentence": "goal: it is proved that no plan exists."})


# what was called proved, and was not: each was found by experiment


@pytest.mark.parametrize("upper", range(280, 300))
def test_a_point_exactly_at_the_end_of_a_range_is_not_proved_to_be_beyond_it(upper: int) -> None:
    request = cell(go(350, 0, upper - 60))
    request["robot"]["tool"] = {"tcp_mm": [0, 0, -60]}
    request["robot"]["limits"] = {"j3_mm": [140, upper]}
    found = plan_document(request)
    assert found["status"] == "planned", found.get("sentence")
    beyond = copy.deepcopy(request)
    beyond["task"] = [go(350, 0, upper - 60 + 0.1)]
    found = plan_document(beyond)
    assert (found["reason"], found["proved"], check_document(beyond, found)["ok"]) == ("JOINT_LIMIT", True, True)


def test_a_frame_that_bears_nothing_may_be_over_at_the_start() -> None:
    cart = {"linear": {"at_m": [5, 5, 0], "velocity_m_s": [0.1, 0, 0]}, "valid_s": [-20, -10]}
    request = cell(go(350, 0, 200), frames={"old-cart": cart})
    assert plan_document(request)["status"] == "planned"
    lies = answer("a law that is over at the start")
    lies["refusal"]["frame"] = "old-cart"
    lies["refusal"]["facts"]["known_s"] = lies["refusal"]["interval_s"] = [-20.0, -10.0]
    assert refused(request, fitted(request, lies))


@pytest.mark.parametrize(
    ("changes", "speed", "step"),
    [
        ([{"at_s": 70, "speed_m_s": -0.25, "acceleration_m_s2": 1, "jerk_m_s3": 100}], 0.05,
         follow(500, 0, 80, "belt", duration_ms=200, window_mm=[-300, 300])),
        ([{"at_s": 3, "speed_m_s": 0, "acceleration_m_s2": 1, "jerk_m_s3": 100},
          {"at_s": 65, "speed_m_s": -0.1, "acceleration_m_s2": 1, "jerk_m_s3": 100}], 1.0,
         follow(-500, 0, 80, "belt", duration_ms=1000, window_mm=[-300, 300])),
    ],
)  # fmt: skip
def test_a_belt_that_comes_back_after_a_minute_is_not_said_never_to(
    changes: list[Any], speed: float, step: Document
) -> None:
    belt = {"conveyor": {"at_m": [0, 0.35, 0.05], "speed_m_s": speed, "changes": changes}}
    request = cell(step, frames={"belt": belt}, options=options(max_candidates=20))
    found = plan_document(request)
    assert found["status"] == "planned" or not found["proved"]
    # nor can it be forged: the way of the belt after the last change is looked at
    lies = answer("a window that is never reached")
    assert refused(request, fitted(request, lies))
    short = answer("a window that is too short")
    assert refused(request, fitted(request, short))


def test_a_change_that_is_proposed_is_not_checked_and_is_named_where_there_is_one() -> None:
    request = PROVED["a block at a point"][0]
    given = answer("a block at a point")
    bare = {key: value for key, value in given.items() if key not in SEARCH}
    assert "relaxation" not in check_document(request, {**given, "relaxation": None})["not_checked"]
    proposed = {**bare, "relaxation": {"what": "dwell", "value": "300 ms", "duration_s": 1.5}}
    verdict = check_document(request, proposed)
    assert (verdict["ok"], [key for key in verdict["not_checked"] if key in SEARCH]) == (True, ["relaxation"])


@pytest.mark.parametrize(
    ("key", "value", "field"),
    [
        ("best_candidate", {"x": 1}, "best_candidate.x"),
        ("best_candidate", {"trajectory": {}}, "best_candidate."),
        ("best_candidate", [], "best_candidate"),
        ("relaxation", {"what": "dwell", "value": 3, "duration_s": 1.0}, "relaxation.value"),
        ("relaxation", {"what": "dwell", "value": "3", "duration_s": 1.0, "safe": True}, "relaxation.safe"),
        ("tried", "all", "tried"),
        ("census", {"candidates": 1, "refused": 1}, "census.lines"),
        ("elapsed_s", "fast", "elapsed_s"),
        pytest.param("elapsed_s", 10**5000, "elapsed_s", id="a number that Python does not write"),
        ("cut_by_clock", 0, "cut_by_clock"),
        ("warnings", [{"kind": "CERTIFIED"}], "warnings[0]."),
        ("explain_budget_spent", None, "explain_budget_spent"),
    ],
)
def test_what_is_not_checked_must_have_its_form(key: str, value: object, field: str) -> None:
    request = PROVED["a block at a point"][0]
    with pytest.raises(InputError) as caught:
        check_document(request, {**answer("a block at a point"), key: value})
    assert caught.value.field.removeprefix("plan.").startswith(field)
    assert len(str(caught.value)) < 600


@pytest.mark.parametrize(
    ("path", "value", "field", "allowed"),
    [
        (("witness",), {"kind": "oath"}, "witness.kind", "one of hindered, met, openings, orbit"),
        (("witness",), {"ways": []}, "witness.kind", "one of hindered, met, openings, orbit"),
        (("witness",), {"kind": "met"}, "witness.ways", "what a witness of this kind has"),
        (("witness",), {"kind": "met", "ways": "all"}, "witness.ways", "what a witness of this kind has"),
        (("witness",), {"kind": "met", "ways": [{"mode": 1}]}, "witness.ways[0].mode", "text"),
        (("facts", "gap_m"), True, "facts.gap_m", "a number"),
        (("facts", "touching"), 1, "facts.touching", "true or false"),
        (("facts", "kind"), "hearsay", "facts.kind", "one of out_of_reach, joint_limit"),
        (("joint",), "j1", "joint", "nothing in addition to bodies: only one of bodies, joint and frame"),
        (("frame",), "belt", "frame", "nothing in addition to bodies: only one of bodies, joint and frame"),
    ],
)
def test_what_is_wrong_in_a_refusal_is_named_in_words(path: Place, value: object, field: str, allowed: str) -> None:
    forged = changed(answer("a block at a point"), {("refusal", *path): value})
    with pytest.raises(InputError) as caught:
        check_document(PROVED["a block at a point"][0], forged)
    assert (caught.value.field, caught.value.allowed.startswith(allowed)) == (f"plan.refusal.{field}", True), str(
        caught.value
    )


NO_NUMBERS = [math.nan, math.inf, -math.inf, 1e308, -1e308]


@pytest.mark.parametrize("name", PROVED)
@pytest.mark.parametrize("value", NO_NUMBERS, ids=str)
def test_no_number_of_a_refusal_may_be_none_or_without_bounds(name: str, value: float) -> None:
    """Each number of the refusal, its facts and its witness: those that are not finite have no form, and those that
    are too large are refused one way or the other."""
    given, tried = answer(name), 0
    for at, number in leaves(given["refusal"]):
        if isinstance(number, int | float) and not isinstance(number, bool):
            forged = changed(given, {("refusal", *at): value})
            tried += 1
            if math.isfinite(value):
                assert refused(PROVED[name][0], forged), at
                continue
            with pytest.raises(InputError) as caught:
                check_document(PROVED[name][0], forged)
            assert caught.value.field.startswith("plan.refusal."), at
            assert "number" in caught.value.allowed, str(caught.value)
    assert tried


SUBJECTS: dict[str, Document] = {
    "nothing": {},
    "body": {"bodies": ["block"]},
    "pair": {"bodies": ["block", "cup"]},
    "joint": {"joint": "j1"},
    "frame": {"frame": "belt"},
}


@pytest.mark.parametrize("name", ["a block at a point", "a load", "an arch", "out of reach", "a window that was over"])
@pytest.mark.parametrize("about", ABOUT)
def test_a_refusal_is_about_what_its_facts_are_about(name: str, about: str) -> None:
    """Another subject has no sentence; it is named with what is allowed."""
    forged = answer(name)
    kind = KINDS[type(refusal_of(forged, cell_of(PROVED[name][0]).scene).refusal.facts)]  # type: ignore[union-attr]
    forged["refusal"] |= {"bodies": [], "joint": None, "frame": None, **SUBJECTS[about]}
    if about in kind.about:
        check_document(PROVED[name][0], forged)
        return
    with pytest.raises(InputError, match=r"plan\.refusal\.(bodies|joint|frame): .*as for all facts of the kind"):
        check_document(PROVED[name][0], forged)


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [("reason", "BODY_COLLISION", "OUT_OF_REACH"), ("unit", "kg", "m")],
)
def test_reason_and_unit_are_those_of_the_facts(key: str, value: str, allowed: str) -> None:
    forged = answer("out of reach")
    forged["refusal"][key] = value
    with pytest.raises(InputError) as caught:
        check_document(PROVED["out of reach"][0], forged)
    assert caught.value.field == f"plan.refusal.{key}"
    assert caught.value.allowed == f"{allowed}, as for all facts of the kind out_of_reach"


@pytest.mark.parametrize(
    "status", [np.array(["not_planned", "planned"]), ["not_planned"], np.array([1.0, 2.0])], ids=str
)
def test_a_status_that_is_an_array_is_named(status: object) -> None:
    request = PROVED["out of reach"][0]
    for call in (check_document, view_document):
        with pytest.raises(InputError) as caught:
            call(request, {**answer("out of reach"), "status": status})
        assert caught.value.field == "plan.status"
        assert "planned" in caught.value.allowed
        assert caught.value.value is status or list(caught.value.value) == list(status)  # type: ignore[call-overload]
    with pytest.raises(InputError, match=r"status"):
        plan_document({**request, "status": status})


def test_of_a_joint_and_a_frame_the_second_is_named() -> None:
    forged = answer("a block at a point")
    forged["refusal"].update(bodies=[], joint="j1", frame="belt")
    with pytest.raises(InputError, match=r"plan\.refusal\.frame: got 'belt'; allowed: nothing in addition to joint"):
        check_document(PROVED["a block at a point"][0], forged)

"""What an answer states beside its plan is stated by the claim; where it is not, the statement checker reports it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from assur.planner.checker.claim.verdict import check_claim
from assur.planner.checker.statement import Handling, state_answer
from assur.planner.checker.verdict import Code, Finding
from assur.planner.claim import columns as c
from assur.planner.claim import filling
from assur.planner.claim.answer import with_answer
from assur.planner.claim.columns import Claim
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import phases
from assur.scenes.scenarios import shipped_scenarios
from tests.planner.checker.statement.cases import Case, case_of, differences
from tests.planner.checker.statement.test_claims_of_plans import NOT_PLANNED

T = Code
Said = Callable[[Claims], Claims]


@cache
def answered(name: str) -> tuple[Case, Claim]:
    """The case of a scenario, whose answer names the nearest pairs, too; and the claim of its answer."""
    case = case_of(name)
    smallest = [each[0] for each in (case.claims.nearest,) if each is not None]
    case = replace(case, claims=replace(case.claims, pairs=tuple(each for each in smallest if each is not None)))
    base, of_plan = filling.claim_of(case.scene), phases(case.scene, case.plan.legs, case.plan.arrivals)
    return case, with_answer(base, case.claim, case.plan, of_plan, case.claims)


def reported(name: str, claims: Claims | None = None, plan: Plan | None = None) -> list[Finding]:
    """What is reported of other statements about a case, or of another plan, whose claim is that of the right one."""
    case, claim = answered(name)
    return state_answer(Handling(case.scene, plan or case.plan), claims or case.claims, claim)


@pytest.mark.parametrize("name", sorted(set(shipped_scenarios()) - NOT_PLANNED))
def test_the_claim_of_the_answer_of_a_shipped_scenario_is_accepted(name: str) -> None:
    case, claim = answered(name)
    assert all((case.claims.peaks, case.claims.tool, case.claims.singularity, case.claims.carried))
    assert reported(name) == []
    assert differences(case, claim) == []
    assert check_claim(claim).findings == ()


def test_an_answer_that_states_nothing_needs_no_rows() -> None:
    case, _ = answered("demo")
    arrivals = tuple(replace(each, grip_m=None, support_m=None) for each in case.plan.arrivals)
    assert state_answer(Handling(case.scene, replace(case.plan, arrivals=arrivals)), NOTHING, case.claim) == []


def changed(what: Any, changes: dict[str, Any]) -> Any:
    """The same with other fields; floats are added to."""
    return replace(what, **{key: plus(getattr(what, key), value) for key, value in changes.items()})


def nearest(of: str, **changes: Any) -> Said:
    """The smallest clearance of a kind, or the first pair, is stated otherwise."""
    return lambda claims: changed(claims, {of: (changed(getattr(claims, of)[0], changes),)})


def plus(old: Any, value: Any) -> Any:
    return old + value if isinstance(value, float) else value


def peak(joint: int, **factors: float | None) -> Said:
    """The peaks of a joint are stated otherwise."""

    def change(claims: Claims) -> Claims:
        peaks = list(claims.peaks or ())
        numbers = {key: by and (by - 1.0) * getattr(peaks[joint], key) for key, by in factors.items()}
        peaks[joint] = changed(peaks[joint], numbers)
        return replace(claims, peaks=tuple(peaks))

    return change


def tool(**changes: float) -> Said:
    """A peak of the tool is stated otherwise, or its time."""
    return lambda claims: replace(claims, tool=changed(claims.tool, changes))


def load(which: int, **changes: Any) -> Said:
    """A load is stated otherwise."""

    def change(claims: Claims) -> Claims:
        loads = list(claims.carried or ())
        loads[which] = changed(loads[which], changes)
        return replace(claims, carried=tuple(loads))

    return change


def margin(of: str, more: float | None) -> Said:
    """A least margin is stated otherwise, or that there is none."""

    def change(claims: Claims) -> Claims:
        value = more if more is None else (getattr(claims, of)[0] or 0.0) + more
        stated: Claims = changed(claims, {of: (value,)})
        return stated

    return change


def longer_contact(claims: Claims) -> Claims:
    first, *others = claims.contacts or ()
    return replace(claims, contacts=(replace(first, t1=first.t1 + 1e-6), *others))


class Wrong(NamedTuple):
    """An answer that states something else."""

    case: str
    code: Code
    change: Said


WRONG: dict[str, Wrong] = {
    "a larger clearance": Wrong("demo", T.NEAREST, nearest("nearest", gap_m=1e-4)),
    "a smaller clearance": Wrong("demo", T.NEAREST, nearest("nearest", gap_m=-1e-4)),
    "another time": Wrong("demo", T.NEAREST, nearest("nearest", time=1e-6)),
    "another phase": Wrong("demo", T.NEAREST, nearest("nearest", phase="FOLLOW")),
    "another pair": Wrong("demo", T.NEAREST, nearest("nearest", bodies=("cup", "post"))),
    "a body that there is not": Wrong("demo", T.NEAREST, nearest("nearest", bodies=("cup", "nobody"))),
    "a clearance that is no number": Wrong("demo", T.NEAREST, nearest("nearest", gap_m=math.nan)),
    "nothing to keep apart": Wrong("demo", T.NEAREST, lambda k: replace(k, nearest=(None,))),
    "a larger clearance of parts": Wrong("demo", T.NEAREST, nearest("placed", gap_m=1e-4)),
    "a smaller clearance of parts": Wrong("demo", T.NEAREST, nearest("placed", gap_m=-1e-4)),
    "the arm as a part": Wrong("demo", T.NEAREST, lambda k: replace(k, placed=k.nearest)),
    "a part as the arm": Wrong("demo", T.NEAREST, lambda k: replace(k, nearest=k.placed)),
    "a nearer pair": Wrong("demo", T.NEAREST, nearest("pairs", gap_m=-1e-4)),
    "a heavier load": Wrong("demo", T.LOAD, load(1, mass_kg=1e-6)),
    "a larger inertia": Wrong("demo", T.LOAD, load(1, inertia_kgm2=1e-9)),
    "no inertia": Wrong("demo", T.LOAD, load(1, inertia_kgm2=None)),
    "a larger share": Wrong("heavy-casting", T.LOAD, load(1, share=1e-6)),
    "a load for longer": Wrong("demo", T.LOAD, load(1, t1=1e-6)),
    "another part": Wrong("demo", T.LOAD, load(1, part="cup")),
    "a load less": Wrong("demo", T.LOAD, lambda k: replace(k, carried=(k.carried or ())[:-1])),
    "a contact less": Wrong("demo", T.CONTACT, lambda k: replace(k, contacts=(k.contacts or ())[1:])),
    "a longer contact": Wrong("demo", T.CONTACT, longer_contact),
    "a lower peak": Wrong("demo", T.PEAK, peak(0, velocity=1.0 - 1e-5)),
    "a higher peak": Wrong("demo", T.PEAK, peak(1, acceleration=1.0 + 1e-5)),
    "a lower jerk": Wrong("demo", T.PEAK, peak(0, jerk=0.99)),
    "a lower share": Wrong("heavy-casting", T.PEAK, peak(0, acceleration_ratio=0.99)),
    "a higher share": Wrong("heavy-casting", T.PEAK, peak(0, acceleration_ratio=1.01)),
    "a peak that is no number": Wrong("demo", T.PEAK, peak(0, velocity=math.nan)),
    "no jerk": Wrong("demo", T.PEAK, peak(0, jerk=None)),
    "a jerk without a limit": Wrong("parabolic-blend", T.PEAK,
                                    lambda k: replace(k, peaks=tuple(replace(p, jerk=1.0) for p in k.peaks or ()))),
    "a joint less": Wrong("demo", T.PEAK, lambda k: replace(k, peaks=(k.peaks or ())[1:])),
    "a slower tool": Wrong("demo", T.PEAK, tool(speed=-1e-3)),
    "a faster tool": Wrong("demo", T.PEAK, tool(speed=1e-3)),
    "a peak of the tool at another time": Wrong("demo", T.PEAK, tool(acceleration_time=1e-4)),
    "a tool that accelerates harder": Wrong("parabolic-blend", T.PEAK, tool(acceleration=1e-3)),
    "a tool that accelerates less": Wrong("demo", T.PEAK, tool(acceleration=-1e-3)),
    "less with a part": Wrong("demo", T.PEAK,
                              lambda k: replace(k, tool_acceleration=0.98 * (k.tool_acceleration or 0.0))),
    "more with a part": Wrong("demo", T.PEAK,
                              lambda k: replace(k, tool_acceleration=1.01 * (k.tool_acceleration or 0.0))),
    "a larger margin": Wrong("demo", T.SINGULARITY, margin("singularity", 2e-3)),
    "a smaller margin": Wrong("demo", T.SINGULARITY, margin("singularity", -2e-3)),
    "no margin": Wrong("demo", T.SINGULARITY, margin("singularity", None)),
    "a margin that is no number": Wrong("demo", T.SINGULARITY, margin("singularity", math.nan)),
    "a larger margin of a loop": Wrong("five-bar", T.SINGULARITY, margin("parallel", 2e-3)),
    "a smaller margin of a loop": Wrong("five-bar", T.SINGULARITY, margin("parallel", -2e-3)),
    "no loop": Wrong("five-bar", T.SINGULARITY, margin("parallel", None)),
    "a loop that is none": Wrong("demo", T.SINGULARITY, margin("parallel", 0.5)),
    "another mode": Wrong("five-bar", T.ELBOW, lambda k: replace(k, modes=("right-left",))),
    "another mode of an arm that tilts": Wrong("elbow-arm", T.ELBOW, lambda k: replace(k, modes=("back-up",))),
    "a mode that there is not": Wrong("demo", T.ELBOW, lambda k: replace(k, modes=("up",))),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_is_not_so_is_reported(name: str) -> None:
    wrong = WRONG[name]
    case, _ = answered(wrong.case)
    assert reported(wrong.case) == []
    claims = wrong.change(case.claims)
    assert claims != case.claims
    assert wrong.code in {each.code for each in reported(wrong.case, claims)}


@pytest.mark.parametrize(("number", "field"), [(0, "grip_m"), (1, "support_m")])
@pytest.mark.parametrize("off", [-1e-4, math.nan])
def test_a_part_that_is_not_as_near_is_reported(number: int, field: str, off: float) -> None:
    case, _ = answered("demo")
    arrivals = list(case.plan.arrivals)
    assert reported("demo", plan=replace(case.plan, arrivals=tuple(arrivals))) == []
    arrivals[number] = replace(arrivals[number])
    object.__setattr__(arrivals[number], field, getattr(arrivals[number], field) + off)
    assert {each.code for each in reported("demo", plan=replace(case.plan, arrivals=tuple(arrivals)))} == {T.NEAREST}


def test_a_place_has_no_grip() -> None:
    case, _ = answered("demo")
    arrivals = (case.plan.arrivals[0], replace(case.plan.arrivals[1], grip_m=1.0), *case.plan.arrivals[2:])
    assert {each.code for each in reported("demo", plan=replace(case.plan, arrivals=arrivals))} == {T.NEAREST}


FAULTS: dict[str, tuple[str, Code, str, int | slice, int, float]] = {
    "a nearer second distance": ("demo", T.NEAREST, "required", 0, c.REQUIRED_NEAREST, -1e-6),
    "a nearer distance of parts": ("demo", T.NEAREST, "required", 0, c.REQUIRED_PLACED, -1e-6),
    "distances at another time": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_TIME, 1e-6),
    "distances in another phase": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_PHASE, 1.0),
    "distances of other bodies": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_BODY, 1.0),
    "distances that are larger": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_MOST, 1e-6),
    "peaks from later on": ("demo", T.PEAK, "sums", slice(None), c.SUM_T0, 1e-3),
    "peaks of other joints": ("demo", T.PEAK, "sums", slice(None), c.SUM_SHARE, 0.5),
    "peaks of another order": ("demo", T.PEAK, "sums", slice(None), c.SUM_ORDER, 1.0),
    "higher bounds of peaks": ("demo", T.PEAK, "sums", slice(None), c.SUM_HIGH, 1e-2),
    "lower bounds of peaks": ("demo", T.PEAK, "sums", slice(None), c.SUM_LOW, -1e-2),
    "another point of the tool": ("demo", T.PEAK, "rates", slice(None), c.RATE_POINT, 1e-6),
    "another link": ("demo", T.PEAK, "rates", slice(None), c.RATE_LINK, -1.0),
    "a faster point": ("demo", T.PEAK, "rates", slice(None), c.RATE_MOST, 1e-2),
    "margins of another link": ("demo", T.SINGULARITY, "axes", slice(None), c.AXIS_LINK, -1.0),
    "margins from later on": ("demo", T.SINGULARITY, "axes", slice(None), c.AXIS_T0, 1e-3),
    "margins along another axis": ("demo", T.SINGULARITY, "axes", slice(None), c.AXIS_DIRECTION, 1e-3),
}
"""Case, topic, table, rows, column, and what is added to its numbers."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_in_the_claim_of_an_answer_is_reported(name: str) -> None:
    of, topic, table, rows, column, more = FAULTS[name]
    case, claim = answered(of)
    numbers = getattr(claim, table).copy()
    numbers[rows, column] += more
    bad = claim._replace(**{table: numbers})
    found = state_answer(Handling(case.scene, case.plan), case.claims, bad)
    assert topic in {each.code for each in found}


@pytest.mark.parametrize("table", ["sums", "axes", "distances"])
def test_no_row_of_an_answer_can_be_spared(table: str) -> None:
    case, claim = answered("five-bar")
    # the smallest clearance and the nearest pair need the same row
    for row in range(len(getattr(case.claim, table)), len(getattr(claim, table))):
        less = claim._replace(**{table: np.delete(getattr(claim, table), row, axis=0)})
        others = [getattr(claim, table)[k] for k in range(len(getattr(claim, table))) if k != row]
        if not any(np.array_equal(getattr(claim, table)[row], other) for other in others):
            assert state_answer(Handling(case.scene, case.plan), case.claims, less), (table, row)


def test_modes_margins_grips_and_supports_that_a_request_asks_for_are_stated() -> None:
    case = case_of("demo, near parts")
    assert differences(case) == []
    for table, topic in (("distances", T.NEAREST), ("axes", T.ELBOW)):
        for row in range(len(getattr(case.claim, table))):
            less = case.claim._replace(**{table: np.delete(getattr(case.claim, table), row, axis=0)})
            assert {each.code for each in differences(case, less)} <= {topic, T.SINGULARITY}
            assert differences(case, less)

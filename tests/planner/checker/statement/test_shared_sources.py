"""Faults made on purpose in the sources from which planner, first checker and the writer of claims get the same facts.

The statement checker derives these facts for itself, so it reports what such a fault does to a claim, whether the claim
alone is written with it, or the whole product plans and checks with it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import pytest
import scipy.interpolate

import assur
from assur.planner.claim import filling, obligations
from assur.planner.geometry import shapes
from assur.planner.laws import kinds, ramps
from assur.planner.laws.law import EXACT
from assur.planner.model import attachments, phases
from assur.planner.model import scene as scenes
from assur.scenes.reading.cell import _kept
from assur.scenes.requests import cell_of
from tests.planner.checker.statement.cases import case_of, claim_of, differences, planned, sealed

DEMO, FLOW, LAWS = "demo, more uncertain", "dense-flow, more uncertain", "demo, all laws"
STACKED = "demo, supports not named"

contacts_of, after, ramp = phases.contacts_of, attachments.Attachments.after, ramps.Change.phases
spline = scipy.interpolate.CubicSpline
changed, phases_of = phases.GraspUncertainty.changed, phases.phases


class Fault(NamedTuple):
    """What is replaced by what: an attribute of a module or a class."""

    name: str
    case: str
    owner: Any
    attribute: str
    instead: Any


def too_many(*given: Any) -> Any:
    """Grip and rest are contacts in all legs that track."""
    return (frozenset().union(*contacts_of(*given)),) * 2


def everything(scene: Any, part: str, *_: Any) -> Any:
    """A part rests on all bodies."""
    return frozenset(scene.index) - {part}


def late(scene: Any, legs: Any, arrivals: Any) -> Any:
    """Parts change hands a leg too late."""
    found = list(phases_of(scene, legs, arrivals))
    pairs = zip([found[0], *found], found, strict=False)
    return tuple(dataclasses.replace(one, attached=before.attached) for before, one in pairs)


def slow(self: Any, before: float) -> Any:
    """Ramps whose jerk lasts twice as long."""
    return [(t * (1.0 + (j != 0.0)), a, j) for t, a, j in ramp(self, before)]


def other_ends(knots: Any, values: Any, bc_type: str) -> Any:
    """Splines with the conditions of another kind at their ends."""
    return spline(knots, values, bc_type={"natural": "clamped", "clamped": "natural"}.get(bc_type, bc_type))


SHARED = (
    Fault("grip and rest in all tracked legs", DEMO, phases, "contacts_of", too_many),
    Fault("a part rests on what is 60 mm below", STACKED, phases, "CONTACT_M", 0.06),
    Fault("a part rests on everything", STACKED, phases, "resting_on", everything),
    Fault("a gripped part is known exactly", FLOW, phases, "gripped_within", lambda *_: EXACT),
    Fault("no correction on the way", FLOW, phases, "on_way", lambda *_: ()),
    Fault("no belt is corrected for", FLOW, scenes.Scene, "corrects", lambda *_: False),
    Fault(
        "a turned grasp is not turned",
        DEMO,
        attachments.Attachments,
        "after",
        lambda self, scene, step, turn=0.0: after(self, scene, step, 0.0 * turn),
    ),
    Fault("a part that was put down is forgotten", DEMO, phases.GraspUncertainty, "changed", lambda self, *_: self),
    Fault(
        "what a part was lifted from stays its support",
        DEMO,
        phases.GraspUncertainty,
        "changed",
        lambda self, part, within, supports: changed(self, part, within, supports | {phases.pair(part, "bar")}),
    ),
    Fault("the distance near a point counts everywhere", DEMO, phases.Phase, "near", True),
    Fault("no standstill", DEMO, phases, "stay_phases", lambda *_: []),
    Fault("loads lower no limit", "heavy-casting", scenes.Scene, "limits_with", lambda self, _: self.robot.limits),
    Fault("bodies reach less far from their axis", FLOW, shapes.Body, "radius", 0.01),
    Fault("ramps last longer", "demo, belt that slows down", ramps.Change, "phases", slow),
    Fault("poses end with another condition", LAWS, scipy.interpolate, "CubicSpline", other_ends),
    Fault("straight parts are twice as long", DEMO, scenes, "STRAIGHT", 20.0),
)
WRITTEN = (
    Fault("contacts are twice as deep", DEMO, obligations, "contact_gap", lambda _: -2e-3),
    Fault("parts change hands a leg too late", DEMO, filling, "phases_in", late),
    Fault("a step is another polynomial", LAWS, kinds, "MOVE", (420.0, -1680.0, 2100.0, -839.9)),
)
"""Faults of the writer of claims alone."""
REFUSED = 10
"""With so many of `SHARED` at least the search has plans that the product's checker refuses."""


@contextmanager
def replaced(fault: Fault) -> Iterator[None]:
    """The product with the fault. No cell is kept from before, or for what comes after."""
    with patch.object(fault.owner, fault.attribute, fault.instead):
        _kept.clear()
        try:
            yield
        finally:
            _kept.clear()


@pytest.mark.parametrize("fault", SHARED + WRITTEN, ids=[fault.name for fault in SHARED + WRITTEN])
def test_a_fault_of_what_a_claim_is_written_from_is_reported(fault: Fault) -> None:
    case = case_of(fault.case)
    with replaced(fault):
        claim = claim_of(cell_of(case.request).scene, case.plan)
    assert differences(case, claim) != []


def test_no_plan_leaves_the_product_with_a_fault_that_touches_it() -> None:
    refused = []
    for fault in SHARED:
        request = case_of(fault.case).request
        with replaced(fault):
            answer = assur.plan(request)
            made = planned(request) if answer.planned else None
        if made is None:
            refused += [fault.name] if answer["reason"] == "NOT_CERTIFIED" else []
            continue
        scene = cell_of(request).scene
        honest = dataclasses.replace(made, scene=scene, plan=sealed(scene, made.plan))
        touched = not all(map(np.array_equal, made.claim, claim_of(scene, made.plan)))
        assert (fault.name, touched, differences(honest) != []) == (fault.name, False, False)
    assert len(refused) >= REFUSED

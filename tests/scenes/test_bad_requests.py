"""Every kind of bad request is refused at the field that is at fault, and the good one is not."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import pytest

from assur.scenes.requests import scene_of
from tests.changed import changed
from tests.scenes.bad_requests import BAD_REQUESTS, GOOD_REQUEST, INLINE, THREE_AXES, Bad


def test_there_are_at_least_sixty_kinds_of_different_names() -> None:
    names = [bad.name for bad in BAD_REQUESTS]
    assert len(names) == len(set(names)) >= 60


def test_the_good_request_is_a_scene() -> None:
    scene = scene_of(GOOD_REQUEST)
    assert [step.name for step in scene.task] == ["pick-1", "place-2", "move-3"]


@pytest.mark.parametrize("bad", BAD_REQUESTS, ids=lambda bad: bad.name)
def test_a_bad_request_is_refused_at_its_field_with_what_is_allowed_or_was_meant(bad: Bad) -> None:
    error = bad.refused()
    assert pickle.loads(pickle.dumps(error)).args == error.args


def test_reading_a_request_does_not_change_it() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    scene_of(request)
    assert request == GOOD_REQUEST


def test_a_start_on_its_limits_is_no_fault() -> None:
    joints = {"j1_deg": -170, "j2_deg": 145, "j3_mm": 333, "j4_deg": -270}
    rates = {"j1_deg_s": 400, "j2_deg_s": -670, "j3_mm_s": 2400, "j4_deg_s": 0}
    assert scene_of(changed(GOOD_REQUEST, {"start": {"joints": joints, "velocity": rates}})).start.q[2] == 0.333


NO_BODIES = "the tool has no bodies: nothing is kept clear of it between flange and tool point"
BARE = "the arm has no bodies: nothing is kept clear of its links"


@pytest.mark.parametrize(
    ("request_", "told"),
    [
        (GOOD_REQUEST, set()),
        (changed(GOOD_REQUEST, {"robot.tool": {"tcp_mm": [0, 0, -100]}}), {NO_BODIES}),
        (changed(GOOD_REQUEST, {"robot.tool": {"tcp_mm": [0, 0, 0]}}), set()),
        (INLINE, {BARE}),
    ],
    ids=["bodies on both", "a long tool", "no tool", "a bare arm"],
)
def test_what_has_no_bodies_is_told_to_be_kept_clear_of_nothing(request_: Any, told: set[str]) -> None:
    assert {NO_BODIES, BARE} & set(scene_of(request_).assumptions) == told


def test_a_length_that_is_too_large_in_millimetres_is_not_told_to_be_in_millimetres() -> None:
    far = Bad("too large", {"task[2].move.to": {"at_mm": [350000, 0, 120]}}, ".at_mm[0]")
    assert "did you mean" not in far.refused().allowed


def test_what_three_axes_cannot_do_is_good_but_for_that() -> None:
    scene_of(THREE_AXES)


def test_a_manner_that_is_given_is_no_fault_where_its_silence_is_one() -> None:
    (silent,) = (bad for bad in BAD_REQUESTS if bad.name == "a via whose manner is left out")
    scene_of(changed(silent.document(), {"task[1].move.match": "position"}))

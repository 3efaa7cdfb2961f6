"""Every kind of bad request is refused at the field that is at fault, and the good one is not."""

from __future__ import annotations

import copy
import pickle

import pytest

from planner.errors import InputError
from scenes.requests import parse_json, scene_of, validate
from tests.scenes.bad_requests import BAD_REQUESTS, BAD_TEXTS, GOOD_REQUEST, Bad, BadText


def test_there_are_at_least_sixty_kinds_of_different_names() -> None:
    names = [bad.name for bad in BAD_REQUESTS] + [text.name for text in BAD_TEXTS]
    assert len(names) == len(set(names)) >= 60


def test_the_good_request_is_a_scene() -> None:
    scene = scene_of(GOOD_REQUEST)
    assert [step.name for step in scene.task] == ["pick-1", "place-2", "move-3"]


@pytest.mark.parametrize("bad", BAD_REQUESTS, ids=lambda bad: bad.name)
def test_a_bad_request_is_refused_at_its_field(bad: Bad) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    bad.change(request)
    with pytest.raises(InputError) as caught:
        scene_of(request)
    assert caught.value.field == bad.field
    assert caught.value.allowed
    assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args


@pytest.mark.parametrize("bad", BAD_TEXTS, ids=lambda bad: bad.name)
def test_a_bad_text_is_refused(bad: BadText) -> None:
    with pytest.raises(InputError) as caught:
        validate(parse_json(bad.data))
    if bad.field is not None:
        assert caught.value.field == bad.field


def test_reading_a_request_does_not_change_it() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    scene_of(request)
    assert request == GOOD_REQUEST

"""No client fills the folder for meshes for all."""

from __future__ import annotations

import pytest

from assur.api.problems import Problem
from assur.api.web.uploads import WINDOW_S, Uploads
from assur.scenes.bounds import MAX_MESH_BYTES

MIB = 1 << 20


def test_a_client_adds_its_share_and_is_told_when_there_is_room_again() -> None:
    now = 100.0
    uploads = Uploads(1024 * MIB, clock=lambda: now)
    for _ in range(16):
        uploads.add("greedy", 16 * MIB)
        now += 10.0
    with pytest.raises(Problem) as refused:
        uploads.add("greedy", 1)
    assert refused.value.kind == "too-many-requests"
    assert int(refused.value.headers["Retry-After"]) == WINDOW_S - 160
    uploads.add("another", 16 * MIB)
    now += WINDOW_S - 160
    uploads.add("greedy", 16 * MIB)
    with pytest.raises(Problem):
        uploads.add("greedy", 1)


def test_what_added_nothing_is_not_counted_and_the_largest_mesh_is_taken_by_any_folder() -> None:
    uploads = Uploads(1 * MIB)
    for _ in range(5):
        uploads.add("a", MAX_MESH_BYTES)
        uploads.take_back("a", MAX_MESH_BYTES)
    uploads.add("a", MAX_MESH_BYTES)
    with pytest.raises(Problem):
        uploads.add("a", 1)

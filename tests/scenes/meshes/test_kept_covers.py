"""Covers that are kept: found once, in steps that can be left, read back only if they are what would be found."""

from __future__ import annotations

import base64
import hashlib
import json
import logging
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.model.deadline import Deadline, OutOfTimeError
from assur.scenes.meshes import covered, process_covers, use_folder
from assur.scenes.meshes.cover import MAX_WORK, Covering, cover, cover_by
from assur.scenes.meshes.covers import Covers, Key
from assur.scenes.meshes.folder import LEAST_BYTES, LEFT_S, FolderError, MeshFolder
from assur.scenes.meshes.kept_cuts import KeptCutsError, cover_from, hulls_digest, written
from assur.scenes.meshes.load import load
from assur.scenes.meshes.parts import InParts, at_once
from assur.scenes.schema.shapes import MeshDocument
from tests.scenes.meshes.solids import SOLIDS, binary_stl, on_triangles, surface, torus
from tests.scenes.meshes.test_cover import WITHIN_M, outside

FLANGE = binary_stl(SOLIDS["flange"])
KEY = Key(hashlib.sha256(FLANGE).hexdigest(), "stl", "mm")


def folder_at(path: Path, quota: int = 1 << 20, kept_s: float = 1000.0) -> MeshFolder:
    return MeshFolder.at(str(path), quota, kept_s, "folder")


def file_of(path: Path) -> Path:
    (found,) = path.glob("*.cover")
    return found


class Ticks:
    """A clock that is asked so often, and then says that the time is over."""

    def __init__(self, looks: int) -> None:
        self.left = looks

    def __call__(self) -> bool:
        self.left -= 1
        return self.left < 0


@pytest.mark.parametrize("looks", [0, 1, 7])
def test_a_covering_that_is_left_again_and_again_ends_as_one_that_is_not(looks: int) -> None:
    solid = surface(SOLIDS["flange"])
    covering, done, left = InParts(Covering(solid).in_parts()), None, 0
    while done is None:
        done = covering.run(Ticks(looks)) if looks or left else covering.run(Ticks(0))
        left += done is None
        looks = max(looks, 1)
    assert left >= 2
    assert hulls_digest(done[1]) == hulls_digest(cover(solid))


def test_work_is_bounded_by_counting() -> None:
    rng = np.random.default_rng(1)
    corners = torus(50, 20)
    vertices, which = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    noisy = (vertices + rng.normal(0.0, 1.5, vertices.shape))[which].reshape(-1, 3, 3)
    for corners in (noisy, torus(20, 10), torus(8, 4)):
        covering = Covering(surface(corners))
        _, found = at_once(covering.in_parts())
        assert covering.work <= MAX_WORK + 6_000
        assert outside(found, on_triangles(surface(corners).corners, 500, seed=3)) <= WITHIN_M


def test_a_mesh_is_covered_once_for_all_processes_with_a_folder(tmp_path: Path) -> None:
    one, other = Covers(folder=folder_at(tmp_path)), Covers(folder=folder_at(tmp_path))
    first, second = one.cover(KEY, FLANGE), other.cover(KEY, FLANGE)
    assert (one.cuts_made, other.cuts_made) == (1, 0)
    assert hulls_digest(first) == hulls_digest(second)
    assert one.cover(KEY, FLANGE) is first
    assert file_of(tmp_path).stat().st_size < 4096
    without = Covers()
    without.cover(KEY, FLANGE)
    assert without.cuts_made == 1


def changed(change: Callable[[dict[str, Any]], None]) -> Callable[[bytes], bytes]:
    def apply(content: bytes) -> bytes:
        document = json.loads(content)
        change(document)
        return json.dumps(document).encode()

    return apply


TAMPERED: dict[str, Callable[[bytes], bytes]] = {
    "torn": lambda content: content[: len(content) // 2],
    "empty": lambda _: b"",
    "nan": lambda content: content.replace(b'"excess_m": ', b'"excess_m": NaN, "x": '),
    "pickle": lambda _: b"\x80\x04cos\nsystem\n(S'true'\ntR.",
    "cut moved": changed(lambda d: d["planes"][0].__setitem__(2, d["planes"][0][2] + 0.003)),
    "cut of no cell": changed(lambda d: d["planes"][0].__setitem__(0, 99)),
    "axis": changed(lambda d: d["planes"][0].__setitem__(1, 3)),
    "true for a number": changed(lambda d: d["planes"][0].__setitem__(0, False)),
    "huge": changed(lambda d: d["planes"][0].__setitem__(2, 10**400)),
    "too many": changed(lambda d: d.__setitem__("planes", d["planes"] * 64)),
    "group left out": changed(lambda d: d["groups"].pop()),
    "group twice": changed(lambda d: d["groups"].append(d["groups"][0])),
    "said to be convex": changed(lambda d: d.__setitem__("convex", True)),
    "other mesh": changed(lambda d: d.__setitem__("mesh", "0" * 64 + "-stl-mm")),
    "other hulls": changed(lambda d: d.__setitem__("hulls", "0" * 64)),
    "negative": changed(lambda d: d.__setitem__("excess_m", -1.0)),
    "further field": changed(lambda d: d.__setitem__("hull", [])),
    "a list": lambda _: b"[]",
}


@pytest.mark.parametrize("how", sorted(TAMPERED))
def test_a_forged_or_torn_file_is_refused_logged_and_made_anew(
    how: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    right = Covers(folder=folder_at(tmp_path)).cover(KEY, FLANGE)
    path = file_of(tmp_path)
    whole = path.read_bytes()
    path.write_bytes(TAMPERED[how](whole))
    with pytest.raises(KeptCutsError):
        at_once(cover_from(path.read_bytes(), KEY.name, load(FLANGE, "stl", "mm")))
    covers = Covers(folder=folder_at(tmp_path))
    with caplog.at_level(logging.WARNING, "assur.meshes"):
        found = covers.cover(KEY, FLANGE)
    assert [record.getMessage() for record in caplog.records] == ["kept cuts are refused"]
    assert hulls_digest(found) == hulls_digest(right)
    assert covers.cuts_made == 1
    assert path.read_bytes() == whole


def test_a_file_that_is_forged_consistently_still_covers_the_mesh() -> None:
    """Who can write the folder can choose the cuts, and with them how tight a cover is; not what it contains."""
    from dataclasses import replace

    solid = surface(SOLIDS["flange"])
    cuts, right = at_once(Covering(solid).in_parts())
    forged = replace(cuts, planes=tuple((c, axis, at + 0.001) for c, axis, at in cuts.planes))
    content = written("name", forged, at_once(cover_by(solid, forged)))
    taken = at_once(cover_from(content, "name", solid))
    assert hulls_digest(taken) != hulls_digest(right)
    assert outside(taken, on_triangles(solid.corners, 2_000, seed=9)) <= WITHIN_M


def test_a_file_of_another_version_is_made_anew_without_a_warning(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    Covers(folder=folder_at(tmp_path)).cover(KEY, FLANGE)
    path = file_of(tmp_path)
    path.write_bytes(changed(lambda d: d.__setitem__("version", "older"))(path.read_bytes()))
    covers = Covers(folder=folder_at(tmp_path))
    with caplog.at_level(logging.WARNING, "assur.meshes"):
        covers.cover(KEY, FLANGE)
    assert (covers.cuts_made, caplog.records) == (1, [])


def test_memory_is_bounded_and_the_least_used_goes_first() -> None:
    contents = [binary_stl(SOLIDS[name]) for name in ("bracket", "tray")]
    keys = [Key(hashlib.sha256(content).hexdigest(), "stl", "mm") for content in contents]
    covers = Covers(kept_bytes=4_000)
    for key, content in zip(keys, contents, strict=True):
        covers.cover(key, content)
    assert covers.known(keys[0]) is None
    assert covers.known(keys[1]) is not None
    assert Covers(kept_bytes=10).cover(keys[0], contents[0]).pieces


def test_what_the_deadline_ends_is_said_kept_and_never_used_unfinished(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that goes on by a second at each look: each request has time for one part of the work."""
    looks = count()
    monkeypatch.setattr("assur.planner.model.deadline.time", SimpleNamespace(perf_counter=lambda: next(looks)))
    covers, left = Covers(), list[str]()
    while len(left) < 20:
        with Deadline(next(looks), 1.5), pytest.raises(OutOfTimeError) as late:
            covers.cover(KEY, FLANGE)
        left.append(str(late.value))
        assert covers.known(KEY) is None
    found = covers.cover(KEY, FLANGE)
    said = ("had not been read", "had been read, and was not covered yet", "was being covered by convex pieces")
    order = [next(k for k, begin in enumerate(said) if text.startswith(begin)) for text in left]
    assert order == sorted(order)
    # reading, and making the first cell, are left several times each
    assert order.count(0) == 4
    assert order.count(1) == 6
    assert order.count(2) == 10
    assert covers.cuts_made == 1
    assert hulls_digest(found) == hulls_digest(cover(load(FLANGE, "stl", "mm")))


def test_a_cover_by_kept_cuts_is_left_when_the_time_is_over_and_gone_on_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = Covers(folder=folder_at(tmp_path)).cover(KEY, FLANGE)
    looks = count()
    monkeypatch.setattr("assur.planner.model.deadline.time", SimpleNamespace(perf_counter=lambda: next(looks)))
    covers, left, found = Covers(folder=folder_at(tmp_path)), list[str](), None
    while found is None:
        try:
            with Deadline(next(looks), 1.5):
                found = covers.cover(KEY, FLANGE)
        except OutOfTimeError as late:
            left.append(str(late))
    # once for each cut and each hull that is made
    assert left.count("had been read, and was not covered yet") > len(right.pieces)
    assert (covers.cuts_made, hulls_digest(found)) == (0, hulls_digest(right))


def test_meshes_by_digest_are_taken_from_the_folder_and_no_other_bytes_are(tmp_path: Path) -> None:
    folder, digest = folder_at(tmp_path), KEY.digest
    mesh = MeshDocument(sha256=digest, format="stl", unit="cm")
    with pytest.raises(InputError, match="ASSUR_MESH_FOLDER"):
        covered(mesh)
    use_folder(folder)
    try:
        with pytest.raises(InputError, match=f"PUT /v1/meshes/{digest}"):
            covered(mesh)
        (tmp_path / f"{digest}.mesh").write_bytes(FLANGE + b"x")
        with pytest.raises(InputError, match=digest):
            covered(mesh)
        assert folder.put(digest, FLANGE)
        assert not folder.put(digest, FLANGE)
        inline = MeshDocument(data=base64.b64encode(FLANGE).decode(), format="stl", unit="cm")
        assert covered(mesh) is covered(inline)
        assert process_covers().known(Key(digest, "stl", "cm")) is not None
    finally:
        use_folder(None)


def test_the_folder_keeps_its_quota_and_forgets_what_is_not_used(tmp_path: Path) -> None:
    folder = folder_at(tmp_path, quota=3 * LEAST_BYTES, kept_s=100.0)
    digests = [hashlib.sha256(bytes([i])).hexdigest() for i in range(4)]
    for i in range(3):
        assert folder.put(digests[i], bytes([i]))
    with pytest.raises(FolderError) as full:
        folder.put(digests[3], bytes([3]))
    assert full.value.full
    old = time.time() - 101.0
    os.utime(tmp_path / f"{digests[0]}.mesh", (old, old))
    assert folder.known(digests[0]) is None
    assert folder.content(digests[0]) is None
    assert folder.put(digests[3], bytes([3]))
    assert not (tmp_path / f"{digests[0]}.mesh").exists()
    half = time.time() - 70.0
    os.utime(tmp_path / f"{digests[1]}.mesh", (half, half))
    assert folder.content(digests[1]) == bytes([1])
    known = folder.known(digests[1])
    assert known is not None
    assert known.left_s > 90.0


def test_an_upload_is_kept_as_long_as_after_a_use_and_its_file_is_as_old_as_it_is(tmp_path: Path) -> None:
    folder = folder_at(tmp_path, kept_s=100_000.0)
    began = time.time()
    assert folder.put(KEY.digest, FLANGE)
    file = tmp_path / f"{KEY.digest}.mesh"
    assert began - 1.0 <= file.stat().st_mtime <= time.time() + 1.0
    kept = folder.known(KEY.digest)
    assert kept is not None
    assert 99_000.0 < kept.left_s <= 100_000.0


@pytest.mark.parametrize("again", ["upload", "request"])
def test_a_file_that_is_sent_or_used_again_is_kept_from_then_on(tmp_path: Path, again: str) -> None:
    folder = folder_at(tmp_path, kept_s=100_000.0)
    folder.put(KEY.digest, FLANGE)
    old = time.time() - 99_990.0
    os.utime(tmp_path / f"{KEY.digest}.mesh", (old, old))
    before = folder.known(KEY.digest)
    assert before is not None
    assert before.left_s < 11.0  # to ask is no use
    if again == "upload":
        assert not folder.put(KEY.digest, FLANGE)
    else:
        assert folder.content(KEY.digest) == FLANGE
    after = folder.known(KEY.digest)
    assert after is not None
    assert after.left_s > 99_000.0


def test_no_two_processes_use_the_same_room(tmp_path: Path) -> None:
    folder = folder_at(tmp_path, quota=3 * LEAST_BYTES)
    contents = [bytes([i]) for i in range(12)]

    def put(content: bytes) -> str:
        try:
            return str(folder.put(hashlib.sha256(content).hexdigest(), content))
        except FolderError as error:
            return f"full: {error.full}"

    # each opens the lock anew, so threads exclude each other as processes do
    with ThreadPoolExecutor(len(contents)) as pool:
        assert sorted(pool.map(put, contents)) == ["True"] * 3 + ["full: True"] * 9
    assert folder.used() == 3 * LEAST_BYTES


def test_only_files_of_the_folder_are_read_written_and_removed(tmp_path: Path) -> None:
    outside_, inside = tmp_path / "outside", tmp_path / "inside"
    outside_.write_bytes(FLANGE)
    folder = folder_at(inside)
    (inside / f"{KEY.digest}.mesh").symlink_to(outside_)
    (inside / "notes.txt").write_text("mine")
    old = time.time() - 10 * LEFT_S
    (inside / f".{'0' * 32}.tmp").write_text("left")
    os.utime(inside / f".{'0' * 32}.tmp", (old, old))
    os.utime(inside / "notes.txt", (old, old))
    assert folder.known(KEY.digest) is None
    assert folder.content(KEY.digest) is None
    assert folder.put(KEY.digest, FLANGE)
    assert not (inside / f"{KEY.digest}.mesh").is_symlink()
    assert outside_.read_bytes() == FLANGE
    assert sorted(path.name for path in inside.iterdir()) == sorted([f"{KEY.digest}.mesh", "notes.txt", ".lock"])
    for name in ("../outside", "x" * 64, KEY.digest.upper(), ""):
        with pytest.raises(InputError):
            folder.content(name)
    with pytest.raises(FolderError):
        folder.put_cuts("../outside", b"")
    with pytest.raises(InputError, match="a folder that can be read and written"):
        folder_at(outside_)


def test_a_folder_that_is_gone_is_told_and_covers_are_found_all_the_same(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = folder_at(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    with pytest.raises(FolderError, match="No such file"):
        folder.put(KEY.digest, FLANGE)
    with caplog.at_level(logging.WARNING, "assur.meshes"):
        assert Covers(folder=folder).cover(KEY, FLANGE).pieces
    assert [record.getMessage() for record in caplog.records] == ["the cuts of a cover are not kept"]

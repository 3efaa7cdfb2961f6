"""Files of motion that nobody meant well: each is read or refused, and nothing else happens."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.scenes.motion_log import parse_log
from assur.scenes.motions.csv_motion import csv_motion
from assur.scenes.motions.motion import matched
from assur.scenes.motions.ros_motion import is_message, ros_motion
from tests.scenes.motions.messages import message, yaml_text

FILES = (
    b"t_s,j1_deg,j3_mm\n" + b"".join(b"%d,%d,0\n" % (k, k) for k in range(60)),
    b"%time,field.name0,field.position0\n" + b"".join(b"%d,j1,%d\n" % (17 * 10**17 + k, k) for k in range(60)),
    (yaml_text(message()) + "\n---\n").encode(),
    json.dumps({"op": "publish", "msg": message()}).encode(),
)


@given(st.sampled_from(FILES), st.integers(0, 10_000), st.binary(min_size=1, max_size=6), st.booleans())
def test_a_file_with_some_bytes_changed_is_read_or_refused(file: bytes, place: int, patch: bytes, cut: bool) -> None:
    content = bytearray(file)
    place %= len(content)
    content[place : place + len(patch)] = patch
    given_ = bytes(content[: place + len(patch)] if cut else content)
    for read in (csv_motion, ros_motion):
        try:
            found = read(given_, "file", 1000)
        except InputError:
            continue
        assert all(
            len(state) == len(found.time) for track in found.tracks for state in track.states if state is not None
        )


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(content: bytes) -> None:
    with pytest.raises(InputError):
        parse_log(content, "file")


NESTED = '{"a": ' * 20 + "1" + "}" * 20


@pytest.mark.parametrize(
    "content",
    [
        b"{}", b"[]", b"[1]", b"---\n---\n", b"- a: 1\n", b'{"points": 1}', b'{"points": [1, 2], "joint_names": ["a"]}',
        b'{"points": [{}, {}], "joint_names": [1]}', b'{"points": [{}, {}], "joint_names": []}', NESTED.encode(),
        b'{"name": 1, "position": 2}', b'{"name": ["a"], "position": [true]}', b'{"name": ["a"], "position": [1]}',
        b'{"joint_names": ["a"], "points": [{"positions": [1], "time_from_start": {"sec": true}}, {}]}',
        b'{"joint_names": ["a"], "points": [{"positions": [1], "time_from_start": {}}, {}]}',
        b'{"joint_names": ["a"], "points": [{"positions": [1], "time_from_start": {"sec": -1}}, {}]}',
        b'{"joint_names": ["a"], "points": [{"positions": [1e999], "time_from_start": {"sec": 0}}, {}]}',
        b'{"joint_names": ["a"], "points": [{"positions": [1], "time_from_start": {"sec": 9007199254740993}}, {}]}',
        b"t_s,j1_deg\n1e999,0\n2,0\n", b"t_s,j1_deg\n" + b"9" * 300 + b",0\n", b"t_s,j1_deg\n1e-999,0\n1,0\n",
        b"t_s", b"t_s\n", b"sec,j1_deg\n0,0\n", b"nanosec,j1_deg\n0,0\n", b"t_s,position99\n0,0\n", b"t_s,name0\n0,a\n",
        b"#\n#\n", b"sep=;\n", b";;;\n;;;\n", b"t_s,j1 [furlong]\n0,0\n", b"t_s," + b"j1_deg," * 40 + b"\n",
        b"t_s,position0,name0\n0,0,\n",
    ],
)  # fmt: skip
def test_files_of_no_motion_are_refused(content: bytes) -> None:
    with pytest.raises(InputError) as caught:
        parse_log(content, "file")
    assert len(str(caught.value)) < 700


@pytest.mark.parametrize(("content", "value"), [(b"t_s,j1_deg\n0,0\n", "no message"), (b"# c\n---\n", "nothing")])
def test_what_is_given_as_a_message_and_is_none_is_said(content: bytes, value: str) -> None:
    with pytest.raises(InputError) as caught:
        ros_motion(content, "file", 1000)
    assert str(caught.value.value) == value or repr(caught.value.value) == value
    assert "joint_names, points" in caught.value.allowed


def test_a_file_is_taken_for_what_its_first_line_is() -> None:
    for text in ("joint_names: [a]", "---\na: 1", "# c\n\n{", "- a: 1", "header:\n", "\ufeffheader:\n"):
        assert is_message(text.encode())
    for text in ("t_s,j1_deg", "# a: 1\nt_s,j1_deg", "", "1,2", "time: s,j1", "t_s;j1 [deg]"):
        assert not is_message(text.encode()) or text.startswith("time: ")


@pytest.mark.parametrize(
    ("given_", "known", "found"),
    [
        (["j1", "j2"], ["j1", "j2", "j3"], (["j1", "j2"], "")),
        (["a/j1", "a/j2"], ["j1", "j2"], (["j1", "j2"], "a/")),
        (["arm_j1", "arm_arm_j1"], ["arm_j1", "j1"], (["j1", "arm_j1"], "arm_")),
        (["x_arm_j1"], ["arm_j1", "j1"], None),  # in two ways
        (["xj1"], ["j1"], None),
        (["a_j1", "b_j2"], ["j1", "j2"], None),
        (["a_j1", "a_j1"], ["j1"], None),
        ([], ["j1"], None),
    ],
)
def test_names_are_matched_in_one_way_or_not_at_all(given_: list[str], known: list[str], found: object) -> None:
    assert matched(given_, known) == found

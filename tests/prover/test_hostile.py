"""What is no bundle is refused with a sentence that says where, and no bundle makes the prover work without end."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from assur.prover import prove as prover
from assur.prover.prove import prove
from tests.prover.bundles import Document, bundle, shown

NAMES = "standard-cycle"
TEXTS = {
    "nothing": b"",
    "no JSON": b"{",
    "a list": b"[]",
    "a number": b"3",
    "no UTF-8": b"\xff\xfe\x00",
    "lists within lists": b"[" * 100_000,
    "a number of ten thousand digits": b'{"schema": ' + b"9" * 10_000 + b"}",
}


@pytest.mark.parametrize("text", TEXTS)
def test_what_is_no_bundle_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        prove(TEXTS[text])


def test_what_is_too_long_is_not_read() -> None:
    with pytest.raises(ValueError, match="32000000 are allowed"):
        prove(b" " * 32_000_001)


CHANGES: dict[str, Callable[[Document], Any]] = {
    "schema": lambda d: d.update(schema="assur-bundle/4"),
    "plan_digest": lambda d: d.update(plan_digest="zz"),
    "request_digest": lambda d: d.update(request_digest=d["request_digest"][7:]),
    "phases.0.t0": lambda d: d["phases"][0].update(t0="0"),
    "phases.0.seats": lambda d: d["phases"][0].update(seats=3),
    "rows.0.pieces.1": lambda d: d["rows"][0]["pieces"].__setitem__(1, -2),
    "rows.0.bodies.0": lambda d: d["rows"][0]["bodies"].__setitem__(0, -1),
    "rows.0.normal": lambda d: d["rows"][0]["normal"].append(0.0),
    "arms.0.q.0.0": lambda d: d["arms"][0]["q"][0].__setitem__(0, True),
    "bodies.0.pieces": lambda d: d["bodies"][0].update(pieces=[]),
    "bodies.0.pieces.0.axis": lambda d: d["bodies"][0]["pieces"][0].update(axis=[0.0, -0.0, 0]),
    "bodies.0.pieces.0.ball": lambda d: d["bodies"][0]["pieces"][0].update(ball=-1e-3),
    "limits": lambda d: d.update(limits=[]),
    "limits.0.velocity": lambda d: d["limits"][0].update(velocity=[]),
    "limits.0.acceleration": lambda d: d["limits"][0].update(acceleration=[]),
    "required.lag": lambda d: d["required"].update(lag=[]),
    "phases": lambda d: d.update(phases=[]),
    "arms": lambda d: d.update(arms=[]),
    "arms.0.time": lambda d: d["arms"][0].update(time=[], q=[], qd=[], qdd=[]),
    "arms.0.q.1": lambda d: d["arms"][0]["q"].__setitem__(1, []),
    "bodies.0.pieces.0.triangles.0": lambda d: d["bodies"][0]["pieces"][0].update(triangles=[[0, 1]]),
}


@pytest.mark.parametrize("where", CHANGES)
def test_a_value_of_another_form_is_refused_with_its_place(where: str) -> None:
    document = bundle(NAMES)
    CHANGES[where](document)
    with pytest.raises(ValueError, match=rf"^{where.replace('.', '[.]')}: "):
        shown(document)


def test_a_bundle_of_the_former_form_is_refused_by_the_name_of_its_form() -> None:
    document = bundle(NAMES)
    document["schema"] = "assur-bundle/1"
    for each in document["bodies"]:
        each["hollow"] = False
        for piece in each["pieces"]:
            del piece["triangles"]
    with pytest.raises(ValueError, match=r'^schema: "assur-bundle/3" was expected$'):
        shown(document)


def backwards(*path: str | int) -> Callable[[Document], Any]:
    """Gives a range, or the second of its ends, in a bundle: its ends change places, and differ."""

    def change(document: Document) -> None:
        *above, last = path
        part: Any = document
        for key in above:
            part = part[key]
        if last == 1:
            part[0], part[1] = 1.0, -1.0
        else:
            first = {"t1": "t0", "s1": "s0", "high": "low"}[str(last)]
            part[first], part[last] = part[last] + 1.0, part[last]

    return change


EMPTY: dict[tuple[str | int, ...], str] = {
    ("frames", 0, "shift", 1): NAMES,
    ("frames", 1, "shift", 1): "demo",
    ("phases", 2, "shares", 1, 1): "demo",
    ("phases", 1, "t1"): NAMES,
    ("limits", 0, "t1"): NAMES,
    ("points", 1, "t1"): NAMES,
    ("rates", 0, "t1"): "belt-to-belt",
    ("axes", 0, "t1"): "hose-on-gripper",
    ("axes", 0, "high"): "hose-on-gripper",
    ("rows", 3, "t1"): NAMES,
    ("rows", 3, "s1"): NAMES,
}


@pytest.mark.parametrize("path", EMPTY, ids=lambda path: ".".join(map(str, path)))
def test_a_range_with_nothing_in_it_is_refused_with_its_place(path: tuple[str | int, ...]) -> None:
    """Nothing would be claimed for the times, the shifts or the shares in it."""
    document = bundle(EMPTY[path])
    backwards(*path)(document)
    where = r"\.".join(map(str, path))
    with pytest.raises(ValueError, match=rf"^{where}: .* is less than .*, with which its range begins$"):
        shown(document)


@pytest.mark.parametrize("key", sorted(bundle("standard-cycle")))
def test_a_missing_part_is_refused_with_its_name(key: str) -> None:
    document = bundle(NAMES)
    del document[key]
    with pytest.raises(ValueError, match=f'"{key}" is a required property'):
        shown(document)


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999", "1e301"])
def test_what_is_no_finite_number_is_refused(number: str) -> None:
    text = json.dumps(bundle(NAMES)).replace('"travel": ', f'"travel": {number}, "x": ', 1)
    with pytest.raises(ValueError, match=r"^required" if number.startswith("1e") else f"^{number} is not allowed"):
        prove(text.encode())


@pytest.mark.parametrize("sign", ["", "-"])
def test_a_whole_number_that_no_double_may_hold_is_refused(sign: str) -> None:
    text = json.dumps(bundle(NAMES)).replace('"travel": ', '"travel": %s, "x": ', 1)
    number = f"{sign}9007199254740993"  # 2^53 + 1
    with pytest.raises(
        ValueError, match=f"^{number} is not allowed; finite numbers are, whole ones of up to 15 digits$"
    ):
        prove((text % number).encode())
    with pytest.raises(ValueError, match=r"^required"):
        prove((text % number[:-1]).encode())  # its length is right; what the form says comes next


OTHERS: dict[str, Callable[[Document], Any]] = {
    "a seat that is not there": lambda d: d["phases"][0]["seats"].__setitem__(0, 999),
    "a phase with a seat less": lambda d: d["phases"][0]["seats"].pop(),
    "a frame that is not there": lambda d: d["seats"][-1].update(frame=77),
    "a body on nothing": lambda d: d["seats"][-1].update(frame=-1),
    "a link that is not there": lambda d: d["seats"][0].update(link=17),
    "a piece that is not there": lambda d: d["rows"][0]["pieces"].__setitem__(0, 5),
    "a body that is not there": lambda d: d["rows"][0]["bodies"].__setitem__(0, 500),
    "an arm that is not there": lambda d: d["frames"][0].update(arm=4),
    "a parent that comes later": lambda d: d["arms"][0]["links"][1].update(parent=3),
    "a coupler without a loop": lambda d: d["arms"][0]["links"][1].update(coupler=0),
    "a tilt without a roll": lambda d: d["arms"][0]["links"][1].update(pitch=d["arms"][0]["links"][1]["yaw"]),
    "a joint that is not there": lambda d: d["arms"][0]["links"][3]["slide"].update(joint=9),
    "a share of a joint less": lambda d: d["arms"][0]["links"][1]["yaw"]["joints"].pop(),
    "a joint less": lambda d: d["arms"][0]["q"][0].pop(),
    "a knot less": lambda d: d["arms"][0]["qd"].pop(),
    "knots that go back in time": lambda d: d["arms"][0]["time"].__setitem__(1, -1.0),
    "a limit beyond": lambda d: d["limits"][0].update(lower=[*d["limits"][0]["lower"], 9.0]),
    "a limit less": lambda d: d["limits"][0]["lower"].pop(),
    "a lag less": lambda d: d["required"].update(lag=[0.1]),
    "what is not known of a body less": lambda d: d["phases"][0]["unknown"].pop(),
    "a rate without a yaw": lambda d: d["points"][0].update(yaw=[], rates=[1.0, 1.0]),
    "edges that do not increase": lambda d: d["frames"][0].update(edges=[0.0, 0.0], acceleration=[[[], [], [], []]]),
    "a triangle of a corner that is not there": lambda d: d["bodies"][0]["pieces"][0].update(triangles=[[0, 1, 99]]),
    "edges without a piece": lambda d: d["frames"][0].update(edges=[0.0, 1.0], acceleration=[]),
    "a tool of no SCARA that is shifted": lambda d: (
        d["arms"][0]["links"][2].update(parent=0),
        d["frames"][0].update(unknown=[{"direction": [1.0, 0.0, 0.0], "amount": 1.0, "growth": 0.0, "shared": True}]),
        [phase.update(shares=[[0.0, 1.0]]) for phase in d["phases"]],
    ),
}


@pytest.mark.parametrize("what", OTHERS)
def test_values_that_do_not_fit_together_are_refused(what: str) -> None:
    document = bundle(NAMES)
    OTHERS[what](document)
    with pytest.raises(ValueError, match=r"\w{3}"):
        shown(document)


def test_more_work_than_is_allowed_is_not_done(monkeypatch: pytest.MonkeyPatch) -> None:
    for work in (0, 100, 2000):
        monkeypatch.setattr(prover, "WORK", work)
        right, lines = shown(bundle("demo"))
        assert (right, lines) == (False, [f"more work than {work} intervals, pairs and pieces of motions"])


def test_the_precision_of_others_is_left_as_it_was() -> None:
    from flint import ctx

    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = 77, 9
    shown(bundle(NAMES))
    with pytest.raises(ValueError, match=r"."):
        prove(b"{}")
    assert (ctx.prec, ctx.cap) == (77, 9)
    ctx.prec, ctx.cap = before


def test_a_key_that_is_there_twice_is_refused() -> None:
    with pytest.raises(ValueError, match="twice: travel"):
        prove(b'{"required": {"travel": 0.5, "travel": 0.008}}')

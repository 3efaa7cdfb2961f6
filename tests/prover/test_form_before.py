"""Bundles of the form before are read as they were meant."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from tests.prover.bundles import Document, bundle, shown

NEW = ("rates", "sums", "guides", "distances", "errors", "gap_rows")


def before(name: str) -> Document:
    """A bundle with what the form before has of it."""
    document = {key: value for key, value in bundle(name).items() if key not in NEW}
    document["pulls"] = []
    for own in bundle(name)["rates"]:
        if own["order"] == 2 and own["least"] == 0.0:
            pull = {key: own[key] for key in ("t0", "t1", "name", "link")}
            document["pulls"].append({**pull, "tool": [*own["point"], 0.5], "most": own["most"], "share": 1e-6})
    document["axes"] = [own for own in document["axes"] if not own["place"] and own["other"] < 0]
    for part, keys in (
        ("frames", ("period", "step")),
        ("axes", ("place", "other")),
        ("required", ("nearest", "placed")),
    ):
        for each in document[part] if part != "required" else [document[part]]:
            for key in keys:
                del each[key]
    return {**document, "schema": "assur-bundle/2"}


@pytest.mark.parametrize("name", ["standard-cycle", "belt-to-belt", "rv-m1"])
def test_a_bundle_of_the_form_before_claims_what_it_claimed(name: str) -> None:
    right, told = shown(before(name))
    assert right
    rows = before(name)["pulls"]
    assert told["times and intervals at which the acceleration of a point is bounded"] == len(rows)
    for row in rows:
        allowed = Fraction(row["most"]) * (1 + Fraction(row["share"]))
        assert allowed * (1 - Fraction(1, 2**51)) <= Fraction(told["greatest acceleration, m/s²"]) <= allowed
    assert told["second distances of the robot's bodies and of parts that were put down, m"] == ["not claimed"] * 2


def test_a_pull_of_the_form_before_is_shown_or_refused() -> None:
    document = before("belt-to-belt")
    assert document["pulls"]
    for share, right in ((0.0, False), (4.0, True)):
        document["pulls"][0].update(most=0.2 * bundle("belt-to-belt")["rates"][0]["most"], share=share)
        assert shown(document)[0] is right


OTHER: dict[str, Callable[[Document], object]] = {
    "a pull without its share": lambda d: d["pulls"][0].pop("share"),
    "a pull with a limit that is no number": lambda d: d["pulls"][0].update(most="much"),
    "a pull with something more": lambda d: d["pulls"][0].update(frame2=0),
    "no pulls": lambda d: d.pop("pulls"),
    "pulls that are a number": lambda d: d.update(pulls=3),
    "no frames": lambda d: d.pop("frames"),
    "a frame that is a list": lambda d: d["frames"].append([]),
    "a table that is new": lambda d: d.update(sums=[]),
    "rates": lambda d: d.update(rates=[]),
    "a frame that repeats": lambda d: d["frames"][0].update(period=1.0),
    "a second distance": lambda d: d["required"].update(nearest=0.1),
}


@pytest.mark.parametrize("what", OTHER)
def test_what_is_not_of_the_form_before_is_refused(what: str) -> None:
    document = before("belt-to-belt")
    OTHER[what](document)
    with pytest.raises(ValueError, match=r"\w{4}"):
        shown(document)

"""A Fanuc SCARA, from a catalogue at second hand. J3 counts downwards from its highest position."""

from __future__ import annotations

from assur.scenes.catalogue.entry import STANDARD_PAIRS, Axis, Entry, Number, Solid, jerk_of

CATALOGUE = "the maker's catalogue, second hand"
FULL_SPEED_S = 0.1
"""Time in which the arm is taken to reach full speed, s: neither catalogue nor manual gives an acceleration."""
GUESS = "full speed within 100 ms; the catalogue gives no acceleration"
HEIGHT = "no drawing at hand; the stroke's place on the column is a guess"
SOLIDS = "by eye from the arm's lengths; no drawing at hand"


def _axis(name: str, ends: tuple[float, float], speed: float) -> Axis:
    lifting = name == "j3"
    length, rate = ("mm", "mm_s") if lifting else ("deg", "deg_s")
    limit = Number(speed / FULL_SPEED_S, rate + "2", "estimated", GUESS)
    return Axis(
        name=name,
        kind="prismatic" if lifting else "revolute",
        lower=Number(ends[0], length, "third_party", CATALOGUE),
        upper=Number(ends[1], length, "third_party", CATALOGUE),
        velocity=Number(speed, rate, "third_party", CATALOGUE),
        acceleration=limit,
        jerk=jerk_of(limit),
        sign=-1 if lifting else 1,
        zero=Number(250.0, "mm", "estimated", HEIGHT) if lifting else None,
    )


SR_3IA = Entry(
    model="fanuc-sr-3ia",
    title="Fanuc SR-3iA",
    l1=Number(200.0, "mm", "third_party", CATALOGUE),
    l2=Number(200.0, "mm", "third_party", CATALOGUE),
    axes=(
        _axis("j1", (-142.0, 142.0), 720.0),
        _axis("j2", (-145.0, 145.0), 780.0),
        _axis("j3", (0.0, 200.0), 1800.0),
        _axis("j4", (-720.0, 720.0), 3000.0),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (70.0, 175.0), (0.0, 0.0, 87.5)),
        Solid("link-1", "link1", "box", (320.0, 100.0, 70.0), (100.0, 0.0, 220.0)),
        Solid("link-2", "link2", "box", (320.0, 100.0, 160.0), (100.0, 0.0, 365.0)),
        Solid("shaft", "quill", "cylinder", (8.0, 380.0), (0.0, 0.0, 190.0)),
    ),
    solids_status="estimated",
    solids_source=SOLIDS,
    self_pairs=STANDARD_PAIRS,
    payload=Number(3.0, "kg", "third_party", "the digit in the model's name, kg"),
)

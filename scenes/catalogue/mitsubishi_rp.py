"""A Mitsubishi five-bar, the RP-5AH. No data sheet is at hand: lengths are second hand, everything else is estimated.

Its mounting face is the table's, cranks and couplers turn above it, and J3 is the height of the flange above that face.
"""

from __future__ import annotations

from assur.scenes.catalogue.entry import Axis, FiveBarEntry, LinkName, Number, Solid, jerk_of

LENGTHS = "widely quoted; no data sheet at hand"
DISPUTED = "260 here and 160 elsewhere; no data sheet at hand"
GUESS = "of the order of small parallel SCARAs; no data sheet at hand"
FULL_SPEED_S = 0.08
"""Time in which the arm is taken to reach full speed, s."""


def _axis(name: str, ends: tuple[float, float], speed: float) -> Axis:
    lifting = name == "j3"
    length, rate = ("mm", "mm_s") if lifting else ("deg", "deg_s")
    limit = Number(speed / FULL_SPEED_S, rate + "2", "estimated", f"full speed within 80 ms; {GUESS}")
    return Axis(
        name=name,
        kind="prismatic" if lifting else "revolute",
        lower=Number(ends[0], length, "estimated", GUESS),
        upper=Number(ends[1], length, "estimated", GUESS),
        velocity=Number(speed, rate, "estimated", GUESS),
        acceleration=limit,
        jerk=jerk_of(limit),
    )


PAIRS: tuple[tuple[LinkName, LinkName], ...] = (
    ("base", "distal-left"),
    ("base", "distal-right"),
    ("base", "quill"),
    ("base", "flange"),
    ("proximal-left", "proximal-right"),
    ("proximal-left", "distal-right"),
    ("proximal-right", "distal-left"),
    ("distal-left", "distal-right"),
    ("proximal-left", "quill"),
    ("proximal-right", "quill"),
    ("proximal-left", "flange"),
    ("proximal-right", "flange"),
    ("distal-left", "flange"),
    ("distal-right", "flange"),
)
"""Links that can meet. Left out are those that are joined (base with cranks, crank with its coupler, quill with flange)
and the couplers with the quill that runs through both. The couplers themselves lie one above the other."""

RP_5AH = FiveBarEntry(
    model="mitsubishi-rp-5ah",
    title="Mitsubishi Electric RP-5AH, a five-bar (parallel SCARA)",
    separation=Number(85.0, "mm", "third_party", LENGTHS),
    l1=Number(200.0, "mm", "third_party", LENGTHS),
    l2=Number(260.0, "mm", "disputed", DISPUTED),
    axes=(
        _axis("j1", (-50.0, 190.0), 432.0),
        _axis("j2", (-190.0, 50.0), 432.0),
        _axis("j3", (60.0, 160.0), 960.0),
        _axis("j4", (-200.0, 200.0), 1330.0),
    ),
    solids=(
        Solid("motors", "base", "box", (100.0, 170.0, 140.0), (0.0, 0.0, 70.0)),
        Solid("crank-left", "proximal-left", "box", (240.0, 40.0, 40.0), (100.0, 0.0, 180.0)),
        Solid("crank-right", "proximal-right", "box", (240.0, 40.0, 40.0), (100.0, 0.0, 180.0)),
        Solid("coupler-left", "distal-left", "box", (300.0, 36.0, 25.0), (130.0, 0.0, 232.5)),
        Solid("coupler-right", "distal-right", "box", (300.0, 36.0, 25.0), (130.0, 0.0, 277.5)),
        Solid("shaft", "quill", "cylinder", (8.0, 250.0), (0.0, 0.0, 125.0)),
    ),
    solids_status="estimated",
    solids_source="by eye from pictures; no drawing at hand",
    self_pairs=PAIRS,
    payload=Number(5.0, "kg", "third_party", "the digit in the model's name, kg"),
)

"""Arms whose kinematics the sources print without any number: ours are estimates of what such machines are like."""

from __future__ import annotations

from typing import Literal

from assur.scenes.catalogue.entry import STANDARD_PAIRS, TILTING_PAIRS, Axis, Entry, Number, Solid, Status, jerk_of

OLIER = "Olier, kinematics of the four-axis SCARA"
CLOSED_FORMS = "closed-form inverse kinematics, slides: elbow arm and polar arm"
UNSAID = "the source gives no numbers"
QUOTED = "widely quoted for the Mitsubishi RV-M1, unsourced"
GUESS: Status = "estimated"


def _axis(
    name: str,
    kind: Literal["revolute", "prismatic"],
    ends: tuple[float, float],
    rates: tuple[float, float],
    sign: Literal[1, -1] = 1,
    zero: float | None = None,
) -> Axis:
    length, rate = ("mm", "mm_s") if kind == "prismatic" else ("deg", "deg_s")
    limit = Number(rates[1], rate + "2", GUESS, UNSAID)
    return Axis(
        name=name,
        kind=kind,
        lower=Number(ends[0], length, GUESS, UNSAID),
        upper=Number(ends[1], length, GUESS, UNSAID),
        velocity=Number(rates[0], rate, GUESS, UNSAID),
        acceleration=limit,
        jerk=jerk_of(limit),
        sign=sign,
        zero=None if zero is None else Number(zero, "mm", GUESS, UNSAID),
    )


OLIER_SCARA = Entry(
    model="olier-scara",
    title="Four-axis SCARA in the Denavit-Hartenberg frames of Olier: z of the tool points down",
    l1=Number(250.0, "mm", GUESS, UNSAID),
    l2=Number(200.0, "mm", GUESS, UNSAID),
    axes=(
        _axis("theta1", "revolute", (-165.0, 165.0), (360.0, 3600.0)),
        _axis("theta2", "revolute", (-145.0, 145.0), (500.0, 5000.0)),
        _axis("d3", "prismatic", (0.0, 180.0), (1200.0, 12000.0), sign=-1, zero=300.0),
        _axis("theta4", "revolute", (-360.0, 360.0), (1200.0, 12000.0), sign=-1),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (60.0, 300.0), (0.0, 0.0, 150.0)),
        Solid("link-1", "link1", "box", (360.0, 90.0, 50.0), (125.0, 0.0, 330.0)),
        Solid("link-2", "link2", "box", (300.0, 90.0, 80.0), (100.0, 0.0, 400.0)),
        Solid("shaft", "quill", "cylinder", (8.0, 360.0), (0.0, 0.0, 180.0)),
    ),
    solids_status=GUESS,
    solids_source="the source draws frames",
    self_pairs=STANDARD_PAIRS,
    tool_frame="z_down",
)

LAB_SCARA = Entry(
    model="lab-scara",
    title="A laboratory arm with the axis order R-P-R-R: a turning column, a carriage on it that carries both links",
    l1=Number(220.0, "mm", GUESS, UNSAID),
    l2=Number(200.0, "mm", GUESS, UNSAID),
    axes=(
        _axis("j1", "revolute", (-170.0, 170.0), (240.0, 1800.0)),
        _axis("j2", "prismatic", (60.0, 420.0), (500.0, 3000.0)),
        _axis("j3", "revolute", (-150.0, 150.0), (400.0, 3000.0)),
        _axis("j4", "revolute", (-360.0, 360.0), (600.0, 5000.0)),
    ),
    solids=(
        Solid("column", "base", "cylinder", (35.0, 600.0), (0.0, 0.0, 300.0)),
        Solid("link-1", "link1", "box", (250.0, 80.0, 40.0), (165.0, 0.0, 70.0)),
        Solid("link-2", "link2", "box", (250.0, 60.0, 30.0), (100.0, 0.0, 30.0)),
        Solid("wrist", "quill", "cylinder", (20.0, 20.0), (0.0, 0.0, 10.0)),
    ),
    solids_status=GUESS,
    solids_source="by eye",
    self_pairs=STANDARD_PAIRS,
)

ELBOW_ARM = Entry(
    model="elbow-arm",
    title="Elbow arm with three axes; upper arm 250 mm, forearm and hand 160 + 72 mm",
    family="elbow_arm",
    height=Number(300.0, "mm", "third_party", QUOTED),
    l1=Number(250.0, "mm", "third_party", QUOTED),
    l2=Number(232.0, "mm", "third_party", QUOTED + ": 160 + 72, hand and forearm in one"),
    axes=(
        _axis("theta1", "revolute", (-150.0, 150.0), (180.0, 1500.0)),
        _axis("theta2", "revolute", (-30.0, 120.0), (150.0, 1200.0)),
        _axis("theta3", "revolute", (-140.0, 0.0), (200.0, 1800.0)),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (60.0, 220.0), (0.0, 0.0, 110.0)),
        Solid("turret", "link1", "box", (110.0, 120.0, 90.0), (0.0, 0.0, -30.0)),
        Solid("upper-arm", "link2", "box", (300.0, 80.0, 60.0), (125.0, 0.0, 0.0)),
        Solid("forearm", "link3", "box", (190.0, 60.0, 50.0), (65.0, 0.0, 0.0)),
        Solid("hand", "flange", "box", (70.0, 24.0, 24.0), (-36.0, 0.0, 0.0)),
    ),
    solids_status=GUESS,
    solids_source="by eye from the lengths",
    self_pairs=TILTING_PAIRS,
)

POLAR_ARM = Entry(
    model="polar-arm",
    title="Polar arm with three axes: it turns, tilts and reaches",
    family="polar_arm",
    height=Number(400.0, "mm", GUESS, CLOSED_FORMS + "; it gives no numbers"),
    axes=(
        _axis("theta1", "revolute", (-150.0, 150.0), (150.0, 1000.0)),
        _axis("psi", "revolute", (-25.0, 60.0), (120.0, 900.0)),
        _axis("d3", "prismatic", (350.0, 650.0), (900.0, 6000.0)),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (70.0, 300.0), (0.0, 0.0, 150.0)),
        Solid("turret", "link1", "box", (120.0, 140.0, 30.0), (0.0, 0.0, -80.0)),
        Solid("guide", "link2", "box", (380.0, 100.0, 100.0), (90.0, 0.0, 0.0)),
        Solid("ram", "link3", "box", (330.0, 40.0, 40.0), (-165.0, 0.0, 0.0)),
    ),
    solids_status=GUESS,
    solids_source="by eye",
    self_pairs=(("base", "link3"), ("base", "flange"), ("link1", "flange")),
)

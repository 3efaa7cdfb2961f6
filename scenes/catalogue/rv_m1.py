"""The Mitsubishi RV-M1 (Movemaster) of source 003. No maker's document is at hand: every number is quoted or ours."""

from __future__ import annotations

from assur.scenes.catalogue.entry import WRIST_PAIRS, Axis, Entry, Number, Solid, jerk_of

QUOTED = "widely quoted for the Mitsubishi RV-M1, unsourced"
ENDS = "only the width of the range is quoted, unsourced; where it lies is ours"
UNSAID = "nothing is quoted"


def _axis(name: str, ends: tuple[float, float], speed: float) -> Axis:
    """A joint that reaches its speed in 0.2 s, which is ours: waist, shoulder, elbow, pitch and roll of the wrist."""
    limit = Number(5.0 * speed, "deg_s2", "estimated", UNSAID)
    return Axis(
        name=name,
        kind="revolute",
        lower=Number(ends[0], "deg", "estimated", ENDS),
        upper=Number(ends[1], "deg", "estimated", ENDS),
        velocity=Number(speed, "deg_s", "third_party", QUOTED),
        acceleration=limit,
        jerk=jerk_of(limit),
    )


RV_M1 = Entry(
    model="mitsubishi-rv-m1",
    title="Mitsubishi RV-M1, five axes; upper arm 250 mm, forearm 160 mm, hand 72 mm from its pitch axis to the flange",
    family="five_axis_arm",
    height=Number(300.0, "mm", "third_party", QUOTED),
    l1=Number(250.0, "mm", "third_party", QUOTED),
    l2=Number(160.0, "mm", "third_party", QUOTED),
    l3=Number(72.0, "mm", "third_party", QUOTED + "; without a tool"),
    axes=(
        _axis("j1", (-150.0, 150.0), 120.0),
        _axis("j2", (-30.0, 100.0), 72.0),
        _axis("j3", (-110.0, 0.0), 109.0),
        _axis("j4", (-90.0, 90.0), 100.0),
        _axis("j5", (-180.0, 180.0), 163.0),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (75.0, 220.0), (0.0, 0.0, 110.0)),
        Solid("turret", "link1", "box", (110.0, 120.0, 90.0), (0.0, 0.0, -30.0)),
        Solid("upper-arm", "link2", "box", (300.0, 80.0, 60.0), (125.0, 0.0, 0.0)),
        Solid("forearm", "link3", "box", (170.0, 60.0, 50.0), (65.0, 0.0, 0.0)),
        Solid("hand", "link4", "box", (60.0, 44.0, 40.0), (20.0, 0.0, 0.0)),
        Solid("hand-flange", "flange", "box", (20.0, 36.0, 36.0), (-11.0, 0.0, 0.0)),
    ),
    solids_status="estimated",
    solids_source="by eye from the lengths",
    self_pairs=WRIST_PAIRS,
    payload=Number(1.2, "kg", "third_party", QUOTED),
)

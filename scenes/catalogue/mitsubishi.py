"""Two Mitsubishi SCARAs, from the configuration of the maker's ROS 2 driver.

J3 is an absolute height: of the flange above the mounting face, up positive.
"""

from __future__ import annotations

from assur.scenes.catalogue.entry import STANDARD_PAIRS, Axis, Entry, Number, Solid, Status, jerk_of

DRIVER = "the maker's ROS 2 driver, description of the arm"
CONFIG = "the maker's ROS 2 driver, joint limits file; 18 times the speed on every axis, a placeholder, hardly dynamics"
SOLIDS = "by eye from the arm's heights; the maker publishes drawings, not solids"
NAMED = "the digit in the model's name, kg"


def _axis(name: str, ends: tuple[float, float], speed: float, acceleration: float) -> Axis:
    lifting = name == "j3"
    length, rate = ("mm", "mm_s") if lifting else ("deg", "deg_s")
    limit = Number(acceleration, "m_s2" if lifting else "rad_s2", "vendor_config", CONFIG)
    vendor: Status = "vendor"
    return Axis(
        name=name,
        kind="prismatic" if lifting else "revolute",
        lower=Number(ends[0], length, vendor, DRIVER),
        upper=Number(ends[1], length, vendor, DRIVER),
        velocity=Number(speed, rate, vendor, DRIVER),
        acceleration=limit,
        jerk=jerk_of(limit),
    )


RH_6FRH5520 = Entry(
    model="mitsubishi-rh-6frh5520",
    title="Mitsubishi Electric RH-6FRH5520",
    l1=Number(325.0, "mm", "vendor", DRIVER),
    l2=Number(225.0, "mm", "vendor", DRIVER),
    axes=(
        _axis("j1", (-170.0, 170.0), 400.0, 125.64),
        _axis("j2", (-145.0, 145.0), 670.0, 210.42),
        _axis("j3", (133.0, 333.0), 2400.0, 43.02),
        _axis("j4", (-360.0, 360.0), 2500.0, 785.34),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (95.0, 265.0), (0.0, 0.0, 132.5)),
        Solid("link-1", "link1", "box", (485.0, 140.0, 90.0), (162.5, 0.0, 325.0)),
        Solid("link-2", "link2", "box", (385.0, 140.0, 200.0), (112.5, 0.0, 485.0)),
        Solid("shaft", "quill", "cylinder", (12.5, 420.0), (0.0, 0.0, 210.0)),
    ),
    solids_status="estimated",
    solids_source=SOLIDS,
    self_pairs=STANDARD_PAIRS,
    payload=Number(6.0, "kg", "third_party", NAMED),
)

RH_6CRH6020 = Entry(
    model="mitsubishi-rh-6crh6020",
    title="Mitsubishi Electric RH-6CRH6020",
    l1=Number(325.0, "mm", "vendor", DRIVER),
    l2=Number(275.0, "mm", "vendor", DRIVER),
    axes=(
        _axis("j1", (-132.0, 132.0), 420.0, 131.94),
        _axis("j2", (-150.0, 150.0), 720.0, 226.08),
        _axis("j3", (-51.0, 149.0), 1100.0, 19.8),
        _axis("j4", (-360.0, 360.0), 2500.0, 785.34),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (90.0, 95.0), (0.0, 0.0, 47.5)),
        Solid("link-1", "link1", "box", (475.0, 130.0, 80.0), (162.5, 0.0, 145.0)),
        Solid("link-2", "link2", "box", (425.0, 130.0, 190.0), (137.5, 0.0, 290.0)),
        Solid("shaft", "quill", "cylinder", (10.0, 400.0), (0.0, 0.0, 200.0)),
    ),
    solids_status="estimated",
    solids_source=SOLIDS,
    self_pairs=STANDARD_PAIRS,
    payload=Number(6.0, "kg", "third_party", NAMED),
)

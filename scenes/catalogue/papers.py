"""The two SCARAs of the sources, and the robot of the benchmark problems. They exist on paper only."""

from __future__ import annotations

import math
from typing import Literal

from assur.scenes.catalogue.entry import STANDARD_PAIRS, Axis, Entry, Number, Solid, Status, jerk_of

OVIEDO = "Noriega, García, Muñiz, inverse kinematics of a SCARA by Assur groups, section 4"
FIUBA = "Nastasi, trajectory generator for a SCARA, 2019, section 1"
UNSAID = "the paper gives no limits"
PROBLEMS = "benchmarks/problems"


def _paper_axis(
    name: str, ends: tuple[float, float], speed: float, acceleration: float, sign: Literal[1, -1] = 1
) -> Axis:
    lifting = name in ("l3", "d3")
    length, rate = ("mm", "mm_s") if lifting else ("deg", "deg_s")
    guess: Status = "estimated"
    limit = Number(acceleration, rate + "2", guess, UNSAID)
    return Axis(
        name=name,
        kind="prismatic" if lifting else "revolute",
        lower=Number(ends[0], length, guess, UNSAID),
        upper=Number(ends[1], length, guess, UNSAID),
        velocity=Number(speed, rate, guess, UNSAID),
        acceleration=limit,
        jerk=jerk_of(limit),
        sign=sign,
        zero=Number(150.0, "mm", "defined", OVIEDO + ": l_OA") if name == "l3" else None,
    )


OVIEDO_SCARA = Entry(
    model="oviedo-scara",
    title="SCARA of the University of Oviedo's paper, three axes",
    l1=Number(80.0, "mm", "defined", OVIEDO),
    l2=Number(50.0, "mm", "defined", OVIEDO),
    axes=(
        _paper_axis("theta1", (-170.0, 170.0), 400.0, 4000.0),
        _paper_axis("theta2", (-150.0, 150.0), 600.0, 6000.0, sign=-1),
        _paper_axis("l3", (0.0, 150.0), 1000.0, 10000.0, sign=-1),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (12.0, 130.0), (0.0, 0.0, 65.0)),
        Solid("link-1", "link1", "box", (104.0, 22.0, 12.0), (40.0, 0.0, 143.0)),
        Solid("link-2", "link2", "box", (74.0, 22.0, 12.0), (25.0, 0.0, 160.0)),
        Solid("shaft", "quill", "cylinder", (3.0, 180.0), (0.0, 0.0, 90.0)),
    ),
    solids_status="estimated",
    solids_source="the paper draws lines",
    self_pairs=STANDARD_PAIRS,
)

FIUBA_SCARA = Entry(
    model="fiuba-scara",
    title="SCARA of the University of Buenos Aires' exercise; its base origin is at the height of the shoulder",
    l1=Number(200.0, "mm", "defined", FIUBA),
    l2=Number(200.0, "mm", "defined", FIUBA),
    axes=(
        _paper_axis("theta1", (-170.0, 170.0), 300.0, 3000.0),
        _paper_axis("theta2", (-150.0, 150.0), 300.0, 3000.0),
        _paper_axis("d3", (-250.0, -20.0), 1000.0, 10000.0),
        _paper_axis("theta4", (-360.0, 360.0), 600.0, 6000.0),
    ),
    solids=(
        Solid("base-column", "base", "cylinder", (40.0, 300.0), (0.0, 0.0, -200.0)),
        Solid("link-1", "link1", "box", (290.0, 80.0, 40.0), (100.0, 0.0, -22.0)),
        Solid("link-2", "link2", "box", (290.0, 80.0, 60.0), (100.0, 0.0, 32.0)),
        Solid("shaft", "quill", "cylinder", (8.0, 320.0), (0.0, 0.0, 160.0)),
    ),
    solids_status="estimated",
    solids_source="the paper draws lines",
    self_pairs=STANDARD_PAIRS,
)


def _problem_axis(name: str, ends: tuple[float, float], rates: tuple[float, float, float]) -> Axis:
    lifting = name == "z"
    unit = "m" if lifting else "rad"
    lower, upper, velocity, acceleration, jerk = (
        Number(value, unit + suffix, "defined", PROBLEMS)
        for value, suffix in zip((*ends, *rates), ("", "", "_s", "_s2", "_s3"), strict=True)
    )
    return Axis(name, "prismatic" if lifting else "revolute", lower, upper, velocity, acceleration, jerk)


BENCHMARK_SCARA = Entry(
    model="benchmark-scara",
    title="The robot of the benchmark problems; its flange is the tip, its column is hit by nothing by construction",
    l1=Number(0.325, "m", "defined", PROBLEMS),
    l2=Number(0.275, "m", "defined", PROBLEMS),
    axes=(
        _problem_axis("q1", (-math.radians(132), math.radians(132)), (7.8, 50.0, 1000.0)),
        _problem_axis("q2", (-math.radians(150), math.radians(150)), (9.4, 80.0, 1600.0)),
        _problem_axis("z", (0.05, 0.25), (2.0, 25.0, 500.0)),
        _problem_axis("q4", (-2 * math.pi, 2 * math.pi), (40.0, 300.0, 6000.0)),
    ),
    solids=(
        Solid("link-1", "link1", "box", (405.0, 80.0, 60.0), (162.5, 0.0, 300.0)),
        Solid("link-2", "link2", "box", (355.0, 80.0, 60.0), (137.5, 0.0, 360.0)),
        Solid("shaft", "quill", "cylinder", (12.0, 310.0), (0.0, 0.0, 155.0)),
    ),
    solids_status="defined",
    solids_source=PROBLEMS,
    self_pairs=(),
)

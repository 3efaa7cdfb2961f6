"""What was imported from a URDF, as tables for people."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from rich.table import Table

from assur.api.cli.console_report import row, table

CALLED = {"scara": "SCARA", "elbow_arm": "elbow arm", "five_axis_arm": "five-axis arm"}


def everything(report: dict[str, Any]) -> Iterator[Table | str]:
    """The robot, its joints, its covers, and what is to be known of them."""
    order = f", axis order {report['axis_order']}" if report["axis_order"] else ""
    yield f"{report['name']}: {CALLED[report['family']]}{order}, from link {report['base']} to link {report['flange']}"
    yield ""
    made = table("joint", "in the URDF", ">sign", ">zero", "unit")
    for joint in report["joints"]:
        turns = joint["unit"] == "rad"
        zero = math.degrees(joint["zero"]) if turns else 1e3 * joint["zero"]
        unit = "deg" if turns else "mm"
        row(made, joint["name"], joint["urdf"], f"{joint['sign']:+d}", f"{zero:.6g}", unit)
    yield from (made, "")
    yield (
        f"flange at {report['states']} random states: at most {1e6 * report['apart_m']:.2g} um and "
        f"{1e6 * report['apart_rad']:.2g} urad from the URDF's"
    )
    if report["flange_turn_deg"] is not None:
        roll, pitch, yaw = report["flange_turn_deg"]
        yield f"the URDF's flange frame is turned in ours by roll {roll:g}, pitch {pitch:g}, yaw {yaw:g} deg"
    if report["covers"]:
        covers = table("mesh of", ">hulls", ">furthest out of the mesh")
        for cover in report["covers"]:
            row(covers, cover["of"], cover["hulls"], f"{1e3 * cover['excess_m']:.1f} mm")
        yield from ("", covers)
    pairs = ", ".join("-".join(pair) for pair in report["self_pairs"])
    yield from ("", f"{report['bodies']} bodies; pairs of links that are kept apart: {pairs or 'none'}")
    yield from (f"warning: {warning}" for warning in report["warnings"])
    yield from report["remarks"]
    if report["unused"]:
        yield f"no plan depends on what else the URDF has: {', '.join(report['unused'])}"
    yield f"written: {report['file']}"

"""The commands `assur robots`: the list and single robots, import from a URDF, drawings."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from rich.table import Table

from assur.api.cli.border import BAD_INPUT, RIGHT, AsJson, answered, bordered, say, show, writable
from assur.api.cli.console_report import row, rows, table, working
from assur.api.cli.inputs import pairs_in, robot_named
from assur.planner.errors import InputError
from assur.planner.report.number_format import SHOWN_AS, number
from assur.scenes import requests
from assur.scenes.schema.stated import Status

LISTING = "list"
"""The command that is meant where none is named."""


class _Group(typer.core.TyperGroup):
    """A group whose first word may be a robot: `assur robots fanuc-sr-3ia` is `assur robots list fanuc-sr-3ia`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        if args[:1] != ["--help"] and (not args or args[0] not in self.commands):
            args = [LISTING, *args]
        return super().parse_args(ctx, args)


app = typer.Typer(
    cls=_Group,
    help="List the shipped robots, show the numbers of one, import one from a URDF, or draw one.",
    rich_markup_mode=None,
    subcommand_metavar="[ROBOT] | COMMAND [ARGS]...",
)

Robot = Annotated[str | None, typer.Argument(help="A shipped robot's name, or a robot's file (YAML).")]


@app.command(LISTING)
@bordered
def robots(robot: Robot = None, as_json: AsJson = False) -> int:
    """List the shipped robots, or show every number of one ROBOT with its status and source."""
    listed = requests.robots() if robot is None else [robot_named(robot).listed()]

    def words() -> Iterator[Table | str]:
        yield from (catalogue(listed), "", LEGEND)
        if robot is not None:
            yield from ("", sources(listed[0]))

    return answered({"robots": listed}, words, as_json=as_json)


@app.command("import")
@bordered
def import_(
    file: Annotated[Path, typer.Argument(help="A URDF, or a xacro file (extra `xacro`).", metavar="FILE.urdf")],
    joint_limits: Annotated[
        Path | None, typer.Option(help="Limits as in MoveIt's joint_limits.yaml: what a URDF has not, or has wrong.")
    ] = None,
    srdf: Annotated[Path | None, typer.Option(help="Which pairs of links never collide.")] = None,
    package: Annotated[
        list[str] | None, typer.Option(help="NAME=FOLDER of a package:// name; else it is looked for above the FILE.")
    ] = None,
    base: Annotated[str | None, typer.Option(help="The link at which the arm begins; else the root.")] = None,
    tip: Annotated[str | None, typer.Option(help="The link that is the flange; else the last one.")] = None,
    hold: Annotated[list[str] | None, typer.Option(help="JOINT=POSITION (rad, m) of a joint that stays.")] = None,
    name: Annotated[str | None, typer.Option(help="Name of the robot; else that of the FILE's <robot>.")] = None,
    status: Annotated[Status, typer.Option(help="Whose word the numbers of the files are.")] = "third_party",
    tolerance_mm: Annotated[
        float, typer.Option(min=0.5, max=200, help="How far hulls may reach out of a mesh.")
    ] = 10.0,
    hulls: Annotated[int, typer.Option(min=1, max=32, help="Hulls of one mesh at most, whatever the tolerance.")] = 8,
    open_meshes: Annotated[
        Literal["refuse", "hull"], typer.Option(help="What a mesh that is not closed is taken as.")
    ] = "refuse",
    arg: Annotated[list[str] | None, typer.Option(help="NAME=VALUE of an argument of a xacro file.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="The robot's file; else NAME.yaml. Hulls go into the same folder.")
    ] = None,
    as_json: AsJson = False,
) -> int:
    """Make a robot's file from a URDF: SCARA, elbow arm or five-axis arm.

    All that is missing or unsuitable is reported at once, with what to supply. The flange of the new robot is compared
    with the URDF's at 1000 random states; more than 1 um or 1 urad is refused.
    """
    from assur.scenes.urdf.importing import ImportOptions, import_robot, write
    from assur.scenes.urdf.refusals import ImportRefused
    from assur.scenes.urdf.solids import Covering

    writable(out, file, joint_limits, srdf)
    wanted = ImportOptions(
        file,
        joint_limits,
        srdf,
        {key: Path(value) for key, value in pairs_in("--package", package, "NAME=FOLDER").items()},
        base,
        tip,
        {key: _position(key, value) for key, value in pairs_in("--hold", hold, "JOINT=POSITION").items()},
        name,
        status,
        Covering(tolerance_mm / 1000, hulls, open_meshes == "hull"),
        pairs_in("--arg", arg, "NAME=VALUE"),
    )
    try:
        with working(f"importing {file.name}"):
            found = import_robot(wanted)
            path = out or Path(f"{found.name}.yaml")
            write(found, path)
    except ImportRefused as error:
        for lack in error.lacks:
            say(f"{error.name}: {lack}")
        return say("nothing was written", BAD_INPUT)
    report: dict[str, Any] = {"file": str(path), **found.report}
    return answered(report, partial(everything, report), as_json=as_json)


@app.command("show")
@bordered
def show_(
    robot: Annotated[str, typer.Argument(help="A shipped robot's name, or a robot's file (YAML).")],
    out: Annotated[Path | None, typer.Option("--out", help="A .png or .svg file; else NAME.png.")] = None,
) -> int:
    """Draw a ROBOT from the side and from above: its solids, its reach, the ranges of its joints."""
    from assur.experiments.robot_figure import draw_robot

    given = robot_named(robot)
    path = out or Path(f"{given.listed()['model']}.png")
    writable(path, robot)
    if path.suffix.lower() not in (".png", ".svg"):
        raise InputError("--out", str(path), "a file that ends in .png or .svg")
    with working(f"drawing {path.name}"):
        draw_robot(given.built(), path)
    show(str(path))
    return RIGHT


def _position(joint: str, text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise InputError("--hold", f"{joint}={text}", "JOINT=POSITION, a number in rad or m") from error


MARKS = {
    "vendor_config": " c",
    "third_party": " t",
    "disputed": " d",
    "measured": " m",
    "estimated": " e",
    None: " ?",
}
"""Marks behind a number that is not the maker's own word; `LEGEND` explains them."""
LEGEND = (
    "c: a maker's configuration file, perhaps a placeholder; t: second hand; d: disputed; m: measured;\n"
    "e: estimated; ?: no status is stated; no mark: the maker's own, or exact by definition\n"
    "unit: of the range; speed, acceleration and jerk are the same per s, s2 and s3\n"
    "reach: from the axis of the first joint to that of the flange, arm straight"
)
NUMBERS = ("lower", "upper", "velocity", "acceleration", "jerk", "zero", "zero_angle")
"""Numbers of a joint; the zero of a lifting one, the zero angle of one that turns."""
LOADS = ("rated_load", "max_load", "max_inertia", "acceleration_by_load")
OF_ARM = ("separation", "proximal", "distal", "l1", "l2", "l3", "height", "base_offset", *LOADS)


def catalogue(robots: list[dict[str, Any]]) -> Table:
    """The robots, a row per joint, in mm, degrees and seconds, each number marked with its status."""
    made = table("robot", ">reach", ">max load", "joint", "unit", ">range", ">speed", ">acceleration", ">jerk")
    for robot in robots:
        load = robot.get("max_load")
        of_robot = [robot["model"], _reach(robot)]
        of_robot.append("" if load is None else f"{load['value']:g} {load['unit']}{_mark(load)}")
        for joint in robot["joints"]:
            lower, upper = joint["lower"], joint["upper"]
            extent = f"{number(_shop(lower)[0], 4)} .. {number(_shop(upper)[0], 4)}{_mark(lower)}"
            rates = (joint[kind] for kind in ("velocity", "acceleration", "jerk"))
            shown = (number(_shop(rate)[0], 4) + _mark(rate) for rate in rates)
            row(made, *of_robot, joint["name"], _shop(lower)[1], extent, *shown)
            of_robot = ["", "", ""]
    return made


def sources(robot: dict[str, Any]) -> Table:
    """Every number of a robot as it was written, with its status and source."""
    made = table("of", "number", ">value", "unit", "status", "source")
    for of, name, quantity in _quantities(robot):
        value = quantity["value"]
        shown = ", ".join(f"{x:g}" for x in (value if isinstance(value, list) else [value]))
        row(made, of, name, shown, quantity["unit"], quantity["status"] or "", quantity["source"] or "")
    solids = robot["solids"]
    if solids["each"]:
        count = f"{len(solids['each'])} solids"
        row(made, robot["model"], count, "", "", solids["status"] or "", solids["source"] or "")
    return made


def _quantities(robot: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for name in OF_ARM:
        if name in robot:
            yield robot["model"], name, robot[name]
    for joint in robot["joints"]:
        for name in NUMBERS:
            if name in joint:
                yield joint["name"], name, joint[name]


def _shop(quantity: dict[str, Any]) -> tuple[float, str]:
    """A length or an angle of a robot, or its rate, in mm or degrees, and which of them; of two sides the left one."""
    name, factor = SHOWN_AS[quantity["unit"].partition("_")[0]]
    value = quantity["value"]
    return (value[0] if isinstance(value, list) else value) * factor, name


def _mark(quantity: dict[str, Any]) -> str:
    return MARKS.get(quantity["status"], "")


def _reach(robot: dict[str, Any]) -> str:
    """How far the flange comes from the shoulder: all links, or, of an arm that extends, its longest extent."""
    links = [robot[key] for key in ("proximal", "distal", "l1", "l2", "l3") if key in robot]
    links = links or [robot["joints"][-1]["upper"]]
    marks = "".join(sorted({_mark(link) for link in links}))
    return f"{number(sum(_shop(link)[0] for link in links), 4)} mm{marks}"


def everything(report: dict[str, Any]) -> Iterator[Table | str]:
    """The robot, its joints, its covers, and what is to be known of them."""
    from assur.scenes.reading.arms import CALLED

    order = f", axis order {report['axis_order']}" if report["axis_order"] else ""
    family = CALLED[report["family"]].partition(" ")[2]
    yield f"{report['name']}: {family}{order}, from link {report['base']} to link {report['flange']}"
    yield ""
    joints = []
    for joint in report["joints"]:
        unit, factor = SHOWN_AS[joint["unit"]]
        joints.append((joint["name"], joint["urdf"], f"{joint['sign']:+d}", f"{joint['zero'] * factor:.6g}", unit))
    yield from (rows(("joint", "in the URDF", ">sign", ">zero", "unit"), joints), "")
    yield (
        f"flange at {report['states']} random states: at most {1e6 * report['apart_m']:.2g} um and "
        f"{1e6 * report['apart_rad']:.2g} urad from the URDF's"
    )
    if report["flange_turn_deg"] is not None:
        roll, pitch, yaw = report["flange_turn_deg"]
        yield f"the URDF's flange frame is turned in ours by roll {roll:g}, pitch {pitch:g}, yaw {yaw:g} deg"
    if report["covers"]:
        covers = ((each["of"], each["hulls"], f"{1e3 * each['excess_m']:.1f} mm") for each in report["covers"])
        yield from ("", rows(("mesh of", ">hulls", ">furthest out of the mesh"), covers))
    pairs = ", ".join("-".join(pair) for pair in report["self_pairs"])
    yield from ("", f"{report['bodies']} bodies; pairs of links that are kept apart: {pairs or 'none'}")
    yield from (f"warning: {warning}" for warning in report["warnings"])
    yield from report["remarks"]
    if report["unused"]:
        yield f"no plan depends on what else the URDF has: {', '.join(report['unused'])}"
    yield f"written: {report['file']}"

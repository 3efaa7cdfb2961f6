"""The commands `assur robots`: the list and single robots, import from a URDF, drawings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from assur.api.cli import catalogue_table, import_report
from assur.api.cli.border import BAD_INPUT, RIGHT, AsJson, bordered, say, show, show_json, writable
from assur.api.cli.console_report import working
from assur.api.cli.inputs import pairs_in, robot_named
from assur.planner.errors import InputError
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
    if as_json:
        show_json({"robots": listed})
        return RIGHT
    show(catalogue_table.catalogue(listed), "", catalogue_table.LEGEND)
    if robot is not None:
        show("", catalogue_table.sources(listed[0]))
    return RIGHT


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
    out: Annotated[Path | None, typer.Option(help="The robot's file; else NAME.yaml. Hulls go beside it.")] = None,
    as_json: AsJson = False,
) -> int:
    """Make a robot's file from a URDF: SCARA, elbow arm or five-axis arm.

    All that is missing or unsuitable is told at once, with what to supply. The flange of the new robot is compared with
    the URDF's at 1000 random states; more than 1 um or 1 urad is refused.
    """
    from assur.scenes.urdf.importing import Wanted, import_robot, write
    from assur.scenes.urdf.refusals import ImportRefused
    from assur.scenes.urdf.solids import Covering

    writable(out, file, joint_limits, srdf)
    wanted = Wanted(
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
    if as_json:
        show_json(report)
    else:
        show(*import_report.everything(report))
    return RIGHT


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

"""Commands about trajectories of controllers: `export` writes them, `check-trajectory` judges them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from assur.api.cli import console_report, trajectory_report
from assur.api.cli.border import writable
from assur.api.cli.cell_reading import announce_compilation, read_cell
from assur.api.cli.inputs import json_file, target, text_file
from assur.api.cli.plan_files import ANSWER, PLAN_OR_CELL, answer_for, in_bytes
from assur.api.documents import to_json
from assur.scenes.exports.doors import check_trajectory_cell, export_cell
from assur.scenes.exports.export import file_bytes
from assur.scenes.motions.ros_motion import is_message
from assur.scenes.plan_file import PlanFile

Cell = Annotated[str, typer.Argument(metavar="FILE", help=f"{PLAN_OR_CELL} Of a plan file the cell counts.")]


def export(
    file: Annotated[str, typer.Argument(metavar="FILE", help=PLAN_OR_CELL)],
    form: Annotated[
        Literal["csv", "ros2", "ros2-json", "glb", "spel", "melfa"],
        typer.Option(
            "--format", help="CSV, ROS 2 JointTrajectory (YAML, JSON), animated glTF, or a recipe (SPEL+, MELFA-BASIC)."
        ),
    ],
    plan: Annotated[Path | None, typer.Argument(help=ANSWER)] = None,
    tick_ms: Annotated[
        float | None, typer.Option("--tick-ms", help="The controller's step; else the points are the plan's knots.")
    ] = None,
    jerk: Annotated[
        Literal["limit", "report"],
        typer.Option(help="Keep the limits of jerk, or prove it against higher ones, which are stated."),
    ] = "limit",
    lead_ms: Annotated[
        float | None,
        typer.Option("--lead-ms", help="ROS 2 since Jazzy: the controller's update period, by which stamps are later."),
    ] = None,
    after: Annotated[
        Path | None,
        typer.Option("--after", help="ROS 2: the plan file that is running; its points come first, up to this plan."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Write to this file, and say what it is.")] = None,
    plan_out: Annotated[
        Path | None,
        typer.Option("--plan-out", help="Write the motion with its proof, a file that `assur check` takes."),
    ] = None,
) -> int:
    """Write a PLAN as a controller's file, proved anew on the points that the file has."""
    writable(out, file, plan, after)
    writable(plan_out, file, plan, after, out, option="--plan-out")
    given = target(file)
    asked: dict[str, Any] = {"format": form, "jerk": jerk}
    if tick_ms is not None:
        asked["tick_ms"] = tick_ms
    if lead_ms is not None:
        asked["lead_ms"] = lead_ms
    if after is not None:
        asked["after"] = json_file(after, "--after", "a plan file")
    answer = answer_for(given, plan)
    cell = read_cell(given)
    announce_compilation()
    with console_report.working(f"exporting {given.name if plan is None else plan.name}"):
        made = export_cell(cell, given.whole, answer, asked)
    if plan_out is not None:  # files first: who reads the output may close it
        plan_out.write_bytes(in_bytes(PlanFile(made["request"], made["plan"], given.title, given.about)))
    if out is None:
        for line in made["warnings"]:
            typer.echo(f"assur: {line}", err=True)
        typer.echo(file_bytes(made), nl=False)
        return 0
    out.write_bytes(file_bytes(made))
    console = console_report.console()
    for line in (f"{out}: {form}", *made["statement"]):
        console.print(line, soft_wrap=True)
    return 0


def check_trajectory(
    file: Cell,
    trajectory: Annotated[
        Path, typer.Argument(help="CSV with time_s, j1_deg, j1_deg_s, j1_deg_s2, ..., or a message of ROS.")
    ],
    jerk: Annotated[
        Literal["limit", "report"], typer.Option(help="Hold the jerk to its limits, or only say how high it is.")
    ] = "limit",
    plan: Annotated[
        Path | None, typer.Option("--plan", help="The answer whose legs it has; else it is one motion in travel.")
    ] = None,
    start_s: Annotated[
        float | None,
        typer.Option(help="The cell's clock when a ROS trajectory, or one with times of the calendar, starts."),
    ] = None,
    start_tolerance_ms: Annotated[
        float | None, typer.Option(help="By how much it may start late, in place of what the cell says.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the verdict as JSON.")] = False,
) -> int:
    """Prove or refute a TRAJECTORY that was made elsewhere: limits of the joints, and distances in the cell of FILE."""
    given = target(file)
    asked: dict[str, Any] = {"file": text_file(trajectory, "TRAJECTORY"), "jerk": jerk}
    asked["format"] = "ros2" if is_message(asked["file"].encode()) else "csv"
    if start_s is not None:
        asked["start_s"] = start_s
    if start_tolerance_ms is not None:
        asked["start_tolerance_ms"] = start_tolerance_ms
    answer = None if plan is None else answer_for(given, plan)
    cell = read_cell(given)
    announce_compilation()
    with console_report.working(f"checking {trajectory.name}"):
        verdict = check_trajectory_cell(cell, given.whole, asked, answer)
    if as_json:
        typer.echo(to_json(verdict).decode("ascii"))
        return 0 if verdict["ok"] else 1
    console = console_report.console()
    for line in trajectory_report.lines(trajectory.name, verdict):
        console.print(line, soft_wrap=isinstance(line, str))
    return 0 if verdict["ok"] else 1

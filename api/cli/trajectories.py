"""Commands about trajectories of controllers: `export` writes them, `check-trajectory` judges them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from assur.api.cli import console_report, trajectory_report
from assur.api.cli.border import writable
from assur.api.cli.cell_reading import announce_compilation, read_cell
from assur.api.cli.inputs import plan_file, target, text_file
from assur.api.documents import to_json
from assur.scenes.exports.doors import check_trajectory_cell, export_cell
from assur.scenes.exports.export import file_bytes

Cell = Annotated[str, typer.Argument(help="A scenario file (YAML), a request (JSON), or a shipped scenario's name.")]


def export(
    file: Cell,
    plan: Annotated[Path, typer.Argument(help="An answer, as `assur plan --out` writes it.")],
    form: Annotated[
        Literal["csv", "ros2", "ros2-json", "glb", "spel", "melfa"],
        typer.Option(
            "--format", help="CSV, ROS 2 JointTrajectory (YAML, JSON), animated glTF, or a recipe (SPEL+, MELFA-BASIC)."
        ),
    ],
    tick_ms: Annotated[
        float | None, typer.Option("--tick-ms", help="The controller's step; else the points are the plan's knots.")
    ] = None,
    jerk: Annotated[
        Literal["limit", "report"],
        typer.Option(help="Keep the limits of jerk, or prove it against higher ones, which are stated."),
    ] = "limit",
    out: Annotated[Path | None, typer.Option("--out", help="Write to this file, and say what it is.")] = None,
    request_out: Annotated[
        Path | None, typer.Option("--request-out", help="Write the request against which it is proved, as JSON.")
    ] = None,
    plan_out: Annotated[
        Path | None, typer.Option("--plan-out", help="Write the motion with its proof, as `assur check` takes it.")
    ] = None,
) -> int:
    """Write a PLAN as a controller's file, proved anew on the points that the file has."""
    for name, path in (("--out", out), ("--request-out", request_out), ("--plan-out", plan_out)):
        writable(path, name)
    given = target(file)
    asked: dict[str, Any] = {"format": form, "jerk": jerk}
    if tick_ms is not None:
        asked["tick_ms"] = tick_ms
    answer = plan_file(plan)
    cell = read_cell(given)
    announce_compilation()
    with console_report.working(f"exporting {plan.name}"):
        made = export_cell(cell, given.whole, answer, asked)
    if out is None:
        typer.echo(file_bytes(made), nl=False)
    else:
        out.write_bytes(file_bytes(made))
        console = console_report.console()
        for line in (f"{out}: {form}", *made["statement"]):
            console.print(line, soft_wrap=True)
    for path, key in ((request_out, "request"), (plan_out, "plan")):
        if path is not None:
            path.write_bytes(to_json(made[key]) + b"\n")
    return 0


def check_trajectory(
    file: Cell,
    trajectory: Annotated[Path, typer.Argument(help="CSV with time_s, j1_deg, j1_deg_s, j1_deg_s2, ..., or ROS 2.")],
    jerk: Annotated[
        Literal["limit", "report"], typer.Option(help="Hold the jerk to its limits, or only say how high it is.")
    ] = "limit",
    plan: Annotated[
        Path | None, typer.Option("--plan", help="The answer whose legs it has; else it is one motion in travel.")
    ] = None,
    start_s: Annotated[float | None, typer.Option(help="The cell's clock when a ROS trajectory starts.")] = None,
    start_tolerance_ms: Annotated[
        float | None, typer.Option(help="By how much it may start late, in place of what the cell says.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the verdict as JSON.")] = False,
) -> int:
    """Prove or refute a TRAJECTORY that was made elsewhere: limits of the joints, and distances in the cell of FILE."""
    given = target(file)
    asked: dict[str, Any] = {"file": text_file(trajectory, "TRAJECTORY"), "jerk": jerk}
    asked["format"] = "csv" if trajectory.suffix.lower() == ".csv" else "ros2"
    if start_s is not None:
        asked["start_s"] = start_s
    if start_tolerance_ms is not None:
        asked["start_tolerance_ms"] = start_tolerance_ms
    answer = None if plan is None else plan_file(plan)
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

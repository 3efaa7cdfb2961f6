"""Commands about trajectories of controllers: `export` writes them, `check-trajectory` judges them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from rich.table import Table

from assur.api.cli.border import RIGHT, AsJson, answered, show, writable
from assur.api.cli.cell_reading import compiled_work, read_cell
from assur.api.cli.console_report import findings
from assur.api.cli.inputs import Values, given_options, json_file, target, text_file
from assur.api.cli.plan_files import ANSWER, PLAN_OR_CELL, answer_for
from assur.api.documents import plan_file_bytes
from assur.planner.report.number_format import amount
from assur.scenes.exports.documents import check_trajectory_cell, export_cell
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
    values: Values = None,
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
    given = target(file, values)
    question: dict[str, Any] = given_options({"format": form, "jerk": jerk, "tick_ms": tick_ms, "lead_ms": lead_ms})
    if after is not None:
        question["after"] = json_file(after, "--after", "a plan file")
    answer = answer_for(given, plan)
    cell = read_cell(given)
    with compiled_work(f"exporting {given.name if plan is None else plan.name}"):
        made = export_cell(cell, given.whole, answer, question)
    if plan_out is not None:  # files first: who reads the output may close it
        held = PlanFile(made["request"], made["plan"], given.title, given.about)
        plan_out.write_bytes(plan_file_bytes(held, "--plan-out"))
    if out is None:
        for line in made["warnings"]:
            typer.echo(f"assur: {line}", err=True)
        typer.echo(file_bytes(made), nl=False)
        return RIGHT
    out.write_bytes(file_bytes(made))
    show(f"{out}: {form}", *made["statement"])
    return RIGHT


def check_trajectory(
    file: Cell,
    trajectory: Annotated[
        Path, typer.Argument(help="CSV with time_s, j1_deg, j1_deg_s, j1_deg_s2, ..., or a message of ROS.")
    ],
    values: Values = None,
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
    as_json: AsJson = False,
) -> int:
    """Prove or refute a TRAJECTORY that was made elsewhere: limits of the joints, and distances in the cell of FILE."""
    given = target(file, values)
    text = text_file(trajectory, "TRAJECTORY")
    form = "ros2" if is_message(text.encode()) else "csv"
    late = {"start_s": start_s, "start_tolerance_ms": start_tolerance_ms}
    question = given_options({"file": text, "jerk": jerk, "format": form, **late})
    answer = None if plan is None else answer_for(given, plan)
    cell = read_cell(given)
    with compiled_work(f"checking {trajectory.name}"):
        verdict = check_trajectory_cell(cell, given.whole, question, answer)
    return answered(verdict, lambda: lines(trajectory.name, verdict), as_json=as_json, right=verdict["ok"])


PLAN_HINT = (
    "judged as one motion in travel: nothing is gripped or let go, and nothing may touch; --plan judges it with the "
    "legs of a plan"
)


def _off(states: list[dict[str, Any]]) -> str:
    """By how much which joints begin elsewhere, positions before speeds: 0.2 rad (j1)."""
    return ", ".join(f"{each['by']:.4g} {each['unit']} ({each['joint']})" for each in states)


def lines(name: str, verdict: dict[str, Any]) -> Iterator[Table | str]:
    """What a verdict says, the first violation before all findings."""
    result = "proved" if verdict["ok"] else "refused"
    yield (
        f"{name}: {result}, {verdict['points']} points from {verdict['start_s']:.6g} s, "
        f"{verdict['duration_s']:.6g} s long, up to {1e3 * verdict['start_tolerance_s']:.6g} ms late"
    )
    if verdict["judged_as"] == "travel":
        yield PLAN_HINT
    if verdict["begins_off"]:
        yield f"begins {_off(verdict['begins_off'])} from the start of the request"
    for note in verdict["notes"]:
        yield f"read: {note}"
    if verdict["ends_moving"]:
        yield "ends moving: nothing after its last point is proved"
    first = verdict["first"]
    if first is not None:
        by = "" if first["amount"] is None else f", by {amount(first['amount'], first['unit'])}"
        yield f"first violation     {first['time_s']:.6g} s: {first['what']}{by}"
    nearest = verdict["clearance"]
    if nearest is not None:
        bodies = " and ".join(nearest["bodies"])
        yield f"smallest clearance  {1e3 * nearest['gap_m']:.2f} mm at {nearest['time_s']:.3f} s, {bodies}"
    jerks = [
        f"{each['joint']} {amount(each['highest'], each['unit'])}, limit {amount(each['of_request'], each['unit'])}"
        for each in verdict["jerk"]
        if each["highest"] is not None
    ]
    yield f"highest jerk        {'; '.join(jerks) or 'no bound'}"
    if verdict["findings"]:
        yield from ("", findings(verdict))
    yield verdict["notice"]

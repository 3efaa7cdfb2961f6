"""The command `assur`. Exit codes: 0 planned or plan right, 1 not planned or plan wrong, 2 bad input, 3 our fault,
12 out of memory."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from assur.api.cli import (
    console_report,
    ik_report,
    keys_group,
    limits_report,
    plan_files,
    proofs,
    report_file,
    robots_group,
    simulation,
    trajectories,
    verdict_report,
)
from assur.api.cli.border import (
    RIGHT,
    WRONG,
    AsJson,
    answered,
    bordered,
    say,
    show,
    show_json,
    telling,
    within_memory,
    writable,
)
from assur.api.cli.cell_reading import announce_compilation, compiled_work, read_cell
from assur.api.cli.console_report import rows
from assur.api.cli.inputs import (
    STANDARD,
    After,
    Values,
    given_options,
    joints_in,
    log_file,
    named_as_options,
    robot_in_place,
    robot_named,
    target,
)
from assur.api.cli.plan_files import ANSWER, PLAN_OR_CELL
from assur.api.version import version
from assur.planner.errors import FaultError, InputError
from assur.scenes import fitted_limits, requests
from assur.scenes import kernels as compiled_kernels
from assur.scenes.faults import NOTHING

app = typer.Typer(
    name="assur",
    help="Plans proved motion of SCARA-class robots through moving control points among moving bodies.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

app.add_typer(robots_group.app, name="robots")
app.add_typer(keys_group.app, name="keys")

File = Annotated[
    str, typer.Argument(help="A scenario or a task (YAML), a request (JSON), or a shipped scenario's name.")
]
PlanOrCell = Annotated[str, typer.Argument(metavar="FILE", help=PLAN_OR_CELL)]
Plan = Annotated[Path | None, typer.Argument(help=ANSWER)]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"assur {version()}")
        raise typer.Exit(RIGHT)


@app.callback()
def assur(
    _: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")] = False,
) -> None:
    """The options before a command."""


@app.command()
@bordered
@within_memory
def plan(
    file: File,
    values: Values = None,
    as_json: AsJson = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="Write request and answer to this file; - is standard output.")
    ] = None,
    certificate: Annotated[
        Literal["full", "digest"], typer.Option(help="The whole table of the proof in the answer, or its digest.")
    ] = "full",
    after: After = None,
    details: Annotated[bool, typer.Option("--details", help="List every assumption, not only their number.")] = False,
    opened: Annotated[bool, typer.Option("--open", help="Show the report of the answer in a browser.")] = False,
) -> int:
    """Plan FILE, check the plan, and say what came out."""
    piped = out is not None and str(out) == STANDARD
    if piped and as_json:
        raise InputError("--json", "with --out -", "one of both: each writes a document to standard output")
    given = target(file, values, after)
    writable(out, file, after)
    read_cell(given)
    with compiled_work(f"planning {given.name}"):
        answer = given.plan()
        checked = answer["status"] == "planned"
        verdict = _held_to_checker(requests.verdict_on(given.cell, answer))
        words = {"title": given.title, "about": given.about, "version": version()}
        page = requests.report_page(given.cell, answer, verdict=verdict, **words) if opened else None
    if checked and certificate == "digest":
        answer["certificate"] = {key: answer["certificate"][key] for key in ("digest", "rows", "covers")}
    if out is not None:
        plan_files.write(out, given, answer)
    if as_json:
        show_json(answer)
    elif not piped:
        title = f"{given.name}: {'planned' if checked else 'not planned'}"
        show(title, "", *console_report.everything(answer, details=details))
        if checked:
            show("plan checked")
    if page is not None:
        say(report_file.show(report_file.kept(given.name, page.encode())))
    for unmet in given.unmet(answer):
        say(f"not as the file expects: {unmet}")
    return RIGHT if checked else WRONG


@app.command()
@bordered
@within_memory
def check(
    file: PlanOrCell,
    plan: Plan = None,
    values: Values = None,
    after: After = None,
    as_json: AsJson = False,
) -> int:
    """Check the answer in a plan file, or an answer (PLAN) to the cell in FILE, with the checker, which trusts no
    planner."""
    given = target(file, values, after)
    cell, answer = read_cell(given), plan_files.answer_for(given, plan)
    read = None if requests.refused(answer) else requests.read_plan(cell, answer)
    with compiled_work(f"checking {given.name if plan is None else plan.name}"):
        verdict = requests.check_cell(cell, answer) if read is None else requests.check_plan(cell, *read)
    words = partial(verdict_report.everything, verdict, answer)
    return answered(verdict, words, as_json=as_json, right=verdict["ok"])


@app.command()
@bordered
@within_memory
def report(
    file: PlanOrCell,
    plan: Plan = None,
    values: Values = None,
    after: After = None,
    out: Annotated[Path, typer.Option("--out", help="Write the report to this file.")] = Path("report.html"),
    opened: Annotated[bool, typer.Option("--open", help="Show the report in a browser.")] = False,
) -> int:
    """Write a page that plays an answer and says all of it; it needs no network. A cell alone is planned first."""
    given = target(file, values, after)
    writable(out, file, plan, after)
    read = plan_files.answer_if_any(given, plan)
    with compiled_work(f"planning {given.name}" if read is None else f"reading {given.name}"):
        answer = given.plan() if read is None else read
        from assur.api.checked_report import checked_report

        text, verdict = checked_report(given.cell, answer, given.title, given.about)
    page = text.encode()
    out.write_bytes(page)
    show(f"report of {given.title}: {out}, {len(page) / 1000:.0f} kB, opens in a browser without network")
    if opened:
        say(report_file.show(out))
    right = verdict is None or verdict["ok"]
    return RIGHT if right else say("the checker refuses this plan; the report says why", WRONG)


@app.command()
@bordered
@within_memory
def ik(
    file: Annotated[str | None, typer.Argument(help="As of `plan`: robot, tool, frames and bodies are its.")] = None,
    values: Values = None,
    robot: Annotated[
        str | None, typer.Option(help="A shipped robot or a robot's file; of FILE the tool point and the base only.")
    ] = None,
    at_mm: Annotated[tuple[float, float, float] | None, typer.Option(help="Where the tool point is, x y z.")] = None,
    yaw_deg: Annotated[float | None, typer.Option(help="Yaw of the tool, if the arm has one.")] = None,
    pitch_deg: Annotated[float | None, typer.Option(help="Pitch of the tool, with five axes.")] = None,
    roll_deg: Annotated[float | None, typer.Option(help="Roll of the tool, with five axes.")] = None,
    frame: Annotated[str | None, typer.Option(help="The frame of FILE in which the pose is; else the world.")] = None,
    joints: Annotated[str | None, typer.Option(help="Joints in place of a pose: j1_deg=17,j2_deg=68,...")] = None,
    at_s: Annotated[float | None, typer.Option(help="When; else at the start of FILE, or at 0.")] = None,
    as_json: AsJson = False,
) -> int:
    """Show every joint position with which the tool is at a pose, or where the tool is with JOINTS."""
    at = None if at_mm is None else list(at_mm)
    pose = {"at_mm": at, "yaw_deg": yaw_deg, "pitch_deg": pitch_deg, "roll_deg": roll_deg, "frame": frame}
    if at_mm is None and joints is None:
        raise InputError("--at-mm", NOTHING, "a position of the tool point, or --joints; one of both must be given")
    question: dict[str, Any] = {"pose": given_options(pose) or None, "at_s": at_s}
    if joints is not None:
        question["joints"] = joints_in(joints)
    cell = None if file is None else read_cell(target(file, values))
    if robot is not None:
        question["robot"] = robot_in_place(robot, cell)
    announce_compilation()
    with named_as_options():
        answer = requests.ik_cell(None if robot is not None else cell, given_options(question))
    words = partial(ik_report.everything, answer)
    return answered(answer, words, as_json=as_json, right=answer["status"] == "reached")


@app.command()
@bordered
def scenes(as_json: AsJson = False) -> int:
    """List the shipped scenarios and why each exists."""
    shipped = requests.shipped_scenarios()
    listed = [{"name": name, "about": about} for name, about in shipped.items()]
    return answered({"scenes": listed}, lambda: [rows(("scene", "about"), shipped.items())], as_json=as_json)


@app.command()
@bordered
def schema(
    kind: Annotated[
        requests.Kind, typer.Argument(help="The kind of document. A scenario is a file with a request.")
    ] = ("request"),
) -> int:
    """Print the JSON Schema of a request, a scenario file, a cell file or a task file."""
    show_json(requests.request_schema() if kind == "request" else requests.schema_of(kind))
    return RIGHT


@app.command()
@bordered
def kernels(
    check: Annotated[
        bool, typer.Option("--check", help="Load every kernel; exit with 1 if one had to be compiled.")
    ] = False,
) -> int:
    """Compile the planner's inner loops once, so that no request waits for it."""
    if not check and compiled_kernels.is_compiled():
        show(f"kernels are compiled, in {compiled_kernels.folder()}")
        return RIGHT
    announce_compilation()
    with telling(lambda: f"{compiled_kernels.counted()} kernels are compiled"):
        loaded = compiled_kernels.load()
    show(
        f"{loaded.count} kernels, {len(loaded.compiled)} compiled now, {loaded.seconds:.1f} s, in {loaded.folder}",
        *loaded.compiled,
    )
    return WRONG if check and loaded.compiled else RIGHT


@app.command("fit-limits")
@bordered
def fit_limits(
    log: Annotated[
        Path, typer.Argument(help="Recorded motion: CSV with t_s or t_ms, j1_deg, j3_mm and so on, or messages of ROS.")
    ],
    robot: Annotated[str | None, typer.Option(help="Whose joints they are: a shipped robot's name, or a file.")] = None,
    commanded: Annotated[
        bool, typer.Option("--commanded", help="The log holds commanded positions, which no servo delays.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print all that was found as JSON.")] = False,
    out: Annotated[
        Path | None, typer.Option("--out", help="Write what belongs into a robot's file or a request to this file.")
    ] = None,
) -> int:
    """Find the limits of acceleration and jerk of each joint in a LOG of recorded motion."""
    given, of = log_file(log), None if robot is None else robot_named(robot)
    writable(out, log, robot)
    with console_report.working(f"fitting {log.name}"):
        found = fitted_limits.fit_limits(given, commanded=commanded, robot=of)
    if out is not None:
        out.write_text(fitted_limits.part(found), encoding="utf-8")
    identified = any(joint[rate]["status"] == "identified" for joint in found["joints"] for rate in fitted_limits.RATES)
    return answered(found, partial(limits_report.fitted, found), as_json=as_json, right=identified)


app.command()(bordered(within_memory(simulation.simulate)))
app.command()(bordered(within_memory(simulation.replay)))
app.command()(bordered(within_memory(trajectories.export)))
app.command("check-trajectory")(bordered(trajectories.check_trajectory))
app.command()(bordered(within_memory(proofs.bundle)))
app.command()(bordered(within_memory(proofs.prove)))


@app.command()
@bordered
def reproduce(
    out: Annotated[Path, typer.Option("--out", help="Folder for figures, numbers and paragraphs; made if needed.")],
    name: Annotated[str, typer.Argument(help="An experiment, or all.")] = "all",
) -> int:
    """Reproduce an experiment of the sources: a figure (PNG, SVG), its numbers (JSON), and what they say."""
    from assur.experiments.reproduce import reproduce as run

    for done in run(name, out):
        place = f"{done.number} of {done.count}, " if done.count > 1 else ""
        show(f"{place}{done.entry.name}: {done.entry.title}, {done.elapsed_s:.1f} s", done.paragraph)
        show(*(str(path) for path in done.files), "")
    return RIGHT


@app.command()
@bordered
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on (ASSUR_HOST).")] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="Port to listen on (ASSUR_PORT).")] = None,
) -> int:
    """Run the HTTP service until SIGTERM; other settings come from the environment (docs/operating.md)."""
    from assur.api.web.serve import serve as run
    from assur.api.web.settings import Settings

    settings = Settings.from_environment()
    if not compiled_kernels.is_compiled():
        announce_compilation()
        # in a process of its own: the web process never loads the compiler
        command = [sys.executable, "-m", "assur.api.command_line", "kernels"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # noqa: S603 - no word of it comes from outside
    run(replace(settings, host=host or settings.host, port=settings.port if port is None else port))
    return RIGHT


def main() -> None:
    """The entry point. What `bordered` does not catch, wrong usage, typer answers itself with exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        reconfigure: Callable[..., None] | None = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")  # a terminal in ASCII gets escapes, not a traceback
    app()


def _held_to_checker(verdict: dict[str, Any] | None) -> dict[str, Any] | None:
    if verdict is not None and not verdict["ok"]:
        raise FaultError("the checker refuses this answer: " + "; ".join(f["what"] for f in verdict["findings"]))
    return verdict


if __name__ == "__main__":
    main()

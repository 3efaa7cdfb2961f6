"""Commands about proof bundles: `bundle` writes one, `prove` shows what it claims, or says what it cannot show."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from assur.api.cli import console_report
from assur.api.cli.border import BAD_INPUT, RIGHT, answered, say, show, writable
from assur.api.cli.cell_reading import compiled_work, read_cell
from assur.api.cli.inputs import Values, target
from assur.api.cli.plan_files import ANSWER, PLAN_OR_CELL, answer_for
from assur.api.documents import to_json
from assur.planner.errors import InputError
from assur.scenes.bundle import bundle_cell
from assur.scenes.faults import DocumentError
from assur.scenes.files import empty
from assur.scenes.not_requests import refuse_but
from assur.scenes.text.json_text import not_json, not_utf8

NEEDS = "assur prove needs python-flint and jsonschema-rs, which are an extra: pip install 'assur[proof]'"
NAMES_ONLY = "All that the bundle claims is shown. Its digests are names: neither plan nor request was read."


def bundle(
    file: Annotated[str, typer.Argument(metavar="FILE", help=PLAN_OR_CELL)],
    plan: Annotated[Path | None, typer.Argument(help=ANSWER)] = None,
    values: Values = None,
    out: Annotated[Path, typer.Option("--out", help="Write the bundle to this file.")] = Path("bundle.json"),
) -> int:
    """Write the proof bundle of a PLAN: all that a second checker needs to prove it."""
    writable(out, file, plan)
    given = target(file, values)
    answer = answer_for(given, plan)
    cell = read_cell(given)
    with compiled_work(f"writing the bundle of {given.name if plan is None else plan.name}"):
        data = to_json(bundle_cell(cell, answer)) + b"\n"
    out.write_bytes(data)
    show(f"proof bundle of {given.title}: {out}, {len(data) / 1000:.0f} kB; assur prove {out}")
    return RIGHT


def prove(
    file: Annotated[Path, typer.Argument(metavar="BUNDLE", help="A proof bundle.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the verdict as JSON.")] = False,
) -> int:
    """Show what a proof bundle claims, in rigorous arithmetic and without code of the planner, or what is not shown."""
    try:
        from assur.prover.prove import prove as show_claims
    except ImportError:
        return say(NEEDS, BAD_INPUT)
    if not file.is_file():
        raise InputError("BUNDLE", str(file), "a file that exists: a proof bundle, as assur bundle writes it")
    data = file.read_bytes()
    if not data.strip():
        raise empty(file, "a proof bundle, as JSON")
    refuse_but("a proof bundle", data, file, "a proof bundle, as `assur bundle PLAN` makes it of a plan file")
    try:
        with console_report.working(f"proving {file.name}"):
            shown, claims = show_claims(data)
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        found, allowed = not_json(error) if isinstance(error, json.JSONDecodeError) else not_utf8(error)
        raise DocumentError(file.name, found, f"a proof bundle, as JSON; {allowed}") from error
    except ValueError as error:
        raise InputError("BUNDLE", file.name, f"a proof bundle, as assur bundle writes it: {error}") from error

    def words() -> list[str]:
        if not shown:
            return ["bundle not shown", *claims]
        return ["bundle shown", NAMES_ONLY, *(f"{name}: {_plain(value)}" for name, value in claims.items())]

    return answered({"shown": shown, "claims" if shown else "not_shown": claims}, words, as_json=as_json, right=shown)


def _plain(value: Any) -> str:
    """A value of a claim in a line of text."""
    if isinstance(value, list):
        return ", ".join(map(_plain, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)

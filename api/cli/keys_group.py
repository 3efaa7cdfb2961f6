"""The commands `assur keys`: who may ask a service."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from assur.api import keys
from assur.api.cli.border import RIGHT, bordered, say, show
from assur.planner.errors import InputError

app = typer.Typer(help="Make, list and remove the API keys of a service.", rich_markup_mode=None, no_args_is_help=True)

File = Annotated[Path, typer.Argument(metavar="FILE", help="The file of keys, which ASSUR_KEYS_FILE names.")]
Name = Annotated[str, typer.Argument(help="Who holds the key; it is written into the log.")]


@app.command()
@bordered
def add(
    file: File,
    name: Name,
    running: Annotated[int | None, typer.Option(help="Requests that are worked on at a time.")] = None,
    waiting: Annotated[int | None, typer.Option(help="Requests that may wait.")] = None,
    seconds: Annotated[float | None, typer.Option(help="Seconds of workers each minute.")] = None,
) -> int:
    """Make a key for NAME, and show it once; FILE is made if it is not there, and keeps only its digest."""
    before = keys.keys_in(file) if file.exists() else keys.KeysDocument()
    if any(key.name == name for key in before.keys):
        raise InputError("NAME", name, "a name that has no key yet; `assur keys remove` takes one away")
    key = keys.new_key()
    limits = {"running": running, "waiting": waiting, "seconds": seconds}
    given = {field: value for field, value in limits.items() if value is not None}
    try:
        after = keys.with_key(before, {"name": name, "sha256": keys.digest(key), **given})
    except InputError as error:
        option = "NAME" if error.field == "name" else f"--{error.field}"
        raise InputError(option, error.value, error.allowed) from error
    keys.write(file, after)
    say(f"the key of {name}, which is not kept anywhere; a service that runs knows it within some seconds:")
    show(key)
    return RIGHT


@app.command("list")
@bordered
def listed(file: File) -> int:
    """List who holds a key, and what is allowed to each."""
    for key in keys.keys_in(file).keys:
        limits = ", ".join(
            f"{field} {value:g}"
            for field, value in (("running", key.running), ("waiting", key.waiting), ("seconds", key.seconds))
            if value is not None
        )
        show(f"{key.name}  {key.sha256[:12]}…  {limits or 'as the settings say'}")
    return RIGHT


@app.command()
@bordered
def remove(file: File, name: Name) -> int:
    """Take the key of NAME away; a service that runs knows it within some seconds."""
    before = keys.keys_in(file)
    left = [key for key in before.keys if key.name != name]
    if len(left) == len(before.keys):
        names = ", ".join(key.name for key in before.keys[:20]) or "none"
        raise InputError("NAME", name, f"one that has a key: {names}")
    keys.write(file, before.model_copy(update={"keys": left}))
    return RIGHT

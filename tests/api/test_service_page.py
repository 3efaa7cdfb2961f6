"""What docs/service.md shows is run here as it stands there."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from typer.testing import CliRunner

from assur.api.command_line import app
from assur.api.problems import STATUS

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "service.md").read_text(encoding="utf-8")
SHOWN = [
    line.removeprefix("$ ")
    for block in re.findall(r"```console\n(.*?)```", PAGE, re.DOTALL)
    for line in block.splitlines()
]


def test_every_command_that_is_shown_succeeds_and_the_demo_says_what_was_planned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    commands = [shlex.split(line)[1:] for line in SHOWN if line.startswith("assur ")]
    assert len(commands) >= 7
    monkeypatch.chdir(tmp_path)
    for arguments in commands:
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 0, (arguments, result.output)
        if arguments == ["plan", "demo"]:
            for words in ("APPROACH", "FOLLOW", "DEPART", "matched", "what binds", "plan checked"):
                assert words in result.stdout


def test_every_call_that_is_shown_succeeds(client: httpx.Client) -> None:
    calls = [shlex.split(line)[1:] for line in SHOWN if line.startswith("curl ")]
    assert len(calls) >= 3
    for arguments in calls:
        address = urlsplit(arguments[-1])
        target = address.path + (f"?{address.query}" if address.query else "")
        options = dict(zip(arguments[1:-1:2], arguments[2:-1:2], strict=True))
        if "-d" in options:
            name, _, value = options["-H"].partition(": ")
            answer = client.post(target, content=options["-d"], headers={name: value})
        else:
            answer = client.get(target)
        assert answer.status_code == (202 if target == "/v1/jobs" else 200), arguments


def test_the_table_of_problems_is_whole_and_its_statuses_are_right() -> None:
    rows = re.findall(r"^\| `([a-z-]+)` \| (\d{3}) \|", PAGE, re.MULTILINE)
    assert {kind: int(status) for kind, status in rows} == {kind: status for kind, (status, _) in STATUS.items()}


def test_the_table_of_addresses_is_whole(client: httpx.Client) -> None:
    shown = set(re.findall(r"^\| `(?:GET|POST|PUT) (/[^`]*)`", PAGE, re.MULTILINE))
    assert set(client.get("/openapi.json").json()["paths"]) | {"/docs"} == shown

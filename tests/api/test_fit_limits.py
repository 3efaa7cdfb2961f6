"""`assur fit-limits`: what it prints, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from assur.api.cli.border import BAD_INPUT, RIGHT, WRONG
from assur.scenes.text.yaml_text import parse_yaml
from tests.api.test_command_line import run

LOG = Path(__file__).parents[2] / "docs" / "logs" / "cycle.csv"


@pytest.fixture
def one_joint(tmp_path: Path) -> Path:
    """The third joint of the shipped log."""
    file = tmp_path / "lift.csv"
    rows = [line.split(",") for line in LOG.read_text().splitlines()]
    file.write_text("\n".join(f"{row[0]},{row[3]}" for row in rows))
    return file


def test_limits_are_told_with_their_errors_beside_those_of_the_robot(one_joint: Path, tmp_path: Path) -> None:
    out = tmp_path / "found.yaml"
    code, output, errors = run("fit-limits", str(one_joint), "--robot", "fanuc-sr-3ia", "--out", str(out))
    assert (code, errors) == (RIGHT, "")
    for words in (
        "lift.csv: 724 rows",
        "10 +- 0.0",
        "servo lag ms",
        "limits of a request with this robot: acceleration: 0.",
    ):
        assert words in output
    pasted, _ = parse_yaml(out.read_bytes())
    assert pasted["joints"][0]["jerk_m_s3"]["status"] == "measured"
    assert set(pasted["limits"]) == {"acceleration", "jerk"}


def test_commanded_positions_have_no_lag(one_joint: Path) -> None:
    code, output, _ = run("fit-limits", str(one_joint), "--commanded", "--json")
    assert code == RIGHT
    document = json.loads(output)
    assert (document["positions"], document["joints"][0]["lag_s"]) == ("commanded", [0.0, 0.0])


def test_a_log_that_shows_no_limit_ends_with_one_and_says_why(tmp_path: Path) -> None:
    file = tmp_path / "still.csv"
    file.write_text("t_ms,j1_deg\n" + "".join(f"{4 * i},30\n" for i in range(100)))
    code, output, _ = run("fit-limits", str(file))
    assert code == WRONG
    assert "not identifiable" in output
    assert "j1 jerk: the joint hardly moved" in output


def test_bad_input_is_one_line_with_file_line_column_and_value(tmp_path: Path) -> None:
    file = tmp_path / "cycle.csv"
    file.write_text("t_ms,j1_deg\n" + "".join(f"{4 * i},30\n" for i in range(100)) + "400,nan\n")
    code, output, errors = run("fit-limits", str(file))
    assert (code, output) == (BAD_INPUT, "")
    assert errors == 'assur: line 102: cycle.csv: j1_deg: got "nan"; allowed: a finite number\n'


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nowhere.csv",), "LOG: got"),
        ((str(LOG.parent),), "LOG: got"),
        ((str(LOG), "--robot", "fanuk-sr-3ia"), "did you mean fanuc-sr-3ia?"),
        ((str(LOG), "--robot", "elbow-arm"), "allowed: a joint of the robot: theta1, theta2, theta3"),
        ((str(LOG), "--out", "/nowhere/found.yaml"), "a file in a folder that exists"),
    ],
)
def test_what_cannot_be_used_is_refused_before_anything_is_fitted(arguments: tuple[str, ...], words: str) -> None:
    code, output, errors = run("fit-limits", *arguments)
    assert (code, output) == (BAD_INPUT, "")
    assert words in errors
    assert errors.count("\n") == 1

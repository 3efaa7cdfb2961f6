"""The web process loads documents and catalogue, and no native library: a crash or a hang of one cannot reach it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.architecture.source_tree import ROOT

HEAVY = ("fcl", "ruckig", "trimesh", "numba")
"""What may be imported in worker processes only."""

ASKED = {
    "creating the application": "from assur.api.web.app import create_app\ncreate_app()",
    "listing robots and scenes, and the schema": (
        "from assur.scenes import requests\nrequests.robots()\nrequests.shipped_scenarios()\nrequests.request_schema()"
    ),
    "validating a request": (
        "from benchmarks.translation import Manners, request, unrelated_problem\n"
        "from assur.scenes.requests import request_digest, validate\n"
        "limits = {'qmin': [-2, -2, 0.0, -6], 'qmax': [2, 2, 0.3, 6], 'vmax': [9] * 4}\n"
        "limits |= {'amax': [9] * 4, 'jmax': [9] * 4}\n"
        "document = request(unrelated_problem(1, True), limits, Manners())\n"
        "validate(document)\nrequest_digest(document)"
    ),
}


@pytest.mark.parametrize("program", ASKED.values(), ids=ASKED)
def test_no_native_library_is_loaded_by(program: str) -> None:
    report = f"import sys\nprint([name for name in {HEAVY!r} if name in sys.modules])"
    ran = subprocess.run(
        [sys.executable, "-c", f"{program}\n{report}"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.strip() == "[]"


def test_the_report_does_see_a_library_that_is_loaded() -> None:
    program = f"import fcl, sys\nprint([name for name in {HEAVY!r} if name in sys.modules])"
    ran = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "['fcl']"

"""Bodies that no reader should accept, as bytes: name, body, status, and the field that the problem must name.

Of texts that are no JSON there are a few: the service reads them as tests/scenes/text/test_json_text.py does.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from assur.api.web.settings import PLAN_BODY_BYTES
from assur.api.workers.jobs import FIRST_PLAN

SHORT_TEXT = f"{{about: A short text., request: {json.dumps(FIRST_PLAN)}}}"
"""A scenario."""


@dataclass(frozen=True)
class BadBody:
    """A body, the HTTP status that it deserves, the field that is named ("request": the text as a whole), and whether
    only the service refuses it, by a limit of its own."""

    name: str
    body: bytes
    status: int
    field: str = "request"
    service_only: bool = False


def _with(text: str, value: str) -> bytes:
    """`FIRST_PLAN` as JSON with the member `"seed": 1` in its options replaced by `text: value`."""
    document = {**FIRST_PLAN, "options": {"seed": 1}}
    return json.dumps(document).replace('"seed": 1', f"{text}: {value}").encode("utf-8", "surrogatepass")


def _nested(depth: int, opening: str, closing: str) -> bytes:
    return (opening * depth + "1" + closing * depth).encode()


def _request(**changes: Any) -> bytes:
    return json.dumps({**FIRST_PLAN, **changes}).encode()


BAD_BODIES = (
    BadBody("empty", b"", 400),
    BadBody("something after the end", _request() + b"{}", 400),
    BadBody("not UTF-8", b'{"schema": "\xff\xfe"}', 400),
    BadBody("a byte order mark", b"\xef\xbb\xbf" + _request(), 400),
    BadBody("NaN", _with('"seed"', "NaN"), 400, "options.seed"),
    BadBody("a number that overflows", _with('"budget_s"', "1e999"), 400, "options.budget_s"),
    BadBody("a whole number of 5,000 digits", _with('"seed"', "9" * 5000), 400, "options.seed"),
    BadBody("a whole number beyond 2^53", _with('"seed"', str(2**53 + 1)), 400, "options.seed"),
    BadBody("a key twice", _with('"seed": 1, "seed"', "2"), 400, "options.seed"),
    BadBody("a lone surrogate", _with('"elbow"', '"\\ud800"'), 400, "options.elbow"),
    BadBody("a lone surrogate as a key", _with('"\\udfff"', "1"), 400, "options"),
    BadBody("2,000 arrays deep", _nested(2000, "[", "]"), 400),
    BadBody("100 deep inside a field", _with('"elbow"', "[" * 100 + "]" * 100), 400, "options.elbow[0][0]"),
    BadBody("unclosed and deep", b"[" * 500_000, 400),
    BadBody("an array at the top", b"[]", 422, "body"),
    BadBody("a number at the top", b"1", 422, "body"),
    BadBody("a string at the top", b'"demo"', 422, "body"),
    BadBody("null at the top", b"null", 422, "body"),
    BadBody("an empty object", b"{}", 422, "schema"),
    BadBody("a scenario that is not shipped", b'{"scenario": "nowhere"}', 422, "scenario"),
    BadBody("a scenario by its path", b'{"scenario": "../cells/demo.yaml"}', 422, "scenario"),
    BadBody("a scenario by an address", b'{"scenario": "http://127.0.0.1/demo"}', 422, "scenario"),
    BadBody("a scenario that is a number", b'{"scenario": 1}', 422, "scenario"),
    BadBody("a scenario that is null", b'{"scenario": null}', 422, "scenario"),
    BadBody("a scenario with a control character", b'{"scenario": "\\u001b[31m"}', 422, "scenario"),
    BadBody("a scenario and more", b'{"scenario": "demo", "options": {}}', 422, "options"),
    BadBody(
        "a whole scenario file", json.dumps({"about": "", "request": FIRST_PLAN, "expect": {}}).encode(), 422, "request"
    ),
    BadBody("a huge list", _request(task=[{}] * 100_000), 422, "task"),
    BadBody("a huge list of numbers", _request(task=[0] * 300_000), 422, "task"),
    BadBody("a huge name", _request(bodies=[{"name": "n" * 500_000}]), 422, "bodies[0].name"),
    BadBody("50,000 unknown fields", _request(**{f"f{i}": i for i in range(50_000)}), 422, "request"),
    BadBody("a budget above the service's", _request(options={"budget_s": 30.5}), 422, "options.budget_s", True),
    BadBody(
        "an explain budget above it", _request(options={"explain_budget_s": 31}), 422, "options.explain_budget_s", True
    ),
    BadBody("a budget in the twin unit", _request(options={"budget_ms": 30_500}), 422, "options.budget_ms", True),
    BadBody("a budget in an escaped key", _with('"budget\\u005fs"', "31"), 422, "options.budget_s", True),
    BadBody("a budget above it elsewhere", _with('"seed": 1}, "budget_s"', '99, "carry": {'), 422, "budget_s"),
    BadBody("one byte too many", _request().ljust(PLAN_BODY_BYTES + 1), 413, "body", True),
)

POSE = {"at_mm": [350, 0, 120], "yaw_deg": 90}
BOTH = {"request": FIRST_PLAN, "plan": {}}
BAD_CALLS: tuple[tuple[str, Any, str], ...] = (
    *(
        (f"/v1/plans?{query}", FIRST_PLAN, field)
        for query, field in (
            ("certificate=none", "certificate"),
            ("certificate=", "certificate"),
            ("certificate=full&certificate=x", "certificate"),
            ("certificate=full&certificate=digest", "certificate"),
            ("certificate=%00", "certificate"),
            ("certficate=digest", "certficate"),
            ("budget_s=1", "budget_s"),
            ("certificate=full&x=1", "x"),
            ("format=dxf", "format"),
            ("format=", "format"),
            ("format=csv&format=csv", "format"),
            ("format=csv&certificate=digest", "certificate"),
            ("format=csv&tick_us=4", "tick_us"),
            ("format=csv&tick_ms=1_0", "tick_ms"),
            ("format=csv&tick_ms=nan", "tick_ms"),
            ("format=csv&tick_ms=-1", "tick_ms"),
            ("format=csv&tick_ms=1&tick_s=0.001", "tick_ms"),
            ("format=csv&jerk=none", "jerk"),
            ("format=glb&tick_ms=1", "tick_ms"),
            ("format=report&tick_ms=1", "tick_ms"),
            ("tick_ms=1", "tick_ms"),
            ("jerk=report", "jerk"),
            ("certificate=digest&jerk=limit", "jerk"),
        )
    ),
    ("/v1/plans?format=csv", {**FIRST_PLAN, "optons": {}}, "optons"),
    ("/v1/plans/check", {}, "body"),
    ("/v1/plans/check", [], "body"),
    ("/v1/plans/check", {"request": {}}, "body"),
    ("/v1/plans/check", {"plan": {}}, "body"),
    ("/v1/plans/check", {"request": {}, "plan": {}, "more": {}}, "body"),
    ("/v1/plans/check", BOTH, "plan.trajectory"),
    ("/v1/plans/check", {**BOTH, "plan": []}, "plan"),
    ("/v1/plans/check", {**BOTH, "plan": None}, "plan"),
    ("/v1/plans/check", {**BOTH, "plan": {"status": "planned", "trajectory": {}}}, "plan.trajectory.joint_names"),
    ("/v1/plans/check", {"request": None, "plan": None}, "request"),
    ("/v1/plans/view", BOTH, "plan.status"),
    ("/v1/plans/view", {**BOTH, "plan": []}, "plan"),
    ("/v1/plans/view", {**BOTH, "plan": {"status": "planned"}}, "plan.trajectory"),
    ("/v1/plans/view", {"request": FIRST_PLAN}, "body"),
    ("/v1/plans/export", {"format": "csv", "plan": {}}, "request"),
    ("/v1/plans/export", {"format": "csv", "request": FIRST_PLAN}, "plan"),
    ("/v1/plans/export", {"format": "dxf", **BOTH}, "format"),
    ("/v1/trajectories/check", {"format": "csv", "file": ""}, "request"),
    ("/v1/trajectories/check", {"format": "csv", "request": FIRST_PLAN}, "file"),
    ("/v1/trajectories/check", {"format": "csv", "request": FIRST_PLAN, "file": ""}, "file"),
    ("/v1/ik", {}, "pose"),
    ("/v1/ik", [], "body"),
    ("/v1/ik", {"pose": POSE}, "request"),
    ("/v1/ik", {"request": 3, "pose": POSE}, "request"),
    ("/v1/ik", {"request": FIRST_PLAN, "pose": {**POSE, "frame": "belt"}}, "pose.frame"),
    ("/v1/ik", {"scenario": "demo", "pose": POSE}, "scenario"),
    ("/v1/ik", {"robot": {"file": "x.yaml", "tool": {"tcp_mm": [0, 0, 0]}}, "pose": POSE}, "robot.file"),
    ("/v1/ik?certificate=digest", {}, "certificate"),
    ("/v1/scenes/nowhere/plans", {}, "scenario"),
    ("/v1/scenes/nowhere/jobs", {}, "scenario"),
    ("/v1/scenes/demo/plans", {"task": []}, "task"),
    ("/v1/scenes/demo/plans", {"options": []}, "options"),
    ("/v1/scenes/demo/plans", {"options": {"seeds": 1}}, "options.seeds"),
    ("/v1/scenes/demo/jobs", {"options": {"budget_s": 1, "budget_ms": 1}}, "options.budget_ms"),
    ("/v1/scenes/demo/plans", {"options": {"budget_s": 59}}, "options.budget_s"),
    ("/v1/scenes/demo/plans?certificate=no", {}, "certificate"),
    ("/v1/scenes/parse", {}, "body"),
    ("/v1/scenes/parse", {"text": 1}, "text"),
    ("/v1/scenes/parse", {"text": "", "file": "x"}, "body"),
    ("/v1/scenes/parse", {"text": "", "draw": 1}, "draw"),
    ("/v1/scenes/parse", {"text": SHORT_TEXT, "set": []}, "set"),
    ("/v1/scenes/parse", {"text": SHORT_TEXT, "set": {"options.seeds": 1}}, "set"),
    ("/v1/scenes/parse", {"text": SHORT_TEXT, "set": {"task.nowhere.move": 1}}, "set.task.nowhere.move"),
    ("/v1/scenes/parse", {"text": SHORT_TEXT, "move": {"kind": "body", "name": "a", "by_mm": [1, 1]}}, "move.name"),
    ("/v1/scenes/parse", {"text": SHORT_TEXT, "move": {"kind": "body", "name": 3, "by_mm": [1, 1]}}, "move.name"),
)
"""Calls of the service that are refused: address, body, and the field that the problem must name."""

"""A request keeps the trace that it came with, and says where its time went."""

from __future__ import annotations

import re
from typing import Any

import httpx
import pytest

from assur.api.telemetry.trace import new_traceparent

TRACE, SPAN = "0af7651916cd43dd8448eb211c80319c", "b7ad6b7169203331"
MADE = re.compile(r"00-([0-9a-f]{32})-([0-9a-f]{16})-(0[01])")


@pytest.mark.parametrize(
    ("given", "flags"),
    [(f"00-{TRACE}-{SPAN}-01", "01"), (f"00-{TRACE}-{SPAN}-00", "00"), (f"cc-{TRACE}-{SPAN}-03-more", "01")],
)
def test_a_valid_header_is_continued_with_a_span_of_our_own(given: str, flags: str) -> None:
    found = MADE.fullmatch(new_traceparent([given]))
    assert found is not None
    assert found[1] == TRACE
    assert found[2] != SPAN
    assert found[3] == flags


@pytest.mark.parametrize(
    "given",
    [
        [],
        [""],
        [f"00-{TRACE}-{SPAN}-01"] * 2,
        [f"ff-{TRACE}-{SPAN}-01"],
        [f"00-{'0' * 32}-{SPAN}-01"],
        [f"00-{TRACE}-{'0' * 16}-01"],
        [f"00-{TRACE}-{SPAN}-01-more"],
        [f"00-{TRACE.upper()}-{SPAN}-01"],
        [f"00-{TRACE}-{SPAN}-0g"],
        [f"00-{TRACE}-{SPAN}"],
    ],
)
def test_without_a_valid_header_there_is_a_trace_of_its_own(given: list[str]) -> None:
    found = MADE.fullmatch(new_traceparent(given))
    assert found is not None
    assert found[1] != TRACE
    assert found[3] == "00"


def test_an_answer_says_its_trace_and_where_its_time_went(client: httpx.Client, small: dict[str, Any]) -> None:
    answer = client.post("/v1/plans", json=small, headers={"traceparent": f"00-{TRACE}-{SPAN}-01"})
    assert answer.headers["traceparent"].split("-")[1] == TRACE
    assert re.fullmatch(r"[0-9a-f]{32}", answer.headers["x-request-id"])
    times = dict(re.findall(r"(\w+);dur=([\d.]+)", answer.headers["server-timing"]))
    assert list(times) == ["queue", "read", "build", "search", "margins", "write"]
    spent = 1e-3 * sum(float(each) for stage, each in times.items() if stage not in ("queue", "write"))
    assert spent >= 0.9 * answer.json()["elapsed_s"] - 0.001


def test_an_answer_without_a_worker_says_no_times(client: httpx.Client) -> None:
    assert "server-timing" not in client.get("/v1/robots").headers
    assert "traceparent" in client.get("/livez").headers


def test_the_version_says_what_an_answer_depends_on(client: httpx.Client) -> None:
    told = client.get("/v1/version").json()
    assert told["schema"] == "assur/1"
    assert re.fullmatch(r"[0-9a-f]{16}", told["kernels"])
    assert told["commit"] is None
    assert {"numpy", "numba", "ruckig"} <= told["libraries"].keys()

"""An audit that could not ask is not a clean one. What pip-audit writes is quoted in its own form."""

from __future__ import annotations

import json

import pytest

from deploy.audit import CLEAN, NOT_AUDITED, VULNERABLE, Verdict, judge, rounds

RELEASES = [("h11", "0.16.0"), ("idna", "3.20")]
FINE = {"name": "h11", "version": "0.16.0", "vulns": []}
ALSO_FINE = {"name": "idna", "version": "3.20", "vulns": []}
BAD = {"name": "idna", "version": "3.20", "vulns": [{"id": "PYSEC-0000-1", "fix_versions": ["3.21"], "aliases": []}]}
SKIPPED = {"name": "idna", "skip_reason": "Dependency not found on PyPI and could not be audited: idna (3.20)"}
OTHER = {"name": "idna", "version": "3.19", "vulns": []}


def said(*dependencies: object) -> str:
    return json.dumps({"dependencies": dependencies, "fixes": []})


@pytest.mark.parametrize(
    ("answer", "error", "code", "words"),
    [
        (said(FINE, ALSO_FINE), "", CLEAN, "2 releases were audited, 0 of them"),
        (said(FINE, BAD), "Found 1 known vulnerability", VULNERABLE, "idna 3.20: PYSEC-0000-1, mended in 3.21"),
        (
            said(FINE, SKIPPED),
            "No known vulnerabilities found",
            NOT_AUDITED,
            "NOT AUDITED idna 3.20: Dependency not found",
        ),
        (said(FINE, OTHER), "", NOT_AUDITED, "NOT AUDITED idna 3.20: left out of the answer"),
        (said(FINE), "", NOT_AUDITED, "NOT AUDITED idna 3.20: left out of the answer"),
        (said(SKIPPED), "", NOT_AUDITED, "2 could not be audited, so nothing is known of them"),
        ("", "Traceback\nConnectionError: no such host", NOT_AUDITED, "h11 0.16.0: ConnectionError: no such host"),
        ("[]", "", NOT_AUDITED, "no answer, and no error"),
    ],
)
def test_vulnerable_clean_and_not_audited_are_three_things(answer: str, error: str, code: int, words: str) -> None:
    verdict = Verdict()
    judge(RELEASES, answer, error, verdict)
    assert verdict.exit_code == code
    assert words in "\n".join(verdict.lines())


def test_a_vulnerable_release_is_told_where_another_could_not_be_asked_for() -> None:
    verdict = Verdict()
    judge([*RELEASES, ("rich", "15.0.0")], said(FINE, BAD), "", verdict)
    assert verdict.exit_code == VULNERABLE
    assert len(verdict.not_audited) == 1


def test_a_package_that_is_locked_twice_is_asked_for_twice() -> None:
    twice = [("numpy", "2.4.6"), ("h11", "0.16.0"), ("numpy", "2.5.5"), ("h11", "0.16.0")]
    assert rounds(twice) == [[("h11", "0.16.0"), ("numpy", "2.4.6")], [("numpy", "2.5.5")]]

"""Checks, before anything is shown, that a document is an answer of this version, and belongs to the request."""

from __future__ import annotations

from typing import Any

from assur.planner.model.scene import Scene
from assur.scenes.faults import Refused, located, within
from assur.scenes.reading.plan import CERTIFICATE_DIGEST, PLAN
from assur.scenes.schema import answer as document
from assur.scenes.schema.normal import plain
from assur.scenes.schema.read import read_written

PROOF = ("certificate", document.Certificate | document.CertificateDigest)
PARTS = ("schema", "status", "trajectory", "legs", "arrivals", "certificate")
"""What a plan with its proof must have."""
FORMS: dict[str, Any] = {
    "planned": document.PlannedAnswer,
    "not_planned": document.NotPlannedAnswer,
    "proved": document.partial(document.CheckedPlan, None, PARTS, (PROOF,)),
}
"""What an answer may be, and a plan with its proof and nothing of a search, as an export writes it."""
ANSWERS = ("planned", "not_planned")
"""Each status of an answer."""


def answer_in(given: object, scene: Scene) -> dict[str, Any]:
    """An answer to the request of a scene, or a plan with its proof and nothing of a search, as an export writes it;
    with the digest of its certificate in place of the rows.

    Raises `DocumentError` below "plan" at the first field that is not as an answer has it. What it says is not checked.
    """
    answer = plain(given)
    with located({PLAN: answer}), within(PLAN):
        if not isinstance(answer, dict):
            raise Refused("an answer, as `assur plan --out` writes it")
        status = answer.get("status")
        if not isinstance(status, str) or status not in ANSWERS:
            raise Refused("planned or not_planned: an answer, as `assur plan --out` writes it", "status")
        if answer.get("request_digest") not in (None, scene.digest):
            raise Refused(f"{scene.digest}, that of the request; this answer is one to another", "request_digest")
    certificate = answer.get("certificate")
    if isinstance(certificate, dict):
        brief = {key: value for key, value in certificate.items() if key in CERTIFICATE_DIGEST}
        answer = {**answer, "certificate": brief}
    read_written(FORMS[_name(answer)], answer, answer, (PLAN,))
    return dict(answer)


def _name(answer: dict[str, Any]) -> str:
    """Of the form that a document must have. A planned one is a whole answer if it says anything of the search."""
    planned = answer["status"] == "planned"
    return "proved" if planned and answer.keys() <= document.CheckedPlan.__annotations__.keys() else answer["status"]

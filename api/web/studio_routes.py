"""The studio: a page that writes, plans and shows scenarios, by the public addresses of this service alone."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from fastapi import APIRouter
from starlette.responses import Response

from assur.api.problems import Problem
from assur.scenes.report.assembly import digests

FILES = Path(__file__).parent / "studio"
SCRIPTS = ("answers", "documents", "drafts", "history", "jobs", "service", "storage", "studio")
KINDS = {"studio.css": "text/css"} | {f"{name}.js": "text/javascript" for name in SCRIPTS}
"""The files of the page, and what they are."""

studio_router = APIRouter(include_in_schema=False)


@cache
def _page() -> tuple[bytes, dict[str, str]]:
    """The page, and the policy that it is sent with: its own files, this service, and the reports that it shows, which
    inherit the policy."""
    script, style = digests()
    policy = (
        f"default-src 'none'; script-src 'self' {script}; style-src 'self' {style}; connect-src 'self'; "
        "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
    )
    return (FILES / "studio.html").read_bytes(), {"Content-Security-Policy": policy}


@studio_router.get("/studio")
def studio() -> Response:
    page, headers = _page()
    return Response(page, media_type="text/html", headers=headers)


@studio_router.get("/studio/{name}")
def studio_file(name: str) -> Response:
    if name not in KINDS:
        raise Problem("not-found", "See /docs for what there is.")
    return Response((FILES / name).read_bytes(), media_type=KINDS[name])

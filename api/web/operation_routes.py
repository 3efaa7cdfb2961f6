"""The addresses for operators and newcomers: metrics, which build this is, what there is, and the studio."""

from __future__ import annotations

import asyncio
from functools import cache
from pathlib import Path

from fastapi import Request
from prometheus_client import CONTENT_TYPE_LATEST
from starlette.responses import Response

from assur.api.documents import json_response
from assur.api.log_lines import Later
from assur.api.problems import Problem
from assur.api.telemetry.meters import Meters
from assur.api.version import version_document
from assur.api.web.clients import Clients
from assur.api.web.job_store import JobStore
from assur.api.web.routes import service_of
from assur.api.web.service import Service
from assur.scenes.report.assembly import digests, page

INDEX = Path(__file__).parent / "index.html"
POLICY = {"Content-Security-Policy": "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"}


def index(_: Request) -> Response:
    return Response(INDEX.read_bytes(), media_type="text/html", headers=POLICY)


async def show_version(request: Request) -> Response:
    return json_response(version_document(service_of(request).settings.commit))


async def metrics(request: Request) -> Response:
    service = service_of(request)
    if service.meshes is not None:
        service.mesh_bytes = await asyncio.to_thread(service.meshes.used)
    # on the event loop, so that all numbers are of one moment; it takes a few milliseconds
    return Response(service.meters.text(), headers={"Content-Type": CONTENT_TYPE_LATEST})


def watch(service: Service, jobs: JobStore, clients: Clients) -> Meters:
    """The meters of a service, with what it has besides its workers."""
    meters = service.meters
    meters.gauge("assur_jobs_kept", "Jobs that are worked on or kept.", lambda: len(jobs))
    meters.counter("assur_log_lines_lost_total", "Lines of the log that were dropped since the start.", Later.lost)
    if service.settings.keys_file:
        about = "1 while the file of keys can be used as it is; 0 while the keys of before its change count."
        meters.gauge("assur_keys_file_usable", about, lambda: float(clients.usable))
    if service.meshes is not None:
        quota = service.meshes.quota_bytes
        meters.gauge("assur_mesh_folder_bytes", "Room that files for meshes take.", lambda: service.mesh_bytes)
        meters.gauge("assur_mesh_folder_quota_bytes", "Room that they may take.", lambda: quota)
    build = version_document(service.settings.commit)
    meters.build.info(
        {name: str(build.get(name) or "") for name in ("version", "schema", "kernels", "commit", "python")}
    )
    return meters


FILES = Path(__file__).parent / "studio"
SCRIPTS = (
    *("answers", "differences", "documents", "drafts", "drawing", "editor", "faults", "files", "history", "jobs"),
    *("links", "parts", "selection", "service", "simulations", "storage", "studio"),
)
KINDS = {"studio.css": "text/css"} | {f"{name}.js": "text/javascript" for name in SCRIPTS}
"""The files of the page, and what they are."""
PLAYER = "player.html"
"""The page that draws the cell of the text in the studio: as a report has it, with nothing to play yet."""


@cache
def _studio_page() -> tuple[bytes, dict[str, str]]:
    """The page, and the policy that it is sent with: its own files, this service, and the reports that it shows, which
    inherit the policy."""
    script, style = digests()
    policy = (
        f"default-src 'none'; script-src 'self' {script}; style-src 'self' {style}; connect-src 'self'; "
        "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
    )
    return (FILES / "studio.html").read_bytes(), {"Content-Security-Policy": policy}


def studio(_: Request) -> Response:
    page, headers = _studio_page()
    return Response(page, media_type="text/html", headers=headers)


def studio_file(request: Request) -> Response:
    name = request.path_params["name"]
    if name == PLAYER:
        return Response(page("cell", "", "", None), media_type="text/html", headers=POLICY)
    if name not in KINDS:
        raise Problem("not-found", "See /docs for what there is.")
    return Response((FILES / name).read_bytes(), media_type=KINDS[name])

"""Cells by the SHA-256 of their documents: sent once, and planned with many tasks from then on."""

from __future__ import annotations

import asyncio

from fastapi import Request
from starlette.responses import Response
from typing_extensions import TypedDict

from assur.api.documents import json_response
from assur.api.problems import Problem
from assur.api.web import plan_files
from assur.api.web.clients import client_of
from assur.api.web.mesh_routes import digest_of, folder_of, keep, require_digest, until, uploaded
from assur.api.web.request_log import FACTS
from assur.api.web.routes import certificate_of, once, read_admitted, service_of, unless_gone
from assur.api.web.settings import PLAN_BODY_BYTES
from assur.api.workers import cell_jobs
from assur.api.workers.answer_parts import NAMES, parts_wanted
from assur.scenes.faults import raised_as
from assur.scenes.meshes.folder import StoredFile


class StoredCell(TypedDict):
    """A cell that is known: its size, and until when it is kept if it is not planned."""

    sha256: str
    bytes: int
    expires: str


async def put_cell(request: Request) -> Response:
    folder, digest = folder_of(request), digest_of(request)
    content = await read_admitted(request, PLAN_BODY_BYTES)
    require_digest(digest, content)

    async def kept() -> bool:
        await service_of(request).quick(cell_jobs.check_cell, client_of(request), content)
        return await asyncio.to_thread(keep, folder, digest, content, "cell")

    is_new = await uploaded(request, kept, len(content))
    request.scope[FACTS]["outcome"] = "new" if is_new else "known"
    return _response(digest, folder.known(digest, "cell"), 201 if is_new else 200)


def show_cell(request: Request) -> Response:
    folder, digest = folder_of(request), digest_of(request)
    return _response(digest, folder.known(digest, "cell"), 200)


async def plan_task(request: Request) -> Response:
    folder, digest = folder_of(request), digest_of(request)
    how, client = plan_files.file_wanted(request), client_of(request)
    if how is None:
        certificate = certificate_of(request)
        with raised_as(Problem.of_input):
            parts = parts_wanted(*map(request.query_params.get, NAMES))
        body = await read_admitted(request, PLAN_BODY_BYTES, "certificate", *NAMES, *plan_files.NAMES)
    else:
        body = await read_admitted(request, PLAN_BODY_BYTES, *plan_files.NAMES)
    if not folder.use(digest, "cell"):
        raise cell_jobs.unknown(digest)
    service = service_of(request)

    async def planned() -> Response:
        if how is None:
            order = await service.task_order(digest, body, certificate, parts, client)
        else:
            order = await service.task_file_order(digest, body, how, client)
        return await unless_gone(request, service.do(order))

    return await once(request, body, planned)


def _response(digest: str, kept: StoredFile | None, status: int) -> Response:
    if kept is None:
        raise cell_jobs.unknown(digest)
    return json_response(StoredCell(sha256=digest, bytes=kept.size, expires=until(kept)), status)

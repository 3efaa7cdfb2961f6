"""Meshes by the SHA-256 of their files: sent once, and named by requests from then on."""

from __future__ import annotations

import asyncio
import hashlib
import json
import logging
import time
from collections.abc import Awaitable, Callable
from datetime import UTC, datetime
from typing import get_args

from fastapi import Request
from starlette.responses import Response
from typing_extensions import TypedDict

from assur.api.documents import json_response
from assur.api.logs import event
from assur.api.problems import FieldError, Problem
from assur.api.web.clients import client_of
from assur.api.web.request_log import FACTS
from assur.api.web.routes import read_admitted, service_of
from assur.api.web.uploads import Uploads
from assur.api.workers import jobs
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_MESH_BYTES
from assur.scenes.meshes.folder import DIGEST, FolderError, Kind, MeshFolder, StoredFile
from assur.scenes.schema.shapes import MeshFormat, MeshUnit


class Covered(TypedDict):
    """How a mesh is covered: convex pieces, and how far they reach out of it, m."""

    pieces: int
    excess_m: float


class KeptMesh(TypedDict):
    """A mesh that is known: its size, until when it is kept if no request names it, and its cover, if it is covered."""

    sha256: str
    bytes: int
    expires: str
    cover: Covered | None


async def put_mesh(request: Request) -> Response:
    folder, digest = folder_of(request), digest_of(request)
    how = _covering(request)
    content = await read_admitted(request, MAX_MESH_BYTES, "format", "unit", json=False)
    if not content:
        raise Problem.of_input(InputError("body", "0 bytes", "the bytes of a mesh file"))
    is_new = await uploaded(request, lambda: asyncio.to_thread(keep, folder, digest, content), len(content))
    cover = None
    if how is not None:
        found = json.loads((await service_of(request).quick(jobs.cover, client_of(request), digest, *how)).body)
        cover = Covered(pieces=found["pieces"], excess_m=found["excess_m"])
    request.scope[FACTS]["outcome"] = "new" if is_new else "known"
    return _response(digest, folder.known(digest), cover, 201 if is_new else 200)


def show_mesh(request: Request) -> Response:
    folder, digest = folder_of(request), digest_of(request)
    return _response(digest, folder.known(digest), None, 200)


def folder_of(request: Request) -> MeshFolder:
    """The folder for meshes and cells. Raises `Problem` where there is none."""
    folder = service_of(request).meshes
    if folder is None:
        what = "Send meshes as data, and cells as documents in requests. An operator may set ASSUR_MESH_FOLDER."
        raise Problem("no-mesh-folder", what)
    return folder


def digest_of(request: Request) -> str:
    """The digest in the address. Raises `Problem`."""
    digest = str(request.path_params["sha256"])
    if not DIGEST.fullmatch(digest):
        raise Problem.of_input(InputError("sha256", digest, "64 hexadecimal digits, small letters"))
    return digest


def _covering(request: Request) -> tuple[str, str] | None:
    """Format and unit with which a mesh is to be covered; None: later. Raises `Problem`."""
    given = {name: request.query_params.get(name) for name in ("format", "unit")}
    if given == {"format": None, "unit": None}:
        return None
    found: list[str] = []
    for name, allowed in (("format", get_args(MeshFormat)), ("unit", get_args(MeshUnit))):
        value = given[name]
        if value is None or value not in allowed:
            raise Problem.of_input(InputError(name, value, f"one of {', '.join(allowed)}, with format and unit both"))
        found.append(value)
    return found[0], found[1]


def require_digest(digest: str, content: bytes) -> None:
    """Raises the `Problem` of bytes with another digest."""
    there = hashlib.sha256(content).hexdigest()
    if there != digest:
        error = FieldError("body", f"{len(content)} bytes with the SHA-256 {there}", f"bytes with the SHA-256 {digest}")
        raise Problem("bad-input", str(error), (error,))


async def uploaded(request: Request, kept: Callable[[], Awaitable[bool]], size: int) -> bool:
    """Whether a file of so many bytes is new, as `kept` says; those count as an upload of the client. Raises
    `Problem`."""
    uploads: Uploads = request.app.state.uploads
    name, is_new = client_of(request).name, False
    uploads.add(name, size)
    try:
        is_new = await kept()
    finally:
        if not is_new:
            uploads.take_back(name, size)
    return is_new


def keep(folder: MeshFolder, digest: str, content: bytes, kind: Kind = "mesh") -> bool:
    """Keeps the bytes of a mesh or a cell; whether they are new. Raises `Problem`."""
    require_digest(digest, content)
    try:
        return folder.put(digest, content, kind)
    except FolderError as error:
        event("a mesh is not kept", logging.ERROR, why=str(error))
        problem = "mesh-folder-full" if error.full else "mesh-folder-fault"
        raise Problem(problem, f"{error}. Send all of it in requests meanwhile.") from error


def until(kept: StoredFile) -> str:
    """Until when a file is kept if it is not used again."""
    return datetime.fromtimestamp(time.time() + kept.left_s, UTC).isoformat(timespec="seconds")


def _response(digest: str, kept: StoredFile | None, cover: Covered | None, status: int) -> Response:
    if kept is None:
        raise Problem("mesh-unknown", f"Send the file with PUT /v1/meshes/{digest}.")
    document = KeptMesh(sha256=digest, bytes=kept.size, expires=until(kept), cover=cover)
    return json_response(document, status)

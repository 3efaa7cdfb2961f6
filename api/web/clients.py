"""The client of a request: the holder of a key where the service has keys, else all who use one address.

An ASGI middleware: it leaves the client in the scope of each request, and refuses one without a key that is known.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from pathlib import Path

from starlette.requests import Request
from starlette.routing import BaseRoute, Match
from starlette.types import ASGIApp, Receive, Scope, Send

from assur.api.documents import problem_response
from assur.api.keys import clients_of, digest, keys_in, unlimited
from assur.api.logs import event
from assur.api.problems import Problem
from assur.api.web.addresses import network
from assur.api.web.header_values import values_of
from assur.api.web.request_log import FACTS
from assur.api.web.settings import Settings
from assur.api.workers.client import Client
from assur.planner.errors import InputError

CLIENT = "assur.client"
"""Key of the request scope under which the client is."""
KEPT = "/v1/"
"""What needs a key begins with this, but for `OPEN`. Pages, health and metrics are for all who reach the service."""
OPEN = frozenset({"/v1/version"})
FIELD = "ASSUR_KEYS_FILE"
REREAD_S = 2.0
"""So often a file of keys is compared with the last one, s: one that has changed counts without a restart."""


def needs_key(path: str) -> bool:
    """Whether an address is for those who have a key, where the service has keys."""
    return path.startswith(KEPT) and path not in OPEN


def client_of(request: Request) -> Client:
    """Who sent a request."""
    client: Client = request.scope[CLIENT]
    return client


class Clients:
    """Whom the service knows. Raises `InputError` for a file of keys that cannot be used."""

    def __init__(self, settings: Settings) -> None:
        self._all = Client(
            "all",
            unlimited(settings.client_running),
            settings.client_waiting,
            unlimited(settings.client_seconds),
        )
        self._file = Path(settings.keys_file) if settings.keys_file else None
        self.usable = True
        """Whether the file of keys can be used as it is now."""
        self._holders: dict[str, Client] = {}
        self._stamp: tuple[int, int] | None = None
        self._looked = 0.0
        if self._file is not None:
            self._holders = clients_of(keys_in(self._file, FIELD), self._all)
            self._stamp, self._looked = _stamp(self._file), time.monotonic()

    def of(self, authorization: str | None, address: str) -> Client:
        """The client with this header, or of this address. Raises `Problem`: unauthorized."""
        if self._file is None:
            return Client(network(address), self._all.running, self._all.waiting, self._all.seconds)
        self._look(self._file)
        scheme, _, key = (authorization or "").partition(" ")
        holder = self._holders.get(digest(key.strip())) if scheme.lower() == "bearer" else None
        if holder is None:
            given = "a key that is not known" if authorization else "no key"
            raise Problem(
                "unauthorized",
                f"The request has {given}. Send Authorization: Bearer KEY, with a key of this service.",
                headers={"WWW-Authenticate": "Bearer"},
            )
        return holder

    def _look(self, file: Path) -> None:
        """Reads the keys anew where their file has changed; one that cannot be used changes nothing, and is logged."""
        if time.monotonic() - self._looked < REREAD_S:
            return
        self._looked = time.monotonic()
        stamp = _stamp(file)
        if stamp == self._stamp:
            return
        self._stamp = stamp
        self.usable = False
        try:
            self._holders = clients_of(keys_in(file, FIELD), self._all)
            self.usable = True
        except InputError as error:
            event("the file of keys cannot be used: those of before count", logging.ERROR, why=str(error))
        else:
            event("the file of keys was read anew", keys=len(self._holders))


class KnowsClients:
    """ASGI middleware: each request has its client in its scope. Raises nothing: who has no key is answered."""

    def __init__(self, app: ASGIApp, clients: Clients, routes: Sequence[BaseRoute]) -> None:
        self._app = app
        self._clients = clients
        self._routes = routes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and needs_key(scope["path"]):
            peer = scope.get("client")
            try:
                client = self._clients.of(_authorization(scope), peer[0] if peer else "")
            except Problem as problem:
                scope[FACTS] |= {"problem": problem.kind, "client": network(peer[0] if peer else "")}
                # it is not routed any more; the log and the metrics need the route
                scope["route"] = next((each for each in self._routes if each.matches(scope)[0] is Match.FULL), None)
                await problem_response(problem)(scope, receive, send)
                return
            scope[CLIENT] = client
            scope[FACTS]["client"] = client.name
        await self._app(scope, receive, send)


def _authorization(scope: Scope) -> str | None:
    found = values_of(scope["headers"], b"authorization")
    return found[0] if len(found) == 1 else None


def _stamp(file: Path) -> tuple[int, int] | None:
    """What changes with the content of a file; None: the file cannot be read."""
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_ino

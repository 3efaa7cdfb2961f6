"""Clients of the service: what `import assur` does in this process, done by another one over HTTP.

Both are thin: `assur.api.python.exchange` says what is sent and what is made of the answers.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar, Unpack

from assur.api.python import exchange
from assur.api.python.answer import Answer
from assur.api.python.exchange import Exchange, Health, Question
from assur.api.python.service_errors import ServiceError
from assur.planner.errors import InputError

try:
    import httpx
except ModuleNotFoundError as missing:
    if missing.name != "httpx":
        raise
    raise ModuleNotFoundError(
        "assur.Client and assur.AsyncClient need httpx, which is not installed: pip install 'assur[client]'",
        name="httpx",
    ) from None

if TYPE_CHECKING:
    from assur.api.python.cell import Cell
    from assur.request import Request
    from assur.scenes.schema.answer import Verdict
    from assur.scenes.schema.ik import IkAnswer

T = TypeVar("T")

MOST_CELLS = 16
"""Cells whose documents a client keeps."""
TIMEOUT_S = 120.0
"""Longest wait for an answer, if the caller names none: a service gives a plan up to twice 60 s by its own defaults."""


class _Endpoint:
    """Where the service is, and how long to wait for it. `_library`: the class of the connections."""

    _library: Any

    def __init__(
        self, url: str, *, timeout: float = TIMEOUT_S, key: str | None = None, headers: Mapping[str, str] | None = None
    ) -> None:
        """`url`: address of the service, such as ``http://127.0.0.1:8000``; `timeout`: longest wait for an answer, s,
        longer than the budgets of a request; `key`: the API key, for a service that has keys; `headers`: sent with each
        request, for a proxy that asks for them.

        Raises `InputError` for an address of another form, and for a key that no header can hold.
        """
        try:
            is_address = httpx.URL(url).scheme in ("http", "https") and httpx.URL(url).host
        except httpx.InvalidURL:
            is_address = False
        if not is_address:
            raise InputError("url", url, "an address such as http://127.0.0.1:8000")
        if not timeout > 0:
            raise InputError("timeout", timeout, "a time in s, more than 0")
        if key is not None and not (key.isascii() and key.isprintable() and key.strip() == key != ""):
            raise InputError("key", f"{len(key)} characters", "a key of the service, as `assur keys add` has shown it")
        own = {} if key is None else {"Authorization": f"Bearer {key}"}
        self.url = url
        self._timeout = timeout
        self._cells: dict[str, dict[str, Any]] = {}
        self._http = self._library(base_url=url, timeout=timeout, headers={**own, **(headers or {})})

    def _kept(self, question: Exchange[str], digest: str) -> str:
        """The digest of a cell that was sent; its document is kept as it was sent."""
        self._cells.pop(digest, None)
        self._cells[digest] = json.loads(question.body or b"")
        while len(self._cells) > MOST_CELLS:
            del self._cells[next(iter(self._cells))]
        return digest

    def _result(self, question: Exchange[T], response: httpx.Response) -> T:
        return question.result(self.url, response.status_code, response.headers, response.content)

    def _sent(self, question: Exchange[T]) -> dict[str, Any]:
        """The request as the library has it. Raises `ServiceError` for a client that is closed."""
        if self._http.is_closed:
            raise ServiceError(self.url, "this client is closed; make another one")
        return {
            "method": question.method,
            "url": question.path,
            "params": dict(question.parameters),
            "content": question.body,
            "headers": question.headers,
        }

    def _lost(self, error: httpx.RequestError) -> ServiceError:
        if isinstance(error, httpx.TimeoutException):
            return ServiceError(self.url, f"no answer within {self._timeout:g} s; a longer timeout may help")
        return ServiceError(self.url, f"not reached ({error}); see whether `assur serve` runs there")


class Client(_Endpoint):
    """A client of the service at `url`. It keeps connections: use it in a ``with`` block, or call `close`.

    Each method raises `RemoteInputError`, which is an `InputError`, for a request with a field that is not right,
    another `ProblemError` for what else the service cannot do, and `ServiceError` if it is not there, or this client
    is closed.
    """

    _library = httpx.Client

    def plan(self, request: Mapping[str, Any] | Request, *, certificate: Literal["full", "digest"] = "full") -> Answer:
        """The answer to a request, or to the shipped scenario that ``{"scenario": name}`` names; as `assur.plan`."""
        return self._send(exchange.planning(request, certificate))

    def put_cell(self, cell: Mapping[str, Any]) -> str:
        """Sends the document of a cell, which the service keeps; its digest, which names it in `plan_task`. This client
        keeps the document of the cells that it sent last, for the answers of `plan_task`."""
        question = exchange.keeping(cell)
        return self._kept(question, self._send(question))

    def plan_task(
        self,
        digest: str,
        *,
        start: object,
        steps: list[Any],
        parts: list[Any] | None = None,
        options: object = None,
        set: Mapping[str, object] | None = None,  # noqa: A002 as of `assur.Cell`
        certificate: Literal["full", "digest"] = "full",
        fields: Sequence[str] | None = None,
        digits: int | None = None,
        cell: Cell | Mapping[str, Any] | None = None,
    ) -> Answer:
        """The answer to a task in the cell with this digest; as `plan` of `assur.Cell`.

        `fields`: names of the fields of the answer that are wanted, or paths such as ``trajectory.position``; `digits`:
        significant digits of its numbers (None: all). `cell`: the cell or its document, from which the answer knows its
        request; it may be left out where this client has sent it (`put_cell`). Otherwise ``answer.request`` is None.
        Raises `InputError` for another cell than the one with this digest.
        """
        task: dict[str, object] = {"start": start, "steps": steps, "parts": parts, "options": options, "set": set}
        question = exchange.planning_task(
            digest, task, certificate, fields, digits, self._cells.get(digest) if cell is None else cell
        )
        return self._send(question)

    def simulate(self, cell: str | Cell | Mapping[str, Any], **question: Unpack[Question]) -> Mapping[str, Any]:
        """How many parts a minute a cell takes, and why not more: as `assur.simulate`, which says what the other
        arguments mean. `set`: values of the cell by their paths.

        `cell`: the digest of a cell that was sent (`put_cell`), or the cell or its document. Waits for the end of the
        job, however long that is; an interrupt cancels it. While the job waits for its turn, the service writes a
        comment every 15 s: the `timeout` of the client has to be longer.
        """
        job = self._send(exchange.simulating(cell, question))
        try:
            self._send(exchange.end_of(job))
        except BaseException:
            self._send(exchange.cancelling(job))
            raise
        return self._send(exchange.answer_of(job))

    def check(self, request: Mapping[str, Any] | Request, answer: Mapping[str, Any]) -> Verdict:
        """The checker's verdict on a planned answer with its certificate in full; as `assur.check`."""
        return self._send(exchange.checking(request, answer))

    def ik(self, request: Mapping[str, Any] | Request | None = None, **question: object) -> IkAnswer:
        """The joint positions at a pose, or the pose at joints; as `assur.ik`."""
        return self._send(exchange.kinematics(request, question))

    def robots(self) -> list[dict[str, Any]]:
        """The robots that the service knows, each number with unit, status and source."""
        return self._send(exchange.robots())

    def scenarios(self) -> dict[str, str]:
        """Name and purpose of each scenario that the service ships."""
        return self._send(exchange.scenarios())

    def load(self, name: str) -> dict[str, Any]:
        """The request of a scenario that the service ships, as a plain document of its own."""
        return self._send(exchange.loading(name))

    def upload_mesh(
        self, content: bytes, form: Literal["stl", "obj", "ply", "glb"], unit: Literal["m", "mm", "cm", "in"]
    ) -> dict[str, Any]:
        """Sends the bytes of a mesh file, which the service keeps and covers now. The mesh as requests name it from
        then on, as in ``{"shape": {"mesh": client.upload_mesh(content, "stl", "mm")}}``."""
        return self._send(exchange.uploading(content, form, unit))

    def health(self) -> Health:
        """Whether the service takes requests; raises `ServiceError` if nothing is there."""
        return self._send(exchange.health())

    def close(self) -> None:
        """Closes the connections."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _send(self, question: Exchange[T]) -> T:
        sent = self._sent(question)
        try:
            response = self._http.request(**sent)
        except httpx.RequestError as error:
            raise self._lost(error) from error
        return self._result(question, response)


class AsyncClient(_Endpoint):
    """`Client` for asyncio: the same methods, to be awaited. Use it in an ``async with`` block, or await `aclose`."""

    _library = httpx.AsyncClient

    async def plan(
        self, request: Mapping[str, Any] | Request, *, certificate: Literal["full", "digest"] = "full"
    ) -> Answer:
        """The answer to a request, or to the shipped scenario that ``{"scenario": name}`` names; as `assur.plan`."""
        return await self._send(exchange.planning(request, certificate))

    async def put_cell(self, cell: Mapping[str, Any]) -> str:
        """Sends the document of a cell, which the service keeps; its digest, which names it in `plan_task`. This client
        keeps the document of the cells that it sent last, for the answers of `plan_task`."""
        question = exchange.keeping(cell)
        return self._kept(question, await self._send(question))

    async def plan_task(
        self,
        digest: str,
        *,
        start: object,
        steps: list[Any],
        parts: list[Any] | None = None,
        options: object = None,
        set: Mapping[str, object] | None = None,  # noqa: A002 as of `assur.Cell`
        certificate: Literal["full", "digest"] = "full",
        fields: Sequence[str] | None = None,
        digits: int | None = None,
        cell: Cell | Mapping[str, Any] | None = None,
    ) -> Answer:
        """The answer to a task in the cell with this digest; as `plan` of `assur.Cell`.

        `fields`: names of the fields of the answer that are wanted, or paths such as ``trajectory.position``; `digits`:
        significant digits of its numbers (None: all). `cell`: the cell or its document, from which the answer knows its
        request; it may be left out where this client has sent it (`put_cell`). Otherwise ``answer.request`` is None.
        Raises `InputError` for another cell than the one with this digest.
        """
        task: dict[str, object] = {"start": start, "steps": steps, "parts": parts, "options": options, "set": set}
        question = exchange.planning_task(
            digest, task, certificate, fields, digits, self._cells.get(digest) if cell is None else cell
        )
        return await self._send(question)

    async def simulate(self, cell: str | Cell | Mapping[str, Any], **question: Unpack[Question]) -> Mapping[str, Any]:
        """How many parts a minute a cell takes, and why not more: as `assur.simulate`, which says what the other
        arguments mean. `set`: values of the cell by their paths.

        `cell`: the digest of a cell that was sent (`put_cell`), or the cell or its document. Waits for the end of the
        job, however long that is; an interrupt cancels it. While the job waits for its turn, the service writes a
        comment every 15 s: the `timeout` of the client has to be longer.
        """
        job = await self._send(exchange.simulating(cell, question))
        try:
            await self._send(exchange.end_of(job))
        except BaseException:
            await self._send(exchange.cancelling(job))
            raise
        return await self._send(exchange.answer_of(job))

    async def check(self, request: Mapping[str, Any] | Request, answer: Mapping[str, Any]) -> Verdict:
        """The checker's verdict on a planned answer with its certificate in full; as `assur.check`."""
        return await self._send(exchange.checking(request, answer))

    async def ik(self, request: Mapping[str, Any] | Request | None = None, **question: object) -> IkAnswer:
        """The joint positions at a pose, or the pose at joints; as `assur.ik`."""
        return await self._send(exchange.kinematics(request, question))

    async def robots(self) -> list[dict[str, Any]]:
        """The robots that the service knows, each number with unit, status and source."""
        return await self._send(exchange.robots())

    async def scenarios(self) -> dict[str, str]:
        """Name and purpose of each scenario that the service ships."""
        return await self._send(exchange.scenarios())

    async def load(self, name: str) -> dict[str, Any]:
        """The request of a scenario that the service ships, as a plain document of its own."""
        return await self._send(exchange.loading(name))

    async def upload_mesh(
        self, content: bytes, form: Literal["stl", "obj", "ply", "glb"], unit: Literal["m", "mm", "cm", "in"]
    ) -> dict[str, Any]:
        """Sends the bytes of a mesh file, which the service keeps and covers now. The mesh as requests name it from
        then on, as in ``{"shape": {"mesh": client.upload_mesh(content, "stl", "mm")}}``."""
        return await self._send(exchange.uploading(content, form, unit))

    async def health(self) -> Health:
        """Whether the service takes requests; raises `ServiceError` if nothing is there."""
        return await self._send(exchange.health())

    async def aclose(self) -> None:
        """Closes the connections."""
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.aclose()

    async def _send(self, question: Exchange[T]) -> T:
        sent = self._sent(question)
        try:
            response = await self._http.request(**sent)
        except httpx.RequestError as error:
            raise self._lost(error) from error
        return self._result(question, response)

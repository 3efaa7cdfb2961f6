"""What an operator or a newcomer does first with a service: look at its address, its metrics, try a WebSocket."""

from __future__ import annotations

import re
import socket
from collections.abc import Iterator
from html.parser import HTMLParser

import httpx
import pytest

from tests.api.processes import serving, until
from tests.api.running import running
from tests.api.test_metrics import value


class Links(HTMLParser):
    """The addresses that a page links to."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found += [value or "" for name, value in attrs if tag == "a" and name == "href"]


@pytest.fixture(scope="module", params=["", "/cell-7"], ids=["at the root", "below a path"])
def service(request: pytest.FixtureRequest) -> Iterator[httpx.Client]:
    with running(below=request.param) as client:
        yield client


def test_the_address_of_the_service_is_a_page_and_its_links_lead_somewhere(service: httpx.Client) -> None:
    page = service.get("")
    page = service.get("/") if page.status_code != 200 else page
    assert (page.status_code, page.headers["Content-Type"]) == (200, "text/html; charset=utf-8")
    links = Links(page.text).found
    assert {"studio", "docs", "openapi.json", "v1/schema", "readyz"} <= set(links)
    for link in links:
        assert service.get(link).status_code == 200, link


def test_every_address_that_there_is_counts_under_its_own_route(client: httpx.Client) -> None:
    before = client.get("/metrics").text
    script = re.search(r'src="([^"]*static-offline-docs/[^"]+\.js)"', client.get("/docs").text)
    assert script is not None
    counted = {
        "/openapi.json": ("/openapi.json", "200"),
        "/docs": ("/docs", "200"),
        "/redoc": ("/redoc", "200"),
        "/": ("/", "200"),
        "/studio/studio.js": ("/studio/{name}", "200"),
        script[1]: ("/static-offline-docs", "200"),
        "/nowhere": ("none", "404"),
        "/v1/plans": ("/v1/plans", "405"),
    }
    for address in counted:
        client.get(address)
    after = client.get("/metrics").text
    name = "assur_requests_total"
    for route, status in counted.values():
        of = {"route": route, "status": status}
        assert value(after, name, **of) > value(before, name, **of), route
    assert value(after, name, route="none") == value(after, name, route="none", status="404")


def test_the_process_that_forks_the_workers_is_in_the_metrics_of_memory(client: httpx.Client) -> None:
    text = client.get("/metrics").text
    for process in ("web", "template", "worker-0"):
        assert value(text, "assur_resident_memory_bytes", process=process) > 10 << 20


UPGRADES = {
    "websocket": (b"Upgrade: websocket\r\nConnection: Upgrade, close\r\n", 400),
    "websocket among others": (b"Upgrade: h2c, WebSocket\r\nConnection: close, upgrade\r\n", 400),
    "another protocol": (b"Upgrade: h2c\r\nConnection: Upgrade, HTTP2-Settings, close\r\n", 200),
    "a header that means nothing alone": (b"Upgrade: websocket\r\nConnection: close\r\n", 200),
}


@pytest.mark.slow
def test_a_websocket_is_refused_in_words_and_nothing_else_is_logged() -> None:
    with serving(WORKERS="1") as server:
        until(server.ready)
        for name, (headers, status) in UPGRADES.items():
            with socket.create_connection(("127.0.0.1", server.port), timeout=30) as connection:
                connection.sendall(b"GET /livez HTTP/1.1\r\nHost: x\r\n" + headers + b"\r\n")
                answer = connection.makefile("rb").read().decode()
            assert answer.startswith(f"HTTP/1.1 {status}"), name
            assert ("urn:assur:problem:no-websockets" in answer) == (status == 400), name
    text = b"".join(server.raw).decode()
    assert '"problem": "no-websockets"' in text
    assert "pip install" not in text
    assert "pgrade" not in text

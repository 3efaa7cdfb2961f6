"""HAProxy with the shipped configuration, and what stands behind it. `make test-proxy` runs these tests."""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest

from tests.api.processes import ROOT, Server, serving, until

SHIPPED = ROOT / "deploy" / "haproxy.cfg"
OTHERS = "127.0.0.1"
ATTACKER = "127.0.0.2"
"""Another address of this machine, from which a test sends what a client should not."""


def program() -> str:
    found = os.environ.get("HAPROXY") or shutil.which("haproxy") or "/usr/sbin/haproxy"
    assert Path(found).exists(), "there is no HAProxy (Debian: apt-get install haproxy)"
    return found


def free_port() -> int:
    with socket.socket() as door:
        door.bind((OTHERS, 0))
        return int(door.getsockname()[1])


def on_this_machine(text: str, port: int, replicas: dict[str, int]) -> str:
    """The shipped configuration with the addresses of a test, and nothing else changed."""
    addresses = {"bind :8080": f"bind {OTHERS}:{port}"}
    addresses |= {f" {name}:8000": f" {OTHERS}:{number}" for name, number in replicas.items()}
    for shipped, ours in addresses.items():
        assert shipped in text, shipped
        text = text.replace(shipped, ours)
    return text


@contextlib.contextmanager
def proxied(folder: Path, replicas: dict[str, int]) -> Iterator[int]:
    """The port of a proxy in front of `replicas`, their ports by name; it ends with the block."""
    port = free_port()
    file = folder / "haproxy.cfg"
    file.write_text(on_this_machine(SHIPPED.read_text(encoding="utf-8"), port, replicas), encoding="utf-8")
    with (folder / "haproxy.log").open("wb") as log:
        process = subprocess.Popen([program(), "-db", "-f", str(file)], stdout=log, stderr=subprocess.STDOUT)
    try:
        until(lambda: answers(port) or process.poll() is not None)
        assert process.poll() is None, (folder / "haproxy.log").read_text(encoding="utf-8")
        yield port
    finally:
        process.kill()
        process.wait()


def answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex((OTHERS, port)) == 0


def sending(port: int, data: bytes, address: str = OTHERS) -> socket.socket:
    """A connection from `address` on which `data` was sent."""
    connection = socket.create_connection((OTHERS, port), timeout=60.0, source_address=(address, 0))
    with contextlib.suppress(ConnectionResetError, BrokenPipeError):  # refused at once: there is no answer then
        connection.sendall(data)
    return connection


def answered(connection: socket.socket) -> bytes:
    """All that comes on a connection until it is closed."""
    found = b""
    with contextlib.suppress(ConnectionResetError):
        while part := connection.recv(65536):
            found += part
    return found


@dataclass
class Pair:
    """Two replicas behind the proxy, and a client of it."""

    port: int
    a: Server
    b: Server
    client: httpx.Client


@contextlib.contextmanager
def replica(name: str, port: int = 0) -> Iterator[Server]:
    """A service with one worker that is ready."""
    with serving(port, REPLICA=name, WORKERS="1", QUEUE="50", GRACE_S="30", QUEUE_WAIT_S="60", DRAIN_S="4") as made:
        until(made.ready)
        yield made


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pair]:
    """Two replicas, `a` and `b`, that are ready and are asked."""
    with contextlib.ExitStack() as stack:
        a, b = stack.enter_context(replica("a")), stack.enter_context(replica("b"))
        port = stack.enter_context(proxied(tmp_path_factory.mktemp("proxy"), {"a": a.port, "b": b.port}))
        client = stack.enter_context(httpx.Client(base_url=f"http://{OTHERS}:{port}", timeout=120.0))
        until(lambda: client.get("/readyz").status_code == 200)
        yield Pair(port, a, b, client)

"""What the Dockerfile says of itself: settings, versions, what it copies, and its health check."""

from __future__ import annotations

import re
import shlex
import socket
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from fnmatch import fnmatch
from pathlib import Path

import pytest

from assur.api.web.settings import PREFIX, Settings
from deploy import check

ROOT = Path(__file__).parents[2]
HEALTHY = ROOT / "deploy" / "healthy.sh"


def instructions() -> list[tuple[str, str]]:
    """Name and rest of each instruction of the Dockerfile."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    plain = "\n".join(line for line in text.splitlines() if not line.startswith("#")).replace("\\\n", " ")
    return [(line.split(maxsplit=1)[0], line.split(maxsplit=1)[1]) for line in plain.splitlines() if line.strip()]


def test_every_variable_of_ours_that_the_image_sets_is_a_setting() -> None:
    known = {PREFIX + field.name.upper() for field in fields(Settings)}
    given = {word.split("=")[0] for name, rest in instructions() if name == "ENV" for word in shlex.split(rest)}
    ours = {name for name in given if name.startswith(PREFIX)}
    assert ours >= {"ASSUR_HOST", "ASSUR_PORT", "ASSUR_COMMIT"}
    assert ours <= known


def test_the_version_of_the_image_is_that_of_the_project() -> None:
    assert ("ARG", f"VERSION={check.version()}") in instructions()


def test_both_stages_have_one_base() -> None:
    bases = [rest.split()[0] for name, rest in instructions() if name == "FROM"]
    assert len(bases) == 2
    assert len(set(bases)) == 1


def test_libraries_are_installed_with_their_hashes_and_the_project_without_an_index() -> None:
    runs = [rest for name, rest in instructions() if name == "RUN"]
    calls = [call for rest in runs for call in rest.split("&&") if re.search(r"\bpip\b.* (install|wheel) ", call)]
    assert len(calls) == 4
    for call in calls:
        locked = "--require-hashes" in call and "requirements" in call
        own = "--no-deps" in call and "--no-index" in call
        assert locked != own, call


def test_what_is_copied_is_there_and_let_in() -> None:
    lines = (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines()
    let_in = {line[1:] for line in lines if line.startswith("!")}
    kept_out = [line for line in lines if not line.startswith(("#", "!"))][1:]
    for name, rest in instructions():
        if name == "COPY" and "--from" not in rest:
            for path in rest.split()[:-1]:
                assert (ROOT / path).exists(), path
                assert path.split("/")[0] in let_in, path
                assert not any(fnmatch(path, pattern) for pattern in kept_out), path


def test_the_health_check_is_the_script_and_starts_no_python() -> None:
    (rest,) = (rest for name, rest in instructions() if name == "HEALTHCHECK")
    assert rest.endswith('CMD ["healthy"]')
    assert ("COPY", "deploy/healthy.sh /opt/assur/bin/healthy") in instructions()
    plain = [line for line in HEALTHY.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    assert not any("python" in line for line in plain)
    assert HEALTHY.stat().st_mode & 0o111 == 0o111


@contextmanager
def answering(answer: bytes | None) -> Iterator[tuple[int, list[bytes]]]:
    """A port where one connection is taken and gets `answer`, or nothing at all (None); and what was asked there."""
    asked: list[bytes] = []
    with socket.create_server(("127.0.0.1", 0)) as door:

        def serve() -> None:
            connection, _ = door.accept()
            with connection:
                got = b""
                while not got.endswith(b"\r\n\r\n"):  # the shell writes line by line
                    got += connection.recv(4096) or b"\r\n\r\n"
                asked.append(got)
                if answer is not None:
                    connection.sendall(answer)
                else:
                    connection.recv(1)  # until the other side goes

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield door.getsockname()[1], asked
        thread.join(timeout=10)


def healthy(port: int) -> int:
    environment = {"PATH": "/usr/bin:/bin", "ASSUR_PORT": str(port)}
    return subprocess.run(["bash", str(HEALTHY)], env=environment, check=False, timeout=30).returncode


@pytest.mark.parametrize(
    ("answer", "well"),
    [
        (b"HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n", True),
        (b"HTTP/1.1 503 Service Unavailable\r\ncontent-length: 0\r\n\r\n", False),
        (b"", False),
        (None, False),
    ],
)
def test_the_container_is_healthy_if_the_service_is_ready(answer: bytes | None, well: bool) -> None:
    with answering(answer) as (port, asked):
        assert (healthy(port) == 0) == well
    assert asked[0].startswith(b"GET /readyz HTTP/1.1\r\nHost: 127.0.0.1:")


def test_the_container_is_not_healthy_if_nobody_listens() -> None:
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))  # taken, and not listening
        assert healthy(door.getsockname()[1]) != 0

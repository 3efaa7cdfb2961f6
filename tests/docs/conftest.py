"""One service for all that the pages show of HTTP."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest

from tests.api.running import started
from tests.docs.pages import ENVIRONMENT, ROOT


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """`assur serve` as a process of its own on a free port; its address."""
    command = [sys.executable, "-m", "assur.api.command_line", "serve"]
    with started(command, ROOT, ENVIRONMENT, tmp_path_factory.mktemp("service") / "log") as address:
        yield address

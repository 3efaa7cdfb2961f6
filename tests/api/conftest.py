"""One service with one real worker for all tests of HTTP that do not kill anything."""

from __future__ import annotations

import copy
import time
from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient

from api.app import create_app
from api.jobs import FIRST_PLAN
from api.settings import Settings

PATIENT = Settings(workers=1, queue=8, grace_s=30.0)
"""The tests share their processors with other tests: nothing here is about how fast a plan is."""


@pytest.fixture(scope="session")
def client() -> Iterator[TestClient]:
    """A client of a service that is ready."""
    with TestClient(create_app(PATIENT), raise_server_exceptions=True) as made:
        for _ in range(1200):
            if made.get("/readyz").status_code == 200:
                break
            time.sleep(0.1)
        assert made.get("/readyz").status_code == 200
        yield made


@pytest.fixture
def small() -> dict[str, Any]:
    """A small request that is planned: a copy to change at will."""
    return copy.deepcopy(FIRST_PLAN)

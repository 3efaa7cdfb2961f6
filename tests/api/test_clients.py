"""Who asks: addresses, keys, the file of keys, and the commands that make it."""

from __future__ import annotations

import json
import stat
from collections.abc import Callable
from dataclasses import replace
from math import inf
from pathlib import Path

import httpx
import pytest

import assur
from assur.api.keys import digest, keys_in, new_key
from assur.api.problems import Problem
from assur.api.web import clients
from assur.api.web.addresses import network
from assur.api.web.clients import Clients
from assur.api.web.settings import Settings
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner.errors import InputError
from tests.api.running import PATIENT, running
from tests.api.test_command_line import run


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "keys.json"


def added(file: Path, name: str, *options: str) -> str:
    code, shown, told = run("keys", "add", str(file), name, *options)
    assert code == 0, told
    return shown.strip()


def test_a_key_is_shown_once_and_only_its_digest_is_kept(file: Path) -> None:
    key = added(file, "line-3", "--running", "2", "--seconds", "30")
    assert key not in file.read_text(encoding="utf-8")
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    (kept,) = keys_in(file).keys
    assert (kept.name, kept.sha256, kept.running, kept.waiting, kept.seconds) == ("line-3", digest(key), 2, None, 30.0)
    assert [entry.name for entry in file.parent.iterdir()] == ["keys.json"]


def test_keys_are_listed_and_removed(file: Path) -> None:
    added(file, "line-3", "--waiting", "0")
    added(file, "line-4")
    code, shown, _ = run("keys", "list", str(file))
    assert code == 0
    assert shown.splitlines()[0].startswith("line-3")
    assert "waiting 0" in shown
    assert run("keys", "remove", str(file), "line-3")[0] == 0
    assert [key.name for key in keys_in(file).keys] == ["line-4"]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("add", "FILE", "line-3"), "line-3"),
        (("add", "FILE", "Line 4"), "NAME"),
        (("add", "FILE", "line-4", "--running", "0"), "--running"),
        (("add", "FILE", "line-4", "--seconds", "nan"), "--seconds"),
        (("remove", "FILE", "line-4"), "line-3"),
        (("list", "nowhere.json"), "nowhere.json"),
        (("add", "nowhere/keys.json", "line-4"), "nowhere"),
    ],
)
def test_a_wrong_command_says_what_is_allowed_and_changes_nothing(
    file: Path, words: tuple[str, ...], says: str
) -> None:
    added(file, "line-3")
    before = file.read_bytes()
    code, shown, told = run("keys", *[str(file) if word == "FILE" else word for word in words])
    assert (code, shown) == (2, "")
    assert says in told
    assert file.read_bytes() == before


KEY = {"name": "a", "sha256": "0" * 64}


@pytest.mark.parametrize(
    ("content", "field"),
    [
        ('{"schema": "assur-keys/1", "keys": [', "FILE"),
        ('{"schema": "assur-keys/2"}', "schema"),
        ('{"keys": 3}', "keys"),
        (json.dumps({"keys": [{"name": "a"}]}), "keys[0].sha256"),
        (json.dumps({"keys": [{**KEY, "sha256": "secret"}]}), "keys[0].sha256"),
        (json.dumps({"keys": [{**KEY, "runing": 3}]}), "keys[0].runing"),
        (json.dumps({"keys": [{**KEY, "seconds": 0}]}), "keys[0].seconds"),
        (json.dumps({"keys": [KEY, {**KEY, "name": "b"}]}), "keys[1].sha256"),
        (json.dumps({"keys": [KEY, {**KEY, "sha256": "1" * 64}]}), "keys[1].name"),
    ],
)
def test_a_wrong_file_stops_the_service_before_it_starts(file: Path, content: str, field: str) -> None:
    file.write_text(content, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        Clients(Settings(keys_file=str(file)))
    named = caught.value.field == "ASSUR_KEYS_FILE"
    assert caught.value.field == field.replace("FILE", "ASSUR_KEYS_FILE")
    assert caught.value.value == str(file) or not named


def test_a_file_that_is_too_large_is_not_read(file: Path) -> None:
    file.write_bytes(b" " * (1 << 21))
    with pytest.raises(InputError, match="at most"):
        keys_in(file)


def test_limits_of_a_key_come_before_those_of_the_settings(file: Path) -> None:
    first, second = added(file, "first", "--running", "7"), added(file, "second")
    known = Clients(Settings(keys_file=str(file), client_running=3, client_waiting=4, client_seconds=5))
    holder = known.of(f"Bearer {first}", "")
    assert (holder.name, holder.running, holder.waiting, holder.seconds) == ("first", 7, 4, 5)
    assert known.of(f"bearer {second}", "").running == 3


@pytest.mark.parametrize(
    "header", [None, "", "Bearer", "Bearer ", "Bearer wrong", "Basic KEY", "KEY", "Bearer ké\udc80"]
)
def test_whoever_has_no_key_is_refused(file: Path, header: str | None) -> None:
    key = added(file, "line-3")
    known = Clients(Settings(keys_file=str(file)))
    assert known.of(f"Bearer {key}", "").name == "line-3"
    with pytest.raises(Problem) as caught:
        known.of(header and header.replace("KEY", key), "")
    assert caught.value.status == 401
    assert caught.value.headers == {"WWW-Authenticate": "Bearer"}
    assert key not in caught.value.detail


def test_a_file_that_changes_counts_without_a_restart_and_a_broken_one_does_not(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "REREAD_S", 0.0)
    old = added(file, "old")
    known = Clients(Settings(keys_file=str(file)))
    new = added(file, "new")
    assert known.of(f"Bearer {new}", "").name == "new"
    file.write_text("{", encoding="utf-8")
    assert known.of(f"Bearer {old}", "").name == "old"
    file.unlink()
    assert known.of(f"Bearer {old}", "").name == "old"
    added(file, "other")
    with pytest.raises(Problem):
        known.of(f"Bearer {old}", "")


@pytest.mark.parametrize(
    ("address", "name"),
    [
        ("192.0.2.7", "192.0.2.7"),
        ("::ffff:192.0.2.7", "192.0.2.7"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("2001:db8:1:2:ffff::", "2001:db8:1:2::/64"),
        ("", "elsewhere"),
        ("testclient", "elsewhere"),
    ],
)
def test_addresses_tell_clients_apart(address: str, name: str) -> None:
    assert network(address) == name
    client = Clients(Settings()).of("Bearer whatever", address)
    assert (client.name, client.running, client.seconds) == (name, inf, inf)


def test_a_service_with_keys_answers_those_who_have_one_and_their_own_jobs_only(file: Path) -> None:
    mine, yours = added(file, "mine"), added(file, "yours", "--seconds", "0.001")
    with running(replace(PATIENT, keys_file=str(file))) as client:

        def asked(key: str) -> Callable[..., httpx.Response]:
            return lambda method, path, **sent: client.request(
                method, path, headers={"Authorization": f"Bearer {key}"}, **sent
            )

        for path in ("livez", "readyz", "docs", "openapi.json", "studio"):
            assert client.get(path).status_code == 200
        for path in ("v1/scenes", "v1/robots", "v1/schema", "v1/jobs/x"):
            problem = client.get(path)
            assert problem.status_code == 401
            assert problem.json()["type"] == "urn:assur:problem:unauthorized"
            assert problem.headers["WWW-Authenticate"] == "Bearer"
        assert client.post("v1/plans", json={"scenario": "demo"}).status_code == 401
        told = client.get("metrics").text
        assert 'problem="unauthorized",route="/v1/plans"' in told
        assert 'problem="unauthorized",route="none"' not in told
        assert "assur_keys_file_usable 1.0" in told
        assert asked(mine)("GET", "v1/scenes").status_code == 200
        with assur.Client(str(client.base_url), key=mine) as known:
            assert known.load("demo") == assur.load("demo")
        with assur.Client(str(client.base_url), key="wrong") as unknown, pytest.raises(assur.ProblemError) as refused:
            unknown.robots()
        assert refused.value.kind == "unauthorized"

        job = asked(mine)("POST", "v1/jobs", json=FIRST_PLAN)
        assert job.status_code == 202
        place = f"v1/jobs/{job.json()['id']}"
        assert asked(mine)("GET", place).status_code == 200
        for method in ("GET", "DELETE"):
            assert asked(yours)(method, place).json()["type"] == "urn:assur:problem:job-lost"

        assert asked(yours)("POST", "v1/plans", json=FIRST_PLAN).status_code == 200
        spent = asked(yours)("POST", "v1/plans", json=FIRST_PLAN)
        assert spent.status_code == 429
        assert int(spent.headers["Retry-After"]) >= 1


def test_a_key_is_new_each_time() -> None:
    assert len({new_key() for _ in range(100)}) == 100


@pytest.mark.parametrize("key", ["", " key", "key\n", "ké"])
def test_a_key_that_no_header_can_hold_is_refused_by_the_client(key: str) -> None:
    with pytest.raises(InputError, match="key"):
        assur.Client("http://127.0.0.1:1", key=key)

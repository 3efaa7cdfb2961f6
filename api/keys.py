"""API keys: a file that has the SHA-256 of each, who holds it, and what is allowed to them.

A key is 32 random bytes that nobody can guess, so that one round of SHA-256 is enough to keep it. The file never has
the key itself: `assur keys add` shows it once.
"""

from __future__ import annotations

import hashlib
import json
import os
import secrets
from math import inf
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from assur.api.workers.client import Client
from assur.planner.errors import InputError
from assur.scenes.schema.read import read
from assur.scenes.text.json_text import parse_json

PREFIX = "assur_"
"""Begins each key, so that a reader who meets one knows what it is."""
MAX_BYTES = 1 << 20
MAX_KEYS = 10_000
NAME = r"^[a-z0-9][a-z0-9._-]{0,62}$"
"""Who holds a key. It is written into the log."""


class KeyDocument(BaseModel):
    """A key, and what is allowed to its holder at most; what is not stated is as in the settings of the service."""

    model_config = ConfigDict(extra="forbid", frozen=True)
    name: Annotated[str, Field(pattern=NAME)]
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    running: Annotated[int, Field(ge=1, le=10_000)] | None = None
    waiting: Annotated[int, Field(ge=0, le=10_000)] | None = None
    seconds: Annotated[float, Field(ge=0.001, le=1e6)] | None = None

    def client(self, others: Client) -> Client:
        """Its holder; `others`: what is allowed where the document says nothing."""
        return Client(
            self.name,
            others.running if self.running is None else self.running,
            others.waiting if self.waiting is None else self.waiting,
            others.seconds if self.seconds is None else self.seconds,
        )


class KeysDocument(BaseModel):
    """All keys of a service."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)
    schema_: Annotated[Literal["assur-keys/1"], Field(alias="schema")] = "assur-keys/1"
    keys: Annotated[list[KeyDocument], Field(max_length=MAX_KEYS)] = Field(default_factory=list)

    def text(self) -> str:
        """The document as it is written in a file."""
        return json.dumps(self.model_dump(by_alias=True, exclude_none=True), indent=2) + "\n"


def digest(key: str) -> str:
    """What the file has of a key."""
    return hashlib.sha256(key.encode("utf-8", "surrogatepass")).hexdigest()


def keys_in(path: Path, field: str = "FILE") -> KeysDocument:
    """The keys in a file, which `field` names. Raises `InputError` that names the field or what is wrong in the file,
    for two keys of one name or of one digest, too."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(field, str(path), f"a file of keys of at most {MAX_BYTES} bytes")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(field, str(path), f"a file of keys that can be read ({error.strerror})") from error
    try:
        written = parse_json(content)
    except InputError as error:
        raise InputError(field, str(path), f"a file of JSON ({error.value})") from error
    document: KeysDocument = read(KeysDocument, written)
    for unique in ("name", "sha256"):
        seen: dict[str, int] = {}
        for place, key in enumerate(document.keys):
            value = getattr(key, unique)
            if value in seen:
                raise InputError(f"keys[{place}].{unique}", value, f"one that keys[{seen[value]}] does not have")
            seen[value] = place
    return document


def new_key() -> str:
    """A key that nobody has."""
    return PREFIX + secrets.token_urlsafe(32)


def write(path: Path, document: KeysDocument) -> None:
    """Puts keys into a file that only its owner may read, all or nothing. Raises `InputError`."""
    beside = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    try:
        with os.fdopen(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
            file.write(document.text())
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise InputError(str(path), error.strerror, "a file that can be written") from error


def with_key(document: KeysDocument, key: dict[str, object]) -> KeysDocument:
    """The keys and one more. Raises `InputError` that names its field."""
    added: KeyDocument = read(KeyDocument, key)
    return document.model_copy(update={"keys": [*document.keys, added]})


def clients_of(document: KeysDocument, others: Client) -> dict[str, Client]:
    """The holder of each key, by its digest."""
    return {key.sha256: key.client(others) for key in document.keys}


def unlimited(value: float) -> float:
    """A limit of the settings, where 0 says that there is none."""
    return value or inf

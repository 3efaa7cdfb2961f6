"""A folder of meshes and cells by the SHA-256 of their files, with the cuts of covers, shared by processes.

It holds `<sha256>.mesh` and `<sha256>.cell`, the bytes of a file, and `<sha256>-<format>-<unit>.cover`, where a mesh is
cut. All are data from outside when they are read: bytes must have the digest, a cell is read as any document, and
`assur.scenes.meshes.kept_cuts` checks the cuts.
Files appear at once and whole (a temporary name, then a rename), one at a time. Names are made of digests alone, links
are not followed, and nothing else in the folder is read or removed.
"""

from __future__ import annotations

import errno
import fcntl
import hashlib
import os
import re
import secrets
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from assur.planner.errors import AssurError, InputError
from assur.scenes.bounds import MAX_MESH_BYTES

Kind = Literal["mesh", "cell"]
"""What a file is, the ending of its name."""
DIGEST = re.compile(r"[0-9a-f]{64}")
_OURS = re.compile(r"[0-9a-f]{64}(?:\.mesh|\.cell|-[a-z]{2,4}-[a-z]{1,2}\.cover)")
_TEMPORARY = re.compile(r"\.[0-9a-f]{32}\.tmp")
LEFT_S = 3600.0
"""A temporary file that is older than this was left by a process that died, s."""
LEAST_BYTES = 64 << 10
"""Least share of the quota that a file takes. So there are at most 16,384 files for each GiB: all are examined when one
is added."""
LOCK = ".lock"
"""Locked while a file is added: no two processes use the same room."""
MAX_COVER_BYTES = 64 << 10
"""A file with cuts."""
TOUCHED_S = 60.0
"""A use is noted when the last one is longer ago than this, s."""


class FolderError(AssurError):
    """The folder did not take a file. `full`: the quota or the disk is full."""

    def __init__(self, why: str, *, full: bool) -> None:
        super().__init__(why)
        self.full = full


@dataclass(frozen=True, slots=True)
class StoredFile:
    """A file of the folder: bytes, and for how long it is kept if it is not used again, s."""

    size: int
    left_s: float


@dataclass(frozen=True, slots=True)
class MeshFolder:
    """The folder at `path` with up to `quota_bytes`, where a file is kept for `kept_s` after its upload or last use."""

    path: Path
    quota_bytes: int
    kept_s: float

    @staticmethod
    def at(path: str, quota_bytes: int, kept_s: float, field: str) -> MeshFolder:
        """The folder, which is made if it does not exist. Raises `InputError` at `field` unless it can be read and
        written."""
        folder = MeshFolder(Path(path).absolute(), quota_bytes, kept_s)
        try:
            folder.path.mkdir(parents=True, exist_ok=True)
            probe = folder.path / f".{secrets.token_hex(16)}.tmp"
            os.close(os.open(probe, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600))
            probe.unlink()
            tuple(folder.path.iterdir())
        except OSError as error:
            raise InputError(field, path, f"a folder that can be read and written; {error.strerror}") from error
        return folder

    def known(self, digest: str, kind: Kind = "mesh") -> StoredFile | None:
        """The mesh or cell with this digest; None if there is none, or no more."""
        return self._kept(f"{_digest(digest)}.{kind}")

    def content(self, digest: str, kind: Kind = "mesh") -> bytes | None:
        """The bytes of the mesh or cell with this digest; None if there are none. Bytes with another digest are
        removed."""
        name = f"{_digest(digest)}.{kind}"
        content = self._read(name, MAX_MESH_BYTES)
        if content is None or hashlib.sha256(content).hexdigest() == digest:
            return content
        self.remove(name)
        return None

    def put(self, digest: str, content: bytes, kind: Kind = "mesh") -> bool:
        """Keeps a mesh or a cell, whose digest is right, from now on; whether it is new. Raises `FolderError`."""
        if self.content(digest, kind) is not None:
            return False
        self._write(f"{digest}.{kind}", content)
        return True

    def use(self, digest: str, kind: Kind = "mesh") -> bool:
        """Notes a use of a mesh or a cell that is not read again; whether it is here."""
        name = f"{_digest(digest)}.{kind}"
        kept = self._kept(name)
        if kept is not None:
            self._note(name, kept)
        return kept is not None

    def cuts(self, name: str) -> bytes | None:
        """The file of cuts of that name."""
        return self._read(name, MAX_COVER_BYTES)

    def put_cuts(self, name: str, content: bytes) -> None:
        """Keeps a file of cuts. Raises `FolderError`."""
        self._write(name, content)

    def used(self) -> int:
        """How many bytes of the quota are used."""
        return sum(max(facts.st_size, LEAST_BYTES) for _, facts in self._files())

    def remove(self, name: str) -> None:
        """Removes a file of the folder, if it is there."""
        with suppress(OSError):
            (self.path / name).unlink()

    def _kept(self, name: str) -> StoredFile | None:
        try:
            facts = os.lstat(f"{self.path}/{name}")
        except OSError:
            return None
        left = facts.st_mtime + self.kept_s - time.time()
        return StoredFile(facts.st_size, left) if stat.S_ISREG(facts.st_mode) and left > 0 else None

    def _read(self, name: str, most: int) -> bytes | None:
        """What is in a regular file of up to `most` bytes that is not too old; its use is noted."""
        kept = self._kept(name)
        if kept is None or not kept.size <= most:
            return None
        try:
            descriptor = os.open(self.path / name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
            with os.fdopen(descriptor, "rb") as file:
                if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                    return None
                content = file.read(most + 1)
        except OSError:
            return None
        self._note(name, kept)
        return content if len(content) <= most else None

    def _note(self, name: str, kept: StoredFile) -> None:
        if kept.left_s < self.kept_s - TOUCHED_S:
            with suppress(OSError):
                os.utime(self.path / name, follow_symlinks=False)

    def _write(self, name: str, content: bytes) -> None:
        if not _OURS.fullmatch(name):
            raise FolderError("a name that is none of this folder", full=False)
        temporary = self.path / f".{secrets.token_hex(16)}.tmp"
        try:
            with self._locked():
                used = self._swept()
                if used + max(len(content), LEAST_BYTES) > self.quota_bytes:
                    raise FolderError(f"{used} of {self.quota_bytes} bytes are used", full=True)
                descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
                with os.fdopen(descriptor, "wb") as file:
                    file.write(content)
                temporary.replace(self.path / name)
        except OSError as error:
            with suppress(OSError):
                temporary.unlink()
            full = error.errno in (errno.ENOSPC, errno.EDQUOT)
            raise FolderError(error.strerror or type(error).__name__, full=full) from error

    @contextmanager
    def _locked(self) -> Iterator[None]:
        """Within it no other process adds a file."""
        descriptor = os.open(self.path / LOCK, os.O_WRONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            yield
        finally:
            os.close(descriptor)

    def _swept(self) -> int:
        """Removes what is too old; the bytes that are used then."""
        used, now = 0, time.time()
        for entry, facts in self._files():
            lives_s = LEFT_S if _TEMPORARY.fullmatch(entry) else self.kept_s
            if facts.st_mtime + lives_s <= now:
                self.remove(entry)
            else:
                used += max(facts.st_size, LEAST_BYTES)
        return used

    def _files(self) -> Iterator[tuple[str, os.stat_result]]:
        with os.scandir(self.path) as entries:
            for entry in entries:
                if _OURS.fullmatch(entry.name) or _TEMPORARY.fullmatch(entry.name):
                    with suppress(FileNotFoundError):  # another process removed it
                        yield entry.name, entry.stat(follow_symlinks=False)


def _digest(digest: str) -> str:
    if not DIGEST.fullmatch(digest):
        raise InputError("sha256", digest, "64 hexadecimal digits, small letters")
    return digest

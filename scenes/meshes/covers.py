"""The covers that a process knows, by the digest of the mesh's file, its format and its unit.

A cover is searched in memory, then among the cuts that are kept in a folder, and is computed if it is in neither. A
covering that the deadline has ended is kept in memory, and goes on from there at the next request: a cover is the same
however often it was interrupted. None is used before it is finished.
"""

from __future__ import annotations

import logging
import threading
from collections import OrderedDict
from typing import TYPE_CHECKING, NamedTuple

from assur.planner.geometry.shapes import Hull
from assur.planner.model.deadline import OutOfTimeError, out_of_time
from assur.scenes.meshes.folder import FolderError, MeshFolder
from assur.scenes.meshes.parts import InParts, Parts

if TYPE_CHECKING:
    from assur.scenes.meshes.cover import Cover, Covering
    from assur.scenes.meshes.surface import Surface

LOGGER = logging.getLogger("assur.meshes")

KEPT_BYTES = 64 << 20
"""Memory of the covers that are kept, with their surfaces; the least recently used ones are removed first."""
UNFINISHED = 4
"""Coverings that are kept unfinished."""


class Key(NamedTuple):
    """All that a cover depends on, besides the code: SHA-256 of the file, its format, its unit."""

    digest: str
    form: str
    unit: str

    @property
    def name(self) -> str:
        return f"{self.digest}-{self.form}-{self.unit}"


class Finding:
    """The work on the cover of a file: it is read, and then covered by the cuts in the folder, or by new cuts, which
    are kept there."""

    def __init__(self, key: Key, content: bytes, folder: MeshFolder | None) -> None:
        self._key, self._folder = key, folder
        self.parts = InParts(self._in_parts(content))
        self._read = False
        self.covering: Covering | None = None
        """Where new cuts are made."""

    @property
    def so_far(self) -> str:
        """How far it has come, in words behind the name of the mesh."""
        if not self._read:
            return "had not been read"
        if self.covering is None or not self.covering.pieces:
            return "had been read, and was not covered yet"
        out, tight = (f"{1e3 * length:.3g} mm" for length in (self.covering.excess_m, self.covering.tight_m))
        return (
            f"was being covered by convex pieces, {self.covering.pieces} so far, which reach up to {out} out of it; "
            f"{tight} are aimed at"
        )

    def _in_parts(self, content: bytes) -> Parts[Cover]:
        from assur.scenes.meshes.cover import Covering
        from assur.scenes.meshes.kept_cuts import written
        from assur.scenes.meshes.load import load_in_parts

        surface = yield from load_in_parts(content, self._key.form, self._key.unit)
        self._read = True
        yield
        kept = None if self._folder is None else (yield from self._kept(self._folder, surface))
        if kept is not None:
            return kept
        self.covering = Covering(surface)
        cuts, cover = yield from self.covering.in_parts()
        if self._folder is not None:
            try:
                self._folder.put_cuts(self._file, written(self._key.name, cuts, cover))
            except FolderError as error:
                _log("the cuts of a cover are not kept", self._key, str(error))
        return cover

    def _kept(self, folder: MeshFolder, surface: Surface) -> Parts[Cover | None]:
        """The cover by the cuts in the folder. A file that cannot be used is removed, for a new one."""
        from assur.scenes.meshes.kept_cuts import KeptCutsError, cover_from

        content = folder.cuts(self._file)
        if content is None:
            return None
        try:
            return (yield from cover_from(content, self._key.name, surface))
        except KeptCutsError as error:
            folder.remove(self._file)
            _log("kept cuts are refused", self._key, str(error), logging.INFO if error.other else logging.WARNING)
            return None

    @property
    def _file(self) -> str:
        return f"{self._key.name}.cover"


class Covers:
    """Covers by key, in up to `kept_bytes` of memory; what does not fit is not kept. `folder`: None, or where cuts and
    uploaded meshes are."""

    def __init__(self, kept_bytes: int = KEPT_BYTES, folder: MeshFolder | None = None) -> None:
        self.folder = folder
        self._kept_bytes, self._used = kept_bytes, 0
        self._covers: OrderedDict[Key, tuple[Cover, int]] = OrderedDict()
        self._begun: OrderedDict[Key, Finding] = OrderedDict()
        self._lock = threading.Lock()
        self.cuts_made = 0
        """Covers that were found with cuts made here: what a cache saves."""

    def known(self, key: Key) -> Cover | None:
        """The cover, if it is in memory."""
        with self._lock:
            found = self._covers.get(key)
            if found is None:
                return None
            self._covers.move_to_end(key)
            return found[0]

    def cover(self, key: Key, content: bytes) -> Cover:
        """The cover of the file with these bytes.

        Raises `InputError` naming mesh.data, mesh.format or mesh.unit, and `OutOfTimeError`, which says how far it has
        come, where the deadline in force passed before it was finished.
        """
        found = self.known(key)
        if found is None:
            found = self._found(key, content)
            self._keep(key, found)
        return found

    def _found(self, key: Key, content: bytes) -> Cover:
        with self._lock:
            begun = self._begun.pop(key, None)
        if begun is None:
            begun = Finding(key, content, self.folder)
        done = begun.parts.run(out_of_time)
        if done is None:
            with self._lock:
                self._begun[key] = begun
                while len(self._begun) > UNFINISHED:
                    self._begun.popitem(last=False)
            raise OutOfTimeError(begun.so_far)
        self.cuts_made += begun.covering is not None
        return done

    def _keep(self, key: Key, cover: Cover) -> None:
        size = _size(cover)
        with self._lock:
            if key in self._covers or size > self._kept_bytes:
                return
            self._covers[key] = cover, size
            self._used += size
            while self._used > self._kept_bytes:
                self._used -= self._covers.popitem(last=False)[1][1]


def _size(cover: Cover) -> int:
    """Memory of a cover, bytes."""
    hulls = [piece.shape for piece in cover.pieces if isinstance(piece.shape, Hull)]
    arrays = [array for hull in hulls for array in (hull.vertices, hull.faces)]
    return sum(array.nbytes for array in (*arrays, *(cover.surface or ())))


def _log(what: str, key: Key, why: str, level: int = logging.WARNING) -> None:
    LOGGER.log(level, what, extra={"facts": {"mesh": key.name, "why": why}})

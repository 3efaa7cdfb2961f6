"""The covers that a process knows, by the digest of the mesh's file, its format and its unit.

A cover is looked for in memory, then among the cuts that are kept in a folder, and is found anew if need be. Coverings
that the deadline in force has ended are kept in memory, and go on from there at the next request: a cover is the same
however often it was left. None is used before it is finished.
"""

from __future__ import annotations

import logging
import threading
from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from assur.planner.geometry.shapes import Hull
from assur.planner.model.deadline import OutOfTimeError, out_of_time
from assur.scenes.meshes.folder import FolderError, MeshFolder

if TYPE_CHECKING:
    from assur.scenes.meshes.cover import Cover, Covering
    from assur.scenes.meshes.load import Loading

LOGGER = logging.getLogger("assur.meshes")

KEPT_BYTES = 64 << 20
"""Memory of the covers that are kept, with their surfaces; those that were not used for longest go first."""
UNFINISHED = 4
"""Coverings that are kept unfinished."""


@dataclass(frozen=True, slots=True)
class Key:
    """All that a cover depends on, besides the code: SHA-256 of the file, its format, its unit."""

    digest: str
    form: str
    unit: str

    @property
    def name(self) -> str:
        return f"{self.digest}-{self.form}-{self.unit}"


class Covers:
    """Covers by key, in up to `kept_bytes` of memory; what does not fit is not kept. `folder`: None, or where cuts and
    uploaded meshes are."""

    def __init__(self, kept_bytes: int = KEPT_BYTES, folder: MeshFolder | None = None) -> None:
        self.folder = folder
        self._kept_bytes, self._used = kept_bytes, 0
        self._covers: OrderedDict[Key, tuple[Cover, int]] = OrderedDict()
        self._begun: OrderedDict[Key, Loading | Covering] = OrderedDict()
        self._lock = threading.Lock()
        self.cuts_made = 0
        """Coverings that were begun here: what a cache saves."""

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
            found = self._kept_in_folder(key, content) or self._found(key, content)
            self._keep(key, found)
        return found

    def _found(self, key: Key, content: bytes) -> Cover:
        from assur.scenes.meshes.cover import Covering
        from assur.scenes.meshes.kept_cuts import written
        from assur.scenes.meshes.load import Loading, load_in_parts

        with self._lock:
            begun = self._begun.pop(key, None)
        if begun is None:
            begun = Loading(load_in_parts(content, key.form, key.unit))
            self.cuts_made += 1
        if isinstance(begun, Loading):
            surface = begun.run(out_of_time)
            if surface is None:
                self._leave(key, begun)
                raise OutOfTimeError("had not been read")
            begun = Covering(surface)
        done = begun.run(out_of_time)
        if done is None:
            self._leave(key, begun)
            raise OutOfTimeError(_so_far(begun))
        cuts, cover = done
        if self.folder is not None:
            try:
                self.folder.put_cuts(f"{key.name}.cover", written(key.name, cuts, cover))
            except FolderError as error:
                _log("the cuts of a cover are not kept", key, str(error))
        return cover

    def _leave(self, key: Key, begun: Loading | Covering) -> None:
        """Keeps what is not finished."""
        with self._lock:
            self._begun[key] = begun
            while len(self._begun) > UNFINISHED:
                self._begun.popitem(last=False)

    def _kept_in_folder(self, key: Key, content: bytes) -> Cover | None:
        """The cover by the cuts in the folder. A file that cannot be used is removed, for a new one."""
        from assur.scenes.meshes.kept_cuts import KeptCutsError, cover_from
        from assur.scenes.meshes.load import load

        with self._lock:
            if key in self._begun:
                return None
        kept = None if self.folder is None else self.folder.cuts(f"{key.name}.cover")
        if self.folder is None or kept is None:
            return None
        if out_of_time():
            raise OutOfTimeError("had not been read")
        try:
            return cover_from(kept, key.name, load(content, key.form, key.unit))
        except KeptCutsError as error:
            self.folder.remove(f"{key.name}.cover")
            _log("kept cuts are refused", key, str(error), logging.INFO if error.other else logging.WARNING)
            return None

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


def _so_far(covering: Covering) -> str:
    if not covering.pieces:
        return "had been read, and was not covered yet"
    out, tight = (f"{1e3 * length:.3g} mm" for length in (covering.excess_m, covering.tight_m))
    return (
        f"was being covered by convex pieces, {covering.pieces} so far, which reach up to {out} out of it; {tight} are "
        "aimed at"
    )


def _log(what: str, key: Key, why: str, level: int = logging.WARNING) -> None:
    LOGGER.log(level, what, extra={"facts": {"mesh": key.name, "why": why}})

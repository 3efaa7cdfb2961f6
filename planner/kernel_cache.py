"""Where compiled kernels are kept, and whether they are there. Imports no compiler.

The compiler decides by a kernel's own file whether its compiled code is still good, and does not read the kernels
that it calls. Therefore the folder is named by the digest of the sources of all kernels.
"""

from __future__ import annotations

import hashlib
import os
from functools import cache
from pathlib import Path

ROOMS = ("kernels", "checker", "bound", "selection")
"""Rooms of the planner whose modules, and those of rooms within them, may hold kernels."""
PLAIN = ("checker/statement",)
"""Rooms within these that hold none: an import rule keeps the compiler out of them."""
COLUMNS = "claim/columns.py"
"""The columns of a claim. Kernels hold these numbers as they are when they are compiled."""
VARIABLE = "NUMBA_CACHE_DIR"
"""Environment variable that says below which folder compiled kernels are kept; the compiler's own."""
WHOLE = "all-kernels-compiled"
"""Name of the file that says that every kernel is in the folder."""


@cache
def digest() -> str:
    """A number, in hexadecimal, of the sources of all kernels."""
    here = Path(__file__).parent
    found = hashlib.sha256()
    sources = (path for room in ROOMS for path in (here / room).rglob("*.py"))
    kept = (path for path in sources if path.parent.relative_to(here).as_posix() not in PLAIN)
    for path in [here / "compiled.py", here / COLUMNS, *sorted(kept)]:
        content = path.read_bytes()
        found.update(f"{path.parent.name}/{path.name} {len(content)}\n".encode() + content)
    return found.hexdigest()[:16]


@cache
def folder() -> Path:
    """The folder of the compiled code of these very sources: below `NUMBA_CACHE_DIR`, else in the user's cache."""
    above = os.environ.get(VARIABLE)
    if above:
        return Path(above) / digest()
    users = os.environ.get("XDG_CACHE_HOME")
    return (Path(users) if users else Path.home() / ".cache") / "assur" / "kernels" / digest()


_whole: set[Path] = set()
"""Folders in which all kernels were: a request does not ask the file system again."""


def is_compiled() -> bool:
    """Whether all kernels were compiled into the folder once, by whatever processor."""
    if folder() not in _whole and (folder() / WHOLE).is_file():
        _whole.add(folder())
    return folder() in _whole

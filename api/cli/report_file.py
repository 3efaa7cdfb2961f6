"""The browser that shows a report, and a file for it."""

from __future__ import annotations

import tempfile
import webbrowser
from pathlib import Path


def show(path: Path) -> str:
    """Opens a report in the browser of this machine; says where it is, and that there is none."""
    opened = webbrowser.open(path.resolve().as_uri())
    return f"the report is {path}" if opened else f"no browser was found here; open {path} in one"


def kept(name: str, page: bytes) -> Path:
    """The file of a report that is only shown, in a folder of its own among the temporary files."""
    path = Path(tempfile.mkdtemp(prefix="assur-")) / f"{name}.html"
    path.write_bytes(page)
    return path

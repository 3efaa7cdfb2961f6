"""Which version of assur this is."""

from __future__ import annotations

from importlib import metadata


def version() -> str:
    """The version of the installed package; "0" in a source tree that was never installed."""
    try:
        return metadata.version("assur")
    except metadata.PackageNotFoundError:
        return "0"

"""The meshes that are shipped, by name. All are STL in millimetres, made by `scenes/assets/make_assets.py`."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from assur.planner.errors import InputError

FOLDER = Path(__file__).parent.parent / "assets"


@lru_cache(maxsize=1)
def asset_names() -> tuple[str, ...]:
    """Names of the shipped meshes."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.stl")))


@lru_cache(maxsize=16)
def asset(name: str) -> bytes:
    """The file of a shipped mesh. Raises `InputError` for a name that is none: no other file is ever opened."""
    if name not in asset_names():
        raise InputError("mesh.asset", name, f"one of {', '.join(asset_names())}")
    return (FOLDER / f"{name}.stl").read_bytes()

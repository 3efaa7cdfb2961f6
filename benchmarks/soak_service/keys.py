"""A file of API keys for a service that knows clients by key."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path


def keys_file(folder: Path, names: list[str]) -> tuple[Path, dict[str, str]]:
    """A file for ASSUR_KEYS_FILE with a key for each name, and the keys by name."""
    keys = {name: hashlib.sha256(f"soak {name}".encode()).hexdigest() for name in names}
    path = folder / "keys.json"
    hashed = [{"name": name, "sha256": hashlib.sha256(key.encode()).hexdigest()} for name, key in keys.items()]
    path.write_text(json.dumps({"schema": "assur-keys/1", "keys": hashed}), encoding="utf-8")
    return path, keys

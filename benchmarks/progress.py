"""What was measured so far, one line an item: a run that was stopped goes on where it was.

The first line says what the run is of (section, parameters, sources, machine). A file of another run is begun anew; a
last line that was cut off in writing is dropped.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

Document = dict[str, Any]


class Progress:
    """The records of a run by the names of their items, kept in `path`. `key`: what the run is of."""

    def __init__(self, path: Path, key: Document) -> None:
        self.path, self.key = path, key
        self.records: dict[str, Document] = {}
        whole = self._read()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(whole), encoding="utf-8")

    def _read(self) -> list[str]:
        """The lines to keep, records filled in."""
        first = json.dumps({"key": self.key}, sort_keys=True) + "\n"
        if not self.path.exists():
            return [first]
        lines = self.path.read_text(encoding="utf-8").splitlines(keepends=True)
        if not lines or lines[0] != first:
            return [first]
        kept = [first]
        for line in lines[1:]:
            try:
                document = json.loads(line)
                name, record = document["item"], document["record"]
            except (ValueError, KeyError, TypeError):
                break
            if not line.endswith("\n"):
                break
            self.records[name] = record
            kept.append(line)
        return kept

    def add(self, item: str, record: Document) -> None:
        """One more record, on disk before anything else is measured."""
        with self.path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({"item": item, "record": record}, allow_nan=False) + "\n")
        self.records[item] = record

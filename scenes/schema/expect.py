"""What the answer to a scenario must be."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from assur.scenes.schema.model import Document, Instant


class RangeDocument(Document):
    """A range; either end may be left out."""

    min: Instant | None = None
    max: Instant | None = None


class ExpectDocument(Document):
    """What a scenario's answer must be."""

    status: Literal["planned", "not_planned"]
    duration_s: RangeDocument | None = None
    reason: str | None = None
    proved: bool | None = None
    mentions: Annotated[list[str], Field(max_length=32)] = Field(default_factory=list)
    matched: Annotated[list[str], Field(max_length=64)] = Field(default_factory=list)
    relaxation: str | None = None

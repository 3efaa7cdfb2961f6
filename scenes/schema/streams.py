"""Streams of a cell file: which parts come on a conveyor, when, and where they go."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from assur.scenes import bounds
from assur.scenes.schema.model import (
    ORIGIN,
    WHOLE,
    Angle,
    Coordinate,
    Distance,
    Document,
    Duration,
    Group,
    Name,
    Point,
    Reference,
    Span,
    Stretch,
)
from assur.scenes.schema.stated import BOTH_FORMS

Share = Annotated[float, Field(ge=bounds.LEAST, le=bounds.STRONG)]
Angles = Annotated[list[Angle], Field(min_length=2, max_length=2)]
SlotsOfKinds = Annotated[dict[Name, Name], Field(min_length=1, max_length=bounds.MAX_BODIES)]
MAX_LANES, MAX_BATCH = 16, 100


class BatchDocument(Document):
    """Several parts that come one after the other."""

    count: Annotated[int, Field(ge=1, le=MAX_BATCH), WHOLE]
    apart_s: Span


class SeenDocument(Document):
    """A line across the conveyor at which each part is seen."""

    at_m: Coordinate
    latency_s: Duration = 0.0


class ArrivalsDocument(Document):
    """A table of arrivals: the name of a file, or its text, which the loader of cell files puts in place of the
    name."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("file", "text"),)

    file: Annotated[str, Field(min_length=1, max_length=255)] | None = None
    text: Annotated[str, Field(min_length=1, max_length=bounds.MAX_ARRIVALS_BYTES)] | None = None


class StreamDocument(Document):
    """Parts that come on a conveyor, to be picked or, without `to`, to be filled."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("kind", "kinds"), ("every_s", "mean_s", "csv"))
    at_most_one: ClassVar[tuple[Group, ...]] = (
        ("lane_m", "lanes_m"),
        ("mean_s", "jitter_s"),
        *[("csv", key) for key in ("jitter_s", "batch", "gap_m", "lane_m", "lanes_m", "yaw_rad")],
    )

    frame: Reference
    kind: Name | None = None
    kinds: Annotated[dict[Name, Share], Field(min_length=1, max_length=bounds.MAX_BODIES)] | None = None
    at_m: Point = ORIGIN
    every_s: Span | None = None
    jitter_s: Duration | None = None
    mean_s: Span | None = None
    batch: BatchDocument | None = None
    csv: ArrivalsDocument | None = None
    gap_m: Distance | None = None
    lane_m: Stretch | None = None
    lanes_m: Annotated[list[Coordinate], Field(min_length=1, max_length=MAX_LANES)] | None = None
    yaw_rad: Angles | None = None
    seen: SeenDocument
    to: Annotated[Name | SlotsOfKinds, BOTH_FORMS] | None = None
    window_m: Stretch

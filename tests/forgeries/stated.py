"""A claim with true rows of all kinds, also of those that its plan needs not."""

from __future__ import annotations

from typing import Any

import numpy as np

from tests.prover.bundles import bundle, planned

Document = dict[str, Any]
NAME, STATED = "demo", "demo with rows of all kinds"
"""A scenario, and what stands for its bundle with more rows."""
MARGIN = 1e-3
"""Share of a range by which it is wider than that of samples."""


def document_of(scenario: str) -> Document:
    """The bundle of a scenario, or of `STATED`, to be changed at will."""
    return stated() if scenario == STATED else bundle(scenario)


def stated() -> Document:
    """The bundle of a scenario, with more rows that are true."""
    document, (scene, plan) = bundle(NAME), planned(NAME)
    path, point, arm = plan.trajectory, document["points"][0], document["arms"][0]
    times = np.unique(np.concatenate((np.linspace(path.start, path.end, 4001), path.time)))
    whole, at, last = {"t0": path.start, "t1": path.end}, point["t0"], len(arm["links"]) - 1
    phase = next(k for k, each in enumerate(document["phases"]) if each["t0"] <= at <= each["t1"])
    for order in range(4):
        values = path.evaluate(times, order)[:, 0]
        more = MARGIN * (float(values.max() - values.min()) if order < 3 else 1e6)
        low, high = float(values.min()) - more, float(values.max()) + more
        document["sums"].append({**whole, "order": order, "joints": [1.0, 0.0, 0.0, 0.0], "low": low, "high": high})
    q = path.evaluate(times)
    places = scene.robot.placements(q)[0][:, len(scene.robot.links) - 1]
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(times)
    rate = {"name": "", "link": last, "point": [0.0] * 3, "frame": -1, "order": 1}
    document["rates"].append({**rate, **whole, "least": 0.0, "most": 1.02 * float(speeds.max())})
    fastest = float(times[speeds.argmax()])
    reached = {"least": 0.95 * float(speeds.max()), "most": 9.0, "t0": fastest, "t1": fastest}
    document["rates"].append({**rate, **reached})
    sines = np.sin(q[:, 1])
    elbow = {"name": "", "link": 1, "place": False, "axis": [0.0, 1.0, 0.0], "other": 2, "direction": [1.0, 0.0, 0.0]}
    sine = {"low": float(sines.min()) - MARGIN, "high": float(sines.max()) + MARGIN}
    document["axes"].append({**elbow, **whole, **sine})
    height = {"name": "", "link": last, "place": True, "axis": [0.0] * 3, "other": -1, "direction": [0.0, 0.0, 1.0]}
    lift = {"low": float(places[:, 2].min()) - MARGIN, "high": float(places[:, 2].max()) + MARGIN}
    document["axes"].append({**height, **whole, **lift})
    where = {"link": last, "tool": [*point["tool"]], "frame": point["frame"], "target": [*point["target"]]}
    guide = {"link": last, "tool": point["tool"][:3], "frames": [point["frame"]] * 2, "from": point["target"][:3]}
    document["guides"].append(
        {**guide, "t0": at, "t1": at, "to": point["target"][:3], "shares": [0.5, 0.5], "most": 1e-5}
    )
    off = {"off": [0.0] * 3, "arm": 0.0, "distance": 0.1, "horizontal": 0.1, "vertical": 0.1, "yaw": 0.1}
    document["errors"].append({**where, **off, "time": at, "phase": phase})
    ahead = {"weights": [1.0, 0.0, 0.0, 0.0], "directions": [1.0, 0.0, 0.0, *[0.0] * 9], "most": 3.0}
    document["distances"].append({**ahead, "time": at, "phase": phase, "bodies": [0, 1], "pieces": [0, 0]})
    document["required"].update(nearest=1e-4)
    document["gap_rows"] = [dict(row) for row in document["rows"]]
    return document

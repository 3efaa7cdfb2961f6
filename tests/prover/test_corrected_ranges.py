"""With a belt correction joints keep their ranges, and the arm its reach, wherever the tool may be shifted."""

from __future__ import annotations

import numpy as np
import pytest

from tests.prover.bundles import Document, agreed, bundle, planned


def beyond(document: Document) -> bool:
    """Whether joints leave their ranges."""
    right, told = agreed(document)
    return not right and any(line.startswith("a joint does not keep its limits") for line in told)


@pytest.mark.parametrize("joint", [0, 1, 3])
def test_a_range_that_the_planned_motion_just_keeps_is_left_by_a_correction(joint: int) -> None:
    document, path = bundle("dense-flow"), planned("dense-flow")[1].trajectory
    shares = [(phase, share) for phase in document["phases"] for share in phase["shares"] if share != [0.0, 0.0]]
    begin, end = min(p["t0"] for p, _ in shares), max(p["t1"] for p, _ in shares)
    every = path.evaluate(np.linspace(path.start, path.end, 4001))[:, joint]
    inside = path.evaluate(np.linspace(max(begin, path.start), min(end, path.end), 4001))[:, joint]
    ends = {"lower": (-1e-5, every.min(), inside.min()), "upper": (1e-5, every.max(), inside.max())}
    # an end of the range at which the arm is while it may be shifted
    end, off, most = next((end, off, x) for end, (off, x, y) in ends.items() if x == pytest.approx(y, abs=1e-3))
    for span in document["limits"]:
        span[end][joint] = float(most) + off
    assert beyond(document)
    for frame in document["frames"]:
        for each in frame["unknown"]:
            each["shared"] = False
    assert not beyond(document)


def test_a_correction_that_may_stretch_the_arm_is_refused() -> None:
    document = bundle("dense-flow")
    assert agreed(document)[0]
    for frame in document["frames"]:
        for each in frame["unknown"]:
            each["amount"] = 5.0 if each["shared"] else each["amount"]
    assert beyond(document)

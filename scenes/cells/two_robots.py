"""Plans the other robot of the two-robots cells and writes its trajectories.

Run it by ``python -m assur.scenes.cells.two_robots``.

Its own request is two-robots-neighbour.yaml. In two-robots.yaml it does the whole of it; in two-robots-parked.yaml it
stops at the nest, as after a fault: the steps behind the one at the nest are left out. Whatever stands between the two
marks of those files is replaced by the knots; YAML and JSON write floats so that they are read back to the bit.
two-robots-late.yaml names the file with the whole answer, two-robots-neighbour.json.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from assur.scenes.requests import plan_document
from assur.scenes.scenarios import load_scenario

CELLS = Path(__file__).parent
BEGIN, END = "      # knots of the other robot: begin\n", "      # knots of the other robot: end\n"
STEPS = {"two-robots.yaml": 4, "two-robots-parked.yaml": 2}
"""How many steps of its task the other robot does in each cell."""


PLAN_FILE = "two-robots-neighbour.json"
"""The answer to all of the other robot's request, which two-robots-late.yaml names."""


def neighbour_request(steps: int) -> dict[str, Any]:
    """The other robot's request with the first `steps` steps of its task."""
    request = load_scenario(CELLS / "two-robots-neighbour.yaml").request
    return {**request, "task": request["task"][:steps]}


def knots(trajectory: dict[str, Any]) -> str:
    """A trajectory of an answer as YAML, one knot a line."""
    lines = ["trajectory:"]
    lines += [f"  {key}: {json.dumps(trajectory[key])}" for key in ("joint_names", "joint_units")]
    for key in ("time_s", "position", "velocity", "acceleration"):
        rows = [json.dumps(row) for row in trajectory[key]]
        lines += [f"  {key}:", *(f"    - {row}" for row in rows)]
    return "".join(f"      {line}\n" for line in lines)


def main() -> None:
    """Plan and write both."""
    answers = {name: plan_document(neighbour_request(steps), certificate="digest") for name, steps in STEPS.items()}
    for name, answer in answers.items():
        if answer["status"] != "planned":
            raise SystemExit(answer["sentence"])
        if name == "two-robots.yaml":
            (CELLS / PLAN_FILE).write_text(f"{json.dumps(answer)}\n", encoding="utf-8")
        path = CELLS / name
        head, rest = path.read_text(encoding="utf-8").split(BEGIN)
        tail = rest.split(END)[1]
        path.write_text(head + BEGIN + knots(answer["trajectory"]) + END + tail, encoding="utf-8")


if __name__ == "__main__":
    main()

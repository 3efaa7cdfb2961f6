"""The experiments, each a module of this package with a function `run() -> Result`. A new one adds a line here."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

from assur.experiments.experiment import Result
from assur.planner.errors import FaultError


@dataclass(frozen=True, slots=True)
class Entry:
    """An experiment by its `name`, what in which `source` it reproduces, and its `title`; `module` holds it."""

    name: str
    source: str
    title: str

    @property
    def module(self) -> str:
        return f"{__package__}.{self.name.replace('-', '_')}"

    def run(self) -> Result:
        """Run it; modules are imported one by one, so that one experiment costs what it needs."""
        result = import_module(self.module).run()
        if not isinstance(result, Result):
            raise FaultError(f"{self.module}.run gives no Result")
        return result


ENTRIES = (
    Entry("dyad-timing", "000, figure 4", "The RRR dyad in four formulations: time of a solution"),
    Entry("spiral", "000, equation 16 and figure 6", "A SCARA along a helix, and a tool that dwells on it"),
    Entry("five-bar", "000, conclusions", "The RRR group in a parallel arm: workspace and both kinds of singularity"),
    Entry("modes", "000 figure 1, 001, 004", "Two assemblies, two solutions, one convention"),
    Entry("dh-chain", "001, sections 4 and 5", "The Denavit-Hartenberg chain of a SCARA, and back"),
    Entry("line-through-singularity", "002, singular configurations", "A straight line past a singular position"),
    Entry("elbow", "002, geometric method and singular configurations", "An elbow arm in closed form, and its det J"),
    Entry("polar", "002, transformation matrices (I) to (III)", "A polar arm by matrices, and its det J"),
    Entry("oblique-triangles", "003, equations 1 to 6", "Half-angle formulas of oblique triangles against the dyad"),
    Entry("rv-m1", "003, section 5", "Five axes by tool point, pitch and roll, and the family of pitches"),
    Entry("joint-move", "004, section 2", "A joint move with parabolic blends, and the same move by Ruckig"),
)
"""In the order of the sources."""
